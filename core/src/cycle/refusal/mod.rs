//! Falls of the force that are no slips, and slips that the samples cannot tell. Before anything is
//! fitted, what the force does before, in and after a fall decides; after it, whether a fit is to
//! be believed.

mod even_fall;
mod recurrence;
mod slackness;
mod stiffness;

use crate::coefficient::Coefficient;
use crate::cycle::slip_record::{SURE, SlipRecord};
use crate::event::{Event, Reason};
use crate::num::math::{self, larger};
use crate::stats::line::Line;

pub(super) use recurrence::{FAST, Recurrence};
pub(super) use slackness::Slackness;
pub(super) use stiffness::RootStiffnessRatio;

/// Part of the rise after it below which a fall is no slip: the first load on a cable that was
/// quieter before makes one like that. A choice: with half or twice as much those classes stay the same.
const LEAST_FALL: f32 = 0.02;
/// Part of the mean rate after a fall; with a lower rate before it the force was held there. A choice:
/// half or twice as much hardly changes a class of `docs/honesty.md`.
const FLAT: f32 = 0.25;
/// Fall, periods, that shows no sample between its ends: samples in a row are one apart, two with
/// another one in between.
const INSTANT: f32 = 1.5;
/// Largest force, parts of the drop, at the end of a fall to zero. A choice as well.
const NEAR_ZERO: f32 = 0.08;
/// Part of its drop by which the force rises again after a slip, at least: to the same `Fs` by all of
/// it, the rest is room for friction that scatters.
const RISES: f32 = 0.6;
/// A coefficient beyond this is no friction: tuned to nothing, ice stays below 2.
const LARGEST: f32 = 3.0;
/// Least `mu` over `mu_s` of a slack cable. A block that slides on one until friction has stopped
/// it stays on it for `Fs (Fs - 2 Fp) / (2 Fp r)`: with a tenth, four times as long as the force
/// took to rise from zero. A cable that stays slack for longer was let go.
const LEAST_RATIO: f32 = 0.1;

/// Why a fall gives no coefficient, if that can be said without a fit: from the line after it and
/// the highest force on that, N, the periods until the next slip or the end, whether a slip of this
/// test was seen to take time, and the swing, periods, if it is known.
pub(crate) fn of_fall(
    slip: &SlipRecord,
    (after, next_n): (&Line, f32),
    periods: f32,
    slides: bool,
    swing: Option<f32>,
) -> Option<Reason> {
    let noise_n = math::sqrt(slip.noise_n2);
    let drop_n = slip.peak.force_n - slip.low.force_n;
    let (from, to) = slip.fall_edges();
    if slip.peak.force_n < -SURE * noise_n {
        return Some(Reason::Negative);
    }
    let near_zero_n = math::smaller(SURE * noise_n + slip.rate(), NEAR_ZERO * drop_n);
    if !slides && to - from < INSTANT && slip.low.force_n.abs() < near_zero_n {
        return Some(Reason::LetGo);
    }
    if even_fall::is_even(slip, swing, after) {
        return Some(Reason::WoundBack);
    }
    let rise_n = next_n - slip.low.force_n;
    if drop_n < LEAST_FALL * rise_n {
        return Some(Reason::Scatters);
    }
    let possible_n = slip.rate() * periods;
    let stays = rise_n < RISES * drop_n && possible_n > larger(drop_n, 2.0 * rise_n);
    (stays || is_held(slip, rise_n / periods)).then_some(Reason::NoRest)
}

/// Was the force held before a fall, so that no load made the block slip? Then its line rises, for
/// sure, by far less than `rate`, the mean rate of the force after the fall.
fn is_held(slip: &SlipRecord, rate: f32) -> bool {
    let before = &slip.before;
    let less = FLAT * rate - before.slope().unwrap_or(0.0);
    is_no_chance((less, slip.noise_n2 / before.slope_weight()))
}

/// Does a sample show the force on its way down? A hand that lets go shows none.
pub(crate) fn takes_time(slip: &SlipRecord) -> bool {
    let (from, to) = slip.fall_edges();
    to - from >= INSTANT
}

/// Is a value, with its variance, surely above zero? What may be zero says nothing: fits of slips
/// that follow each other too fast may end with hardly a drop. False for NaN.
#[inline(never)]
pub(crate) fn is_no_chance((value, variance): (f32, f32)) -> bool {
    value > 0.0 && SURE * SURE * variance < value * value
}

/// Why a measured event is not believed.
pub(crate) fn of_event(event: &Event) -> Option<Reason> {
    let (mu_s, mu) = (event.mu_s?, event.mu);
    if event.slack && mu.is_some_and(|mu| mu.value < LEAST_RATIO * mu_s.value) {
        return Some(Reason::LetGo);
    }
    // A coefficient that is no larger than its own standard deviation says nothing.
    if mu_s.std > mu_s.value.abs() {
        return Some(Reason::TooShort);
    }
    let is_possible = |c: &Coefficient| c.value < LARGEST && c.value > -SURE * c.std;
    (!is_possible(&mu_s) || mu.is_some_and(|mu| !is_possible(&mu))).then_some(Reason::Implausible)
}
