//! A quantity that the events of a test share, such as the loading rate or the swing.
//!
//! Each event measures it; the next one may expect it again, within what it varies from event to
//! event. Old events fade, so a cable that shortens or a winch that tires is followed. A single
//! event that is far off (the winch had paused) is ignored; three in a row mean that the quantity
//! has changed, and the past is dropped.
//!
//! What counts only when it is significant counts from its limit on, and fully from twice that
//! (`surely`): no expectation jumps because of a last digit.

use crate::num::math::{self, larger};
use crate::stats::line::Line;
use crate::stats::prior::{Prior, surely};
use crate::stats::quantity::Quantity;

/// Events over which the past is forgotten. A choice: more make expectations surer, fewer follow a cable
/// that gets shorter.
const MEMORY: f32 = 40.0;
/// Fewest events, their number fading, that give an expectation: two.
const LEAST_EVENTS: f32 = 1.5;
/// Standard errors beyond which the mean of a quantity that should be zero counts: of normal ones one
/// in 370.
const SIGNIFICANT: f32 = 3.0;
/// Standard errors beyond which a trend counts: more, for it is looked at with every event.
const TREND: f32 = 5.0;
/// Standard deviations beyond which an event is far off: of normal ones one in 5e8.
const FAR_OFF: f32 = 6.0;
/// So many far off in a row: the quantity has changed, and the past is dropped. A pause of the winch
/// spoils a stick line, and with it the two events that share it.
const CHANGED: u8 = 3;

/// Running mean of a quantity that events share, its trend, and how much it varies.
///
/// A weighted line over the events with weights `1/(s² + τ²)`: `s²` the event's own
/// variance, `τ²` the variance between events, estimated alongside with the squared
/// weights. The trend counts once it is significant.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct FadingTrend {
    /// Over the events so far, the newest at time −1.
    line: Line,
    /// Variance of the first event: weights are in units of one over it, so that their squares
    /// neither overflow nor vanish, whatever the size of the forces.
    unit: f32,
    /// Number of events, fading: at most [`MEMORY`].
    count: f32,
    /// Σ w² (step² − s²) and Σ w², where a step is an event's distance from the line before it,
    /// without the part that is the line's own error.
    excess: f32,
    weight_squares: f32,
    /// Variance between events, `τ²`, as far as it is significant.
    between: f32,
    /// Events in a row that were far off.
    strangers: u8,
    /// The value that the next event may expect, and its variance without that between events;
    /// zeros before the first event.
    now: (f32, f32),
}

impl FadingTrend {
    /// Lets the past count for less, and moves the trend on by an event. Once an event, whether or
    /// not it tells anything, so that no expectation that is too sure of itself shuts out for good
    /// what could correct it.
    pub(crate) fn forget(&mut self) {
        self.line.shift(1.0);
        self.fade();
    }

    /// Moves the trend on by an event; the past counts as much as before.
    pub(crate) fn pass(&mut self) {
        self.line.shift(1.0);
        self.now = self.at(NEXT);
    }

    /// Lets the past count for less; the trend stays where it is.
    #[inline(never)]
    pub(crate) fn fade(&mut self) {
        const FADE: f32 = 1.0 - 1.0 / MEMORY;
        self.line.fade(FADE);
        self.count *= FADE;
        self.excess *= FADE;
        self.weight_squares *= FADE;
        self.now = self.at(NEXT);
    }

    /// Takes the newest event's own measurement and its variance. One that is no finite number, or
    /// far off, is ignored.
    pub(crate) fn add(&mut self, value: f32, variance: f32) {
        if !(value.is_finite() && variance.is_normal() && variance > 0.0) {
            return;
        }
        let (expected, expected_variance) = self.at(NEWEST);
        let step = value - expected;
        let usual = variance + self.between + expected_variance;
        if self.is_known() && step * step > FAR_OFF * FAR_OFF * usual {
            self.strangers += 1;
            if self.strangers < CHANGED {
                return;
            }
            self.count = 0.0;
        }
        self.strangers = 0;
        if self.count <= 0.0 {
            *self = Self { unit: variance, ..Self::default() };
        }
        let weight = self.unit / (variance + self.between);
        let square = weight * weight;
        if !square.is_normal() {
            return;
        }
        self.line.add(NEWEST, value, weight, 1.0);
        self.count += 1.0;
        // The first value has nothing to differ from.
        if self.count > 1.0 {
            let share = 1.0 / (1.0 + weight * expected_variance / self.unit);
            self.excess += square * (share * step * step - variance);
            self.weight_squares += square;
            self.between = self.significant_excess();
        }
        self.now = self.at(NEXT);
    }

    /// The value at a time and its variance, without the variation between events: on
    /// the line as far as its slope is significant.
    fn at(&self, time: f32) -> (f32, f32) {
        let slope = self.line.slope().unwrap_or(0.0);
        let size = slope * slope * self.line.slope_weight();
        let near = surely(size, TREND * TREND * self.unit) * (time - self.line.time);
        let time = self.line.time + near;
        (self.line.at(time, slope), self.unit * self.line.leverage(time))
    }

    /// Variance between events: zero unless it is more than the own variances of so few events can
    /// feign.
    fn significant_excess(&self) -> f32 {
        let between = self.excess / self.weight_squares;
        if between <= 0.0 {
            return 0.0;
        }
        let own = self.count * self.unit / self.line.weight;
        let feigned = own * math::sqrt(2.0 / (self.count - 1.0));
        larger(between, 0.0) * surely(between, feigned)
    }

    /// The value that the next event may expect; `None` before the first event.
    #[must_use]
    pub(crate) fn mean(&self) -> Option<f32> {
        (self.count > 0.0).then_some(self.now.0)
    }

    /// That value and its variance without that between events; zeros before the first event.
    pub(crate) fn now(&self) -> (f32, f32) {
        self.now
    }

    /// That value with its standard deviation; `None` before the first event.
    pub(crate) fn known(&self) -> Option<Quantity> {
        let (value, variance) = self.now;
        (self.count > 0.0).then(|| Quantity { value, std: math::sqrt(variance) })
    }

    /// Have three events told it? For a quantity in which single events may be far off.
    pub(crate) fn is_well_known(&self) -> bool {
        self.count > LEAST_EVENTS + 1.0
    }

    /// Was the newest event far off, and left out?
    pub(crate) fn is_off(&self) -> bool {
        self.strangers > 0
    }

    /// Have two events told it?
    #[must_use]
    pub(crate) fn is_known(&self) -> bool {
        self.count >= LEAST_EVENTS
    }

    /// What the next event may expect. The weight is `noise_n2` over the variance between events
    /// plus that of the mean; zero before two events.
    #[must_use]
    #[inline(never)]
    pub(crate) fn prior(&self, noise_n2: f32) -> Prior {
        if !self.is_known() {
            return Prior::default();
        }
        let (mean, variance) = self.now;
        Prior { mean, weight: noise_n2 / (self.between + variance) }
    }

    /// Adds `by` to all values that were measured so far.
    pub(crate) fn translate(&mut self, by: f32) {
        self.line.level_n += by;
        self.now.0 += by;
    }

    /// As [`Self::prior`], for a quantity that is zero unless the events say otherwise.
    #[must_use]
    pub(crate) fn prior_around_zero(&self, noise_n2: f32) -> Prior {
        let prior = self.prior(noise_n2);
        let mean = self.line.level_n;
        let limit = SIGNIFICANT * SIGNIFICANT * self.unit / self.line.weight;
        let sure = surely(mean * mean, limit);
        // Around zero: within a quarter of the standard error of the mean that shows nothing else.
        Prior { mean: sure * prior.mean, weight: (16.0 - 15.0 * sure) * prior.weight }
    }
}

/// Times of the line, in events: the event that is being learnt, and the one after it.
const NEWEST: f32 = -1.0;
const NEXT: f32 = 0.0;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::prior::without_prior;

    #[test]
    fn equal_measurements_sharpen_the_expectation_and_scatter_widens_it() {
        let prior_after = |scatter: f32, events: u32| {
            let mut shared = FadingTrend::default();
            (0..events).for_each(|i| {
                shared.forget();
                shared.add(10.0 + scatter * (i % 2) as f32, 1.0);
            });
            shared.prior(1.0)
        };
        assert!(prior_after(1.0, 1).weight <= 0.0);
        let (few, many) = (prior_after(1.0, 6), prior_after(1.0, 40));
        assert!(many.weight > few.weight && many.weight > 10.0, "{many:?}");
        let wide = prior_after(20.0, 40);
        assert!(wide.weight < 0.02, "{wide:?}");
        assert!((many.mean - 10.5).abs() < 0.1);
    }

    #[test]
    fn one_far_off_teaches_nothing_and_three_in_a_row_begin_anew() {
        let mut shared = FadingTrend::default();
        (0..20).for_each(|i| shared.add(22.5 + 0.01 * (i % 2) as f32, 1e-3));
        for (times, mean) in [(1, 22.5), (1, 22.5), (1, 30.0)] {
            (0..times).for_each(|_| shared.add(30.0, 1e-12));
            assert!((shared.mean().unwrap() - mean).abs() < 0.01, "{shared:?}");
        }
        assert!(shared.prior(1.0).weight <= 0.0);
        (0..5).for_each(|_| shared.add(30.0, 1e-3));
        assert!((shared.mean().unwrap() - 30.0).abs() < 0.01 && shared.prior(1.0).weight > 0.0);
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
