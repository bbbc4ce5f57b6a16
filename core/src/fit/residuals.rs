//! What the fits leave over: the noise that is reported and that scales every
//! standard deviation.

use crate::num::math::{self, smaller};
use crate::stats::prior::surely;
use crate::stats::quantile::Quantile;

/// Pooled residuals of the events' fits.
///
/// The mean square over all degrees of freedom, without events that fit badly (a
/// start in the middle of things, a slip that was none).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Residuals {
    squares_n2: f32,
    free: f32,
    median_n2: Quantile,
}

/// Degrees of freedom after which old events fade: they tell the noise to about 1 %, `1/√(2 × 4000)`.
const MEMORY: f32 = 8000.0;
/// An event whose residuals are so many times those of the median event is left out: with ten degrees
/// of freedom chance does that once in 3e8.
const LIMIT: f32 = 6.0;
/// An event whose residuals are so many times the usual ones does not fit: as if every sample were off
/// by seven standard deviations.
const MISFIT: f32 = 50.0;

/// What the first events may leave in each degree of freedom, times the rough noise variance. Tuned: with
/// 1.5 events of `creep_quiet` are eleven standard deviations off.
const ROUGH: f32 = 3.0;

impl Residuals {
    /// Nothing yet.
    #[must_use]
    pub(crate) const fn new() -> Self {
        Self { squares_n2: 0.0, free: 0.0, median_n2: Quantile::new(0.5) }
    }

    /// Takes an event's squared residuals and their degrees of freedom.
    ///
    /// `rough_n2` is a rough variance of the noise, for the first events.
    pub(crate) fn add(&mut self, squares_n2: f32, free: f32, rough_n2: f32) {
        // Median of χ²/ν over its mean (Wilson and Hilferty).
        let skew = 1.0 - 2.0 / (9.0 * math::larger(free, 1.0));
        // Limits foul events among the first ones to what the median comes back from.
        let most_n2 = LIMIT * ROUGH * rough_n2;
        self.median_n2.add(math::smaller(squares_n2 / (free * skew * skew * skew), most_n2));
        let limit = LIMIT * self.usual_n2(rough_n2);
        if self.free > MEMORY {
            self.squares_n2 *= 0.5;
            self.free *= 0.5;
        }
        if self.squares_n2 > limit * self.free {
            // What was pooled before the median was known does not belong.
            self.free = smaller(self.free, 2.0);
            self.squares_n2 = limit / LIMIT * self.free;
        }
        if squares_n2 <= limit * free {
            self.squares_n2 += squares_n2;
            self.free += free;
        }
    }

    /// Does an event leave so much more than the others that the model cannot be what
    /// its samples show? The winch paused or started, the block hit something.
    ///
    /// `rough_n2` is a rough variance of the noise, for the first events, `rounding_n2` the variance of
    /// what single precision leaves of its forces.
    #[must_use]
    pub(crate) fn is_outlier(
        &self,
        squares_n2: f32,
        free: f32,
        (rough_n2, rounding_n2): (f32, f32),
    ) -> bool {
        let usual_n2 = self.usual_n2(rough_n2) + rounding_n2;
        squares_n2 > MISFIT * usual_n2 * math::larger(free, 1.0)
    }

    /// The median, or what the first events may leave.
    #[inline(never)]
    fn usual_n2(&self, rough_n2: f32) -> f32 {
        self.median_n2.value().unwrap_or(ROUGH * rough_n2)
    }

    /// Degrees of freedom that count.
    #[must_use]
    pub(crate) fn free(&self) -> f32 {
        self.free
    }

    /// Variance of the noise, N²; `None` before the first event.
    #[must_use]
    pub(crate) fn variance_n2(&self) -> Option<f32> {
        (self.free >= 1.0).then(|| self.squares_n2 / self.free)
    }
}

/// How many times the noise variance the mean square of an event's own residuals is (the square of
/// Birge's ratio), where that is clear; else 1. What the model lacks in one event is seldom what it
/// lacks in the next.
#[must_use]
pub(crate) fn excess_ratio(squares_n2: f32, free: f32, noise_n2: f32) -> f32 {
    // Standard errors.
    const SIGNIFICANT: f32 = 4.0;
    let free = math::larger(free, 1.0);
    let more = squares_n2 / (free * noise_n2) - 1.0;
    if more <= 0.0 {
        return 1.0;
    }
    1.0 + more * surely(more, SIGNIFICANT * math::sqrt(2.0 / free))
}

impl Default for Residuals {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first events are compared with the detector's noise, later ones with what they leave themselves.
    #[test]
    fn a_foul_event_is_told_from_the_first_one_on() {
        let (mut residuals, known) = (Residuals::new(), (4.0, 0.0));
        assert!(residuals.is_outlier(20.0 * 1000.0, 20.0, known));
        assert!(!residuals.is_outlier(20.0 * 100.0, 20.0, known));
        // What all of them leave is how things are.
        (0..12).for_each(|_| residuals.add(20.0 * 60.0, 20.0, 4.0));
        assert!(!residuals.is_outlier(20.0 * 1000.0, 20.0, known));
        assert!(residuals.is_outlier(20.0 * 10_000.0, 20.0, known));
    }

    #[test]
    fn pools_all_degrees_of_freedom() {
        let mut pool = Residuals::new();
        assert_eq!(pool.variance_n2(), None);
        pool.add(8.0, 2.0, 1.0);
        pool.add(12.0, 8.0, 1.0);
        assert!((pool.variance_n2().unwrap() - 2.0).abs() < 1e-6);
    }

    #[test]
    fn an_event_that_leaves_far_too_much_is_less_sure() {
        assert!((excess_ratio(8.0, 2.0, 4.0) - 1.0).abs() < 1e-6);
        assert!((excess_ratio(60.0, 5.0, 4.0) - 1.0).abs() < 1e-6);
        assert!((excess_ratio(4000.0, 10.0, 4.0) - 100.0).abs() < 1e-3);
        assert!(excess_ratio(f32::NAN, 10.0, 4.0).is_nan());
    }

    #[test]
    fn foul_events_among_the_first_ones_are_forgotten() {
        let mut pool = Residuals::new();
        let first = [5.0, 5e3, 4e3, 4e3, 6.0, 7.0, 2e4, 1.0, 4e4, 3e4];
        first.into_iter().for_each(|mean| pool.add(20.0 * mean, 20.0, 4.0));
        (0..20).for_each(|_| pool.add(80.0, 20.0, 4.0));
        let variance = pool.variance_n2().unwrap();
        assert!((3.0..6.0).contains(&variance), "{variance}");
    }

    #[test]
    fn a_bad_start_and_single_bad_events_are_left_out() {
        let mut pool = Residuals::new();
        (0..3).for_each(|_| pool.add(1e4, 5.0, 4.0));
        for i in 0..400 {
            pool.add(if i % 20 == 0 { 1e5 } else { 20.0 }, 5.0, 4.0);
        }
        let variance = pool.variance_n2().unwrap();
        assert!((3.5..5.5).contains(&variance), "{variance}");
    }
}
