//! Which events are tested for round corners.

use crate::effects::corner::CornerEstimator;
use crate::model::corner::Corner;

/// Number of first events tested without any sign of a round corner; a test takes two passes.
const FIRST: u32 = 12;
/// After those, one event in this number is tested.
const SELDOM: u32 = 4;
/// Number of events in a row that cannot be tested after which the corners are forgotten: slips of
/// two samples show none, and the few that seemed to be longer would decide for all.
const MOST_UNTESTED: u8 = 8;

impl CornerEstimator {
    /// Counts an event that shows nothing of its corners.
    pub(crate) fn pass_over(&mut self) {
        self.untested += 1;
        if self.untested > MOST_UNTESTED {
            *self = Self::default();
        }
    }

    /// Is the next event to be tested? Without any sign of a round corner only the first ones and
    /// one in [`SELDOM`] are.
    pub(crate) fn is_due(&mut self, used: &Corner) -> bool {
        self.events = self.events.wrapping_add(1);
        self.untested = 0;
        let is_sharp = used.is_sharp() && self.possible.iter().all(|&v| v <= 0.0);
        !is_sharp || self.events <= FIRST || self.events.is_multiple_of(SELDOM)
    }
}

#[cfg(test)]
mod tests {
    // Without the feature all corners are sharp.
    #[cfg(feature = "corner")]
    #[test]
    fn corners_that_are_not_tested_any_more_are_forgotten() {
        use super::*;

        let round = Corner { smoothing: 0.02, missing_n: 0.0, range_n: 30.0 };
        let mut learnt = CornerEstimator { corner: round, ..CornerEstimator::default() };
        for _ in 0..3 {
            (0..MOST_UNTESTED).for_each(|_| learnt.pass_over());
            assert!(!learnt.is_sharp());
            assert!(learnt.is_due(&round));
        }
        (0..=MOST_UNTESTED).for_each(|_| learnt.pass_over());
        assert!(learnt.is_sharp());
    }
}
