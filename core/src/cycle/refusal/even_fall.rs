//! Falls along a straight line: the winch turned back, and nothing slipped.

use crate::cycle::slip_record::SlipRecord;
use crate::fit::rounding_n2;
use crate::num::math::{self, larger};
use crate::stats::line::Line;

/// Most variance of an even fall about its line, in variances of the noise, which at times is known
/// from few samples only. Tuned: with 5 a fall of `winding_back` is taken for a slip, with 20 no class
/// of `docs/honesty.md` changes.
const EVEN: f32 = 10.0;
/// Shortest fall, periods, whose samples in between, three of them, can lie off a line.
const SHORTEST: f32 = 4.0;
/// Periods beyond which a fall is judged by its middle. A choice: with 8 or 18 no class of
/// `docs/honesty.md` changes.
const LONGEST: f32 = 12.0;
/// Fewest periods of that middle.
const SHAPELY_PERIODS: f32 = 6.0;
/// Fewest samples of a fall that tell half a cosine from a line.
const SHAPELY: u32 = 4;
/// By how many variances of the noise half a cosine has to lie further off than a line: twice the
/// logarithm of the ratio of their likelihoods. A choice: with half or twice as much none changes.
const LIKELIER: f32 = 12.0;
/// And by how many times what the line is off. A choice: with 1.2 or 4 none changes.
const FURTHER: f32 = 2.0;
/// Part of what a slip falls from sample to sample that an even fall stays below. Tuned: a slip on a
/// coarse clock reaches nine tenths.
const SLOW: f32 = 0.85;
/// Standard deviations by which it does: of normal ones one in 3.5 million.
const SURELY: f32 = 5.0;

/// Does the force fall as evenly as a winch that turns back makes it? Then it lies on a straight
/// line, as far as the noise allows, and no slip does: a slip with the swing that is known falls
/// faster on its way, and where none is known half a cosine from the highest sample to the lowest
/// has to lie further off. Looks at the samples of the slip's record.
pub(super) fn is_even(slip: &SlipRecord, swing: Option<f32>, after: &Line) -> bool {
    let (peak, low) = slip.extremes();
    if low - peak < SHORTEST {
        return false;
    }
    // The highest sample of a long fall may lie anywhere on a slow rest: its edges count.
    let is_long = low - peak > LONGEST;
    let edges = slip.fall_edges();
    let (straight, cosine) = if is_long {
        lines(slip, edges, slip.edge_angle(), edges)
    } else {
        lines(slip, slip.steep(), 0.0, (peak, low))
    };
    let off_n2 = straight.residual();
    let own_n2 = off_n2 / (straight.count as f32 - 2.0);
    let noise_n2 = larger(slip.line_noise_n2(after), rounding_n2(slip.peak.force_n));
    // False for NaN as well.
    let is_straight = own_n2 < EVEN * noise_n2;
    if swing.is_some_and(|swing| is_straight && is_slow(slip, swing, &straight, noise_n2)) {
        return true;
    }
    if is_long {
        return edges.1 - edges.0 >= SHAPELY_PERIODS && is_likelier(&straight, &cosine);
    }
    let further_n2 = cosine.residual() - off_n2;
    let is_clear = further_n2 > LIKELIER * larger(own_n2, noise_n2);
    let is_shapely = straight.count >= SHAPELY && further_n2 > FURTHER * off_n2;
    swing.is_none() && is_straight && is_shapely && is_clear
}

/// Is a line through the samples far likelier than half a cosine, without knowing the noise?
fn is_likelier(straight: &Line, cosine: &Line) -> bool {
    let likelier = straight.count as f32 * math::ln(cosine.residual() / straight.residual());
    // False for a force without any noise, and for NaN.
    likelier > LIKELIER
}

/// Lines through the samples between two times, one over their time, one over the cosine of an
/// angle. That goes evenly from `angle` at the third time to `π − angle` at the fourth.
#[inline(never)]
fn lines(
    slip: &SlipRecord,
    (first, last): (f32, f32),
    angle: f32,
    (from, to): (f32, f32),
) -> (Line, Line) {
    let turn = (core::f32::consts::PI - 2.0 * angle) / (to - from);
    let (mut straight, mut cosine) = (Line::default(), Line::default());
    for (time, force_n) in slip.samples().good() {
        if time >= first && time <= last {
            straight.add(time, force_n, 1.0, 1.0);
            cosine.add(math::sin_cos(angle + turn * (time - from)).1, force_n, 1.0, 1.0);
        }
    }
    (straight, cosine)
}

/// Does a fall along a line take longer than a slip with this swing, periods? Wherever its samples
/// lie, such a slip falls once from one sample to the next by `sin(1/s)` times half its drop.
fn is_slow(slip: &SlipRecord, swing: f32, straight: &Line, noise_n2: f32) -> bool {
    let angle = math::smaller(1.0 / swing, core::f32::consts::FRAC_PI_2);
    let part = 0.5 * math::sin_cos(angle).0;
    let drop_n = slip.peak.force_n - slip.low.force_n;
    let variance_n2 = noise_n2 * (2.0 * part * part + 1.0 / straight.slope_weight());
    let slow_n = SLOW * part * drop_n - SURELY * math::sqrt(variance_n2);
    straight.slope().is_some_and(|slope| -slope < slow_n)
}
