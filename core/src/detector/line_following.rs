//! Extension of the stick line by the samples of a resting block: at some delay behind the newest
//! one, weighted by the flop profile, and without the samples off the line.

use crate::detector::Detector;
use crate::detector::onset::OFF_LINE;
use crate::detector::slack_wait;
use crate::detector::stick_line::{LINE_POINTS, Stick};
use crate::effect::Effect;
use crate::noise::ripple::Ripple;
use crate::num::math::{larger, smaller};
use crate::sample::{ForcePoint, periods_between};
use crate::signal::window::WINDOW;

/// Number of samples in a row off the line, all on one side, after which the line starts anew.
/// Tuned: two happen by a spike and its neighbour, four find a new line later.
const NEW_LINE: u8 = 3;
/// Interval, samples, at which the usual drop is halved in a stick whose line begins anew again and
/// again, or more than twice as long as the one before; a power of two. Tuned: a knock hides slips
/// for as long, and no flop lasts as long.
const FORGET: i32 = 32;
/// Least number of times that a line has begun anew if slips are to be unseen on it: at the
/// beginning of each and at its end, and a winch that turned back once does as much.
const RENEWED: u8 = 4;
/// Lower limit of a halved usual drop, standard deviations of the noise: a slip that begins low on
/// the line needs half of the usual drop.
const LEAST_USUAL: f32 = 16.0;

/// Number of a line's samples for each that may lie in a slip, above which the line is kept: a slip
/// begins slowly, and that sample moves the line's end by less than the line's own error. Tuned:
/// with 16 the intervals of `many_pauses` widen, with 32 those of a real recording of friction that
/// wanders are 1.65 times its errors (1.42), with 128 slow loading is read less precisely.
const PURE: u32 = 64;

/// Most samples of a line whose stick is tested to its end. Tuned: without a limit creep at the end
/// of long sticks passes for ripple (`slack_creep` covers .79 of its `mu`, .89).
const FEW: u32 = 12;
/// Most samples between such a line and the onset that are tested: the delay of the line where
/// slips are as short.
const MOST_LEFT: usize = 8;

/// Rounds to the nearest sample.
pub(super) fn whole(periods: f32) -> u32 {
    (periods + 0.5) as u32
}

/// Samples by which the line stays behind: by the usual fall, the usual rise and creep, periods.
#[inline(never)]
pub(super) fn delay(usual_fall: f32, usual_rise: f32, creep_periods: f32) -> u32 {
    let before = (0.3 * usual_fall + creep_periods) as u32;
    (2 + before + whole(usual_rise)).min(WINDOW as u32 / 4)
}

impl Detector {
    /// Sets the delay of the line from the usual fall, the usual rise and the time of creep.
    pub(super) fn update_delay(&mut self) {
        self.line_delay = delay(self.usual_fall, self.usual_rise, self.creep_periods.value());
    }

    /// Takes samples into the line, at a delay long enough that neither a slip that has begun
    /// unseen nor creep before it bends the line.
    pub(super) fn extend_line(&mut self, newest: u32) {
        while periods_between(self.stick.next, newest) >= self.line_delay.cast_signed() {
            let index = self.stick.next;
            self.stick.next += 1;
            let rested = periods_between(self.stick.origin, self.stick.next);
            if rested & (FORGET - 1) == 0
                && (self.stick.renewals >= RENEWED
                    || rested > 2 * periods_between(self.ended.origin, self.ended.next))
            {
                self.forget_usual();
            }
            self.look_on(rested);
            let is_first = rested == 1 && self.usual_drop_n <= 0.0;
            if is_first && self.begins_in_slip(newest) {
                continue;
            }
            if let Some(force_n) = self.window.get(index) {
                self.take_into_line(ForcePoint { index, force_n });
            }
        }
    }

    /// A record may begin in the middle of a slip: then its first line begins two samples after the
    /// force has stopped falling, as after any slip, and its first stick too if the fall is long, since
    /// what lies before is no flop. Before the noise is known no fall is significant; once it is
    /// known, all samples are examined again. Where the first sample is the only one of a slip no
    /// fall shows: it is left out if it lies above the line of the next two.
    #[cold]
    fn begins_in_slip(&mut self, newest: u32) -> bool {
        /// Twice the noise: a difference that one in five first samples exceeds, and about all that
        /// would bend the line.
        const ABOVE: f32 = 2.0;
        /// Most samples of a fall that is too short to look like flop. Tuned: with none a record of
        /// aliased slips (`aliased_fast`) has three coefficients.
        const SHORT: u32 = 3;
        let first = self.stick.origin;
        let force_n = |index: u32| self.window.get(index).unwrap_or(f32::NAN);
        let mut low = first;
        while low < newest && force_n(low + 1) < force_n(low) {
            low += 1;
        }
        if force_n(first) - force_n(low) > OFF_LINE * self.std_n {
            self.stick.next = low + 2;
            if low > first + SHORT {
                let start = low + 1;
                self.stick =
                    Stick::new(start, ForcePoint { index: start, force_n: f32::NEG_INFINITY });
                self.look_back(start, newest);
            }
            return true;
        }
        let second_n = force_n(first) - 2.0 * force_n(first + 1) + force_n(first + 2);
        second_n > ABOVE * self.std_n
    }

    /// No slip for more than twice the length of the stick before, or on a line that has begun anew
    /// again and again, as unseen slips make it: the usual drop may be that of a knock, or of the
    /// first slip of a block that was frozen in. It is halved, down to [`LEAST_USUAL`] standard
    /// deviations of the noise.
    #[cold]
    fn forget_usual(&mut self) {
        let usual_n = self.usual_drop_n;
        self.usual_drop_n = larger(0.5 * usual_n, smaller(usual_n, LEAST_USUAL * self.std_n));
    }

    /// A slip that was seen late, as one after a brief rest is, may have samples on the line. Then
    /// the line is dropped, unless it has far more others ([`PURE`]), and the last samples before
    /// the onset are used one by one.
    pub(super) fn shorten_line(&mut self) {
        let (next, end) = (self.stick.next, self.stick_end());
        if next > end && self.stick.line.count < PURE * (next - end) {
            self.stick.forget_line();
            self.stick.next = self.stick.next.min(end);
        }
    }

    /// Index of the last sample of the stick that has ended, before the force rose to its peak.
    fn stick_end(&self) -> u32 {
        let Stick { origin, highest, .. } = self.stick;
        highest.index.saturating_sub(whole(self.usual_rise)).max(origin)
    }

    /// Examines the last samples of a short stick as well: the line leaves them to the fit, and of a
    /// dozen samples it would have too few innovations.
    pub(super) fn test_end(&mut self) {
        let stick = self.stick;
        if stick.line.count > FEW || stick.strikes != 0 {
            return;
        }
        let end = self.stick_end().saturating_sub(self.creep_periods.value() as u32);
        self.spent += MOST_LEFT / 2;
        for index in (stick.next..end + 1).take(MOST_LEFT) {
            let Some(force_n) = self.window.get(index) else { break };
            self.take_into_line(ForcePoint { index, force_n });
            if self.stick.strikes != 0 {
                break;
            }
        }
        self.stick = stick;
    }

    /// Do the innovations matter? False at compile time where no effect needs them.
    #[inline(always)]
    fn tests_lines(&self) -> bool {
        self.effects.has(Effect::Ripple) || self.effects.has(Effect::Sag)
    }

    fn take_into_line(&mut self, sample: ForcePoint) {
        let variance = self.variance(sample.index);
        let weight = 1.0 / variance;
        let time = self.stick.time(sample.index);
        if let Some(innovation) = self.stick.innovation_n(time, sample.force_n, variance) {
            let is_known = self.stick.line.count >= LINE_POINTS;
            if is_known {
                self.noise.add_innovation(innovation);
                if innovation.abs() > OFF_LINE * self.line_std_n {
                    return self.strike(sample.index, innovation);
                }
            }
            // The first innovations of a cable that flops are its oscillation.
            let counts = is_known || !self.flops();
            if self.tests_lines() && counts {
                self.ripple.update(|ripple| ripple.add(innovation, weight));
            }
        }
        if self.stick.strikes != 0 {
            // A sample next to samples that were left out may be off the line as well: its
            // innovation does not count for the ripple.
            self.ripple.update(Ripple::interrupt);
            self.stick.strikes = 0;
        }
        self.stick.take(time, sample.force_n, weight);
    }

    /// Leaves out a sample off the line; several on one side start a new line.
    #[inline(never)]
    fn strike(&mut self, index: u32, innovation: f32) {
        let (flops, stick) = (self.flops(), &mut self.stick);
        let side = if innovation > 0.0 { 1 } else { -1 };
        let goes_on = stick.strikes.signum() == side;
        stick.strikes = if goes_on { stick.strikes + side } else { side };
        if stick.strikes.unsigned_abs() < NEW_LINE {
            return;
        }
        self.spent += 8;
        // The last samples are examined once more, for the new line.
        let start = (index + 1).saturating_sub(u32::from(NEW_LINE));
        stick.next = start;
        stick.start_line(start);
        // A cable that flops leaves the line as well, at an unchanged rate.
        stick.broken = !flops;
        // Earlier samples, a spike perhaps, are not the highest of this line.
        stick.highest = ForcePoint { index: start, force_n: f32::NEG_INFINITY };
        self.look_back(start, self.last.index);
    }

    /// Does the cable still hang slack? Once its force has risen, the stick line starts.
    pub(super) fn hangs(&mut self, now: ForcePoint) -> bool {
        let Some(wait) = &mut self.slack_wait else { return false };
        if wait.is_endless() {
            self.slack_wait = None;
            return false;
        }
        let Some(risen_n) = wait.risen_n(now.force_n) else { return true };
        self.slack_wait = None;
        let since =
            self.ended.line.slope().map_or(0, |rate| slack_wait::periods_above(risen_n, rate));
        self.spent += 2 * since as usize;
        let origin = self.stick.origin.max(now.index.saturating_sub(since));
        self.stick = Stick::new(origin, self.stick.highest);
        false
    }
}
