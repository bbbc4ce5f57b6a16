//! What the events of a test share: the loading rate and omega.
//!
//! Each event measures both; the next one may expect them again, within what they
//! vary from event to event. Old events are forgotten slowly, so a cable that
//! shortens or a winch that tires is followed.

use crate::fit::Prior;
use crate::line::Line;
use crate::math;

/// Events over which the past is forgotten.
const MEMORY: f32 = 40.0;
const FADE: f32 = 1.0 - 1.0 / MEMORY;
/// Events before which nothing is expected.
const LEAST_EVENTS: f32 = 2.5;
/// Standard errors beyond which a value that should be zero, or a trend, counts: the
/// trend is looked at with every event.
const SIGNIFICANT: f32 = 3.0;
const TREND: f32 = 5.0;

/// Running mean of a quantity that events share, its trend, and how much it varies.
///
/// A weighted line over the events with weights `1/(s² + τ²)`: `s²` the event's own
/// variance, `τ²` the variance between events, estimated alongside with the squared
/// weights. The trend counts once it is significant.
#[derive(Clone, Copy, Debug, Default)]
pub struct Shared {
    /// Over the events so far, the newest at time −1.
    line: Line,
    /// Number of events, at most [`MEMORY`].
    count: f32,
    /// Σ w² (step² − s²) and Σ w²; a step without what the expectation adds to it.
    excess: f32,
    weight_squares: f32,
    between: f32,
}

impl Shared {
    /// Takes an event's own measurement and its variance.
    pub fn add(&mut self, value: f32, variance: f32) {
        if !(value.is_finite() && variance.is_finite() && variance > 0.0) {
            return;
        }
        let (expected, expected_variance) = self.forecast();
        self.count = (FADE * self.count) + 1.0;
        let weight = 1.0 / (variance + self.between);
        // The first value has nothing to differ from.
        if self.count > 1.0 {
            let (square, step) = (weight * weight, value - expected);
            let share = 1.0 / (1.0 + weight * expected_variance);
            self.excess = FADE * self.excess + square * (share * step * step - variance);
            self.weight_squares = FADE * self.weight_squares + square;
        }
        self.line.fade(FADE);
        self.line.add(0.0, value, weight);
        self.line.shift(1.0);
        if self.count > 1.0 {
            self.between = self.significant_excess();
        }
    }

    /// What comes next and the variance of that, without the variation between events.
    fn forecast(&self) -> (f32, f32) {
        match self.trend() {
            Some(trend) => (self.line.at(0.0, trend), self.line.leverage(0.0)),
            None => (self.line.level_n, 1.0 / self.line.weight),
        }
    }

    /// Change from event to event, if there is any to be seen.
    fn trend(&self) -> Option<f32> {
        let limit = TREND * TREND;
        self.line.slope().filter(|slope| slope * slope * self.line.slope_weight() > limit)
    }

    /// Variance between events; zero unless it is more than so few events can feign.
    fn significant_excess(&self) -> f32 {
        let between = self.excess / self.weight_squares;
        let own = self.count / self.line.weight;
        let feigned = own * math::sqrt(2.0 / (self.count - 1.0));
        if between > feigned { between } else { 0.0 }
    }

    /// The value now; `None` before the first event.
    #[must_use]
    pub fn mean(&self) -> Option<f32> {
        (self.count > 0.0).then(|| self.forecast().0)
    }

    /// What the next event may expect, in units of one over `noise_n2`: its variance
    /// is that between events plus that of the mean.
    #[must_use]
    pub fn prior(&self, noise_n2: f32) -> Prior {
        if self.count < LEAST_EVENTS {
            return Prior::default();
        }
        let (mean, variance) = self.forecast();
        Prior { mean, weight: noise_n2 / (self.between + variance) }
    }
}

impl Shared {
    /// The same for a quantity that is zero unless the events say otherwise.
    #[must_use]
    pub fn prior_around_zero(&self, noise_n2: f32) -> Prior {
        let prior = self.prior(noise_n2);
        let mean = self.line.level_n;
        if prior.weight <= 0.0 || mean * mean * self.line.weight > SIGNIFICANT * SIGNIFICANT {
            return prior;
        }
        // No sign of anything: half the standard error of the mean that says so.
        Prior { mean: 0.0, weight: 4.0 * prior.weight }
    }
}

/// What an event measured by itself, without the expectation it was fitted with.
///
/// `mean` and `variance` are the fitted ones; the precisions subtract. `None` when
/// less than the given part of the fitted precision is the event's own.
#[must_use]
pub fn without_prior(
    mean: f32,
    variance: f32,
    prior: Prior,
    noise_n2: f32,
    least: f32,
) -> Option<(f32, f32)> {
    let (fitted, expected) = (1.0 / variance, prior.weight / noise_n2);
    let own = fitted - expected;
    (own > least * fitted).then(|| ((fitted * mean - expected * prior.mean) / own, 1.0 / own))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_measurements_sharpen_the_expectation_and_scatter_widens_it() {
        let prior_after = |scatter: f32, events: u32| {
            let mut shared = Shared::default();
            (0..events).for_each(|i| shared.add(10.0 + scatter * (i % 2) as f32, 1.0));
            shared.prior(1.0)
        };
        assert!(prior_after(1.0, 2).weight <= 0.0);
        let (few, many) = (prior_after(1.0, 6), prior_after(1.0, 40));
        assert!(many.weight > few.weight && many.weight > 10.0, "{many:?}");
        let wide = prior_after(20.0, 40);
        assert!(wide.weight < 0.02, "{wide:?}");
        assert!((many.mean - 10.5).abs() < 0.1);
    }

    #[test]
    fn a_measurement_without_its_prior_is_the_measurement() {
        // Measured 12 ± 1, expected 10 ± 2 (noise variance 3).
        let prior = Prior { mean: 10.0, weight: 3.0 / 4.0 };
        let variance = 1.0 / (1.0 + 0.25);
        let mean = (12.0 + 10.0 * 0.25) * variance;
        let (value, own) = without_prior(mean, variance, prior, 3.0, 0.1).unwrap();
        assert!((value - 12.0).abs() < 1e-5 && (own - 1.0).abs() < 1e-5);
        assert!(without_prior(10.0, 4.0, prior, 3.0, 0.1).is_none());
    }
}
