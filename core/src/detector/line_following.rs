//! The samples of a resting block, taken into its stick line: some way behind the newest
//! one, weighted by the flop's profile, and left out where they are off the line.

use crate::detector::onset::OFF_LINE;
use crate::detector::stick_line::Stick;
use crate::detector::{Detector, slack_wait};
use crate::effect::{Effect, Kept};
use crate::noise::flop::FlopProfile;
use crate::noise::ripple::Ripple;
use crate::sample::{ForcePoint, near};
use crate::signal::window::WINDOW;

/// After this many samples in a row off the line, all on one side, the line starts anew;
/// after twice as many on both sides as well. Tuned: two happen by a spike and its neighbour,
/// four find a new line later.
const NEW_LINE: u32 = 3;
/// Samples of a longer stick that the profile looks at.
pub(super) const PROFILE: u64 = WINDOW as u64 * 3 / 4;

/// How far a stick line stays behind, for a usual fall, a usual rise after the onset and a time
/// of creep before it, in periods.
pub(super) fn line_delay(usual_fall: f32, usual_rise: f32, creep_periods: f32) -> u32 {
    (2 + (0.3 * usual_fall + creep_periods) as u32 + whole(usual_rise)).min(WINDOW as u32 / 4)
}

/// To the nearest sample.
pub(super) fn whole(periods: f32) -> u32 {
    (periods + 0.5) as u32
}

impl Detector {
    /// The line stays as far behind as what is usual now wants it.
    pub(super) fn update_delay(&mut self) {
        self.line_delay = line_delay(self.usual_fall, self.usual_rise, self.creep_periods);
    }

    /// Takes samples into the line, far enough behind the newest one that a slip
    /// which has just begun, unseen, does not bend it, nor creep before it.
    pub(super) fn extend_line(&mut self, newest: u64) {
        while near(self.stick.next, newest) >= self.line_delay.cast_signed() {
            let index = self.stick.next;
            self.stick.next += 1;
            if near(self.stick.origin, self.stick.next) == PROFILE as i32 {
                self.learn_profile();
            }
            if let Some(force_n) = self.window.get_near(index) {
                self.take_into_line(ForcePoint { index, force_n });
            }
        }
    }

    /// A slip that was seen late, as that after a brief rest is, may have samples on the line:
    /// then the last samples before its onset count, one by one.
    pub(super) fn shorten_line(&mut self) {
        let Stick { origin, highest, next, .. } = self.stick;
        let end = highest.index.saturating_sub(whole(self.usual_rise).into()).max(origin);
        if next > end {
            self.stick.forget_line();
            self.stick.next = self.stick.next.min(end);
        }
    }

    fn take_into_line(&mut self, sample: ForcePoint) {
        let variance = self.variance(sample.index);
        let weight = 1.0 / variance;
        let time = self.stick.time(sample.index);
        if let Some(innovation) = self.stick.off_n(time, sample.force_n) {
            let relative = innovation / self.stick.spread(time, variance);
            self.noise.add(relative);
            if relative.abs() > OFF_LINE * self.line_std_n {
                return self.strike(sample.index, relative);
            }
            if self.effects.has(Effect::Ripple) {
                self.ripple.tell(|ripple| ripple.add(relative, weight));
            }
        }
        if self.stick.strikes > 0 {
            // Next to samples that were left out it may be off the line as well: it does not count.
            self.ripple.tell(Ripple::interrupt);
            self.stick.strikes = 0;
        }
        self.stick.take(time, sample.force_n, weight);
    }

    /// A sample off the line is left out; several on one side start a new line.
    #[inline(never)]
    fn strike(&mut self, index: u64, innovation: f32) {
        let stick = &mut self.stick;
        stick.strikes += 1;
        let same = stick.strikes > 1 && innovation * stick.strike_sign > 0.0;
        stick.same_side = if same { stick.same_side + 1 } else { 1 };
        stick.strike_sign = innovation;
        if stick.same_side < NEW_LINE && stick.strikes < 2 * NEW_LINE {
            return;
        }
        // The samples that are on it are taken once more.
        let start = (index + 1).saturating_sub(u64::from(NEW_LINE));
        stick.next = start;
        stick.start_line(start);
        // A cable that flops leaves the line as well.
        stick.broken = self.profile.get().is_none_or(FlopProfile::is_flat);
        // What was higher before, a spike perhaps, is not of this line.
        stick.highest = ForcePoint { index: start, force_n: f32::NEG_INFINITY };
        for past in start..=self.last.index {
            let Some(force_n) = self.window.get(past) else { continue };
            if force_n > stick.highest.force_n {
                stick.highest = ForcePoint { index: past, force_n };
            }
        }
    }

    /// Does the cable still hang slack? Where its force has risen the line starts.
    pub(super) fn hangs(&mut self, now: ForcePoint) -> bool {
        let Some(wait) = &mut self.slack_wait else { return false };
        let Some(risen_n) = wait.risen_n(now.force_n) else { return true };
        self.slack_wait = None;
        let since =
            self.ended.line.slope().map_or(0, |rate| slack_wait::periods_above(risen_n, rate));
        let origin = self.stick.origin.max(now.index.saturating_sub(since));
        self.stick = Stick::new(origin, self.stick.highest);
        false
    }

    /// Takes the stick line so far into the profile.
    pub(super) fn learn_profile(&mut self) {
        let (stick, window) = (&self.stick, &self.window);
        let (origin, next) = (stick.origin, stick.next);
        if !self.effects.has(Effect::Flop) || window.first_from(origin) != origin {
            return;
        }
        let begins = self.profile.tell(|profile| {
            if !profile.is_due() {
                return false;
            }
            let was_flat = profile.is_flat();
            let line = stick.is_straight().then(|| stick.line_from(origin));
            profile.learn(line, window.between(origin, next));
            was_flat && !profile.is_flat()
        });
        if begins {
            // What the innovations told had the swing in it.
            self.ripple = Kept::default();
        }
    }
}
