//! Scatter of friction between events, when there are only a few.
//!
//! With `s²` the variance of an event by its noise and `τ²` that between events, the values of `n`
//! events have the variance `v = s² + τ²`. Two or three values hardly determine it. So a prior is
//! stated: any order of magnitude of `τ` is as likely as any other, from the noise up to about 15 %
//! of the coefficient,
//!
//! `p(τ) ∝ exp(−½ (τ / 0.15 m)²) / (τ + s)`,
//!
//! and with the likelihood of the values, `v^(−(n−1)/2) exp(−Σ (x − m)² / 2v)`, this gives the mean
//! and the variance of `v`. The mean of the events is then distributed as Student's t, with the
//! degrees of freedom that give `v` this relative variance. From the ninth event on the prior is
//! not used.

use crate::num::math;

/// Number of events up to which the prior is used: nine give their variance to a half, `√(2/8)`.
pub(super) const FEW: u32 = 8;
/// Largest likely scatter, relative to the coefficient. Stated, not measured: with twice as much
/// the interval of two events is a tenth wider, that of three hardly.
const LARGEST: f32 = 0.15;
/// Number of values of `τ` for the moments, in equal steps of its logarithm, from a quarter of the
/// noise to three times [`LARGEST`].
const STEPS: u8 = 16;

/// Variance of an event's value about the mean, and its degrees of freedom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scatter {
    /// Variance by noise and friction together.
    pub(crate) variance: f32,
    /// 1 or more.
    pub(crate) freedom: f32,
}

impl Scatter {
    /// From `count` values, two or more, with this mean and sum of squared deviations; `noise` is
    /// the variance of each by its noise.
    pub(crate) fn of(count: u32, mean: f32, squares: f32, noise: f32) -> Self {
        let free = (count.max(2) - 1) as f32;
        if count > FEW {
            Self::seen(free, squares, noise)
        } else {
            Self::few(free, mean, squares, noise)
        }
    }

    /// From the values alone: the noise is known, the rest has `free` degrees of freedom (Welch and
    /// Satterthwaite).
    #[inline(never)]
    fn seen(free: f32, squares: f32, noise: f32) -> Self {
        let between = math::larger(squares / free - noise, 0.0);
        let variance = noise + between;
        let ratio = variance / math::larger(between, 1e-3 * variance);
        Self { variance, freedom: free * ratio * ratio }
    }

    /// With the prior: the moments of `v` over a grid of `τ`.
    fn few(free: f32, mean: f32, squares: f32, noise: f32) -> Self {
        let (noise_std, largest) = (math::sqrt(noise), LARGEST * mean.abs());
        let (first, last) = (0.25 * noise_std, 3.0 * largest);
        if !(first > 0.0 && last > first) {
            return Self::seen(free, squares, noise);
        }
        let step = math::exp(math::ln(last / first) / f32::from(STEPS - 1));
        // Likelihoods are relative to that of this variance, and near one.
        let likely = math::larger(squares / free, noise);
        let (mut sum, mut first_moment, mut second_moment) = (0.0, 0.0, 0.0);
        let mut between = first;
        for _ in 0..STEPS {
            let (ratio, part) = (noise / likely + between * between / likely, between / largest);
            let power = free * (math::ln(ratio) + squares / (free * likely * ratio));
            let weight = math::exp(-0.5 * (power + part * part)) * between / (between + noise_std);
            sum += weight;
            first_moment += weight * ratio;
            second_moment += weight * ratio * ratio;
            between *= step;
        }
        if !(sum > 0.0 && second_moment.is_finite()) {
            return Self::seen(free, squares, noise);
        }
        let (mean, square) = (first_moment / sum, second_moment / sum);
        let spread = math::larger(square - mean * mean, 1e-6 * mean * mean);
        // 2/(ν − 4) is the relative variance of v, and v (ν − 2)/ν the square of t's scale.
        let freedom = 4.0 + 2.0 * mean * mean / spread;
        Self { variance: likely * mean * (freedom - 2.0) / freedom, freedom }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(values: &[f32], noise_std: f32) -> Scatter {
        let n = values.len() as f32;
        let mean = values.iter().sum::<f32>() / n;
        let squares = values.iter().map(|x| (x - mean) * (x - mean)).sum();
        Scatter::of(values.len() as u32, mean, squares, noise_std * noise_std)
    }

    #[test]
    fn two_that_agree_do_not_prove_that_all_do() {
        let scatter = of(&[0.780, 0.781], 0.001);
        assert!(scatter.variance.sqrt() > 0.005, "{scatter:?}");
    }

    #[test]
    fn many_tell_what_they_show() {
        let values: [f32; 40] = core::array::from_fn(|i| 0.78 + 0.04 * (i % 2) as f32);
        let scatter = of(&values, 0.001);
        assert!((scatter.variance.sqrt() / 0.02 - 1.0).abs() < 0.02, "{scatter:?}");
        assert!((scatter.freedom - 39.0).abs() < 1.0);
        // Known noise has unlimited degrees of freedom.
        let noise = of(&[0.78; 40], 0.001);
        assert!(noise.freedom > 1e5 && (noise.variance.sqrt() / 0.001 - 1.0).abs() < 1e-3);
    }

    #[test]
    fn the_prior_ends_without_a_jump() {
        let values: [f32; 9] = [0.76, 0.80, 0.77, 0.79, 0.76, 0.80, 0.78, 0.77, 0.79];
        let width = |n: usize| {
            let scatter = of(&values[..n], 0.001);
            crate::stats::student::t95(scatter.freedom) * (scatter.variance / n as f32).sqrt()
        };
        assert!((width(9) / width(8) - 1.0).abs() < 0.15, "{} {}", width(8), width(9));
    }

    #[test]
    fn odd_numbers_are_no_trouble() {
        for (mean, squares, noise) in [(0.0, 0.0, 1e-6), (0.78, 0.0, 1e-18), (1e-30, 1e9, 1e18)] {
            let scatter = Scatter::of(2, mean, squares, noise);
            assert!(scatter.variance.is_finite() && scatter.freedom >= 1.0, "{scatter:?}");
        }
    }
}
