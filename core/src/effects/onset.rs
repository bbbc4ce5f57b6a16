//! Slips whose force does not take the course of the model, from what the fits leave over.
//!
//! A smooth onset, friction that depends on speed or varies along the way, a cell that lags, a
//! block that rocks: the force of the slip departs from the ellipse, most where it falls fastest.
//! The scores of two terms of such a course are asked (`effects/score.rs`): `A d (4 x (1 − x))²` at
//! the part `x` of the slip, close to `sin² πx`, and the same times `1 − 2 x`, which has different
//! signs in the two halves. The cause is not known, so nothing is shifted: `Fs`, which the line and
//! the beginning of the slip tell together, is as unsure as the terms would move it. The first
//! three events hardly tell the terms: there a prior, `UNTOLD`, and their samples together say how
//! large they may be.

use crate::effect::Parameter;
use crate::effects::score::{Score, ScoreSum};
use crate::fit::slip_scatter::steepness;
use crate::model::Shape;
use crate::num::math::larger;
use crate::stats::prior::surely;

/// Standard errors beyond which a term is possible. Tuned: with 2 the median event of snow is given a
/// percent wider than the noise makes it, a larger one makes a block that rocks too sure.
const POSSIBLE: f32 = 2.2;

/// Factor on the variance: the cause has another course than the terms, and moves `Fs` by as much
/// again where they do not see it.
const COURSE: f32 = 2.0;

/// Standard deviation of an amplitude before the events tell it. Tuned: a smaller one leaves the
/// first event of a slow cell or a smooth onset more than five standard deviations off, a larger
/// one makes the first three events of a test that has neither twice as wide as their errors.
const UNTOLD: f32 = 0.06;

/// What an event counts as whose slip is too brief to tell the terms, parts of one. Where slips
/// never have more samples they are taken as the model has them from the twenty-fifth on, as
/// shorter slips are. Tuned: with a quarter two more of 773 events of `jitter_10` are beyond five
/// standard deviations.
const UNTELLING: f32 = 0.1;

/// What the events tell of the two terms, whose amplitudes are parts of half the drop.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Onset {
    terms: [ScoreSum; 2],
    /// Events that were asked; one whose slip has too few samples counts as [`UNTELLING`].
    asked: f32,
}

/// Forces of both terms with amplitudes of one, N, at a time since the onset.
pub(crate) fn terms_n(shape: &Shape, since_onset: f32) -> [f32; 2] {
    let part = since_onset / shape.slide_time();
    let even_n = shape.cycle().half_drop_n * steepness(part);
    [even_n, even_n * (1.0 - 2.0 * part)]
}

impl Onset {
    /// Takes what an event tells of the terms; gives a variance of `Fs`, N²: that by terms which
    /// are possible, and by terms which are not told yet.
    pub(crate) fn learn(&mut self, event: &[Score; 2], noise_n2: f32) -> f32 {
        let mut possible_n2 = 0.0;
        let tells = event.iter().any(|term| term.information > 0.0);
        let left = self.left();
        self.asked += if tells { 1.0 } else { UNTELLING };
        for (sum, event) in self.terms.iter_mut().zip(event) {
            sum.learn(event, noise_n2);
            let [_, _, by_n, ..] = event.response;
            possible_n2 += mean_square(sum, left) * by_n * by_n;
        }
        possible_n2
    }

    /// Part that the events leave of what is not told: all of it with the first one, none from the
    /// fourth on.
    fn left(&self) -> f32 {
        const TELLING: f32 = 2.5;
        larger(1.0 - self.asked / TELLING, 0.0)
    }

    /// Square of the first term's largest force, N², for half a drop, as far as it is possible.
    pub(crate) fn largest_n2(&self, half_drop_n: f32) -> f32 {
        let [even, _] = &self.terms;
        possible(even) * half_drop_n * half_drop_n
    }

    /// Is the first term's amplitude significant?
    pub(crate) fn is_found(&self) -> bool {
        let [even, _] = &self.terms;
        even.is_found()
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

/// Mean square of an amplitude: what the events tell if it is possible, or, with a part of
/// [`UNTOLD`], that and what they tell together.
#[inline(never)]
fn mean_square(sum: &ScoreSum, left: f32) -> f32 {
    const PRIOR: f32 = UNTOLD * UNTOLD;
    let told = PRIOR / (PRIOR + sum.variance());
    let value = told * sum.value();
    let untold = PRIOR * (1.0 - told) + value * value;
    larger(COURSE * possible(sum), left * untold)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::score::Asked;
    use crate::effects::synthetic::{self, NOISE_N};
    use crate::model::CycleParams;

    /// The first event's own samples narrow what a term may be, and widen it where they show one;
    /// a slip that tells nothing leaves the prior.
    #[test]
    fn the_first_event_tells_what_its_samples_show() {
        let square = |amplitude: f32, std: f32| {
            let mut sum = ScoreSum::default();
            let information = 1.0 / (std * std);
            let score = amplitude * information;
            sum.learn(&Score { score, information, ..Score::default() }, 1.0);
            mean_square(&sum, 1.0)
        };
        let prior = UNTOLD * UNTOLD;
        assert!((mean_square(&ScoreSum::default(), 1.0) - prior).abs() < 1e-6);
        assert!((square(0.0, UNTOLD) - 0.5 * prior).abs() < 1e-6);
        assert!((square(UNTOLD, UNTOLD) - 0.75 * prior).abs() < 1e-6);
        assert!(square(0.0, 0.1 * UNTOLD) < 0.02 * prior);
        assert!((square(UNTOLD, 0.01 * UNTOLD) - COURSE * prior).abs() < 0.01 * prior);
    }

    /// A term in the samples is found with its size, and `Fs` is the less sure for it; without any
    /// nothing is, and from the fourth event on `Fs` is as sure as it was.
    #[test]
    fn an_amplitude_is_found_and_none_is_none() {
        for amplitudes in [[0.0, 0.0], [0.05, 0.0], [-0.05, 0.0], [0.0, 0.1], [0.0, -0.1]] {
            let (mut onset, mut first_n2, mut widest_n2) = (Onset::default(), 0.0, 0.0_f32);
            let mut told = 0;
            let force_n = |cycle: &CycleParams, time: f32| {
                let (shape, since_onset) = (cycle.shape(), time - cycle.onset);
                let [even_n, odd_n] = terms_n(&shape, since_onset);
                shape.force(time).0 + amplitudes[0] * even_n + amplitudes[1] * odd_n
            };
            synthetic::events(100, force_n, |data, cycle| {
                let noise_n2 = NOISE_N * NOISE_N;
                let Some(fit) = data.fit(cycle, noise_n2) else { return };
                let Some(alone) = synthetic::alone(&fit, &data) else { return };
                let shape = &fit.shape;
                let mut asked = Asked::default();
                asked.take((&data, 0..data.places()), shape, |time, _| {
                    let [even_n, odd_n] = terms_n(shape, time);
                    [even_n, odd_n, 0.0]
                });
                asked.free(&alone);
                let static_n2 = onset.learn(&[asked.score(0), asked.score(1)], noise_n2);
                told += 1;
                match told {
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
