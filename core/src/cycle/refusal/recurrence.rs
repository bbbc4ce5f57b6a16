//! How the slips follow each other: too fast for the sampling, or as the samples of faster ones would.

use crate::num::math;

/// Fewest periods from slip to slip: two samples of a rest and two of a slip.
pub(super) const FEWEST_PERIODS: f32 = 4.0;
/// Periods from slip to slip below which a single event may tell that it is folded, or that its
/// rate is not known; of slower slips only all events together tell.
pub(crate) const FAST: f32 = 16.0;
/// Events over which these means fade.
const MEMORY: f32 = 16.0;

/// How the slips of late follow each other: the mean number of periods from one to the next (of
/// slips every 3.8 samples most are seen four apart), and how many of their fits say that slips in
/// between were missed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Recurrence {
    mean: f32,
    /// Part of the events of late that were folded by their own fits, or refused for reasons of
    /// their own.
    folded: f32,
}

impl Default for Recurrence {
    fn default() -> Self {
        // Tuned: with 0 twice as many events of `aliased_fast` are believed, the first ones.
        Self { mean: FEWEST_PERIODS, folded: 0.4 }
    }
}

impl Recurrence {
    /// Takes the periods to the next slip: does it follow too fast for the sampling?
    pub(crate) fn is_aliased(&mut self, periods: f32) -> bool {
        // Tuned: slips every four samples stay above the limit less this.
        const UNSURE: f32 = 0.05;
        self.mean += (math::smaller(periods, FAST) - self.mean) / MEMORY;
        periods < FEWEST_PERIODS || self.mean < FEWEST_PERIODS - UNSURE
    }

    /// Is an event folded, by its own fit, or because most events of late were?
    pub(crate) fn is_folded(&mut self, fit_tells: bool) -> bool {
        // Most events of late.
        const MOST: f32 = 0.5;
        let now = if fit_tells { 1.0 } else { 0.0 };
        self.folded += (now - self.folded) / MEMORY;
        fit_tells || self.folded > MOST
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
        // One in four by chance: each for itself.
        assert!((0..64).all(|i| recurrence.is_folded(i % 4 == 0) == (i % 4 == 0)));
        // Three in four: after some of them all.
        let refused = (0..64).filter(|i| recurrence.is_folded(i % 4 != 0)).count();
        assert!((58..=64).contains(&refused), "{refused}");
        // It ends.
        assert!((0..16).filter(|_| recurrence.is_folded(false)).count() < 12);
        assert!(!recurrence.is_folded(false));
    }
}
