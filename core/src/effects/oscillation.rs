//! Source of an oscillation about the stick lines, from a winch that cogs or from hum: cable or
//! cell.
//!
//! Both look the same on the lines. An oscillation of the cable is part of the force at the onset,
//! so the forces by the lines are off by it; one of the cell is an error of measurement, and the
//! lines are right. The oscillation next to the slip is known (`noise::sinusoid`), and so is the
//! shift `D` of the forces that it causes if it is the cable's. If a share `κ` of it is, `Fs` and
//! `Fp` by the lines are off by `−κ D`. Friction is independent of `D`, so the scatter of the
//! forces determines `κ`, by least squares over the distances of each event's forces from their
//! running means.
//!
//! Cable or cell is a choice of two: `κ` and its standard deviation give the probability `p` that
//! it is the cable's, and the forces are shifted by `p D`. The frequency is tracked from event to
//! event.

use crate::effect::Parameter;
use crate::effects::score::{Score, ScoreSum};
use crate::fit::correction::Correction;
use crate::fit::posterior::Posterior;
use crate::model::Shape;
use crate::noise::ripple::ColoredNoise;
use crate::noise::sinusoid::Sinusoid;
use crate::num::math::{self, larger, smaller};

/// Prior probability that the oscillation is the cable's. A choice: about even, and less than a
/// half since a wrong correction for hum of the cell adds an error, where a missing one for cogging
/// only leaves it.
const CABLE: f32 = 0.45;
/// Prior standard deviation of the share, whose prior mean is [`CABLE`], between the two possible
/// values.
const SPREAD: f32 = 0.6;
/// Gain of the running means of the forces: friction wanders.
const GAIN: f32 = 0.2;
/// Relative increase of the share's variance, over the number of events less one, since few events
/// determine the scatter of the friction badly. Tuned: without it events of `hum_5` at 60 Hz are
/// 5.5 standard deviations off (4.0), of `cogging_5` at 32 samples a second 6.6 (4.7).
const FEW: f32 = 6.0;
/// Part of the variance of a cable's oscillation that a correction misses: the model of the
/// oscillation while the block slides holds to about a tenth.
const MISSED: f32 = 0.01;
/// Part of the information on the frequency that is kept after an event: a winch changes its speed.
/// Tuned: with .9 the frequency of `cogging_5` is off by .04 rad at times.
const FADE: f32 = 0.95;
/// Largest distance of the tracked frequency from that of the innovations, rad per period: with 24
/// samples a Gauss-Newton step corrects an error below `π/24`.
const NEAR: f32 = 0.15;
/// Least distance from the natural frequency, relative, that is used for an oscillation near
/// resonance.
const RESONANCE: f32 = 0.05;

/// Estimate of the oscillation's source and frequency.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Oscillation {
    sum: ScoreSum,
    /// Running means of `Fs` and `Fp` by the lines, N.
    usual_n: Option<[f32; 2]>,
    /// Angle per period, rad, and the information on it, N².
    angle: f32,
    information_n2: f32,
}

/// An event's forces by its lines, and their shift if the oscillation is the cable's.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moved {
    /// `Fs` and `Fp` by the lines, N, and their variances if all noise about the lines were white,
    /// N².
    pub(crate) forces_n: [f32; 2],
    pub(crate) plain_n2: [f32; 2],
    /// Shifts of the two forces, N, and the variances of the shifts, N².
    pub(crate) by_n: [f32; 2],
    pub(crate) own_n2: [f32; 2],
    /// Relative excess of the plain variances: the lines already average out most of an
    /// oscillation.
    pub(crate) less: f32,
}

impl Oscillation {
    /// Angle per period, rad: the tracked one if it is near `seen`, the one of the innovations;
    /// else `seen`.
    pub(crate) fn angle(&self, seen: f32) -> f32 {
        if self.is_near(seen) { self.angle } else { seen }
    }

    fn is_near(&self, seen: f32) -> bool {
        (seen - self.angle).abs() < NEAR
    }

    /// Updates the tracked frequency with an event's two oscillations, each estimated with the
    /// angle `seen`: a Gauss-Newton step from there, averaged by information with the angle so far.
    pub(crate) fn follow(&mut self, seen: f32, (before, after): (&Sinusoid, &Sinusoid)) {
        self.information_n2 *= FADE;
        if !self.is_near(seen) {
            (self.angle, self.information_n2) = (seen, 0.0);
        }
        let information_n2 = before.information_n2 + after.information_n2;
        self.information_n2 += information_n2;
        let off_n2 = information_n2 * (seen - self.angle)
            + before.information_n2 * before.faster
            + after.information_n2 * after.faster;
        if self.information_n2 > 0.0 {
            self.angle += off_n2 / self.information_n2;
        }
    }

    /// Shift of an event's forces by an oscillation about its lines, if it is the cable's.
    ///
    /// `Fs` is the force at the onset, `s` above the line. While the block slides, `M x'' = F − Fp`
    /// adds `−s ρ²/(1 − ρ²)` to the force, where `ρ` is the frequency over the natural one. `Fp` is
    /// the mean of `Fs` and `Fe` without that, so it is off by the mean of both `s` over `1 − ρ²`.
    /// Onset and stop are half a natural turn apart: each `s` follows from the other, a form that
    /// holds in resonance as well.
    pub(crate) fn event(
        &self,
        (wander, noise_n2): (&ColoredNoise, f32),
        (before, after): (&Sinusoid, &Sinusoid),
        shape: &Shape,
        posterior: &Posterior,
    ) -> Moved {
        let (angle, unsure) = (self.angle, wander.unsure);
        let cycle = shape.cycle();
        let white = wander.noise_part();
        let white_n2 = white * noise_n2;
        let ratio = angle * cycle.inverse_omega();
        let ratio = if (ratio - 1.0).abs() < RESONANCE { 1.0 + RESONANCE } else { ratio };
        let gain = 0.5 / (1.0 - ratio * ratio);
        let (sin, cos) = math::sin_cos(core::f32::consts::PI * ratio);
        let (by_value, by_quarter) = (gain * (1.0 + cos), gain * sin);
        // The prior of the frequency is its distance from that of the innovations.
        let angle_variance = 1.0 / (self.information_n2 / white_n2 + 1.0 / (NEAR * NEAR));
        let at = |line: &Sinusoid, time: f32| {
            let (n, quarter_n) = line.at(time, angle);
            let late = time - line.middle;
            let late_n2 = 0.5 * (n * n + quarter_n * quarter_n) * late * late * angle_variance;
            let own_n2 = smaller(white_n2 * line.variance + late_n2, 2.0 * unsure * noise_n2);
            (n, quarter_n, own_n2)
        };
        let (on_n, on_quarter_n, on_n2) = at(before, cycle.onset);
        let (off_n, off_quarter_n, off_n2) = at(after, shape.stop());
        let by_dynamic =
            0.5 * (by_value * (on_n + off_n) + by_quarter * (on_quarter_n - off_quarter_n));
        let gain2 = 0.25 * (by_value * by_value + by_quarter * by_quarter);
        Moved {
            forces_n: [posterior.cycle.static_n, posterior.cycle.dynamic_n()],
            plain_n2: posterior.forces_n2().into(),
            by_n: [on_n, by_dynamic],
            own_n2: [on_n2, gain2 * (on_n2 + off_n2)],
            // Variance that an oscillation leaves at the end of a line over that of white noise of
            // the same variance: `2/n`, the variance of the cosine, over `1 − cos ω`, which is
            // `ω²/2`.
            less: (1.0 - white) * (1.0 - smaller(2.0 * before.variance / (angle * angle), 1.0)),
        }
    }

    /// Updates the share of the cable with an event.
    pub(crate) fn learn(&mut self, event: &Moved, noise_n2: f32) {
        let Some(usual_n) = &mut self.usual_n else {
            self.usual_n = Some(event.forces_n);
            return;
        };
        let gain = larger(1.0 / (2.0 + self.sum.count), GAIN);
        let mut score = Score::default();
        for ((usual_n, force_n), by_n) in usual_n.iter_mut().zip(event.forces_n).zip(event.by_n) {
            let off_n = force_n - *usual_n;
            score.score -= off_n * by_n;
            score.information += by_n * by_n;
            *usual_n += gain * off_n;
        }
        self.sum.learn(&score, noise_n2);
    }

    /// Estimate of the share of the oscillation that is the cable's, and one over its variance.
    fn estimate(&self) -> (f32, f32) {
        let few = 1.0 + FEW / (self.sum.count - 1.0);
        let weight = if self.sum.counts() { 1.0 / (few * self.sum.variance()) } else { 0.0 };
        (self.sum.value(), weight)
    }

    /// Probability that the oscillation is the cable's and not the cell's, and the variance of its
    /// share, larger where the estimate lies between the two, as if it were a part of each.
    fn cable(&self) -> (f32, f32) {
        const BEFORE: f32 = 1.0 / (SPREAD * SPREAD);
        let (estimate, weight) = self.estimate();
        let odds = (1.0 - CABLE) / CABLE;
        let cable = 1.0 / (1.0 + odds * math::exp((0.5 - estimate) * weight));
        let share = (CABLE * BEFORE + estimate * weight) / (BEFORE + weight);
        let apart = cable - smaller(larger(share, 0.0), 1.0);
        (cable, cable * (1.0 + MISSED - cable) + apart * apart)
    }

    /// Shift of an event's forces, and the variance that it adds.
    pub(crate) fn correction(&self, event: &Moved) -> Correction {
        let (cable, variance) = self.cable();
        let wider_n2 = |i: usize| {
            variance * event.by_n[i] * event.by_n[i] + cable * event.own_n2[i]
                - event.less * event.plain_n2[i]
        };
        let [static_n, dynamic_n] = event.by_n.map(|by_n| cable * by_n);
        Correction {
            moved: [0.0, 0.0, static_n, static_n - dynamic_n, 0.0, 0.0],
            static_n2: wider_n2(0),
            dynamic_n2: wider_n2(1),
        }
    }

    /// The share, once enough events determine it.
    pub(crate) fn parameter(&self) -> Option<Parameter> {
        let (value, weight) = self.estimate();
        let std = math::sqrt(1.0 / weight);
        self.sum.counts().then_some(Parameter { name: "cable_share", value, std })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::Random;

    const NOISE_N2: f32 = 4.0;

    /// An event with an oscillation at the onset and at the stop of standard deviation `moved_n`,
    /// of which the part `share` is the cable's; friction scatters.
    fn event(random: &mut Random, moved_n: f32, share: f32) -> Moved {
        let by_n = [0.0; 2].map(|_: f32| moved_n * random.normal());
        let friction_n = [780.0, 490.0].map(|n| n + 8.0 * random.normal());
        Moved {
            forces_n: core::array::from_fn(|i| friction_n[i] - share * by_n[i]),
            plain_n2: [1.0; 2],
            by_n,
            own_n2: [0.5; 2],
            less: 0.4,
        }
    }

    /// The estimate after 400 such events, and the next event.
    fn learnt(share: f32) -> (Oscillation, Moved) {
        let (mut oscillation, mut random) = (Oscillation::default(), Random(3));
        assert_eq!(oscillation.parameter(), None);
        for _ in 0..400 {
            oscillation.learn(&event(&mut random, 10.0, share), NOISE_N2);
        }
        (oscillation, event(&mut random, 10.0, share))
    }

    #[test]
    fn the_scatter_of_the_friction_tells_whose_an_oscillation_is() {
        for share in [0.0, 0.5, 1.0] {
            let (oscillation, _) = learnt(share);
            let found = oscillation.parameter().unwrap();
            assert!((found.value - share).abs() < 3.0 * found.std, "{found:?}");
            // The standard error after these events, with a margin for the error of their scatter.
            let std = math::sqrt(oscillation.sum.variance());
            assert!(std < 0.05 && found.std < 1.1 * std, "{std} {found:?}");
        }
    }

    #[test]
    fn the_forces_move_by_what_is_the_cables() {
        for share in [0.0, 1.0] {
            let (oscillation, event) = learnt(share);
            let Correction { moved: [_, _, static_n, half_drop_n, ..], .. } =
                oscillation.correction(&event);
            assert!((static_n - share * event.by_n[0]).abs() < 0.15 * event.by_n[0].abs());
            let dynamic_n = static_n - half_drop_n;
            assert!((dynamic_n - share * event.by_n[1]).abs() < 0.15 * event.by_n[1].abs());
        }
    }

    /// Where both oscillate, the variance covers the error of the choice.
    #[test]
    fn an_oscillation_of_both_is_unsure() {
        let (oscillation, event) = learnt(0.6);
        let Correction { moved: [_, _, static_n, ..], static_n2, .. } =
            oscillation.correction(&event);
        let off_n = static_n - 0.6 * event.by_n[0];
        assert!(off_n.abs() < 1.5 * math::sqrt(static_n2), "{off_n} {static_n2}");
    }

    /// Before any event is used, the variance covers either source.
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

    /// A change of the block is one outlier; the oscillation's share is still found.
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
