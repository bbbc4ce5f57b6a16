//! Falls along a straight line: the winch turned back, and nothing slipped.

use crate::cycle::slip_record::SlipRecord;
use crate::fit::rounding_n2;
use crate::model::Shape;
use crate::num::math::{self, larger, smaller};
use crate::stats::line::Line;
use crate::stats::significance::SURE;

/// Largest residual variance of an even fall about its line, in units of the noise variance, which
/// may come from few samples. Tuned: with 5 a fall of `winding_back` is taken for a slip, with 20
/// no class of `docs/honesty.md` changes.
const EVEN: f32 = 10.0;
/// Fall, periods, above which only the steep middle is tested. A choice: with 8 or 18 no class of
/// `docs/honesty.md` changes.
const LONGEST: f32 = 12.0;
/// Shortest steep middle that is tested, periods.
const SHAPELY_PERIODS: f32 = 6.0;
/// Fewest samples of a fall that distinguish half a cosine from a line. Tuned: with three, true
/// slips are refused where the cell lags.
const SHAPELY: u32 = 4;
/// The same for a fall to zero, as a hand makes it that lets the cable go. Tuned: with four, a cable
/// let go in three samples is read as a slip on a slack cable (`no_slip/hand.rs`), with two, half of
/// the true ones are refused where the cable creeps.
const SHAPELY_TO_ZERO: u32 = 3;
/// Threshold of twice the log-likelihood ratio of line and half cosine. Tuned: with 10 a hundredth
/// more of the slips in real recordings at 50 Hz is refused, with 12 a winch that runs back for as
/// long as a slip takes is a slip in one of forty turns (one of sixty).
const LIKELIER: f32 = 11.0;
/// An even fall is slower than this part of the steepest fall of a slip from sample to sample.
/// Tuned: a slip on a coarse clock reaches nine tenths.
const SLOW: f32 = 0.85;
/// Standard deviations by which an even fall is slower: exceeded by a normal variable once in 3.5
/// million.
const SURELY: f32 = 5.0;

/// Does the force fall evenly, as when the winch turns back? Its samples then lie on a straight
/// line within the noise, and, where the swing is known, the line falls more slowly than a slip
/// with that swing would. The steep middle of a long fall is even as well if a line is likelier for
/// it than half a cosine. Other falls are fitted first, see [`is_angular`].
pub(super) fn is_even(slip: &SlipRecord, swing: Option<f32>, after: &Line) -> bool {
    // The highest sample of a long fall may lie anywhere on a slow rest; the edges do not.
    let is_long = slip.fall() > LONGEST;
    let (from, to) = if is_long { slip.rough.edges } else { slip.steep() };
    let (straight, cosine) = lines(slip, (from, to), is_long);
    let noise_n2 = noise_n2(slip, after);
    // False for NaN as well.
    let is_straight = own_n2(&straight) < EVEN * noise_n2;
    let is_slow = |swing| is_slow(slip, swing, &straight, noise_n2);
    (is_straight && swing.is_some_and(is_slow))
        || (is_long
            && to - from >= SHAPELY_PERIODS
            && is_likelier(straight.count as f32, cosine.residual_n2 / straight.residual_n2))
}

/// May a fall have enough inner samples for [`is_angular`]? Long falls are judged before the fit.
pub(crate) fn is_shapely(slip: &SlipRecord) -> bool {
    let fall = slip.fall();
    fall > shapely(slip) as f32 && fall <= LONGEST
}

/// Does the slip that was fitted describe the samples significantly worse than its two stick lines
/// with a straight line between them, through the steep fall? Not by the noise about the stick
/// lines: real slips are no exact half cosines.
pub(crate) fn is_angular(slip: &SlipRecord, shape: &Shape, after: &Line) -> bool {
    let (straight, _) = lines(slip, slip.steep(), false);
    if straight.count < shapely(slip) || own_n2(&straight) > EVEN * noise_n2(slip, after) {
        return false;
    }
    let (mut fitted_n2, mut even_n2, mut count) = (0.0, 0.0, 0.0);
    for (time, force_n) in slip.samples().good() {
        let since_onset = time - shape.cycle().onset;
        let even_n = smaller(shape.before(since_onset).0, straight.at(time, straight.slope));
        // A cable does not push.
        let off_n = force_n - larger(larger(even_n, shape.after(since_onset).0), 0.0);
        let fitted_n = force_n - shape.force(time).0;
        (fitted_n2, even_n2) = (fitted_n2 + fitted_n * fitted_n, even_n2 + off_n * off_n);
        count += 1.0;
    }
    is_likelier(count, fitted_n2 / even_n2)
}

/// Fewest samples by which the shape of this fall is told.
fn shapely(slip: &SlipRecord) -> u32 {
    if falls_to_zero(slip) { SHAPELY_TO_ZERO } else { SHAPELY }
}

fn falls_to_zero(slip: &SlipRecord) -> bool {
    slip.reaches_zero(slip.rough.rate)
}

/// Is another shape significantly likelier, for an unknown noise variance, if this one's squared
/// residuals of so many samples are larger by this factor?
fn is_likelier(count: f32, larger_by: f32) -> bool {
    // False for a force without any noise, and for NaN.
    count * math::ln(larger_by) > LIKELIER
}

/// Least-squares lines of the force between two times: over time, and, if it is asked for, over the
/// cosine of an angle that runs linearly from that of the one edge to that of the other. Samples
/// within the noise of the ends of a short fall to zero lie beside it.
fn lines(slip: &SlipRecord, (from, to): (f32, f32), with_cosine: bool) -> (Line, Line) {
    let angle = slip.rough.edge_angle;
    let turn = (core::f32::consts::PI - 2.0 * angle) / (to - from);
    let (mut straight, mut cosine) = (Line::default(), Line::default());
    let beside = !with_cosine && falls_to_zero(slip);
    let end_n = if beside { SURE * math::sqrt(slip.noise_n2) } else { f32::NEG_INFINITY };
    let (high_n, low_n) = (slip.peak.force_n - end_n, slip.low.force_n + end_n);
    for (time, force_n) in slip.samples().good() {
        if time >= from && time <= to && force_n < high_n && force_n > low_n {
            straight.add(time, force_n, 1.0, 1.0);
            if with_cosine {
                cosine.add(math::sin_cos(angle + turn * (time - from)).1, force_n, 1.0, 1.0);
            }
        }
    }
    (straight, cosine)
}

/// Variance of the noise about the stick lines, N².
fn noise_n2(slip: &SlipRecord, after: &Line) -> f32 {
    larger(slip.line_noise_n2(after), rounding_n2(slip.peak.force_n))
}

/// Variance of the samples about their own line, N²; NaN for two samples.
fn own_n2(straight: &Line) -> f32 {
    straight.residual_n2 / (straight.count as f32 - 2.0)
}

/// Is a straight fall slower than a slip with this swing `s`, periods? Wherever the samples lie,
/// such a slip falls at least once from one sample to the next by `sin(1/s)` times half its drop.
fn is_slow(slip: &SlipRecord, swing: f32, straight: &Line, noise_n2: f32) -> bool {
    let angle = smaller(1.0 / swing, core::f32::consts::FRAC_PI_2);
    let part = 0.5 * math::sin_cos(angle).0;
    let variance_n2 = noise_n2 * (2.0 * part * part + 1.0 / straight.slope_weight);
    let slow_n = SLOW * part * slip.drop_n() - SURELY * math::sqrt(variance_n2);
    straight.slope().is_some_and(|slope| -slope < slow_n)
}
