//! Recurrence of the slips: too short for the sampling, or a sign that the slips are aliases of
//! faster ones.

use crate::num::math;

/// Shortest recurrence that can be sampled, periods: two samples of a rest and two of a slip.
pub(super) const FEWEST_PERIODS: f32 = 4.0;
/// Recurrence, periods, below which a single event may be found to be an alias or without a known
/// rate; for slower slips only all events together decide.
pub(crate) const FAST: f32 = 16.0;
/// Memory of the running means, events.
const MEMORY: f32 = 16.0;

/// Running means over recent slips: the recurrence, periods (slips every 3.8 samples are mostly
/// seen four apart), and the part of events whose fits are aliases of faster slips.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Recurrence {
    mean: f32,
    /// Part of recent events that are aliases by their own fits, or that were refused for reasons
    /// of their own.
    folded: f32,
}

impl Default for Recurrence {
    fn default() -> Self {
        // Tuned: with 0 twice as many events of `aliased_fast` are believed, the first ones.
        Self { mean: FEWEST_PERIODS, folded: 0.4 }
    }
}

impl Recurrence {
    /// Updates the mean with the periods to the next slip. Is the recurrence too short for the
    /// sampling?
    pub(crate) fn is_aliased(&mut self, periods: f32) -> bool {
        // Tuned: the mean of slips every four samples stays above the limit less this.
        const UNSURE: f32 = 0.05;
        self.mean += (math::smaller(periods, FAST) - self.mean) / MEMORY;
        periods < FEWEST_PERIODS || self.mean < FEWEST_PERIODS - UNSURE
    }

    /// Is an event an alias, by its own fit (`by_fit`) or because most recent events were?
    pub(crate) fn is_folded(&mut self, by_fit: bool) -> bool {
        // More than half of the recent events.
        const MOST: f32 = 0.5;
        let now = if by_fit { 1.0 } else { 0.0 };
        self.folded += (now - self.folded) / MEMORY;
        by_fit || self.folded > MOST
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How many of 200 slips count as aliased, `samples` samples apart and seen at whole ones.
    fn aliased_of(samples: f32) -> usize {
        let mut recurrence = Recurrence::default();
        let peak = |i: u16| libm::roundf(samples * f32::from(i));
        (0..200).filter(|&i| recurrence.is_aliased(peak(i + 1) - peak(i))).count()
    }

    #[test]
    fn slips_every_3_8_samples_are_aliased_and_every_4_are_not() {
        for (samples, aliased) in
            [(2.9, 200..=200), (3.8, 190..=200), (4.0, 0..=0), (4.3, 0..=0), (29.0, 0..=0)]
        {
            let count = aliased_of(samples);
            assert!(aliased.contains(&count), "{samples} {count}");
        }
    }

    #[test]
    fn most_of_late_decide_for_all() {
        let mut recurrence = Recurrence::default();
        // One in four by chance: only these are refused.
        assert!((0..64).all(|i| recurrence.is_folded(i % 4 == 0) == (i % 4 == 0)));
        // Three in four: after a few events all are refused.
        let refused = (0..64).filter(|i| recurrence.is_folded(i % 4 != 0)).count();
        assert!((58..=64).contains(&refused), "{refused}");
        // It ends.
        assert!((0..16).filter(|_| recurrence.is_folded(false)).count() < 12);
        assert!(!recurrence.is_folded(false));
    }
}
