//! Falls of the force that are no slips, and slips that the samples cannot tell: judged
//! by what the force does before, in and after the fall, before anything is fitted.

use crate::coefficient::Coefficient;
use crate::cycle::slip_record::SlipRecord;
use crate::event::{Event, Reason};
use crate::num::math;
use crate::stats::line::Line;

/// Fewest periods from slip to slip: two samples of a rest and two of a slip.
const FEWEST_PERIODS: u64 = 4;
/// Standard deviations of the noise that are no chance.
pub(super) const SURE: f32 = 4.0;
/// Part of the rise after it below which a fall is no slip: what the first load does to a cable
/// that was quieter before.
const LEAST_FALL: f32 = 0.02;
/// Periods of a fall that shows no sample between its ends.
const INSTANT: f32 = 1.5;
/// Fewest periods of a fall that shows its shape.
const SHAPELY: f32 = 6.0;
/// Twice the logarithm of the likelihoods' ratio beyond which one of two shapes is it.
const LIKELIER: f32 = 12.0;
/// A coefficient beyond this is no friction: tuned to nothing, ice stays below 2.
const LARGEST: f32 = 3.0;
/// A block that slides on a slack cable until friction has taken its speed stays on it for
/// `Fs (Fs - 2 Fp) / (2 Fp r)`: with `mu` a tenth of `mu_s`, four times as long as the force took
/// to rise from nothing. One that stays longer was let go.
const LEAST_RATIO: f32 = 0.1;

/// Why a fall gives no coefficient, if that can be said without a fit: the highest force
/// after it, N, the periods until the next slip or the end, and whether a slip of this test
/// took time.
pub(crate) fn of_fall(
    slip: &SlipRecord,
    next_n: f32,
    periods: f32,
    slides: bool,
) -> Option<Reason> {
    let noise_n = math::sqrt(slip.noise_n2);
    let drop_n = slip.peak.force_n - slip.low.force_n;
    let (from, to) = slip.fall_edges();
    if slip.peak.force_n < -SURE * noise_n {
        return Some(Reason::Negative);
    }
    let near_zero_n = (SURE * noise_n + slip.rate()).min(0.08 * drop_n);
    if !slides && to - from < INSTANT && slip.low.force_n.abs() < near_zero_n {
        return Some(Reason::LetGo);
    }
    if to - from >= SHAPELY && is_even(slip) {
        return Some(Reason::WoundBack);
    }
    let rise_n = next_n - slip.low.force_n;
    if drop_n < LEAST_FALL * rise_n {
        return Some(Reason::Scatters);
    }
    let possible_n = slip.rate() * periods;
    let stays = rise_n < 0.6 * drop_n && possible_n > drop_n.max(2.0 * rise_n);
    stays.then_some(Reason::NoRest)
}

/// Does a sample show the force on its way down? A hand lets go at once.
pub(crate) fn takes_time(slip: &SlipRecord) -> bool {
    let (from, to) = slip.fall_edges();
    to - from >= INSTANT
}

/// Do slips follow each other too fast for the sampling?
pub(crate) fn is_aliased(earlier: u64, later: u64) -> bool {
    later.saturating_sub(earlier) < FEWEST_PERIODS
}

/// Why a measured event is not believed.
pub(crate) fn of_event(event: &Event) -> Option<Reason> {
    let (mu_s, mu) = event.mu_s.zip(event.mu)?;
    if event.slack && mu.value < LEAST_RATIO * mu_s.value {
        return Some(Reason::LetGo);
    }
    let is_possible = |c: &Coefficient| c.value < LARGEST && c.value > -SURE * c.combined_std();
    (!is_possible(&mu_s) || !is_possible(&mu)).then_some(Reason::Implausible)
}

/// Does the force fall as evenly as a winch that turns back lets it, and not along half a
/// cosine? Both lines, through the same samples, have two unknowns; their likelihoods decide,
/// the noise unknown.
/// At most as many samples as the record of a slip holds.
fn is_even(slip: &SlipRecord) -> bool {
    let from = slip.edge_angle();
    let (first, last) = slip.fall_edges();
    let turn = (core::f32::consts::PI - 2.0 * from) / (last - first);
    let (mut straight, mut cosine) = (Line::default(), Line::default());
    for (time, force_n) in slip.samples().good() {
        if time >= first && time <= last {
            straight.add(time, force_n, 1.0, 1.0);
            let angle = from + turn * (time - first);
            cosine.add(math::sin_cos(angle).1, force_n, 1.0, 1.0);
        }
    }
    let likelier = straight.count as f32 * math::ln(cosine.residual() / straight.residual());
    // Also not for a force without any noise, or NaN.
    straight.count > 4 && likelier > LIKELIER
}
