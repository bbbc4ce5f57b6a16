//! From events to a coefficient: a mean and its standard error.
//!
//! The events differ by their own noise, whose variance each states, and by real variation of the
//! friction, whose variance is estimated: random effects. All sums are kept to 48 bits
//! (`DoubleSingle`), relative to the running mean, so a million events lose nothing. What one event
//! adds is rounded to 24 bits, and so are the sums when they are read.
//!
//! With `s_i` an event's standard deviation, `τ²` the variance between events:
//!
//! - `τ² = max(0, S² − mean s_i²)`, `S²` the sample variance (method of moments), or, with the
//!   weights `w_i = 1/s_i²`, `(Σ w_i (x_i − m_w)² − (n − 1)) / (Σ w_i − Σ w_i² / Σ w_i)`
//!   (DerSimonian and Laird) if that is more: where a few events are much more precise than most,
//!   only these determine the scatter of friction. With few events a stated prior is used
//!   (`Scatter`); one event carries no information on `τ²`;
//! - mean `m = λ m_w + (1 − λ) m_1`: `m_w` weighted by `1/s_i²`, `m_1` plain,
//!   `λ = s̄²/(s̄² + τ²)` with `s̄²` the harmonic mean of `s_i²`; `m_w` is the best mean for
//!   small `τ²`, `m_1` for large `τ²`;
//! - errors that are common to the events do not average out: the mean keeps their mean size
//!   ([`Common`]), given apart from the random ones. While no parameter of the model has moved a
//!   coefficient, the size that the newest events state holds for all;
//! - variance of `m` from the same weights, times `1 + 2 Σ ρ_k` with the correlations
//!   `ρ_k` of the events in order, and degrees of freedom divided by that: two neighbours share the
//!   stick line between them, and real friction wanders.

mod autocovariance;
mod scatter;

pub use crate::estimator::autocovariance::LAGS;

use crate::coefficient::{Coefficient, Estimate};
use crate::estimator::autocovariance::Correlation;
use crate::estimator::scatter::{FEW, Scatter};
use crate::num::double_single::DoubleSingle;
use crate::num::math::{self, larger};

/// Parts of an event's standard deviation that are common to all events.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Common {
    /// By parameters that the model learns from the events: weighted in the mean as the event is.
    pub shared: f32,
    /// By assumptions that all events need where samples are few. The least precise events show
    /// this part, and the others rest on it as well: it has the same weight in every event.
    pub granted: f32,
    /// Have the parameters moved the coefficient? While they have moved none, all coefficients rest
    /// on the same assumptions, and the newest and best knowledge of the parameters holds for all.
    pub moved: bool,
}

/// Number of the newest events whose shared part holds for all. Tuned: with 16 the means of 400
/// records of dff8-13 scatter by .89 of their standard deviations, with 8 by .92.
const RECENT: f32 = 8.0;

impl Common {
    /// Moves these means by the part `share` towards an event's, and the shared part by
    /// [`Self::newest`].
    fn follow(&mut self, event: Self, share: f32) {
        self.moved |= event.moved;
        self.granted += share * (event.granted - self.granted);
        self.shared += self.newest(share) * (event.shared - self.shared);
    }

    /// Weight of the newest event in the shared part: `share`, or that of a running mean over
    /// [`RECENT`] events while no parameter has moved a coefficient.
    fn newest(&self, share: f32) -> f32 {
        if self.moved { share } else { larger(share, 1.0 / RECENT) }
    }
}

/// Running mean of one coefficient over events.
#[derive(Clone, Copy, Debug, Default)]
pub struct Estimator {
    /// Plain mean and Σ (x − mean)².
    mean: DoubleSingle,
    squares: DoubleSingle,
    /// Mean of the events' variances.
    variance: DoubleSingle,
    /// Weighted mean, Σ w, Σ w².
    weighted_mean: DoubleSingle,
    weight: DoubleSingle,
    weight_squares: DoubleSingle,
    /// Σ w (x − weighted mean)², and Σ w_i w_j over the pairs of events.
    weighted_squares: DoubleSingle,
    weight_pairs: DoubleSingle,
    correlation: Correlation,
    /// Means of the common parts of the events' standard deviations: plain ones, and a weighted one
    /// of the shared part.
    common: Common,
    weighted_shared: f32,
}

impl Estimator {
    /// Takes an event's coefficient. One without a finite value, or with a standard deviation below
    /// 1e-9 or above 1e9, is left out.
    pub fn add(&mut self, event: Coefficient) {
        self.add_with_common(event, Common::default());
    }

    /// Takes an event's coefficient, see [`Self::add`], with the parts of its standard deviation in
    /// common with the others: the mean keeps these parts, however many events there are.
    pub fn add_with_common(&mut self, event: Coefficient, common: Common) {
        if !(event.value.is_finite() && (1e-9..=1e9).contains(&event.std)) {
            return;
        }
        let (value, variance) = (event.value, event.std * event.std);
        self.correlation.add(value);
        // One event moves a mean by a part of its distance from it: that step may be rounded, the
        // mean is not.
        let count = self.count();
        let (n, share) = ((count - 1) as f32, 1.0 / count as f32);
        let from = |mean: DoubleSingle, value: f32| (DoubleSingle::from(value) - mean).rounded();
        let step = from(self.mean, value);
        self.squares += n * share * step * step;
        self.mean += share * step;
        self.variance += share * from(self.variance, variance);
        self.common.follow(common, share);
        let weight = 1.0 / variance;
        let before = self.weight.rounded();
        self.weight_pairs += before * weight;
        self.weight += weight;
        let (share, step) = (weight / self.weight.rounded(), from(self.weighted_mean, value));
        self.weighted_squares += before * share * step * step;
        self.weighted_mean += share * step;
        let newest = self.common.newest(share);
        self.weighted_shared += newest * (common.shared - self.weighted_shared);
        self.weight_squares += weight * weight;
    }

    /// Number of events that count.
    #[must_use]
    pub fn count(&self) -> u32 {
        self.correlation.count
    }

    /// Mean, standard error and spread; `None` without events. The systematic part is that common
    /// to the events, without the inputs.
    #[must_use]
    pub fn estimate(&self) -> Option<Estimate> {
        if self.count() == 0 {
            return None;
        }
        let (own, mean) = (self.variance.rounded(), self.mean.rounded());
        let scatter = (self.count() > 1)
            .then(|| Scatter::of(self.count(), mean, self.squares.rounded(), own));
        let seen = self.between();
        // With few events the prior counts.
        let between = match scatter {
            Some(scatter) if self.count() <= FEW => larger(scatter.variance - own, 0.0),
            _ => seen.unwrap_or_default(),
        };
        let n = self.count() as f32;
        let typical = n / self.weight.rounded();
        let lambda = typical / (typical + between);
        let mean = mean + lambda * (self.weighted_mean - self.mean).rounded();
        let rest = 1.0 - lambda;
        let uneven = typical * typical * self.weight_squares.rounded() / n - 1.0;
        let noise = typical + rest * rest * (own - typical);
        let independent = (noise + between + between * lambda * lambda * uneven) / n;
        let inflation = self.inflation(lambda);
        let variance = independent * inflation;
        let Common { shared, granted, .. } = self.common;
        let shared = shared + lambda * (self.weighted_shared - shared);
        let common_std = math::hypotenuse(shared, granted);
        Some(Estimate {
            mean,
            std_error: scatter.map(|_| math::sqrt(variance)),
            // Correlated values determine their scatter as fewer independent ones do.
            freedom: scatter.map_or(0.0, |scatter| scatter.freedom / inflation),
            systematic_std: common_std,
            common_std,
            spread: seen.map(math::sqrt),
            events: self.count(),
        })
    }

    /// Variance between events, without the noise; `None` before two events.
    fn between(&self) -> Option<f32> {
        let free = (self.count().checked_sub(2)? + 1) as f32;
        let plain = larger(self.squares.rounded() / free - self.variance.rounded(), 0.0);
        if self.count() <= FEW {
            return Some(plain);
        }
        // Σ w − Σ w² / Σ w, without a difference of near equals.
        let pairs = 2.0 * self.weight_pairs.rounded() / self.weight.rounded();
        Some(larger((self.weighted_squares.rounded() - free) / pairs, plain))
    }

    /// Factor on the variance of the mean for the correlation of the events: as estimated, from
    /// thirty events on, but at least that of neighbours which share one of their two stick lines.
    /// Their correlation is a sixth of the noise's share of the variance: tuned, so that the means
    /// of 400 tests scatter as they say (`means` among the examples of the tests).
    fn inflation(&self, noise_share: f32) -> f32 {
        const ENOUGH: u32 = 30;
        const NEIGHBOURS: f32 = 0.18;
        let shared_line = if self.count() > 1 { 1.0 + 2.0 * NEIGHBOURS * noise_share } else { 1.0 };
        if self.count() < ENOUGH {
            return shared_line;
        }
        let variance = self.squares.rounded() / self.count() as f32;
        larger(self.correlation.inflation(self.mean, variance), shared_line)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn coefficient(value: f32, std: f32) -> Coefficient {
        Coefficient::random(value, std)
    }

    fn all(values: &[(f32, f32)]) -> Estimator {
        let mut e = Estimator::default();
        values.iter().for_each(|&(v, s)| e.add(coefficient(v, s)));
        e
    }

    const VALUES: [(f32, f32); 7] = [
        (1.24, 0.01),
        (1.21, 0.02),
        (1.29, 0.01),
        (1.18, 0.05),
        (1.25, 0.01),
        (1.22, 0.03),
        (1.27, 0.02),
    ];

    /// Sixty imprecise events must not hide the scatter of the three precise ones.
    #[test]
    fn a_few_sharp_events_show_the_scatter() {
        let mut e = all(&[(1.21, 1e-3), (1.24, 1e-3), (1.27, 1e-3)]);
        (0..60_u8).for_each(|i| e.add(coefficient(1.24 + 0.005 * f32::from(i % 5), 0.03)));
        let estimate = e.estimate().unwrap();
        assert!(estimate.spread.is_some_and(|spread| spread > 0.02), "{estimate:?}");
        assert!(estimate.std_error.is_some_and(|std| (0.003..0.01).contains(&std)), "{estimate:?}");
    }

    #[test]
    fn nothing_in_nothing_out() {
        let mut e = all(&[(f32::NAN, 1.0), (1.0, 0.0), (1.0, f32::INFINITY)]);
        assert_eq!(e.estimate(), None);
        e.add(coefficient(0.5, 0.1));
        let one = e.estimate().unwrap();
        assert!((one.mean - 0.5).abs() < 1e-6);
        assert_eq!((one.std_error, one.ci95(), one.spread, one.events), (None, None, None, 1));
    }

    #[test]
    fn equals_the_batch_formulas() {
        let x = VALUES.map(|v| f64::from(v.0));
        let n = x.len() as f64;
        let mean = x.iter().sum::<f64>() / n;
        let e = all(&VALUES);
        let noise = VALUES.iter().map(|v| f64::from(v.1).powi(2)).sum::<f64>() / n;
        let spread = (x.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0) - noise).sqrt();
        assert!((f64::from(e.estimate().unwrap().spread.unwrap()) - spread).abs() < 1e-6);
    }

    #[test]
    fn pure_noise_is_weighted_and_real_variation_is_not() {
        // No variation beyond the noise: a precise event dominates.
        let values = [(1.0, 0.001), (1.05, 0.1), (0.95, 0.1), (1.0, 0.1), (1.0, 0.1)];
        let noise = all(&[values, values].concat()).estimate().unwrap();
        assert!((noise.mean - 1.0).abs() < 1e-3 && noise.spread == Some(0.0));
        // Much more variation than noise: all events have the same weight.
        let real = all(&[(1.0, 0.001), (1.5, 0.01), (0.5, 0.01), (1.4, 0.01)]).estimate().unwrap();
        assert!((real.mean - 1.1).abs() < 1e-3, "{}", real.mean);
        assert!(real.std_error.unwrap() > 0.15);
    }

    /// The shared part of the first events stays in the mean with the weight of these events.
    #[test]
    fn what_unsure_events_share_weighs_no_more_than_they_do() {
        let of = |common: Common| {
            let mut e = Estimator::default();
            (0..3).for_each(|_| e.add_with_common(coefficient(1.0, 0.01), common));
            (0..60).for_each(|_| e.add(coefficient(1.0, 0.001)));
            e.estimate().unwrap().common_std
        };
        // Σ w c / Σ w and Σ c / n.
        let shared = of(Common { shared: 0.01, granted: 0.0, moved: true });
        assert!((shared / 5e-6 - 1.0).abs() < 0.01, "{shared}");
        // No parameter has moved a coefficient: the sixty events that share nothing hold for all.
        let newest = of(Common { shared: 0.01, granted: 0.0, moved: false });
        assert!(newest < 1e-5, "{newest}");
        let granted = of(Common { shared: 0.0, granted: 0.01, moved: false });
        assert!((granted / (0.03 / 63.0) - 1.0).abs() < 0.01, "{granted}");
    }

    #[test]
    fn a_million_events_do_not_stagnate() {
        let mut e = Estimator::default();
        for i in 0..1_000_000_u32 {
            // The second half is higher by a thousandth.
            let value = 0.78 + if i < 500_000 { 0.0 } else { 0.001 };
            e.add(coefficient(value, 0.0005));
        }
        let mean = e.estimate().unwrap().mean;
        assert!((mean - 0.7805).abs() < 1e-6, "{mean}");
    }
}
