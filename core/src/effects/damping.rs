//! Losses in the cable or the air, from what the fits leave over.
//!
//! With a damping ratio `D` the swing about `Fp` decays, `F − Fp = e^(−D ωτ) (d cos ωτ + q sin ωτ)`
//! to first order, so an event that is fitted without it leaves `−ωτ (F − Fp)` times `D`. The
//! score of every fitted event, its own unknowns free, tells `D` a little; the scores add up.
//! One shared `D` is known to about ±.018 after ten events and ±.008 after fifty.
//!
//! What is found is never taken off, since friction that varies along the slip looks much the
//! same: it widens the stated prior. Beyond one standard error losses are possible, and `D̂²` is
//! added to the stated variance; with `D ~ N(0, s²)` the events are most likely under
//! `s² = D̂² − var D̂`, but a `D̂` that came out low by chance must not hide them. Losses that are
//! stated to be known exactly, with 0, stay so.

use crate::effect::Parameter;
use crate::fit::{Alone, Data, Fit};
use crate::num::math;
use crate::stats::normal_equations::{Gradient, dot};
use crate::stats::prior::surely;

/// Part that is left of the past with every event.
const FADE: f32 = 1.0 - 1.0 / 200.0;
/// Events before which nothing counts.
const LEAST_EVENTS: f32 = 4.0;
/// Standard errors beyond which losses are found.
const SIGNIFICANT: f32 = 3.0;
/// Information that is left when the unknowns are free, of the whole: less is rounding.
const LEAST_OWN: f32 = 1e-4;
/// Most losses of a cable that still swings: beyond it nothing is known.
const MOST: f32 = 0.3;

/// What the events of a fading past tell of the losses.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Damping {
    count: f32,
    /// Sums over events, in units of the noise.
    information: f32,
    score: f32,
    /// Sum of the squared scores over their information: 1 an event, if the noise is all.
    surprise: f32,
}

impl Damping {
    /// Takes what an event's residuals tell.
    pub(crate) fn learn(&mut self, data: &Data<'_>, fit: &Fit, alone: &Alone, noise_n2: f32) {
        let Some((score, information)) = score(data, fit, alone) else { return };
        let (score, information) = (score / noise_n2, information / noise_n2);
        let off = score - self.value() * information;
        let square = off * off / information;
        if !(score + information + square).is_finite() {
            return;
        }
        let fade = |sum: &mut f32, by: f32| *sum = FADE * *sum + by;
        fade(&mut self.count, 1.0);
        fade(&mut self.score, score);
        fade(&mut self.information, information);
        fade(&mut self.surprise, square);
    }

    fn value(&self) -> f32 {
        if self.information > 0.0 { self.score / self.information } else { 0.0 }
    }

    /// Its variance; scores that scatter by more than the noise tell so much less.
    fn variance(&self) -> f32 {
        (self.surprise / self.count).max(1.0) / self.information
    }

    /// The stated standard deviation with what the events ask for beyond it.
    pub(crate) fn std(&self, stated: f32) -> f32 {
        let value = self.value();
        if self.count <= LEAST_EVENTS || value <= 0.0 || stated <= 0.0 {
            return stated;
        }
        let possible = surely(value * value, self.variance());
        math::hypotenuse(stated, value * math::sqrt(possible)).min(MOST)
    }

    /// The damping ratio, if it is significant.
    pub(crate) fn parameter(&self) -> Option<Parameter> {
        let (value, std) = (self.value(), math::sqrt(self.variance()));
        let found = self.count > LEAST_EVENTS && value > SIGNIFICANT * std;
        found.then_some(Parameter { name: "damping_ratio", value, std })
    }
}

/// Score and information of one event, N².
#[cold]
fn score(data: &Data<'_>, fit: &Fit, alone: &Alone) -> Option<(f32, f32)> {
    let shape = fit.cycle.shape();
    if shape.is_slack() {
        return None;
    }
    // What losses do to the line after the slip is a smaller drop. Without that the rest is told
    // by the slip's samples alone, and is no small difference of large sums.
    let slide = shape.slide_time();
    let drop_n = -shape.by_damping(slide) / shape.after(slide).1[3];
    let (mut product, mut whole, mut score) = (Gradient::default(), 0.0, 0.0);
    for (time, force_n, weight) in data.levels() {
        let since_onset = time - fit.cycle.onset;
        if since_onset > 0.0 && since_onset < slide {
            let (off_n, gradient) = data.residual(&shape, time, force_n);
            let by = shape.by_damping(since_onset) + drop_n * gradient[3];
            product.iter_mut().zip(gradient).for_each(|(sum, g)| *sum += weight * by * g);
            whole += weight * by * by;
            score += weight * by * off_n;
        }
    }
    let response = alone.factor.solve(&product);
    let information = whole - dot(&product, &response);
    let is_told = information > LEAST_OWN * whole;
    is_told.then_some((score - dot(&response, &alone.right), information))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::synthetic::{self, NOISE_N};
    use crate::model::CycleParams;

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
            let Some(alone) = fit.alone(&data) else { return };
            damping.learn(&data, &fit, &alone, noise_n2);
        });
        damping
    }

    #[test]
    fn losses_are_found_and_none_are_none() {
        for ratio in [0.0, 0.01, 0.02, 0.05] {
            let damping = learnt(100, ratio);
            let (value, std) = (damping.value(), math::sqrt(damping.variance()));
            assert!(
                (value - ratio).abs() < 0.1 * ratio + 3.0 * std && std < 0.012,
                "{ratio}: {value} {std}"
            );
        }
    }
}
