//! Looking at samples later than they came: while there was no slip, and the noise turns out
//! to be far less than was thought, the whole window is looked at again, a few samples a step; and
//! slips that follow each other faster than they are fitted wait in the window.

use crate::detector::onset::FARTHEST;
use crate::detector::{Detector, Transition};
use crate::num::math::larger;
use crate::sample::{ForcePoint, Phase, periods_between};
use crate::signal::window::WINDOW;

/// Samples looked at in a step, while catching up: of the whole window in half as many steps, for each
/// brings another one.
pub(super) const CATCH_UP: u32 = 3;
/// It is worth looking at all samples again where the noise is less than this part of what was
/// thought. Tuned: with .2 an event of `tightened_low` is 4.4 standard deviations off (3.5), with .7 one
/// of `tightened_held` 3.9 (2.8).
const LESS_NOISE: f32 = 0.4;

/// Samples that may have been put off: the others are room for what a slip looks back to.
pub(crate) const MOST_PUT_OFF: u32 = WINDOW as u32 * 3 / 4;

impl Detector {
    /// Leaves a sample for later; `false` if there is no room.
    #[cold]
    #[inline(never)]
    pub(super) fn put_off(&mut self, index: u32) -> bool {
        if !self.is_behind {
            (self.next, self.is_behind) = (index, true);
        }
        self.put_off = index - self.window.first_from(self.next);
        self.put_off < MOST_PUT_OFF
    }

    /// Looks at samples that were taken and not yet looked at, as many as given, up
    /// to the first transition. At the end of a test: until it returns `None`.
    pub(crate) fn catch_up(&mut self, most: u32) -> Option<Transition> {
        for _ in 0..most {
            if self.is_up_to_date() {
                return None;
            }
            let index = self.window.first_from(self.next);
            self.next = index + 1;
            self.is_behind = self.next < self.window.end();
            if let Some(force_n) = self.window.get(index) {
                let transition = self.look(ForcePoint { index, force_n });
                if transition.is_some() {
                    return transition;
                }
            }
        }
        None
    }

    /// Has it looked at all that it was given?
    #[must_use]
    pub(crate) fn is_up_to_date(&self) -> bool {
        !self.is_behind
    }

    /// Samples that wait.
    #[must_use]
    pub(crate) fn waiting(&self) -> u32 {
        if self.is_behind { self.put_off } else { 0 }
    }

    /// In a test without any slip so far: once the noise turns out to be far less than was thought,
    /// looks at all samples in the window again.
    pub(super) fn judge_again(&mut self) {
        let Some(std) = self.noise_n().filter(|_| self.phase != Phase::Slip) else { return };
        if std < LESS_NOISE * self.judged_with_n {
            self.judged_with_n = std;
            self.forget_ripple();
            (self.next, self.is_behind) = (0, true);
            self.phase = Phase::Unknown;
        } else {
            self.judged_with_n = larger(self.judged_with_n, std);
            self.forget_first();
        }
    }

    /// A record may begin with its highest sample, in the middle of a slip. Where the block rests too
    /// briefly for a line no slip is told before a higher one, so that one is forgotten in the end.
    fn forget_first(&mut self) {
        let highest = self.stick.highest.index;
        let is_first =
            highest == self.stick.origin && periods_between(highest, self.last.index) > FARTHEST;
        if is_first && !self.line_fits() {
            self.stick.highest = self.last;
        }
    }
}
