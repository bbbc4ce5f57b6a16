//! Departures of a slip's force from the ellipse, estimated from the residuals of the fits.
//!
//! Causes are a smooth onset, friction that depends on speed or position, a cell that lags, or a
//! block that rocks. The departure is largest where the force falls fastest. Two force terms are
//! tested by their scores (`effects/score.rs`): `A d (4 x (1 − x))²` at the part `x` of the slip,
//! close to `sin² πx`, and the same times `1 − 2 x`, which changes sign in the middle. The cause is
//! not known, so no value is shifted: the variance of `Fs`, which the line and the beginning of the
//! slip determine together, grows by the shift that the terms would cause. The first three events
//! hardly determine the amplitudes; until then the prior `PRIOR_STD` is combined with their scores.

use crate::effect::Parameter;
use crate::effects::score::{Score, ScoreSum};
use crate::fit::slip_residuals::steepness;
use crate::model::Shape;
use crate::num::math::larger;
use crate::stats::significance::surely;

/// Standard errors beyond which a term is possible. Tuned: with 2 the intervals of the median event
/// of snow are a percent wider than the noise makes them, a larger one makes those of a block that
/// rocks too narrow.
const POSSIBLE: f32 = 2.2;

/// Factor on the variance: the true departure has another course than the terms, and its remainder
/// shifts `Fs` by as much again.
const COURSE: f32 = 2.0;

/// Prior standard deviation of an amplitude. Tuned: a smaller one leaves the first event of a slow
/// cell or a smooth onset more than five standard deviations off, a larger one makes the intervals
/// of the first three events of a test with neither twice as wide as their errors.
const PRIOR_STD: f32 = 0.06;

/// Weight, in events, of an event whose slip is too brief to determine the terms. Where no slip has
/// more samples, the prior is dropped from the twenty-sixth event on, as for shorter slips. Tuned:
/// with a quarter two more of 773 events of `jitter_10` are beyond five standard deviations.
const BRIEF: f32 = 0.1;

/// Estimates of the two terms, whose amplitudes are parts of half the drop.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Onset {
    terms: [ScoreSum; 2],
    /// Number of events tested; one whose slip has too few samples counts as [`BRIEF`].
    asked: f32,
}

/// Forces of both terms with amplitudes of one, N, at a time since the onset.
pub(crate) fn terms_n(shape: &Shape, since_onset: f32) -> [f32; 2] {
    let part = since_onset / shape.slide_time();
    let even_n = shape.cycle().half_drop_n * steepness(part);
    [even_n, even_n * (1.0 - 2.0 * part)]
}

impl Onset {
    /// Adds an event's scores of the terms. Returns the variance of `Fs`, N², by terms that are
    /// possible and by amplitudes that are not determined yet.
    pub(crate) fn learn(&mut self, event: &[Score; 2], noise_n2: f32) -> f32 {
        let mut possible_n2 = 0.0;
        let determines = event.iter().any(|term| term.information > 0.0);
        let left = self.left();
        self.asked += if determines { 1.0 } else { BRIEF };
        for (sum, event) in self.terms.iter_mut().zip(event) {
            sum.learn(event, noise_n2);
            let [_, _, by_n, ..] = event.response;
            possible_n2 += mean_square(sum, left) * by_n * by_n;
        }
        possible_n2
    }

    /// Part of the prior that remains: all of it in the first event, none from the fourth on.
    fn left(&self) -> f32 {
        const FIRST_EVENTS: f32 = 2.5;
        larger(1.0 - self.asked / FIRST_EVENTS, 0.0)
    }

    /// Square of the first term's largest force, N², for half a drop, as far as it is significant.
    pub(crate) fn largest_n2(&self, half_drop_n: f32) -> f32 {
        let [even, _] = &self.terms;
        possible(even) * half_drop_n * half_drop_n
    }

    /// The first term's amplitude, if it is significant.
    pub(crate) fn parameter(&self) -> Option<Parameter> {
        let [even, _] = &self.terms;
        let (value, std) = even.found()?;
        Some(Parameter { name: "part_of_half_drop", value, std })
    }
}

/// Square of an amplitude, as far as it is significantly more than zero.
fn possible(sum: &ScoreSum) -> f32 {
    let square = sum.value() * sum.value();
    // Zero before the first event as well, where the variance is infinite.
    square * surely(square, POSSIBLE * POSSIBLE * sum.variance())
}

/// Mean square of an amplitude: its square where possible, or, weighted by `left`, its mean square
/// under the posterior of the prior [`PRIOR_STD`] and the scores; the larger of the two.
#[inline(never)]
fn mean_square(sum: &ScoreSum, left: f32) -> f32 {
    const PRIOR: f32 = PRIOR_STD * PRIOR_STD;
    let known = PRIOR / (PRIOR + sum.variance());
    let value = known * sum.value();
    let mean_square = PRIOR * (1.0 - known) + value * value;
    larger(COURSE * possible(sum), left * mean_square)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::score::Asked;
    use crate::effects::synthetic::{self, NOISE_N};
    use crate::model::CycleParams;

    /// The first event's own samples narrow the prior of a term, and widen it where they show one;
    /// a slip without information leaves the prior.
    #[test]
    fn the_first_event_tells_what_its_samples_show() {
        let square = |amplitude: f32, std: f32| {
            let mut sum = ScoreSum::default();
            let information = 1.0 / (std * std);
            let score = amplitude * information;
            sum.learn(&Score { score, information, ..Score::default() }, 1.0);
            mean_square(&sum, 1.0)
        };
        let prior = PRIOR_STD * PRIOR_STD;
        assert!((mean_square(&ScoreSum::default(), 1.0) - prior).abs() < 1e-6);
        assert!((square(0.0, PRIOR_STD) - 0.5 * prior).abs() < 1e-6);
        assert!((square(PRIOR_STD, PRIOR_STD) - 0.75 * prior).abs() < 1e-6);
        assert!(square(0.0, 0.1 * PRIOR_STD) < 0.02 * prior);
        assert!((square(PRIOR_STD, 0.01 * PRIOR_STD) - COURSE * prior).abs() < 0.01 * prior);
    }

    /// A term in the samples is found with its size and adds variance to `Fs`; without a term none
    /// is found, and from the fourth event on no variance is added.
    #[test]
    fn an_amplitude_is_found_and_none_is_none() {
        for amplitudes in [[0.0, 0.0], [0.05, 0.0], [-0.05, 0.0], [0.0, 0.1], [0.0, -0.1]] {
            let (mut onset, mut first_n2, mut widest_n2) = (Onset::default(), 0.0, 0.0_f32);
            let mut events = 0;
            let force_n = |cycle: &CycleParams, time: f32| {
                let (shape, since_onset) = (cycle.shape(), time - cycle.onset);
                let [even_n, odd_n] = terms_n(&shape, since_onset);
                shape.force(time).0 + amplitudes[0] * even_n + amplitudes[1] * odd_n
            };
            synthetic::events(100, force_n, |data, cycle| {
                let noise_n2 = NOISE_N * NOISE_N;
                let Some(fit) = data.fit(cycle) else { return };
                let Some(alone) = synthetic::alone(&fit, &data) else { return };
                let shape = &fit.shape;
                let mut asked = Asked::default();
                asked.take((&data, 0..data.places()), shape, |time, _| {
                    let [even_n, odd_n] = terms_n(shape, time);
                    [even_n, odd_n, 0.0]
                });
                asked.free(&alone);
                let static_n2 = onset.learn(&[asked.score(0), asked.score(1)], noise_n2);
                events += 1;
                match events {
                    1 => first_n2 = static_n2,
                    2 | 3 => {}
                    _ => widest_n2 = static_n2.max(widest_n2),
                }
            });
            for (sum, amplitude) in onset.terms.iter().zip(amplitudes) {
                let (far, near) = (sum.value() - amplitude, 0.1 * amplitude);
                let most = (near * near).max(9.0 * sum.variance());
                assert!(far * far < most, "{amplitudes:?}: {} {}", sum.value(), sum.variance());
                assert_eq!(sum.found().is_some(), amplitude.abs() > 0.0, "{amplitudes:?}");
            }
            assert_eq!(onset.parameter().is_some(), amplitudes[0].abs() > 0.0);
            assert!(first_n2 > 0.2 * NOISE_N * NOISE_N, "{first_n2}");
            let is_wide = widest_n2 > 0.2 * NOISE_N * NOISE_N;
            let is_some = amplitudes.iter().any(|it| it.abs() > 0.0);
            assert_eq!(is_wide, is_some, "{amplitudes:?}: {widest_n2}");
        }
    }
}
