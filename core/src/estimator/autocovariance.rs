//! Correlation between the events of a test, in order.
//!
//! Neighbouring events share a stick line, and real friction wanders: a mean over correlated values
//! is less precise than their number suggests. The autocovariances up to the lag [`LAGS`] are kept
//! as running sums, so that they can be computed about any mean.

use crate::num::double_single::DoubleSingle;
use crate::num::math;

/// Largest lag, events, whose correlation is followed. A quarter of the events is used at most, so
/// it limits records of more than 96; each lag takes 16 bytes of each mean's state.
pub const LAGS: usize = 24;

/// Running sums of products of values `x_i` with `x_{i+k}`, relative to a reference.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Correlation {
    /// The first value: all others are kept relative to it.
    reference: f32,
    /// Number of values.
    pub(super) count: u32,
    sum: DoubleSingle,
    /// The first values, and the last ones, newest first; zero where there are fewer.
    first: [f32; LAGS],
    last: [f32; LAGS],
    /// `Σ x_i x_{i+k}` for k = 1..=LAGS.
    products: [DoubleSingle; LAGS],
}

impl Correlation {
    /// Takes the next value.
    pub(crate) fn add(&mut self, value: f32) {
        if self.count == 0 {
            self.reference = value;
        }
        let x = value - self.reference;
        // In one loop: the product with each of the last values, and that value's move to the next
        // place.
        let mut newer = x;
        for (product, last) in self.products.iter_mut().zip(&mut self.last) {
            *product = product.plus_smaller(x * *last);
            newer = core::mem::replace(last, newer);
        }
        if let Some(slot) = self.first.get_mut(self.count as usize) {
            *slot = x;
        }
        self.sum += x;
        self.count = self.count.saturating_add(1);
    }

    /// Means of `(x_i − mean)(x_{i+k} − mean)` over the pairs of values `k` = 1, 2, ... apart, up to
    /// [`LAGS`].
    pub(crate) fn covariances(&self, mean: DoubleSingle) -> impl Iterator<Item = f32> {
        let m = mean - self.reference.into();
        let square = m.rounded() * m.rounded();
        // Σ (x_i + x_{i+k}) over these pairs.
        let mut sums = self.sum + self.sum;
        let ends = self.first.iter().zip(&self.last);
        let lags = (1..self.count).zip(&self.products).zip(ends);
        lags.map(move |((lag, product), (first, last))| {
            sums = sums - DoubleSingle::from(first + last);
            (*product - m * sums).rounded() / (self.count - lag) as f32 + square
        })
    }

    /// Factor by which the variance of the mean exceeds that of independent values, 1 or more:
    /// `I = 1 + 2 Σ ρ_k` over the `K` lags up to the first one whose correlation is not significant
    /// (Geyer's initial positive sequence, cut at one standard error), and at most up
    /// to a quarter of the number of values.
    ///
    /// The mean is that of the values themselves: it removes `I/n` of their variance, and as much
    /// from every covariance. So, with the observed correlations,
    /// `I = (1 + 2 Σ ρ_k) / (1 − 2 (K − Σ ρ_k) / n)`, and the variance of a value is
    /// `(n − 1) / (n − I)` times what it would be for independent values.
    pub(crate) fn inflation(&self, mean: DoubleSingle, variance: f32) -> f32 {
        if variance <= 0.0 {
            return 1.0;
        }
        let count = self.count as f32;
        let longest = self.count as usize / 4;
        let least = 1.0 / math::sqrt(count);
        let (mut missing, mut sum) = (0.0, 0.0);
        for covariance in self.covariances(mean).take(longest) {
            let correlation = math::smaller(covariance / variance, 1.0);
            if correlation <= least {
                break;
            }
            sum += correlation;
            missing += 1.0 - correlation;
        }
        // Not below a half: the lags are at most a quarter of the values.
        let inflation = (1.0 + 2.0 * sum) / (1.0 - 2.0 * missing / count);
        inflation * (count - 1.0) / (count - math::smaller(inflation, 0.5 * count))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::student::t95;
    use crate::tests::Random;

    /// A wandering row of numbers.
    fn value(i: usize) -> f64 {
        let x = i as f64;
        f64::from((0.8 + 0.05 * (0.1 * x).sin() + 0.01 * (1.7 * x * x).cos()) as f32)
    }

    fn all(from: usize, to: usize) -> Correlation {
        let mut c = Correlation::default();
        (from..to).for_each(|i| c.add(value(i) as f32));
        c
    }

    fn covariance(c: &Correlation, lag: usize, mean: f64) -> Option<f64> {
        c.covariances(mean.into()).nth(lag - 1).map(f64::from)
    }

    fn direct(n: usize, lag: usize, mean: f64) -> f64 {
        let d = |i: usize| value(i) - mean;
        (0..n - lag).map(|i| d(i) * d(i + lag)).sum::<f64>() / (n - lag) as f64
    }

    #[test]
    fn covariances_are_those_of_the_definition() {
        for n in [2, 3, LAGS - 1, LAGS, LAGS + 1, 64, 200] {
            for lag in [1, 2, 7, LAGS - 1, LAGS] {
                let got = covariance(&all(0, n), lag, 0.81);
                if lag >= n {
                    assert_eq!(got, None);
                } else {
                    let error = (got.unwrap() - direct(n, lag, 0.81)).abs();
                    assert!(error < 1e-9, "{n} {lag} {error}");
                }
            }
        }
    }

    #[test]
    fn a_wandering_mean_is_less_certain() {
        let c = all(0, 200);
        let mean = (0..200).map(value).sum::<f64>() / 200.0;
        let variance = (0..200).map(|i| (value(i) - mean).powi(2)).sum::<f64>() / 199.0;
        let inflation = c.inflation(mean.into(), variance as f32);
        assert!(inflation > 10.0, "{inflation}");
        let mut alternating = Correlation::default();
        (0..200).for_each(|i| alternating.add((i % 2) as f32));
        assert!((alternating.inflation(0.5_f32.into(), 0.25) - 1.0).abs() < 1e-9);
    }

    /// Rows of 134 values, each .9 of the one before and noise: nine of ten intervals cover the
    /// mean.
    #[test]
    fn intervals_of_rows_that_wander_hold_their_mean() {
        const ROWS: usize = 400;
        let mut random = Random(1);
        let mut held = 0;
        for _ in 0..ROWS {
            let mut x = random.normal() / 0.19_f32.sqrt();
            let row: [f32; 134] = core::array::from_fn(|_| {
                x = 0.9 * x + random.normal();
                x
            });
            let mean = row.iter().sum::<f32>() / 134.0;
            let variance = row.iter().map(|x| (x - mean) * (x - mean)).sum::<f32>() / 133.0;
            let mut c = Correlation::default();
            row.into_iter().for_each(|x| c.add(x));
            let inflation = c.inflation(mean.into(), variance);
            let reach = t95(133.0 / inflation);
            held += u32::from(mean * mean < reach * reach * inflation * variance / 134.0);
        }
        let coverage = held as f32 / ROWS as f32;
        assert!((0.86..0.97).contains(&coverage), "{coverage}");
    }
}
