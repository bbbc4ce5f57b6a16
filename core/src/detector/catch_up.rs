//! Examination of samples after their arrival. While there was no slip and the noise estimate falls
//! far below the one used so far, the whole window is examined again, a few samples a step. Samples
//! wait in the window while slips recur faster than they can be fitted.

use crate::detector::onset::FARTHEST;
use crate::detector::{Detector, LONGEST_GAP, Transition};
use crate::num::math::larger;
use crate::sample::{ForcePoint, Phase, periods_between};
use crate::signal::window::WINDOW;

/// Samples examined in a step while catching up. One sample arrives in each step, so a backlog of a
/// whole window is examined in half as many steps as it has samples.
pub(super) const CATCH_UP: u32 = 3;
/// The samples are examined again where the noise estimate is less than this part of the one they
/// were examined with. Tuned: with .2 an event of `tightened_low` is 4.4 standard deviations off
/// (3.5), with .7 one of `tightened_held` 3.9 (2.8).
const LESS_NOISE: f32 = 0.4;

/// Limit of the number of waiting samples: the rest of the window holds what a slip looks back to,
/// which is little where slips follow each other so fast.
pub(crate) const MOST_PUT_OFF: u32 = WINDOW as u32 - 16;

impl Detector {
    /// May the next sample to be examined, the newest if none waits, end a stick line: in a slip, or
    /// after a gap?
    #[inline(always)]
    pub(super) fn may_end_line(&self) -> bool {
        let newest = self.window.end.wrapping_sub(1);
        let index = if self.is_behind { self.window.first_from(self.next) } else { newest };
        match self.phase {
            Phase::Unknown => false,
            Phase::Stick => index - self.last.index > LONGEST_GAP,
            Phase::Slip => true,
        }
    }

    /// Leaves a sample for later; `false` if there is no room.
    #[cold]
    pub(super) fn put_off(&mut self, index: u32) -> bool {
        if !self.is_behind {
            (self.next, self.is_behind) = (index, true);
        }
        self.put_off = index - self.window.first_from(self.next);
        self.put_off < MOST_PUT_OFF
    }

    /// Examines waiting samples, at most `most` of them, up to the first transition. Where the
    /// cycles are full it ends before the next one that may end a line. At the end of a test the
    /// caller repeats this until it returns `None`.
    pub(crate) fn catch_up(&mut self, most: u32, is_full: bool) -> Option<Transition> {
        for examined in 0..most {
            let waits = is_full && examined > 0 && self.may_end_line();
            if !self.is_behind || waits {
                return None;
            }
            let index = self.window.first_from(self.next);
            self.next = index + 1;
            let left = self.window.end - self.next;
            (self.is_behind, self.put_off) = (left > 0, self.put_off.min(left));
            if let Some(force_n) = self.window.get(index) {
                let transition = self.look(ForcePoint { index, force_n });
                if transition.is_some() {
                    return transition;
                }
            }
        }
        None
    }

    /// Number of waiting samples; zero while those that are examined again wait for nothing else.
    pub(crate) fn waiting(&self) -> u32 {
        self.put_off
    }

    /// Called while no slip has been seen: once the noise estimate falls far below the largest one
    /// used so far, all samples in the window are examined again.
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

    /// A record may begin with its highest sample, in the middle of a slip. Where rests are too
    /// brief for a line no slip is detected until a sample is higher, so the first one is dropped
    /// in time.
    fn forget_first(&mut self) {
        let highest = self.stick.highest.index;
        let is_first =
            highest == self.stick.origin && periods_between(highest, self.last.index) > FARTHEST;
        if is_first && !self.line_fits() {
            self.stick.highest = self.last;
        }
    }
}
