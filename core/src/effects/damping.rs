//! Damping ratio of the losses in cable or air, estimated from the residuals of the fits.
//!
//! With a damping ratio `D` the force decays towards `Fp`,
//! `F − Fp = e^(−D ωτ) (d cos ωτ + q sin ωτ)` to first order. A fit without it leaves the residual
//! `−D ωτ (F − Fp)`. This is a force term, and its score (`effects/score.rs`) determines `D` to
//! about ±.018 after ten events and ±.008 after fifty.
//!
//! The estimate `D̂` never corrects a value, since friction that varies along the slip has nearly
//! the same residual. It widens the stated prior by `D̂²` in the variance. One that is not
//! significant counts as the posterior mean of losses with a wider prior ([`LIKELY`]). A `D̂` that
//! came out low by chance must not hide losses, so it counts as a little more ([`LOW`]). Losses that
//! are stated to be known exactly, with 0, stay so.

use crate::config::InputStd;
use crate::effect::Parameter;
use crate::effects::score::ScoreSum;
use crate::model::{CycleParams, Shape};
use crate::num::math;
use crate::stats::normal_equations::Gradient;

/// Part of the stated standard deviation that is added to a damping ratio above zero, which may
/// have come out low by chance; at most the ratio is doubled. Few events determine it better.
/// Tuned: drag of 30 N s/m is two and a half of the default standard deviations. Without this, .70
/// of the intervals of `mu` of two-minute records cover with that drag, with it .92; with 1 as many
/// do, and the intervals are a ninth wider.
const LOW: f32 = 0.5;
/// Standard deviation of losses that are not significant, in stated ones. Slips of two samples leave
/// the damping ratio uncertain by tenths: without this bound, half of the records without any losses
/// had intervals ten times too wide. Tuned: with 3 the intervals of `damping_2` cover .88 (.99), with
/// 8 those of `jitter_10` are a fifth wider.
const LIKELY: f32 = 5.0;

/// The damping ratio, estimated as the amplitude of a force term.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Damping(pub(crate) ScoreSum);

/// Force by losses with a damping ratio of one, N, to first order, at a time since the onset, from
/// the model's gradient at that time. The slip decays towards `Fp` by `−ωτ (F − Fp)`; the line
/// after the stop, where `F − Fp = −d`, keeps the shift it has at the stop.
///
/// The term in `sin ωτ` is left out: its sign is opposite for losses in the cable and in the air,
/// and a shift of the onset has the same form.
///
/// On the line after the slip losses look like a smaller drop. That drop is subtracted from the
/// term, so that only the slip's samples determine `D`, without a small difference of large sums.
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
    /// The stated standard deviation, from the third event on widened by the estimated losses.
    pub(crate) fn std(&self, stated: f32) -> f32 {
        if !self.0.counts() || stated <= 0.0 {
            return stated;
        }
        let mut found = math::larger(self.0.value(), 0.0);
        if self.parameter().is_none() {
            let likely = LIKELY * stated * LIKELY * stated;
            found *= likely / (likely + self.0.variance());
        }
        let losses = found + math::smaller(found, LOW * stated);
        math::smaller(math::hypotenuse(stated, losses), InputStd::MOST_DAMPING)
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
            let Some(fit) = data.fit(cycle) else { return };
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

    /// The stated value is never narrowed; an estimate widens it by its size and a little more; a
    /// value stated to be exact stays exact.
    #[test]
    fn what_is_found_widens_what_is_stated() {
        let stated = 0.005;
        let std = |found: f32, sure: f32, events: u8| {
            let mut damping = Damping::default();
            let event = Score { score: found * sure, information: sure, ..Score::default() };
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
            let (widened, exact) = std(found, 1e8, events);
            assert!((widened - expected).abs() < 1e-6, "{found}, {events}: {widened}");
            assert!(exact.abs() < 1e-9, "{exact}");
        }
    }

    /// Slips of two samples leave the damping ratio uncertain by a tenth: what comes out by chance
    /// only doubles the stated standard deviation. By a hundredth: the estimate counts nearly as it is.
    #[test]
    fn what_is_hardly_determined_widens_little() {
        let widened = |found: f32, std: f32| {
            let mut damping = Damping::default();
            let information = 1.0 / (9.0 * std * std);
            let event = Score { score: found * information, information, ..Score::default() };
            (0..9).for_each(|_| damping.0.learn(&event, 1.0));
            damping.std(0.005)
        };
        assert!((0.009..0.011).contains(&widened(0.1, 0.1)), "{}", widened(0.1, 0.1));
        assert!((0.011..0.013).contains(&widened(0.01, 0.01)), "{}", widened(0.01, 0.01));
    }
}
