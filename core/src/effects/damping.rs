//! Losses in the cable or the air, from what the fits leave over.
//!
//! With a damping ratio `D` the force decays towards `Fp`, `F − Fp = e^(−D ωτ) (d cos ωτ + q sin
//! ωτ)` to first order. An event that is fitted without it leaves `−ωτ (F − Fp)` times `D`: a force
//! term, whose score tells `D` (`effects/score.rs`), to about ±.018 after ten events and ±.008
//! after fifty.
//!
//! What is found is never taken off, since friction that varies along the slip looks much the same.
//! It widens the stated prior, by `D̂²` in the variance, however little is sure of it. With `D ~
//! N(0, s²)` the events are most likely under `s² = D̂² − var D̂`; but a `D̂` that came out low by
//! chance must not hide losses, so it counts as a little more ([`LOW`]). Losses that are stated to
//! be known exactly, with 0, stay so.

use crate::config::InputStd;
use crate::effect::Parameter;
use crate::effects::score::ScoreSum;
use crate::model::{CycleParams, Shape};
use crate::num::math;
use crate::stats::normal_equations::Gradient;

/// Part of the stated standard deviation by which a damping ratio above zero may have come out low by
/// chance, up to twice what was found: few events tell it to less than that. Tuned: without it drag of
/// 30 N s/m, two and a half of the usual stated standard deviations, is covered by .70 of the intervals
/// of `mu` of two-minute records, with it by .92; with 1 that is the same, and they are a ninth wider.
const LOW: f32 = 0.5;

/// The damping ratio, a term's amplitude, as the events tell it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Damping(pub(crate) ScoreSum);

/// Force by losses with a ratio of one, N, to first order, at a time since the onset at which the
/// model has this gradient: the force decays towards `Fp`, `−ωτ (F − Fp)`, and the line after the
/// stop, where `F − Fp = −d`, keeps the force it has there.
///
/// What `sin ωτ` adds is left out: losses in the cable have the opposite of those in the air, and
/// an onset that is a little earlier or later has the same.
///
/// On the line after the slip losses are a smaller drop. That drop is taken out of the term, so
/// that only the slip's samples tell the rest, which is no small difference of large sums.
pub(crate) fn term_n(shape: &Shape) -> impl Fn(f32, &Gradient) -> f32 {
    let CycleParams { omega, rate, half_drop_n, .. } = *shape.cycle();
    let slide = shape.slide_time();
    let drop_n = -omega * slide * half_drop_n / shape.after(slide).1[3];
    move |since_onset, &[_, by_rate, _, by_drop, ..]| {
        // `d cos ωτ + q sin ωτ`.
        let from_centre_n = half_drop_n * (1.0 + by_drop) + rate * by_rate;
        drop_n * by_drop - omega * since_onset * from_centre_n
    }
}

impl Damping {
    /// The stated standard deviation, widened by what the events show, from the third one on.
    pub(crate) fn std(&self, stated: f32) -> f32 {
        if !self.0.counts() || stated <= 0.0 {
            return stated;
        }
        let found = math::larger(self.0.value(), 0.0);
        let losses = found + math::smaller(found, LOW * stated);
        math::smaller(math::hypotenuse(stated, losses), InputStd::MOST_DAMPING)
    }

    /// Is the damping ratio significant?
    pub(crate) fn is_found(&self) -> bool {
        self.0.is_found() && self.0.value() > 0.0
    }

    /// The damping ratio, if it is significant.
    pub(crate) fn parameter(&self) -> Option<Parameter> {
        let (value, std) = self.0.found().filter(|&(value, _)| value > 0.0)?;
        Some(Parameter { name: "damping_ratio", value, std })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::score::{Asked, Score};
    use crate::effects::synthetic::{self, NOISE_N};

    /// Force at a time since the onset of a slip with losses in the air, brute force.
    fn damped_n(cycle: &CycleParams, ratio: f32, since_onset: f32) -> f32 {
        if since_onset <= 0.0 {
            return cycle.static_n + cycle.rate * since_onset;
        }
        let (mut y, mut speed, mut time) = (cycle.half_drop_n, cycle.rate, 0.0);
        let (step, omega) = (1e-3, cycle.omega);
        while time < since_onset {
            let slips = time < 1.0 / omega || speed < cycle.rate;
            if !slips {
                y += cycle.rate * (since_onset - time);
                break;
            }
            speed -= step * (omega * omega * y + 2.0 * ratio * omega * (speed - cycle.rate));
            y += step * speed;
            time += step;
        }
        cycle.dynamic_n() + y
    }

    fn learnt(events: u16, ratio: f32) -> Damping {
        let mut damping = Damping::default();
        let force_n = |cycle: &CycleParams, time: f32| damped_n(cycle, ratio, time - cycle.onset);
        synthetic::events(events, force_n, |data, cycle| {
            let noise_n2 = NOISE_N * NOISE_N;
            let Some(fit) = data.fit(cycle, noise_n2) else { return };
            let Some(alone) = synthetic::alone(&fit, &data) else { return };
            let shape = &fit.shape;
            let losses_n = term_n(shape);
            let mut asked = Asked::default();
            let levels = (&data, 0..data.places());
            asked.take(levels, shape, |time, by| [losses_n(time, by), 0.0, 0.0]);
            asked.free(&alone);
            damping.0.learn(&asked.score(0), noise_n2);
        });
        damping
    }

    #[test]
    fn losses_are_found_and_none_are_none() {
        for ratio in [0.0, 0.01, 0.02, 0.05] {
            let damping = learnt(100, ratio);
            let (value, std) = (damping.0.value(), math::sqrt(damping.0.variance()));
            assert!(
                (value - ratio).abs() < 0.1 * ratio + 3.0 * std && std < 0.012,
                "{ratio}: {value} {std}"
            );
        }
    }

    /// What is stated is never narrowed, what is found widens it, and a little more than that; what
    /// is stated to be exact stays so.
    #[test]
    fn what_is_found_widens_what_is_stated() {
        let stated = 0.005;
        let std = |found: f32, events: u8| {
            let mut damping = Damping::default();
            let event = Score { score: found, information: 1.0, ..Score::default() };
            (0..events).for_each(|_| damping.0.learn(&event, 1.0));
            (damping.std(stated), damping.std(0.0))
        };
        for (found, events, expected) in [
            (0.04, 2, stated),
            (-0.01, 9, stated),
            (0.0, 9, stated),
            (0.001, 9, math::hypotenuse(stated, 0.002)),
            (0.04, 9, math::hypotenuse(stated, 0.0425)),
            (0.9, 9, InputStd::MOST_DAMPING),
        ] {
            let (widened, exact) = std(found, events);
            assert!((widened - expected).abs() < 1e-6, "{found}, {events}: {widened}");
            assert!(exact.abs() < 1e-9, "{exact}");
        }
    }
}
