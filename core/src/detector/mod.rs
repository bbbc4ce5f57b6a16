//! Stick or slip: the state of the block, sample by sample.
//!
//! ```text
//!            falls from the stick line by more than the noise
//!            and by more than a part of the usual drop
//!   ┌───────┐ ────────────── Onset ──────────────► ┌──────┐
//!   │ Stick │                                      │ Slip │
//!   └───────┘ ◄───── Restick, or Cancelled ─────── └──────┘
//!       ▲      has stopped falling, and stays          │
//!       │      below the line, or does not             │
//!       └─── Lost: a long gap, or a fall without end ──┘
//! ```
//!
//! The methods below follow this order, from [`Detector::step`] on. The criteria: `onset` (does a
//! slip begin?), `restick` (is it over, and was it a slip?), `innovation` (how far off the line is
//! a sample?), `line_following` and `stick_line` (the line itself).
//!
//! *Stick line*: the straight line fitted recursively to the samples since the block came to rest.
//! *Innovation*: a sample minus the line's forecast. *Noise*: the running scale of the innovations.
//! *Usual* drop, fall and rise: running estimates over the slips so far. No limit is in newtons:
//! all are multiples of the noise or parts of the drops seen so far.
//!
//! Delay: an onset high on the line is detected at the first sample that is clearly below the line,
//! a re-stick two samples after the lowest one (half the slip's length for longer slips). The spike
//! filter before the detector adds a sample; `Detector::foresees_slip` examines the sample that the
//! filter holds, so the displayed phase has no such delay.
//!
//! Before the noise is known no slip can be detected. Once it is known, and while there was no
//! slip, the window is examined again, a few samples a step.

mod catch_up;
mod innovation;
mod line_following;
mod onset;
mod readings;
mod rest_noise;
mod restick;
mod slack_wait;
mod stick_line;

pub(crate) use crate::detector::catch_up::MOST_PUT_OFF;
pub use crate::detector::onset::FIRST_DROP;
pub(crate) use crate::detector::stick_line::Stick;

use crate::detector::catch_up::CATCH_UP;
use crate::detector::line_following::delay;
use crate::detector::rest_noise::{Look, SHORT};
use crate::detector::slack_wait::SlackWait;
use crate::effect::{Effect, Effects, Kept};
use crate::noise::flop::FlopProfile;
use crate::noise::ripple::Ripple;
use crate::noise::scale::Noise;
use crate::num::math::{larger, smaller};
use crate::sample::{ForcePoint, Phase, since};
use crate::signal::window::{WINDOW, Window};

/// Upper limit of the noise, parts of the usual drop: the drops have to be eight times the noise,
/// and could not have been detected in more noise.
const MOST_NOISE: f32 = 0.1;
/// Longest gap that a line, or a constant force, continues over, periods: a whole slip may hide in a
/// longer one.
pub(crate) const LONGEST_GAP: u32 = 8;
/// Longest slip, periods: its samples are still in the window when it ends.
const LONGEST_SLIP: u32 = WINDOW as u32 * 3 / 4;

/// What a sample changed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Transition {
    /// A slip has begun.
    Onset,
    /// The block rests again; the stick line that ended is `Detector::ended`.
    Restick {
        /// Highest sample before the slip.
        peak: ForcePoint,
        /// Lowest sample.
        low: ForcePoint,
    },
    /// The fall was no slip: the force is back on the stick line.
    Cancelled,
    /// A gap or a fall was too long: the stick line before it cannot be continued.
    Lost,
}

/// The state machine.
// Field order: first what every sample touches, which the board reaches in one instruction.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Detector {
    /// Newest sample looked at.
    pub(crate) last: ForcePoint,
    /// Standard deviations of a sample's noise and of the innovations, N; infinite before known.
    pub(crate) std_n: f32,
    line_std_n: f32,
    /// Samples by which the line stays behind the newest one.
    line_delay: u32,
    /// Usual drop of a slip, a running estimate, N; zero before the first slip.
    pub(crate) usual_drop_n: f32,
    effects: Effects,
    /// Work of the newest step beyond that of one at rest, in units of 160 instructions on the
    /// board.
    pub(crate) spent: usize,
    /// Samples that waited when one was last put off.
    put_off: u32,
    phase: Phase,
    /// Are there samples in the window that have not been examined?
    pub(crate) is_behind: bool,
    /// The cable may hang slack: the stick line has yet to start.
    slack_wait: Option<SlackWait>,
    pub(crate) stick: Stick,
    ripple: Kept<Ripple, { Effect::Ripple.room() }>,
    profile: Kept<FlopProfile, { Effect::Flop.room() }>,
    noise: Noise,
    pub(crate) window: Window,
    /// First index that has not been examined, while `is_behind`.
    next: u32,
    pub(crate) ended: Stick,
    lowest: ForcePoint,
    /// Largest noise that the samples were examined with, N.
    judged_with_n: f32,
    /// Usual time from the highest to the lowest sample of a slip, periods.
    usual_fall: f32,
    /// Usual time from the onset to the highest force, periods.
    usual_rise: f32,
    /// Time before an onset in which creep bends the line, periods.
    creep_periods: Kept<f32, { Effect::Corner.room() }>,
    /// Middle of the usual range of the force, N: half the usual drop below the last peak.
    middle_n: f32,
    /// No slip begins before the stick line has risen above this force, N.
    ceiling_n: f32,
}

impl Detector {
    /// Before the first sample, for a rate in hertz.
    #[must_use]
    pub fn new(rate_hz: f32, effects: Effects) -> Self {
        // Initial value, a fifth of a second: the first slip replaces it.
        let usual_fall = 0.2 * rate_hz;
        Self {
            effects,
            window: Window::new(),
            noise: Noise::new(),
            std_n: f32::INFINITY,
            line_std_n: f32::INFINITY,
            ripple: Kept::default(),
            profile: Kept::default(),
            phase: Phase::Unknown,
            stick: Stick::default(),
            ended: Stick::default(),
            slack_wait: None,
            lowest: ForcePoint::default(),
            last: ForcePoint::default(),
            spent: 0,
            is_behind: false,
            put_off: 0,
            next: 0,
            judged_with_n: f32::INFINITY,
            usual_drop_n: 0.0,
            usual_fall,
            usual_rise: 0.0,
            line_delay: delay(usual_fall, 0.0, 0.0),
            creep_periods: Kept::default(),
            middle_n: 0.0,
            ceiling_n: f32::NEG_INFINITY,
        }
    }

    /// Takes a good sample with an index past all earlier ones. Where the cycles are full, so that
    /// they have no room for the end of another line, one that may end it is examined later, as far
    /// as the window has room for that.
    pub fn step(&mut self, index: u32, force_n: f32, is_full: bool) -> Option<Transition> {
        self.spent = 0;
        let in_a_row = self.window.push(index, force_n);
        self.noise.add_sample(force_n, in_a_row && !self.lies_at_zero());
        let (line_std_n, std_n) = self.noise.std_n(force_n);
        self.line_std_n = line_std_n;
        if self.usual_drop_n > 0.0 {
            self.std_n = smaller(std_n, MOST_NOISE * self.usual_drop_n);
        } else {
            self.std_n = std_n;
            self.judge_again();
        }
        if is_full && self.may_end_line() && self.put_off(index) {
            return None;
        }
        if self.is_behind {
            return self.catch_up(CATCH_UP, is_full);
        }
        self.look(ForcePoint { index, force_n })
    }

    /// Has the cable hung slack for some samples?
    #[inline(always)]
    fn lies_at_zero(&self) -> bool {
        self.slack_wait.is_some_and(SlackWait::is_long)
    }

    /// Examines one sample.
    fn look(&mut self, now: ForcePoint) -> Option<Transition> {
        let index = now.index;
        let started = self.phase != Phase::Unknown;
        let goes_on = started && index - self.last.index <= LONGEST_GAP;
        self.last = now;
        if !goes_on {
            self.rest_from(now, index);
            return started.then_some(Transition::Lost);
        }
        match self.phase {
            Phase::Unknown | Phase::Stick => self.stick_step(now),
            Phase::Slip => self.slip_step(now),
        }
    }

    /// At rest: a significant fall below the stick line is an onset, any other sample extends it.
    fn stick_step(&mut self, now: ForcePoint) -> Option<Transition> {
        if now.force_n > self.stick.highest.force_n {
            if !self.jumps(now) {
                self.stick.highest = now;
            }
        } else if self.slips(now) {
            self.phase = Phase::Slip;
            self.lowest = now;
            self.find_peak(now.index);
            self.shorten_line();
            return Some(Transition::Onset);
        }
        if !self.hangs(now) {
            self.extend_line(now.index);
        }
        None
    }

    /// Sliding: nothing is decided before the force has stopped falling.
    fn slip_step(&mut self, now: ForcePoint) -> Option<Transition> {
        if now.force_n < self.lowest.force_n {
            self.lowest = now;
        }
        let peak = self.stick.highest;
        if now.index - peak.index > LONGEST_SLIP {
            self.rest_from(now, now.index);
            return Some(Transition::Lost);
        }
        if !self.turns(now) {
            return None;
        }
        let drop = peak.force_n - self.lowest.force_n;
        Some(if self.is_back(now, drop) { self.cancel(now) } else { self.restick(now, drop) })
    }

    /// The block rests again: updates the usual drop, and begins a stick line.
    fn restick(&mut self, now: ForcePoint, drop: f32) -> Transition {
        let peak = self.stick.highest;
        let wait = SlackWait::under(self.lowest, drop, self.std_n);
        let low = if wait.is_some() { self.first_low(peak.index) } else { self.lowest };
        if self.usual_drop_n <= 0.0 && !self.line_fits() {
            // The first line does not fit: its innovations may be due to its own bend.
            self.forget_ripple();
        }
        self.update_usual(drop, since(peak.index, low.index));
        // Only now is the usual rise known, by which the first onset lies before its peak.
        self.shorten_line();
        self.test_end();
        self.middle_n = peak.force_n - 0.5 * larger(drop, self.usual_drop_n);
        self.rest_from(now, now.index + 1);
        self.slack_wait = wait;
        self.look_back(low.index, now.index);
        Transition::Restick { peak, low }
    }

    /// Drops the sums over the innovations so far, which no longer hold.
    #[inline(never)]
    fn forget_ripple(&mut self) {
        self.ripple = Kept::default();
    }

    /// Returns to the old line, without the samples that looked like a slip.
    fn cancel(&mut self, now: ForcePoint) -> Transition {
        self.phase = Phase::Stick;
        self.stick.next = now.index + 1;
        Transition::Cancelled
    }

    /// Begins a stick line whose first sample is `next`.
    fn rest_from(&mut self, highest: ForcePoint, next: u32) {
        self.spent += 8;
        self.phase = Phase::Stick;
        self.ended = self.stick;
        self.look_for_flop(Look::Both, 0..SHORT, false);
        self.ripple.update(|ripple| {
            ripple.interrupt();
            ripple.settle();
        });
        if !self.line_fits() {
            self.ended.forget_line();
        }
        if self.slack_wait.take().is_some() {
            // The block slipped as soon as the force rose: samples before the peak may be slack.
            self.ended.origin = self.ended.highest.index;
            self.ended.next = self.ended.origin;
        }
        self.stick = Stick::new(next, highest);
    }
}
