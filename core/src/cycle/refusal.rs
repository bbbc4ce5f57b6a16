//! Falls of the force that are no slips, and slips that the samples cannot tell. Before anything is
//! fitted, what the force does before, in and after a fall decides; after it, whether a fit is to
//! be believed.

use crate::coefficient::{Coefficient, Site};
use crate::cycle::slip_record::SlipRecord;
use crate::event::{Event, Reason};
use crate::fit::rounding_n2;
use crate::num::math::{self, larger};
use crate::stats::line::Line;

/// Fewest periods from slip to slip: two samples of a rest and two of a slip.
const FEWEST_PERIODS: f32 = 4.0;
/// Standard deviations of the noise beyond which nothing is chance.
pub(super) const SURE: f32 = 4.0;
/// Part of the rise after it below which a fall is no slip: the first load on a cable that was
/// quieter before makes one like that.
const LEAST_FALL: f32 = 0.02;
/// Part of the mean rate after a fall; with a lower rate before it the force was held there.
const FLAT: f32 = 0.25;
/// Periods from slip to slip below which a single event may tell that it is folded, or that its
/// rate is not known; of slower slips only all events together tell.
pub(super) const FAST: f32 = 16.0;
/// Least rest between slow slips, swings. An oscillation of the force, which rises as it falls, is
/// fitted by slips with rests of half a swing to one, whatever its period.
pub(super) const SWINGS: f32 = 1.4;
/// Ratio of the stiffness by the winch to that by the slip that no error of weight, winch or model
/// makes: of the scenes that can be read none comes to 1.2.
const STIFFER: f32 = 2.0;
/// Such a ratio the other way: weight and winch speed are known better than to a half.
const SOFTER: f32 = 2.0 / 3.0;
/// The root of that ratio is one within these limits: the ratio within about 20 %.
const CLOSE: (f32, f32) = (0.9, 1.11);
/// Standard errors by which it has to be beyond a limit, where the true ratio is far beyond. Tuned:
/// at four, seven times as many events of `aliased_fast` and `aliased_stiff` are believed.
const LIKELY: f32 = 2.0;
/// Fall, periods, that shows no sample between its ends.
const INSTANT: f32 = 1.5;
/// Most variance of an even fall about its line, in variances of the noise, which at times is known
/// from few samples only.
const EVEN: f32 = 10.0;
/// Shortest fall, periods, whose samples in between, three of them, can lie off a line.
const SHORTEST: f32 = 4.0;
/// Periods beyond which a fall is judged by its middle.
const LONGEST: f32 = 12.0;
/// Fewest periods of that middle.
const SHAPELY_PERIODS: f32 = 6.0;
/// Fewest samples of a fall that tell half a cosine from a line.
const SHAPELY: u32 = 4;
/// By how many variances of the noise half a cosine has to lie further off than a line: twice the
/// logarithm of the ratio of their likelihoods.
const LIKELIER: f32 = 12.0;
/// And by how many times what the line is off.
const FURTHER: f32 = 2.0;
/// Part of what a slip falls from sample to sample that an even fall stays below. Tuned: a slip on a
/// coarse clock reaches nine tenths.
const SLOW: f32 = 0.85;
/// Standard deviations by which it does.
const SURELY: f32 = 5.0;
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
    let near_zero_n = math::smaller(SURE * noise_n + slip.rate(), 0.08 * drop_n);
    if !slides && to - from < INSTANT && slip.low.force_n.abs() < near_zero_n {
        return Some(Reason::LetGo);
    }
    if is_even(slip, swing, after) {
        return Some(Reason::WoundBack);
    }
    let rise_n = next_n - slip.low.force_n;
    if drop_n < LEAST_FALL * rise_n {
        return Some(Reason::Scatters);
    }
    let possible_n = slip.rate() * periods;
    let stays = rise_n < 0.6 * drop_n && possible_n > larger(drop_n, 2.0 * rise_n);
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

/// Events over which these means fade.
const MEMORY: f32 = 16.0;

/// How the slips of late follow each other: the mean number of periods from one to the next (of
/// slips every 3.8 samples most are seen four apart), and how many of their fits say that slips in
/// between were missed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Recurrence {
    mean: f32,
    /// Part of the events of late that were folded by their own fits, or refused for reasons of
    /// their own.
    folded: f32,
}

impl Default for Recurrence {
    fn default() -> Self {
        // Tuned: with 0 twice as many events of `aliased_fast` are believed, the first ones.
        Self { mean: FEWEST_PERIODS, folded: 0.4 }
    }
}

impl Recurrence {
    /// Takes the periods to the next slip: does it follow too fast for the sampling?
    pub(super) fn is_aliased(&mut self, periods: f32) -> bool {
        // Tuned: slips every four samples stay above the limit less this.
        const UNSURE: f32 = 0.05;
        self.mean += (math::smaller(periods, FAST) - self.mean) / MEMORY;
        periods < FEWEST_PERIODS || self.mean < FEWEST_PERIODS - UNSURE
    }

    /// Is an event folded, by its own fit, or because most events of late were?
    pub(super) fn is_folded(&mut self, fit_tells: bool) -> bool {
        const MOST: f32 = 0.5;
        let now = if fit_tells { 1.0 } else { 0.0 };
        self.folded += (now - self.folded) / MEMORY;
        fit_tells || self.folded > MOST
    }
}

/// Limits of the root of the ratio of two stiffnesses, `k = F'/w` over `k = ω² M`: by the loading
/// rate, N per period, and the swing, periods, each with its variance. NaN where the speed of the
/// winch is not known: then neither limit tells anything.
#[inline(never)]
pub(crate) fn root_stiffness_ratio(site: &Site, rate: (f32, f32), swing: (f32, f32)) -> (f32, f32) {
    let root = swing.0 * math::sqrt(rate.0 / site.momentum);
    // Of the root the rate's relative error is halved.
    let unsure = 0.25 * rate.1 / (rate.0 * rate.0) + swing.1 / (swing.0 * swing.0);
    let by = LIKELY * root * math::sqrt(unsure);
    (root - by, root + by)
}

/// Does the winch show a stiff cable, and the slips a soft one? Then the slips that are seen are
/// made of single samples of many: with time stretched by a factor, `k = F'/w` falls by it and `k =
/// ω² M` by its square, and the true slips follow each other that much faster. `periods` is the
/// time to the next slip.
pub(crate) fn is_folded((least, _): (f32, f32), periods: f32) -> bool {
    least > 0.0 && least * least > larger(STIFFER, periods / FEWEST_PERIODS)
}

/// Is the ratio surely one, as far as weight and winch are known? Then the slips are not folded,
/// and no oscillation of the cell.
pub(crate) fn agrees_with_winch((least, most): (f32, f32)) -> bool {
    least > CLOSE.0 && most < CLOSE.1
}

/// Is the loading rate surely far too low for the swing? A winch of known speed loads the cable
/// that the swing shows by `ω² M w`; at two thirds of that the fit has found another slip than the
/// one in the samples, as it may with few of them.
pub(crate) fn is_softer((_, most): (f32, f32)) -> bool {
    most * most < SOFTER
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

/// Does the force fall as evenly as a winch that turns back makes it? Then it lies on a straight
/// line, as far as the noise allows, and no slip does: a slip with the swing that is known falls
/// faster on its way, and where none is known half a cosine from the highest sample to the lowest
/// has to lie further off. Looks at the samples of the slip's record.
fn is_even(slip: &SlipRecord, swing: Option<f32>, after: &Line) -> bool {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::Effects;

    /// Slips every so many samples, seen at whole ones.
    fn aliased_of(samples: f32) -> usize {
        let mut recurrence = Recurrence::default();
        let peak = |i: u16| libm::roundf(samples * f32::from(i));
        (0..200).filter(|&i| recurrence.is_aliased(peak(i + 1) - peak(i))).count()
    }

    #[test]
    fn slips_every_3_8_samples_are_aliased_and_every_4_are_not() {
        for (samples, aliased) in
            [(2.9, 200..=200), (3.8, 190..=200), (4.0, 0..=0), (4.3, 0..=0), (29.0, 0..=0)]
        {
            let count = aliased_of(samples);
            assert!(aliased.contains(&count), "{samples} {count}");
        }
    }

    #[test]
    fn most_of_late_decide_for_all() {
        let mut recurrence = Recurrence::default();
        // One in four by chance: each for itself.
        assert!((0..64).all(|i| recurrence.is_folded(i % 4 == 0) == (i % 4 == 0)));
        // Three in four: after some of them all.
        let refused = (0..64).filter(|i| recurrence.is_folded(i % 4 != 0)).count();
        assert!((58..=64).contains(&refused), "{refused}");
        // It ends.
        assert!((0..16).filter(|_| recurrence.is_folded(false)).count() < 12);
        assert!(!recurrence.is_folded(false));
    }

    /// DFF8-13: `k w` of 360 N/s, a swing of a 19th of a second.
    #[test]
    fn time_that_is_stretched_is_seen_if_the_winch_is_known() {
        let (hz, rate_n_per_s, omega) = (16.0, 360.0, 18.93_f32);
        let mass_kg = 630.0 / 9.806_65;
        let winch_m_per_s = rate_n_per_s / (omega * omega * mass_kg);
        let limits = |winch_m_per_s: f32, stretched: f32, std: f32| {
            let site = Site {
                weight_n: 630.0,
                momentum: mass_kg * winch_m_per_s * hz,
                slope: (0.0, 1.0),
                rate_hz: hz,
                effects: Effects::NONE,
            };
            let (rate, swing) = (rate_n_per_s / hz / stretched, stretched * hz / omega);
            let variance = |value: f32| std * std * value * value;
            root_stiffness_ratio(&site, (rate, variance(rate)), (swing, variance(swing)))
        };
        for (stretched, std, folded, asked_for) in [
            (1.0, 0.001, false, true),
            (1.0, 0.04, false, true),
            (1.0, 0.06, false, false),
            (2.5, 0.001, false, false),
            (7.0, 0.001, false, false),
            (7.5, 0.001, true, false),
            (7.5, 0.01, false, false),
            (29.0, 0.1, true, false),
            (29.0, 0.2, true, false),
            (29.0, 0.25, false, false),
        ] {
            let seen = limits(winch_m_per_s, stretched, std);
            let told = (is_folded(seen, 29.0), agrees_with_winch(seen));
            assert_eq!(told, (folded, asked_for), "{stretched} ± {std}");
            let unknown = limits(f32::NAN, stretched, std);
            assert!(
                !is_folded(unknown, 29.0) && !agrees_with_winch(unknown) && !is_softer(unknown)
            );
        }
    }
}
