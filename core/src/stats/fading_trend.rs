//! A quantity that the events of a test share, such as the loading rate or the swing.
//!
//! Each event measures it, and the expectation of the next event is the mean with the variation
//! between events. Old events fade, so a cable that shortens or a winch that tires is followed. A
//! single outlier (the winch had paused) is ignored; three in a row mean that the quantity has
//! changed, and the past is dropped.
//!
//! A trend or a variance that has to be significant counts from its limit on, and fully from twice
//! that (`surely`): no expectation jumps because of a rounding error.

use crate::num::math::{self, larger};
use crate::stats::in_a_row::InARow;
use crate::stats::line::Line;
use crate::stats::prior::Prior;
use crate::stats::quantity::Quantity;
use crate::stats::significance::{SIGNIFICANT, surely};

/// Time constant of the forgetting, events. A choice: more make expectations more precise, fewer
/// follow a cable that gets shorter.
const MEMORY: f32 = 40.0;
/// Part of the past that is kept with every event, of all that the events share.
pub(crate) const FADE: f32 = 1.0 - 1.0 / MEMORY;
/// Least effective number of events (with forgetting) for an expectation: two events.
const LEAST_EVENTS: f32 = 1.5;
/// Least part of the events that have to measure a quantity. Tuned: with a sixth or two fifths no
/// class of `docs/honesty.md` changes, without it half of the slips of two thirds of a sample in a
/// real recording are refused.
const LEAST_PART: f32 = 0.25;
/// Standard errors beyond which a trend is significant: more, for it is tested with every event.
const TREND: f32 = 5.0;
/// Standard deviations beyond which an event is an outlier (normal: one in 5e8).
const FAR_OFF: f32 = 6.0;

/// Running mean of a quantity that events share, its trend, and its variance between events.
///
/// A weighted line over the events with weights `1/(s² + τ²)`: `s²` is the event's own variance,
/// `τ²` the variance between events, estimated with the squared weights. The trend counts in so far
/// as it is significant.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct FadingTrend {
    /// Line through the events so far, the newest at time −1.
    line: Line,
    /// Variance of the first event: weights are in units of one over it, so that their squares
    /// neither overflow nor vanish, whatever the size of the forces.
    unit: f32,
    /// Number of events, with forgetting: at most [`MEMORY`].
    count: f32,
    /// Σ w² (step² − s²) and Σ w², where a step is an event's distance from the line before it,
    /// less the part that is due to the line's own error.
    excess: f32,
    weight_squares: f32,
    /// Variance between events, `τ²`, in so far as it is significant.
    between: f32,
    /// Outliers in a row.
    strangers: InARow,
    /// Expected value of the next event, and its variance without that between events; zeros before
    /// the first event.
    pub(crate) now: (f32, f32),
}

impl FadingTrend {
    /// Applies the forgetting, and moves the trend on by an event. Called once an event, even if it
    /// adds nothing, so that an expectation that is too narrow does not exclude for good what could
    /// correct it.
    pub(crate) fn forget(&mut self) {
        self.line.shift(1.0);
        self.fade();
    }

    /// Moves the trend on by an event, without forgetting.
    pub(crate) fn pass(&mut self) {
        self.line.shift(1.0);
        self.now = self.at(NEXT);
    }

    /// Applies the forgetting; the trend stays where it is.
    pub(crate) fn fade(&mut self) {
        self.line.fade(FADE);
        self.count *= FADE;
        self.excess *= FADE;
        self.weight_squares *= FADE;
        self.now = self.at(NEXT);
    }

    /// Takes the newest event's own measurement and its variance. An outlier, or a number that is
    /// not finite, is ignored.
    pub(crate) fn add(&mut self, value: f32, variance: f32) {
        if !(value.is_finite() && variance.is_normal() && variance > 0.0) {
            return;
        }
        let (expected, expected_variance) = self.at(NEWEST);
        let step = value - expected;
        let usual = variance + self.between + expected_variance;
        let is_off = self.is_known() && step * step > FAR_OFF * FAR_OFF * usual;
        if self.strangers.take(is_off) {
            self.count = 0.0;
        } else if is_off {
            return;
        }
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

    /// Value of the line at a time, and its variance, without that between events; the slope counts
    /// in so far as it is significant.
    fn at(&self, time: f32) -> (f32, f32) {
        let slope = self.line.slope;
        let size = slope * slope * self.line.slope_weight;
        let near = surely(size, TREND * TREND * self.unit) * (time - self.line.time);
        let time = self.line.time + near;
        (self.line.at(time, slope), self.unit * self.line.leverage(time))
    }

    /// Variance between events: zero unless it exceeds what the events' own variances produce by
    /// chance.
    fn significant_excess(&self) -> f32 {
        let between = self.excess / self.weight_squares;
        if between <= 0.0 {
            return 0.0;
        }
        let own = self.count * self.unit / self.line.weight;
        let feigned = own * math::sqrt(2.0 / (self.count - 1.0));
        larger(between, 0.0) * surely(between, feigned)
    }

    /// Expected value of the next event; `None` before the first event.
    pub(crate) fn mean(&self) -> Option<f32> {
        (self.count > 0.0).then_some(self.now.0)
    }

    /// Expected value, with the standard deviation of [`Self::now`]; `None` before the first event.
    pub(crate) fn known(&self) -> Option<Quantity> {
        let (value, variance) = self.now;
        (self.count > 0.0).then(|| Quantity { value, std: math::sqrt(variance) })
    }

    /// Have three events measured it, and enough of those that measured `another`? For a quantity in
    /// which single events may be outliers.
    pub(crate) fn is_well_known(&self, another: &Self) -> bool {
        self.count > LEAST_EVENTS + 1.0 && self.count > LEAST_PART * another.count
    }

    /// Was the newest event an outlier, and left out?
    pub(crate) fn is_off(&self) -> bool {
        self.strangers.is_odd()
    }

    /// Have two events measured it?
    pub(crate) fn is_known(&self) -> bool {
        self.count >= LEAST_EVENTS
    }

    /// Prior of the next event. The weight is `noise_n2` over the variance between events plus that
    /// of the mean; zero before two events.
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

    /// Prior of a quantity that is zero unless the mean of the events is significant.
    pub(crate) fn prior_around_zero(&self, noise_n2: f32) -> Prior {
        let prior = self.prior(noise_n2);
        let mean = self.line.level_n;
        let limit = SIGNIFICANT * SIGNIFICANT * self.unit / self.line.weight;
        let sure = surely(mean * mean, limit);
        // Unless significant: around zero with a quarter of the prior's standard deviation.
        Prior { mean: sure * prior.mean, weight: (16.0 - 15.0 * sure) * prior.weight }
    }
}

/// Times of the line, in events: the event that is being added, and the one after it.
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
