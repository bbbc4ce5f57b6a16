//! Falls along a straight line: the winch turned back, and nothing slipped.

use crate::cycle::slip_record::SlipRecord;
use crate::fit::rounding_n2;
use crate::num::math::{self, larger};
use crate::stats::line::Line;

/// Largest residual variance of an even fall about its line, in units of the noise variance, which
/// may come from few samples. Tuned: with 5 a fall of `winding_back` is taken for a slip, with 20
/// no class of `docs/honesty.md` changes.
const EVEN: f32 = 10.0;
/// Shortest fall that is tested, periods: its three inner samples can depart from a line.
const SHORTEST: f32 = 4.0;
/// Fall, periods, above which only the steep middle is tested. A choice: with 8 or 18 no class of
/// `docs/honesty.md` changes.
const LONGEST: f32 = 12.0;
/// Shortest steep middle that is tested, periods.
const SHAPELY_PERIODS: f32 = 6.0;
/// Fewest samples of a fall that distinguish half a cosine from a line.
const SHAPELY: u32 = 4;
/// Threshold of twice the log-likelihood ratio of line and half cosine: by how many noise variances
/// the squared residuals of the cosine are larger. A choice: with half or twice as much no class
/// changes.
const LIKELIER: f32 = 12.0;
/// Least ratio of the difference of squared residuals, cosine less line, to those of the line. A
/// choice: with 1.2 or 4 no class changes.
const FURTHER: f32 = 2.0;
/// An even fall is slower than this part of the steepest fall of a slip from sample to sample.
/// Tuned: a slip on a coarse clock reaches nine tenths.
const SLOW: f32 = 0.85;
/// Standard deviations by which an even fall is slower: exceeded by a normal variable once in 3.5
/// million.
const SURELY: f32 = 5.0;

/// Does the force fall evenly, as when the winch turns back? Its samples then lie on a straight
/// line within the noise. In addition, where the swing is known, the line falls more slowly than a
/// slip with that swing would; where it is unknown, half a cosine from the highest to the lowest
/// sample fits significantly worse than the line. Of a long fall the steep middle is tested, and
/// either condition is enough.
pub(super) fn is_even(slip: &SlipRecord, swing: Option<f32>, after: &Line) -> bool {
    let (peak, low) = slip.extremes();
    if low - peak < SHORTEST {
        return false;
    }
    // The highest sample of a long fall may lie anywhere on a slow rest; the edges do not.
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

/// Is a line significantly likelier than half a cosine, for an unknown noise variance?
fn is_likelier(straight: &Line, cosine: &Line) -> bool {
    let likelier = straight.count as f32 * math::ln(cosine.residual() / straight.residual());
    // False for a force without any noise, and for NaN.
    likelier > LIKELIER
}

/// Least-squares lines of the force between two times: over time, and over the cosine of an angle
/// that runs linearly from `angle` at `from` to `π − angle` at `to`.
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

/// Is a straight fall slower than a slip with this swing `s`, periods? Wherever the samples lie,
/// such a slip falls at least once from one sample to the next by `sin(1/s)` times half its drop.
fn is_slow(slip: &SlipRecord, swing: f32, straight: &Line, noise_n2: f32) -> bool {
    let angle = math::smaller(1.0 / swing, core::f32::consts::FRAC_PI_2);
    let part = 0.5 * math::sin_cos(angle).0;
    let drop_n = slip.peak.force_n - slip.low.force_n;
    let variance_n2 = noise_n2 * (2.0 * part * part + 1.0 / straight.slope_weight());
    let slow_n = SLOW * part * drop_n - SURELY * math::sqrt(variance_n2);
    straight.slope().is_some_and(|slope| -slope < slow_n)
}
