//! An oscillation about the stick lines, by a winch that cogs or by hum: is it the cable's or the
//! cell's?
//!
//! On the lines both look alike. Where the cable oscillates, what counts at the onset is the force
//! there, and the mean of the line is off by the oscillation; where the cell does, it is the other
//! way round. So two fits of an event, one that follows the force and one that takes the lines as
//! they are, differ by `D`. If a share `κ` of the oscillation is the cable's, `Fs` and `Fp` by the
//! lines are off by `−κ D`. Friction does not know of `D`, so the scatter of the forces tells `κ`,
//! by least squares over each event's distances of both from their usual values of late.
//!
//! Before the events tell `κ` it is `SHARE` ± `SPREAD`.

use crate::effect::Parameter;
use crate::effects::score::{Score, ScoreSum};
use crate::fit::correction::Correction;
use crate::num::math::{self, larger, smaller};

/// Share of the oscillation that is the cable's, and its standard deviation, before the events tell
/// it. Tuned: such that an event that takes all of it for the wrong one's is as unsure as it is
/// off. A larger share makes hum worse than the lines alone would, a smaller one cogging.
const SHARE: f32 = 0.3;
const SPREAD: f32 = 0.65;
/// Part of an event's distance from the usual one by which that follows: friction wanders.
const GAIN: f32 = 0.2;
/// Variance of a distance from such a mean over that from the true one, `1 + GAIN / (2 − GAIN)`.
const OF_MEAN: f32 = 1.11;
/// Part of a cable's oscillation that is missed where it is followed, in its variance. Tuned: with
/// .4 the scene `cogging_2_5` covers .87 of its `mu_s`, a larger part is of no use.
const MISSED: f32 = 0.55;
/// Variance of `Fp` over `(b/ω)²`, where the loading rate differs by `b` from its mean while the block
/// slides on a cable that oscillates. Tuned: with 1 `cogging_2_5` covers .86 of its `mu`.
const TURN: f32 = 2.5;
/// It counts fully from the share of `√(1/3)` on.
const SURELY: f32 = 3.0;
/// Variance of `Fp` over `(b/ω)²` times the variance of the share: a share that came out as zero by
/// chance is not sure. Tuned: with .3 events of `cogging_2_5` are eight standard deviations off,
/// with .4 hum is given twice too wide.
const TURN_UNSURE: f32 = 0.38;
/// What a line leaves of an oscillation in its variance, over what it would leave of white noise of
/// the same variance. Tuned: of an oscillation of eight samples in rests of twenty a fifth is left,
/// seldom more than this.
const LEFT: f32 = 0.5;

/// Whose the oscillation is.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Oscillation {
    sum: ScoreSum,
    /// `Fs` and `Fp` by the lines, N, and by how much following the force moves them, N: means of
    /// late.
    usual: Option<[[f32; 2]; 2]>,
}

/// An event by two fits, one with the lines as they are, one that follows the force.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TwoFits {
    /// `Fs` and `Fp` by the lines, N, and their variances if all noise about the lines were white,
    /// N².
    pub(crate) forces_n: [f32; 2],
    pub(crate) plain_n2: [f32; 2],
    /// By how much they move where the force is followed, N, and their variances then, N².
    pub(crate) by_n: [f32; 2],
    pub(crate) followed_n2: [f32; 2],
    /// The noise's part of the variance about the lines.
    pub(crate) white_share: f32,
    /// Variance of the oscillation's rate over `ω²`, N².
    pub(crate) turn_n2: f32,
}

impl Oscillation {
    /// Takes what an event tells.
    pub(crate) fn learn(&mut self, event: &TwoFits, noise_n2: f32) {
        let [forces_n, by_n] = self.usual.get_or_insert([event.forces_n, event.by_n]);
        let mut score = Score::default();
        for ((usual_n, force_n), (usual_by_n, by_n)) in
            forces_n.iter_mut().zip(event.forces_n).zip(by_n.iter_mut().zip(event.by_n))
        {
            let (off_n, moved_n) = (force_n - *usual_n, by_n - *usual_by_n);
            score.score -= off_n * moved_n;
            score.information += moved_n * moved_n;
            *usual_n += GAIN * off_n;
            *usual_by_n += GAIN * moved_n;
        }
        self.sum.learn(&score, noise_n2);
    }

    /// Share of the oscillation that is the cable's, and its variance.
    fn share(&self) -> (f32, f32) {
        const BEFORE: f32 = 1.0 / (SPREAD * SPREAD);
        let told = if self.sum.counts() { 1.0 / (OF_MEAN * self.sum.variance()) } else { 0.0 };
        let share = (SHARE * BEFORE + self.sum.value() * told) / (BEFORE + told);
        (smaller(larger(share, 0.0), 1.0), 1.0 / (BEFORE + told))
    }

    /// By how much the forces of an event move, and how much less sure they are.
    pub(crate) fn correction(&self, event: &TwoFits) -> Correction {
        let (share, variance) = self.share();
        let wider_n2 = |i: usize| {
            let plain_n2 = event.plain_n2[i];
            let lines_n2 = (LEFT + (1.0 - LEFT) * event.white_share) * plain_n2;
            let moved_n2 = (variance + MISSED * share) * event.by_n[i] * event.by_n[i];
            let followed_n2 = larger(event.followed_n2[i] - lines_n2, 0.0);
            moved_n2 + share * followed_n2 + lines_n2 - plain_n2
        };
        let [static_n, dynamic_n] = event.by_n.map(|by_n| share * by_n);
        let turns = TURN * smaller(SURELY * share * share, 1.0) + TURN_UNSURE * variance;
        Correction {
            moved: [0.0, 0.0, static_n, static_n - dynamic_n, 0.0, 0.0],
            static_n2: wider_n2(0),
            dynamic_n2: wider_n2(1) + turns * event.turn_n2,
        }
    }

    /// The share, once events tell it.
    pub(crate) fn parameter(&self) -> Option<Parameter> {
        let (value, variance) = self.share();
        let std = math::sqrt(variance);
        self.sum.counts().then_some(Parameter { name: "cable_share", value, std })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::Random;

    const NOISE_N2: f32 = 4.0;

    /// An event with an oscillation of some newtons at the onset and at the stop, of which the part
    /// `share` is the cable's; friction scatters.
    fn event(random: &mut Random, moved_n: f32, share: f32) -> TwoFits {
        let by_n = [0.0; 2].map(|_: f32| moved_n * random.normal());
        let friction_n = [780.0, 490.0].map(|n| n + 8.0 * random.normal());
        TwoFits {
            forces_n: core::array::from_fn(|i| friction_n[i] - share * by_n[i]),
            plain_n2: [1.0; 2],
            by_n,
            followed_n2: [2.0; 2],
            white_share: 0.2,
            turn_n2: 0.0,
        }
    }

    #[test]
    fn the_scatter_of_the_friction_tells_whose_an_oscillation_is() {
        for share in [0.0, 0.5, 1.0] {
            let (mut oscillation, mut random) = (Oscillation::default(), Random(3));
            assert_eq!(oscillation.parameter(), None);
            for _ in 0..400 {
                oscillation.learn(&event(&mut random, 10.0, share), NOISE_N2);
            }
            let found = oscillation.parameter().unwrap();
            assert!((found.value - share).abs() < 3.0 * found.std && found.std < 0.05, "{found:?}");
            let event = event(&mut random, 10.0, share);
            let Correction { moved: [_, _, static_n, half_drop_n, ..], .. } =
                oscillation.correction(&event);
            assert!((static_n - share * event.by_n[0]).abs() < 0.15 * event.by_n[0].abs());
            let dynamic_n = static_n - half_drop_n;
            assert!((dynamic_n - share * event.by_n[1]).abs() < 0.15 * event.by_n[1].abs());
        }
    }

    /// Before the events tell anything an event is as unsure as it is off by either answer.
    #[test]
    fn what_is_not_told_is_unsure() {
        let (oscillation, mut random) = (Oscillation::default(), Random(3));
        let event = event(&mut random, 10.0, 1.0);
        let Correction { moved: [_, _, static_n, ..], static_n2, .. } =
            oscillation.correction(&event);
        let std_n = math::sqrt(event.plain_n2[0] + static_n2);
        for off_n in [static_n, static_n - event.by_n[0]] {
            assert!(off_n.abs() < 1.5 * std_n, "{off_n} {std_n}");
        }
    }

    /// A change of the block is one foul event, and the oscillation's share is still told.
    #[test]
    fn one_foul_event_in_twenty_does_no_harm() {
        let (mut oscillation, mut random) = (Oscillation::default(), Random(5));
        for i in 0..400 {
            let mut event = event(&mut random, 10.0, 1.0);
            if i % 20 == 7 {
                event.forces_n[0] += 40.0;
            }
            oscillation.learn(&event, NOISE_N2);
        }
        let found = oscillation.parameter().unwrap();
        assert!((found.value - 1.0).abs() < 3.0 * found.std && found.value > 0.7, "{found:?}");
    }
}
