//! Residuals of the fits: they estimate the noise that is reported and that scales every standard
//! deviation.

use crate::num::math::{self, smaller};
use crate::stats::quantile::Quantile;
use crate::stats::significance::{SURE, surely};

/// Pooled residuals of the events' fits.
///
/// The variance is their mean square over all degrees of freedom, without events that fit badly (an
/// incomplete first slip, a fall that is no slip).
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Residuals {
    squares_n2: f32,
    /// Number of pooled degrees of freedom.
    pub(crate) free: f32,
    median_n2: Quantile,
}

/// Degrees of freedom after which old events fade: they determine the noise to about 1 %,
/// `1/√(2 × 4000)`.
const MEMORY: f32 = 8000.0;
/// An event whose mean square is this many times that of the median event is left out: with ten
/// degrees of freedom chance does that once in 3e8.
const LIMIT: f32 = 6.0;
/// An event whose mean square is this many times the median does not fit the model: as if every
/// sample were off by seven standard deviations.
const MISFIT: f32 = 50.0;

/// Largest mean square expected of the first events, in units of the rough noise variance. Tuned:
/// with 1.5 events of `creep_quiet` are eleven standard deviations off.
const ROUGH: f32 = 3.0;

impl Residuals {
    /// Adds an event's squared residuals and their degrees of freedom.
    pub(crate) fn add(&mut self, squares_n2: f32, free: f32, rough_n2: f32) {
        // Median of χ²/ν over its mean (Wilson and Hilferty).
        let skew = 1.0 - 2.0 / (9.0 * math::larger(free, 1.0));
        // Limits outliers among the first events, so that the median recovers from them.
        let most_n2 = LIMIT * ROUGH * rough_n2;
        self.median_n2.add(math::smaller(squares_n2 / (free * skew * skew * skew), most_n2), 0.5);
        let limit = LIMIT * self.usual_n2(rough_n2);
        if self.free > MEMORY {
            self.squares_n2 *= 0.5;
            self.free *= 0.5;
        }
        if self.squares_n2 > limit * self.free {
            // What was pooled before the median was known is too large: it is dropped.
            self.free = smaller(self.free, 2.0);
            self.squares_n2 = limit / LIMIT * self.free;
        }
        if squares_n2 <= limit * free {
            self.squares_n2 += squares_n2;
            self.free += free;
        }
    }

    /// Are the event's residuals so much larger than those of the others that the model does not
    /// describe its samples? The winch paused or started, or the block hit something.
    ///
    /// `rough_n2` is a rough variance of the noise, for the first events; `rounding_n2` that of
    /// rounding to single precision.
    pub(crate) fn is_outlier(
        &self,
        squares_n2: f32,
        free: f32,
        (rough_n2, rounding_n2): (f32, f32),
    ) -> bool {
        let usual_n2 = self.usual_n2(rough_n2) + rounding_n2;
        squares_n2 > MISFIT * usual_n2 * math::larger(free, 1.0)
    }

    /// The median, N², or the limit for the first events.
    #[inline(never)]
    fn usual_n2(&self, rough_n2: f32) -> f32 {
        self.median_n2.value().unwrap_or(ROUGH * rough_n2)
    }

    /// Variance of the noise, N²; `None` before the first event.
    pub(crate) fn variance_n2(&self) -> Option<f32> {
        (self.free >= 1.0).then(|| self.squares_n2 / self.free)
    }
}

/// The square of Birge's ratio, if significantly above 1: an event's own mean square residual over
/// the noise variance; else 1. What the model lacks in one event it seldom lacks in the next.
pub(crate) fn excess_ratio(squares_n2: f32, free: f32, noise_n2: f32) -> f32 {
    let free = math::larger(free, 1.0);
    let more = squares_n2 / (free * noise_n2) - 1.0;
    if more <= 0.0 {
        return 1.0;
    }
    1.0 + more * surely(more, SURE * math::sqrt(2.0 / free))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first events are compared with the detector's noise, later ones with the median of all.
    #[test]
    fn a_foul_event_is_told_from_the_first_one_on() {
        let (mut residuals, known) = (Residuals::default(), (4.0, 0.0));
        assert!(residuals.is_outlier(20.0 * 1000.0, 20.0, known));
        assert!(!residuals.is_outlier(20.0 * 100.0, 20.0, known));
        // Large residuals of all events are no outliers.
        (0..12).for_each(|_| residuals.add(20.0 * 60.0, 20.0, 4.0));
        assert!(!residuals.is_outlier(20.0 * 1000.0, 20.0, known));
        assert!(residuals.is_outlier(20.0 * 10_000.0, 20.0, known));
    }

    #[test]
    fn pools_all_degrees_of_freedom() {
        let mut pool = Residuals::default();
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
        let mut pool = Residuals::default();
        let first = [5.0, 5e3, 4e3, 4e3, 6.0, 7.0, 2e4, 1.0, 4e4, 3e4];
        first.into_iter().for_each(|mean| pool.add(20.0 * mean, 20.0, 4.0));
        (0..20).for_each(|_| pool.add(80.0, 20.0, 4.0));
        let variance = pool.variance_n2().unwrap();
        assert!((3.0..6.0).contains(&variance), "{variance}");
    }

    #[test]
    fn a_bad_start_and_single_bad_events_are_left_out() {
        let mut pool = Residuals::default();
        (0..3).for_each(|_| pool.add(1e4, 5.0, 4.0));
        for i in 0..400 {
            pool.add(if i % 20 == 0 { 1e5 } else { 20.0 }, 5.0, 4.0);
        }
        let variance = pool.variance_n2().unwrap();
        assert!((3.5..5.5).contains(&variance), "{variance}");
    }
}
