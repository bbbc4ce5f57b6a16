//! Noise of a force that never rests: the remainder without its oscillation.
//!
//! The second differences `u` of a sinusoid with the angle `ω` per sample obey `u'' + p u' + u = 0`
//! with `p = −2 cos ω` (primes count samples). Least squares over the recent past give `p`. White
//! noise leaves a remainder of `2 + 2 (p − 2)² + 4 (1 − p)²` times its variance, the squared
//! weights of five samples. (At `p = −2`, a slow oscillation, it is the fourth difference.) The
//! remainder is an upper bound of the noise.

use crate::num::math::larger;

/// Time constant of the forgetting, samples: 64 give a variance to a fifth, `√(2/64)`.
const MEMORY: f32 = 64.0;
/// Least effective number of samples for an estimate: right to a quarter, `√(2/30)`.
const FEWEST: f32 = 30.0;
/// A smooth oscillation leaves less than this part of its squared second differences, both in units
/// of what white noise has. Tuned: with more, noise is now and then taken for an oscillation.
const LITTLE: f32 = 0.3;
/// Rounding error of the squares in single precision, parts of them: some seventy units of 2⁻²⁴.
const ROUNDING: f32 = 4e-6;

/// Running sums over the recent second differences.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct WithoutOscillation {
    /// Σ u'²: of the one in the middle.
    middle_n2: f32,
    /// Σ (u + u'') u'.
    product_n2: f32,
    /// Σ (u + u'')².
    outer_n2: f32,
    count: f32,
}

impl WithoutOscillation {
    /// Takes the sum of two second differences, N, and the one between them.
    pub(crate) fn add(&mut self, outer_n: f32, middle_n: f32) {
        const FADE: f32 = 1.0 - 1.0 / MEMORY;
        self.middle_n2 = FADE * self.middle_n2 + middle_n * middle_n;
        self.product_n2 = FADE * self.product_n2 + outer_n * middle_n;
        self.outer_n2 = FADE * self.outer_n2 + outer_n * outer_n;
        self.count = FADE * self.count + 1.0;
    }

    /// Variance of white noise that leaves the same remainder, N²; `None` before enough samples, and
    /// for a period of less than three samples (`p > 1`): hum of the mains has one at most rates, and
    /// slips that recur as fast are refused.
    pub(crate) fn noise_n2(&self) -> Option<f32> {
        let p = -self.product_n2 / self.middle_n2;
        let left_n2 = larger(self.outer_n2 + p * self.product_n2, ROUNDING * self.outer_n2);
        let gain = 2.0 + 2.0 * (p - 2.0) * (p - 2.0) + 4.0 * (1.0 - p) * (1.0 - p);
        (self.count >= FEWEST && self.middle_n2 > 0.0 && p <= 1.0)
            .then(|| left_n2 / (gain * self.count))
    }

    /// Is a variance, N², far less than that of white noise with these second differences, whose
    /// mean square is six times its variance?
    pub(crate) fn leaves_little(&self, noise_n2: f32) -> bool {
        6.0 * noise_n2 * self.count < LITTLE * self.middle_n2
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::num::math;
    use crate::tests::Random;

    /// Mean estimate of the noise's standard deviation, N: for noise of 2 N and an oscillation of
    /// this amplitude, with this period in samples.
    fn seen(amplitude_n: f32, samples: f32) -> Option<f32> {
        let (mut oscillation, mut random) = (WithoutOscillation::default(), Random(3));
        let mut last = [0.0; 5];
        let mut mean_n2 = 0.0;
        for i in 0..1500_u16 {
            last.rotate_left(1);
            let turn = core::f32::consts::TAU * f32::from(i) / samples;
            last[4] = amplitude_n * math::sin_cos(turn % core::f32::consts::TAU).0
                + 2.0 * random.normal();
            let [a, b, c, d, e] = last;
            oscillation.add(a - 2.0 * (b - c + d) + e, b - 2.0 * c + d);
            if i >= 500 {
                mean_n2 += oscillation.noise_n2()? / 1000.0;
            }
        }
        Some(math::sqrt(mean_n2))
    }

    #[test]
    fn the_noise_is_left_whatever_the_oscillation() {
        for (amplitude_n, samples) in [(300.0, 3.3), (300.0, 4.03), (900.0, 6.1), (900.0, 20.0)] {
            let std_n = seen(amplitude_n, samples).unwrap();
            assert!((std_n - 2.0).abs() < 0.1, "{std_n} N, {samples} samples");
        }
    }

    #[test]
    fn white_noise_and_fast_hum_are_no_slips() {
        assert_eq!([(0.0, 1.0), (20.0, 2.5), (20.0, 2.02)].map(|(n, it)| seen(n, it)), [None; 3]);
    }

    #[test]
    fn few_samples_and_a_force_that_stands_still_tell_nothing() {
        let mut oscillation = WithoutOscillation::default();
        (0..20_u8).for_each(|i| oscillation.add(f32::from(i % 3), f32::from(i % 2)));
        assert!(oscillation.noise_n2().is_none());
        let mut still = WithoutOscillation::default();
        (0..200).for_each(|_| still.add(0.0, 0.0));
        assert!(still.noise_n2().is_none());
    }
}
