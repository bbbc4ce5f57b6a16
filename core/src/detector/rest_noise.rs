//! The two effects that the rests show, flop and ripple; and how long a block creeps before a slip.

use core::ops::Range;

use crate::detector::Detector;
use crate::effect::{Effect, Effects, Parameter};
use crate::noise::flop::FlopProfile;
use crate::noise::ripple::{ColoredNoise, Ripple};
use crate::num::math::{larger, smaller};
use crate::sample::{periods_between, since};
use crate::signal::window::WINDOW;

/// Most samples of a stick that the flop profile looks at.
const PROFILE: i32 = WINDOW as i32 * 3 / 4;
/// Longest stick, samples, that the profile processes in one step, when the stick has ended. A
/// longer one takes two steps: at the first and the second sample of the next stick or, from
/// [`PROFILE`] samples on, at its own two samples there.
pub(super) const SHORT: i32 = 80;
const FIRST: i32 = 1;
const SECOND: i32 = FIRST + 1;
const PAST_PROFILE: i32 = PROFILE + 1;

/// What the profile does in a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Look {
    Begin,
    Learn,
    Both,
}

impl Detector {
    /// Colored noise: how the force departs from a straight stick line beyond white noise.
    pub(crate) fn wander(&self) -> ColoredNoise {
        if self.effects.has(Effect::Ripple) { self.colored() } else { ColoredNoise::NONE }
    }

    /// Do all rests bend the same way?
    pub(crate) fn bends(&self) -> bool {
        self.colored().bends
    }

    fn colored(&self) -> ColoredNoise {
        self.ripple.get().map_or(ColoredNoise::NONE, Ripple::wander)
    }

    /// Common weight of all samples from the lowest one to the newest: the flop profile's at the
    /// age of their middle, which is negative, before the re-stick.
    pub(crate) fn rest_weight(&self) -> f32 {
        let age = -0.5 * since(self.lowest.index, self.last.index);
        self.profile.get().map_or(1.0, |profile| 1.0 / profile.variance(age))
    }

    /// Which of the two noise effects, flop and ripple, the recent rests show.
    pub(crate) fn found(&self) -> Effects {
        Effects::NONE
            .with(Effect::Flop, self.flops())
            .with(Effect::Ripple, !self.wander().is_none())
    }

    /// Estimate of the flop from the recent rests.
    pub(crate) fn flop(&self) -> Option<Parameter> {
        self.profile.get().map(FlopProfile::parameter)
    }

    /// Estimate of the ripple from the recent rests.
    pub(crate) fn ripple(&self) -> Option<Parameter> {
        self.ripple.read(Ripple::parameter)
    }

    /// Gives the flop profile a long stick, in two steps, at the samples of a rest where it has
    /// time: `rested` is the number of those on the line.
    #[inline(always)]
    pub(super) fn look_on(&mut self, rested: i32) {
        match rested {
            FIRST => self.look_for_flop(Look::Begin, SHORT..PROFILE, false),
            SECOND => self.look_for_flop(Look::Learn, SHORT..PROFILE, false),
            PROFILE => self.look_for_flop(Look::Begin, PROFILE..i32::MAX, true),
            PAST_PROFILE => self.look_for_flop(Look::Learn, PROFILE..i32::MAX, true),
            _ => {}
        }
    }

    /// Gives the flop profile the stick that has ended, or the current one if `goes_on`, provided
    /// that its number of samples lies within `lengths`.
    pub(super) fn look_for_flop(&mut self, look: Look, lengths: Range<i32>, goes_on: bool) {
        let (window, stick) = (&self.window, if goes_on { &self.stick } else { &self.ended });
        let (origin, next) = (stick.origin, stick.next);
        let looks =
            self.effects.has(Effect::Flop) && lengths.contains(&periods_between(origin, next));
        if !looks || window.first_from(origin) != origin {
            return;
        }
        // Where no single line was followed one is fitted in this step: to half as many samples.
        let most = if stick.is_straight() { PROFILE } else { PROFILE / 2 };
        let forces_n = window.between(origin, next.min(origin + most as u32));
        self.spent += forces_n.iter().map(|part| part.len() * 2 / 3).sum::<usize>();
        let flops = self.profile.update(|profile| {
            let was_flat = profile.is_flat();
            if look != Look::Learn {
                profile.begin(stick.is_straight().then(|| stick.line_from(origin)), forces_n);
            }
            if look != Look::Begin {
                profile.learn(forces_n);
            }
            was_flat && !profile.is_flat()
        });
        if flops {
            // The innovations so far contain the cable's oscillation.
            self.forget_ripple();
        }
    }

    /// Keeps the samples of the last `periods` before an onset, which creep bends, out of the line.
    pub(crate) fn creeps(&mut self, periods: f32) {
        // Limit, periods: the fit takes those samples one by one, and its record has no more room.
        const ROOM: f32 = 48.0;
        // Half a sample: a smaller change does not move the end of a line.
        const LONGER: f32 = 0.5;
        let periods = larger(smaller(periods, ROOM - self.usual_fall), 0.0);
        let before = self.creep_periods.update(|kept| core::mem::replace(kept, periods));
        if self.creep_periods.value() > before + LONGER {
            // The innovations so far contain the creep.
            self.forget_ripple();
        }
        self.update_delay();
    }
}
