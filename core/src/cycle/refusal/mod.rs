//! Refusal of falls that are no slips, and of slips that the samples do not determine. Before the
//! fit the force before, in and after the fall decides; after the fit, the fitted values and their
//! errors.

mod even_fall;
mod recurrence;
mod slackness;
mod stiffness;

use crate::coefficient::Coefficient;
use crate::cycle::slip_record::SlipRecord;
use crate::event::{Event, Reason};
use crate::num::math::{self, larger};
use crate::stats::line::Line;
use crate::stats::significance::SURE;

pub(super) use even_fall::{is_angular, is_shapely};
pub(super) use recurrence::{FAST, Recurrence};
pub(super) use slackness::Slackness;
pub(super) use stiffness::RootStiffnessRatio;

/// Least drop of a slip, as a part of the rise after it; the first load on a quiet cable falls by
/// less. A choice: with half or twice as much no class of `docs/honesty.md` changes.
const LEAST_FALL: f32 = 0.02;
/// A line that rises at less than this part of the mean rate after the fall is a force that was
/// held. A choice: half or twice as much hardly changes a class of `docs/honesty.md`.
const FLAT: f32 = 0.25;
/// Longest fall, periods, that shows no sample between its ends: consecutive samples are one period
/// apart, samples with another one in between two.
const INSTANT: f32 = 1.5;
/// Upper limit of the force at the end of a fall to zero, as a part of the drop. A choice.
const NEAR_ZERO: f32 = 0.08;
/// Least rise after a slip, as a part of its drop. With a constant `Fs` the force rises by the
/// whole drop; the rest is room for friction that scatters.
const RISES: f32 = 0.6;
/// Largest coefficient of friction that is believed: ice stays below 2. Tuned to nothing.
const LARGEST: f32 = 3.0;
/// Least `mu / mu_s` on a slack cable. A block that friction alone stops leaves the cable slack for
/// `Fs (Fs - 2 Fp) / (2 Fp r)`: at a tenth, four times as long as the force took to rise from zero.
/// A cable that stays slack for longer was let go.
const LEAST_RATIO: f32 = 0.1;
/// The same where the stiffness from the winch does not confirm the slip: at 0.3, slack for two
/// thirds of the time in which the force rose. A choice: cables wound up by hand and let go at once
/// have a fifth to a quarter, the slack cables of `docs/honesty.md` two fifths.
pub(super) const LEAST_UNCONFIRMED: f32 = 0.3;

/// Why a fall gives no coefficient, as far as that is known without a fit. Arguments: the line
/// after it and the highest force on that, N; the periods until the next slip or the end; whether a
/// slip of this test has a sample on its fall; the swing, periods, if known.
pub(crate) fn of_fall(
    slip: &SlipRecord,
    (after, next_n): (&Line, f32),
    periods: f32,
    slides: bool,
    swing: Option<f32>,
) -> Option<Reason> {
    let noise_n = math::sqrt(slip.noise_n2);
    let drop_n = slip.drop_n();
    // A cable does not push; half the highest force is room for an error of the zero.
    if slip.low.force_n < -0.5 * slip.peak.force_n.abs() {
        return Some(Reason::Negative);
    }
    let near_zero_n = math::smaller(SURE * noise_n + slip.rough.rate, NEAR_ZERO * drop_n);
    if !slides && !takes_time(slip) && slip.low.force_n.abs() < near_zero_n {
        return Some(Reason::LetGo);
    }
    if even_fall::is_even(slip, swing, after) {
        return Some(Reason::WoundBack);
    }
    let rise_n = next_n - slip.low.force_n;
    if drop_n < LEAST_FALL * rise_n {
        return Some(Reason::Scatters);
    }
    let possible_n = slip.rough.rate * periods;
    let stays = rise_n < RISES * drop_n && possible_n > larger(drop_n, 2.0 * rise_n);
    (stays || is_held(slip, rise_n / periods)).then_some(Reason::NoRest)
}

/// Was the force held before the fall, so that no load made the block slip? Then the slope of the
/// line before it is significantly below [`FLAT`] times `rate`, the mean rate of the force after
/// the fall.
fn is_held(slip: &SlipRecord, rate: f32) -> bool {
    let before = &slip.before;
    let less = FLAT * rate - before.slope;
    is_no_chance((less, slip.noise_n2 / before.slope_weight))
}

/// Does the fall have a sample between its ends? The fall of a cable that is let go has none.
pub(crate) fn takes_time(slip: &SlipRecord) -> bool {
    let (from, to) = slip.rough.edges;
    to - from >= INSTANT
}

/// Is a value, with its variance, above zero by more than [`SURE`] standard deviations? Fits of
/// slips that follow each other too fast may end with hardly a drop. False for NaN.
#[inline(never)]
pub(crate) fn is_no_chance((value, variance): (f32, f32)) -> bool {
    value > 0.0 && SURE * SURE * variance < value * value
}

/// Why a measured event is refused, by its coefficients alone.
pub(crate) fn of_event(event: &Event) -> Option<Reason> {
    let (mu_s, mu) = (event.mu_s?, event.mu);
    if event.slack && mu.is_some_and(|mu| mu.value < LEAST_RATIO * mu_s.value) {
        return Some(Reason::LetGo);
    }
    // A coefficient smaller than its own standard deviation is not determined.
    if mu_s.std > mu_s.value.abs() {
        return Some(Reason::TooShort);
    }
    let is_possible = |c: &Coefficient| c.value < LARGEST && c.value > -SURE * c.std;
    (!is_possible(&mu_s) || mu.is_some_and(|mu| !is_possible(&mu))).then_some(Reason::Implausible)
}
