//! Rounding of the corners between stick line and slip, estimated from the residuals of the fits.
//!
//! The score of a fitted event, all six unknowns free, gives its estimate of `κ`, `h` and `ln c`
//! (`model/corner.rs`), and the scores of the events are summed. `κ` and `h` stay zero until they
//! are significantly above it; before that they widen the intervals. When they change, the event's
//! own fit and the estimates of rate, swing and rate change are corrected to first order.

#![allow(clippy::needless_range_loop, reason = "an index is that of rows and columns alike")]

mod due;
mod score;

use crate::effect::Parameter;
pub(crate) use crate::effects::corner::score::ask;
use crate::effects::corner::score::{numbers_of, with_zeros};
use crate::effects::score::Asked;
use crate::fit::correction::Correction;
use crate::fit::{DYNAMIC, Fit, STATIC};
use crate::model::corner::{Corner, NUMBERS, Numbers};
use crate::num::math::{self, larger, smaller};
use crate::stats::fading_trend::FADE;
use crate::stats::normal_equations::{ENTRIES_OF_FIRST, Factor, Gradient, Symmetric, dot, place};
use crate::stats::significance::{SIGNIFICANT, surely};

/// Estimate of the corners that the events share.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct CornerEstimator {
    /// Sums over the events, with a fading memory, in units of the noise variance: information
    /// matrix and right-hand side of the normal equations of `κ`, `h` and `ln c`.
    information: [f32; ENTRIES_OF_FIRST],
    right: Numbers,
    /// Number of these events, fading; and Σ of their squared scores, each less its expectation,
    /// over its variance.
    count: f32,
    chi_square: f32,
    /// Unit of the range, N: the third parameter is the logarithm of the range over it, so that
    /// rounding does not depend on the size of the forces.
    unit_n: f32,
    /// The most likely values of the three parameters.
    best: Numbers,
    /// The corners expected for the next event.
    corner: Corner,
    /// Variances of `κ` and `h` by values that are possible but not significant.
    possible: [f32; 2],
    /// Variances of the estimates of `κ` and `h`.
    variances: [f32; 2],
    /// Number of events that could be tested, whether they were or not.
    events: u32,
    /// Number of the last events in a row that could not.
    untested: u8,
}

/// Number of events up to which no parameter is significant; it may only widen.
const LEAST_EVENTS: f32 = 2.5;
/// Standard errors beyond which a parameter is possible and widens. Tuned: a smaller one widens
/// linear scenes, a larger one lets smooth onsets pass for sharp ones.
const POSSIBLE: f32 = 1.1;
/// Standard errors beyond which a parameter is possible in the first events, where none is
/// significant. Tuned: 2 leaves the first two events of creep in 5 N of noise up to 11 standard
/// deviations off, 1.3 makes the intervals of tests of one to three events twice as wide as their
/// errors.
const POSSIBLE_EARLY: f32 = 1.5;
/// Information, over its own, that holds an insignificant parameter at zero: within a millionth.
const HELD: f32 = 1e12;
/// Range before the events determine it: the rise of the line in this number of swings. Tuned: with
/// 3 the mean `mu` of `rate_and_state` is 2.3 standard deviations off at worst, with 1.5 one.
const RANGE: f32 = 1.5;
/// Prior information on the logarithm of the range: it is known to a factor of two, `e^√½`.
const RANGE_KNOWN: f32 = 2.0;
/// Information on `κ = 0`, periods⁻⁴, added per event: negligible except on a slack cable.
const SMOOTHING_KNOWN: f32 = 0.025;
/// Part of the squared shift of `Fp` by the corners that is added to its variance where another
/// cause is possible. Tuned with the smooth onsets of the honesty scenes.
const PART: f32 = 0.5;
/// Largest `κ`, periods²: a mean over one and a half periods, `√(24 κ)`.
const MOST_SMOOTHING: f32 = 0.1;
/// Least range `c`, as a part of `h`.
const LEAST_RANGE: f32 = 0.125;
/// Largest step of `ln c` per event, a factor of two: first order does not hold beyond it.
const MOST_STEP: f32 = 0.7;
/// Largest shift of the event's own onset by a step, in swings.
const MOST_ONSET: f32 = 0.4;
/// Largest relative shift of the event's own swing by a step.
const MOST_SWING: f32 = 0.1;

impl CornerEstimator {
    /// The corners expected for the next event, which has this rate and swing.
    pub(crate) fn expected(&self, rate: f32, inverse_omega: f32) -> Corner {
        if self.count > 0.0 {
            return self.corner;
        }
        Corner { range_n: RANGE * rate * inverse_omega, ..Corner::default() }
    }

    /// The significant parameters: the force missing at the onset, `h`, N, and the averaging time
    /// of the converter, s, `τ² = 24 κ`.
    pub(crate) fn parameters(&self, rate_hz: f32) -> [Option<Parameter>; 2] {
        let Corner { smoothing, missing_n, .. } = self.corner;
        let [of_smoothing, of_missing] = self.variances.map(math::sqrt);
        let averaging = 2.0 * math::sqrt(6.0 * smoothing);
        let (value, std) =
            (averaging / rate_hz, 0.5 * averaging * of_smoothing / smoothing / rate_hz);
        let averaging = Parameter { name: "averaging_s", value, std };
        let missing = Parameter { name: "missing_n", value: missing_n, std: of_missing };
        let found = |size: f32, parameter| (size > 0.0).then_some(parameter);
        [found(missing_n, missing), found(smoothing, averaging)]
    }

    /// Are the estimated corners sharp, as in the model?
    pub(crate) fn is_sharp(&self) -> bool {
        self.corner.is_sharp()
    }

    /// The force missing at the onset, `h`, N.
    pub(crate) fn missing_n(&self) -> f32 {
        self.corner.missing_n
    }

    /// Distance below `Fs`, N, from which creep lowers the force by `lacking_n` or more; zero if it
    /// never does.
    pub(crate) fn creep_n(&self, lacking_n: f32) -> f32 {
        let Corner { missing_n, range_n, .. } = self.corner;
        if missing_n > lacking_n { range_n * math::ln(missing_n / lacking_n) } else { 0.0 }
    }

    /// Adds an event's score, its unknowns free; returns the correction of its forces. `other_n2` is the square of
    /// another force by which the slips depart from the model. As far as that is as large as `h` it
    /// may be the cause instead of the corners, and their shift of `Fp` is added to the variance.
    pub(crate) fn learn(
        &mut self,
        used: Corner,
        fit: &Fit,
        score: &Asked,
        noise_n2: f32,
        other_n2: f32,
    ) -> Correction {
        // Zero is valid: without creep there is no information on its range.
        if (0..NUMBERS).any(|i| score.normal.matrix[[i, i]].is_nan()) {
            return Correction::default();
        }
        let used = (used, fit.cycle().inverse_omega());
        let mut effect = self.take(used, score, noise_n2).unwrap_or_default();
        let Corner { smoothing, missing_n, range_n } = self.corner;
        // Only with creep, for which the other departure may be mistaken.
        if missing_n > 0.0 {
            let [by_smoothing, by_missing, _] = score.by(&DYNAMIC);
            let moved_n = by_smoothing * smoothing + by_missing * missing_n;
            let doubt = math::smaller(other_n2, missing_n * missing_n) / (missing_n * missing_n);
            effect.dynamic_n2 += PART * doubt * moved_n * moved_n;
        }
        if effect.is_finite() && (smoothing + missing_n + range_n).is_finite() {
            return effect;
        }
        // After an overflow the estimates are undefined.
        *self = Self::default();
        Correction::default()
    }

    fn numbers(&self, corner: &Corner) -> Numbers {
        [corner.smoothing, corner.missing_n, math::ln(corner.range_n / self.unit_n)]
    }

    /// Variance of a force, N², by the possible parameters; `by` is its change per unit of each.
    fn possible_n2(&self, by: Numbers) -> f32 {
        self.possible.iter().zip(by).fold(0.0, |sum, (v, by)| sum + v * by * by)
    }

    /// Takes the score of an event, fitted with these corners and of this swing.
    fn take(&mut self, used: (Corner, f32), score: &Asked, noise_n2: f32) -> Option<Correction> {
        let (corner, swing) = used;
        if !score.determines(1) {
            let [static_n2, dynamic_n2] =
                [STATIC, DYNAMIC].map(|force| self.possible_n2(score.by(&force)));
            return Some(Correction { static_n2, dynamic_n2, ..Correction::default() });
        }
        if self.count <= 0.0 {
            // The corners of the first event's fit; only the range has a prior.
            (self.corner, self.unit_n) = (corner, corner.range_n);
            self.best = self.numbers(&corner);
            self.information[place(2, 2)] = RANGE_KNOWN;
        }
        let used = self.numbers(&corner);
        let sharp = score.of_sharp(&used);
        self.add(score, &sharp, &used, noise_n2);
        let information = Symmetric::of_first(&self.information);
        let free = information.factor(0.0)?;
        let best = numbers_of(&free, &self.right);
        let (before, after) = (score.times(&self.best), score.times(&best));
        self.chi_square *= FADE;
        for k in (0..2).filter(|&k| score.determines(k)) {
            // The distance from the expectation before this event, times that from the estimate
            // with it: its mean is the variance of the noise.
            let squared = (sharp[k] - before[k]) * (sharp[k] - after[k]);
            self.chi_square += 0.5 * squared / (score.normal.matrix[[k, k]] * noise_n2);
        }
        self.best = best;
        // Scores that scatter by more than the noise make the variances larger in proportion.
        let excess = math::larger(self.chi_square / math::larger(self.count - 1.0, 1.0), 1.0);
        let factor = self.decide(information, &free, excess, &used)?;
        let moved = self.limited(score, swing, &used);
        let variance = |force: &Gradient| {
            let by = score.by(force);
            let possible = self.possible_n2(by);
            let all = with_zeros(&by);
            excess * dot(&all, &factor.solve(&all)) + possible
        };
        let (static_n2, dynamic_n2) = (variance(&STATIC), variance(&DYNAMIC));
        Some(Correction { moved, static_n2, dynamic_n2 })
    }

    /// Adds an event's score and information.
    fn add(&mut self, score: &Asked, sharp: &Numbers, used: &Numbers, noise_n2: f32) {
        self.count = FADE * self.count + 1.0;
        let fade = |sum: &mut f32, by: f32| *sum = FADE * *sum + by / noise_n2;
        let of_event = score.normal.matrix.entries();
        self.information.iter_mut().zip(of_event).for_each(|(sum, by)| fade(sum, *by));
        self.right.iter_mut().zip(sharp).for_each(|(sum, by)| fade(sum, *by));
        // Keeps the prior of the range while no event determines it.
        self.information[place(2, 2)] += (1.0 - FADE) * RANGE_KNOWN;
        self.right[2] += (1.0 - FADE) * RANGE_KNOWN * used[2];
        self.information[place(0, 0)] += SMOOTHING_KNOWN;
    }

    /// Decides which parameters are significant, and sets the corners.
    fn decide(
        &mut self,
        mut likely: Symmetric,
        free: &Factor,
        excess: f32,
        used: &Numbers,
    ) -> Option<Factor> {
        let mut counts = [false; 2];
        let variances = free.variances();
        for k in 0..2 {
            let square = self.best[k] * self.best[k];
            let variance = excess * variances[k];
            self.variances[k] = variance;
            let beyond = |errors: f32| {
                if self.best[k] > 0.0 { surely(square, errors * errors * variance) } else { 0.0 }
            };
            let is_early = self.count <= LEAST_EVENTS;
            let sure = if is_early { 0.0 } else { beyond(SIGNIFICANT) };
            counts[k] = sure > 0.0;
            let errors = if is_early { POSSIBLE_EARLY } else { POSSIBLE };
            self.possible[k] = (1.0 - sure) * beyond(errors) * square;
            // Prior about zero: as wide as the estimate as far as it counts, else nearly exact.
            let own = &mut likely[[k, k]];
            *own += if counts[k] { 1.0 / (sure * square) } else { HELD * *own };
        }
        let factor = likely.factor(0.0)?;
        let numbers = numbers_of(&factor, &self.right);
        let counted = |k: usize| if counts[k] { larger(numbers[k], 0.0) } else { 0.0 };
        let missing_n = counted(1);
        let range = used[2] + (numbers[2] - used[2]).clamp(-MOST_STEP, MOST_STEP);
        self.corner = Corner {
            smoothing: smaller(counted(0), MOST_SMOOTHING),
            missing_n,
            range_n: larger(self.unit_n * math::exp(range), LEAST_RANGE * missing_n),
        };
        Some(factor)
    }

    /// Moves the corners from the values used in the fit to those that count now, within the limits
    /// of first order. Returns the shift of the event's own unknowns.
    fn limited(&mut self, score: &Asked, swing: f32, used: &Numbers) -> Gradient {
        let mut steps = self.numbers(&self.corner);
        steps.iter_mut().zip(used).for_each(|(step, used)| *step -= used);
        let mut moved = score.moved(&steps);
        let [onset, _, _, _, inverse_omega, _] = moved;
        let far = larger((onset / MOST_ONSET).abs(), (inverse_omega / MOST_SWING).abs()) / swing;
        if far > 1.0 {
            let part = 1.0 / far;
            moved.iter_mut().for_each(|moved| *moved *= part);
            self.corner = Corner {
                smoothing: used[0] + part * steps[0],
                missing_n: used[1] + part * steps[1],
                range_n: self.unit_n * math::exp(used[2] + part * steps[2]),
            };
        }
        moved
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::synthetic::{self, NOISE_N};
    use crate::fit::{Data, Priors};
    use crate::model::CycleParams;

    /// Events with the corners `truth`: the number with round corners found, and the estimate after
    /// the last.
    fn learnt(events: u16, truth: &Corner) -> (u16, CornerEstimator) {
        let (mut learnt, mut round) = (CornerEstimator::default(), 0);
        let force_n = |cycle: &CycleParams, time: f32| {
            let shape = cycle.shape();
            shape.force(time).0 + truth.at(&shape).shift(time - cycle.onset).force_n
        };
        synthetic::events(events, force_n, |data, cycle| {
            let corner = learnt.expected(22.5, cycle.inverse_omega());
            let data = Data { priors: &Priors { corner, ..*data.priors }, ..data };
            let noise_n2 = NOISE_N * NOISE_N;
            let Some(fit) = data.fit(cycle) else { return };
            let Some(alone) = synthetic::alone(&fit, &data) else { return };
            // In two parts, as for the samples of a long slip.
            let mut asked = Asked::default();
            ask(&mut asked, &data, &fit, 0..5);
            ask(&mut asked, &data, &fit, 5..data.places());
            asked.free(&alone);
            learnt.learn(corner, &fit, &asked, noise_n2, 0.0);
            round += u16::from(!learnt.corner.is_sharp());
        });
        (round, learnt)
    }

    #[test]
    fn white_noise_rounds_no_corner() {
        let sharp = Corner { range_n: 30.0, ..Corner::default() };
        let (round, _) = learnt(4000, &sharp);
        assert!(round < 40, "{round}");
    }

    // Without the feature a fit has sharp corners, whatever the estimate.
    #[cfg(feature = "corner")]
    #[test]
    fn creep_and_aperture_are_told_apart() {
        let near = |got: f32, truth: f32, within: f32| (got - truth).abs() < within;
        let creep = Corner { smoothing: 0.0, missing_n: 20.8, range_n: 30.0 };
        let (round, CornerEstimator { corner, .. }) = learnt(60, &creep);
        assert!(round > 55 && corner.smoothing < 0.01, "{round} {corner:?}");
        assert!(near(corner.missing_n, 20.8, 2.0) && near(corner.range_n, 30.0, 8.0), "{corner:?}");

        let aperture = Corner { smoothing: 0.0267, missing_n: 0.0, range_n: 30.0 };
        let (round, CornerEstimator { corner, .. }) = learnt(60, &aperture);
        assert!(round > 45 && corner.missing_n < 2.0, "{round} {corner:?}");
        assert!(near(corner.smoothing, 0.0267, 0.008), "{corner:?}");
    }
}
