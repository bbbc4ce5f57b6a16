//! Slips that do not begin as the model has it, from what the fits leave over.
//!
//! A smooth onset, friction that depends on speed or swings along the way, a cell that lags: the
//! force of the slip departs from the ellipse most where it falls fastest. A term of that course,
//! `A d (4 x (1 − x))²` at the part `x` of the slip, close to `sin² πx`, is asked by its score
//! (`effects/score.rs`). Its cause is not known, so nothing is shifted: `Fs`, which the line and
//! the beginning of the slip tell together, is as unsure as the term would move it. The first three
//! events hardly tell the term: in them it is as possible as `UNTOLD` has it.

use crate::effect::Parameter;
use crate::effects::score::{Score, ScoreSum};
use crate::fit::STATIC;
use crate::fit::slip_scatter::steepness;
use crate::model::Shape;
use crate::stats::normal_equations::dot;
use crate::stats::prior::surely;

/// Standard errors beyond which the term is possible, and beyond which it is so in the first
/// events. Tuned: smaller ones widen linear scenes.
const POSSIBLE: f32 = 1.8;
const POSSIBLE_EARLY: f32 = 3.0;

/// Times the variance: the cause has another course than the term, and moves `Fs` by as much again
/// where the term does not see it.
const COURSE: f32 = 2.0;

/// Standard deviation of the amplitude before the events tell it. Tuned: a smaller one leaves the
/// first event of a slow cell or a smooth onset more than five standard deviations off, a larger one
/// makes the first three of a test that has neither twice as wide as their errors.
const UNTOLD: f32 = 0.07;

/// What the events tell of the term: parts of half the drop.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Onset(pub(crate) ScoreSum);

/// Force of an amplitude of one at a time since the onset.
pub(crate) fn term_n(shape: &Shape, since_onset: f32) -> f32 {
    shape.cycle().half_drop_n * steepness(since_onset / shape.slide_time())
}

impl Onset {
    /// Square of the term's largest force, N², for half a drop, as far as it is possible.
    pub(crate) fn largest_n2(&self, half_drop_n: f32) -> f32 {
        let largest_n = self.0.value() * half_drop_n;
        self.possible() * largest_n * largest_n
    }

    /// How possible the term is, 0 to 1.
    fn possible(&self) -> f32 {
        let value = self.0.value();
        let errors = if self.0.counts() { POSSIBLE } else { POSSIBLE_EARLY };
        // Also not before the first event.
        surely(value * value, errors * errors * self.0.variance())
    }

    /// Variance of `Fs`, N², by what the term would move it in an event: as far as it is possible,
    /// and as far as it is untold.
    pub(crate) fn static_n2(&self, event: &Score) -> f32 {
        let by_n = dot(&event.response, &STATIC.0);
        let value = self.0.value();
        (COURSE * self.possible() * value * value + self.0.untold(UNTOLD)) * by_n * by_n
    }

    /// The amplitude, if it is significant.
    pub(crate) fn parameter(&self) -> Option<Parameter> {
        let (value, std) = self.0.found()?;
        Some(Parameter { name: "part_of_half_drop", value, std })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::synthetic::{self, NOISE_N};
    use crate::model::CycleParams;

    /// The term in the samples is found with its size; without it nothing is, and from the fourth
    /// event on `Fs` is as sure as it was.
    #[test]
    fn an_amplitude_is_found_and_none_is_none() {
        for amplitude in [0.0, 0.05, -0.05] {
            let (mut onset, mut first_n2, mut widest_n2) = (Onset::default(), 0.0, 0.0_f32);
            let mut told = 0;
            let force_n = |cycle: &CycleParams, time: f32| {
                let (shape, since_onset) = (cycle.shape(), time - cycle.onset);
                shape.force(time).0 + amplitude * term_n(&shape, since_onset)
            };
            synthetic::events(100, force_n, |data, cycle| {
                let noise_n2 = NOISE_N * NOISE_N;
                let Some(fit) = data.fit(cycle, noise_n2) else { return };
                let Some(alone) = fit.alone(&data) else { return };
                let shape = fit.cycle.shape();
                let [score] = Score::of(&data, &shape, &alone, |time, _| [term_n(&shape, time)]);
                onset.0.learn(&score, noise_n2);
                told += 1;
                match told {
                    1 => first_n2 = onset.static_n2(&score),
                    2 | 3 => {}
                    _ => widest_n2 = onset.static_n2(&score).max(widest_n2),
                }
            });
            let (value, variance) = (onset.0.value(), onset.0.variance());
            let far = (value - amplitude) * (value - amplitude);
            let near = 0.1 * amplitude;
            assert!(far < (near * near).max(9.0 * variance), "{amplitude}: {value} {variance}");
            assert_eq!(onset.parameter().is_some(), amplitude.abs() > 0.0);
            assert!(first_n2 > 0.2 * NOISE_N * NOISE_N, "{first_n2}");
            assert!(amplitude.abs() > 0.0 || widest_n2 < 0.2 * NOISE_N * NOISE_N, "{widest_n2}");
        }
    }
}
