//! Does the force bend down before the onset, where the line still goes?
//!
//! A block that creeps lets the force lag behind its line, more and more up to the onset. The
//! last innovations of the lines are then below zero on average: a t-test on one of each line.
//! Where it tells, the lines end a period earlier, and the test begins anew.

use crate::num::math;

/// Standard errors that tell. Tuned: a larger one leaves creep to be taken for a ripple, which
/// hides it from the corners; a smaller one takes a ripple in step with the slips for creep.
const SIGNIFICANT: f32 = 3.0;
/// Fewest lines.
const FEWEST: f32 = 4.0;
/// Lines after which the past has faded.
const FADE: f32 = 1.0 - 1.0 / 32.0;
/// Most periods: the samples after the line are taken one by one.
const MOST: f32 = 8.0;

/// The last innovations of the lines.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LineEnd {
    sum: f32,
    squares: f32,
    count: f32,
    /// The lines end so many periods earlier.
    periods: f32,
}

impl LineEnd {
    /// How much earlier the lines end, periods.
    pub(super) fn periods(&self) -> f32 {
        self.periods
    }

    /// Takes the last innovation of a line; is the next line to end earlier?
    pub(super) fn take(&mut self, innovation: f32) -> bool {
        self.sum = FADE * self.sum + innovation;
        self.squares = FADE * self.squares + innovation * innovation;
        self.count = FADE * self.count + 1.0;
        let limit = SIGNIFICANT * math::rough_sqrt(self.squares);
        let bends = self.count >= FEWEST && self.sum < -limit && self.periods < MOST;
        if bends {
            *self = Self { periods: self.periods + 1.0, ..Self::default() };
        }
        bends
    }
}
