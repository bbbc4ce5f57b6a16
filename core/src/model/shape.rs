//! The force of one cycle at any time, by pieces, with its derivatives by the six unknowns.

use crate::model::CycleParams;
use crate::model::slack::{ByShape, Slack, Then};
use crate::num::math::{self, larger};
use crate::stats::normal_equations::Gradient;

/// Precomputed terms that several formulas of one [`CycleParams`] share.
#[derive(Clone, Copy, Debug, Default)]
pub struct Shape {
    cycle: CycleParams,
    /// `q = k w / ω`, N.
    q: f32,
    /// `a² = d² + q²` (10), N².
    a2: f32,
    /// `φ = atan(q / d)`.
    phase: f32,
    /// Time of sliding: `T_slide` (25), or up to the stop on a slack cable.
    slide: f32,
    /// Shift of the ellipse's centre by a rate change of one that grows linearly over the slip:
    /// `1 / (T_slide ω²)`, from `F'' + ω² (F − Fp) = k w'`. Zero on a slack cable.
    ramp: f32,
    /// Time since the onset up to which the force is on the ellipse: to the stop, or until the
    /// cable is slack.
    arc: f32,
    slack: Option<Slack>,
}

/// Where the stick line after the slip starts.
struct Rest {
    /// Time since the onset.
    time: f32,
    /// Derivatives of that time.
    by: ByShape,
    /// Force at that time, N, with its derivatives by `Fs` and `d`.
    force_n: f32,
    force_by: [f32; 2],
}

impl CycleParams {
    /// Precomputes the terms of the force and its gradient.
    #[must_use]
    pub fn shape(&self) -> Shape {
        let q = self.rate / self.omega;
        let phase = math::atan2(q, self.half_drop_n);
        let a2 = self.half_drop_n * self.half_drop_n + q * q;
        let (slack, arc, slide) = match Slack::of(self, q, a2, phase) {
            Some((slack, falls, stop)) => (Some(slack), falls, stop),
            None => {
                let slide = (core::f32::consts::PI + 2.0 * phase) / self.omega;
                (None, slide, slide)
            }
        };
        let ramp = if slack.is_none() { 1.0 / (slide * self.omega * self.omega) } else { 0.0 };
        Shape { cycle: *self, q, a2, phase, slide, ramp, arc, slack }
    }
}

impl Shape {
    /// Time of sliding (25), or up to the stop on a slack cable.
    pub(crate) fn slide_time(&self) -> f32 {
        self.slide
    }

    /// Time from the onset in which the force depends on the slide: up to the stop, or until the
    /// cable goes slack.
    pub(crate) fn fall_time(&self) -> f32 {
        self.arc
    }

    /// Time from the onset to the largest force, `φ / ω`.
    pub(crate) fn peak_time(&self) -> f32 {
        self.phase / self.cycle.omega
    }

    /// Time at which the block rests again.
    pub(crate) fn stop(&self) -> f32 {
        self.cycle.onset + self.slide
    }

    /// Time at which the next stick line starts: later than the stop if the block
    /// stops on a slack cable.
    pub(crate) fn loads(&self) -> f32 {
        self.cycle.onset + self.slack.map_or(self.slide, |slack| larger(self.slide, slack.taut))
    }

    /// The cycle.
    pub(crate) fn cycle(&self) -> &CycleParams {
        &self.cycle
    }

    /// Does the cable go slack?
    #[must_use]
    pub fn is_slack(&self) -> bool {
        self.slack.is_some()
    }

    /// Force at a time (4, 7), N, and its gradient.
    #[must_use]
    pub fn force(&self, time: f32) -> (f32, Gradient) {
        let since_onset = time - self.cycle.onset;
        if since_onset <= 0.0 {
            self.before(since_onset)
        } else if since_onset < self.arc {
            self.during(since_onset)
        } else {
            match &self.slack {
                Some(slack) => self.after_fall(slack, since_onset),
                None => self.after(since_onset),
            }
        }
    }

    /// The force and its gradient after the ellipse has reached zero.
    fn after_fall(&self, slack: &Slack, since_onset: f32) -> (f32, Gradient) {
        if since_onset < slack.taut {
            return (0.0, Gradient::default());
        }
        match &slack.then {
            Then::Slides(delay, by) if since_onset < self.slide => {
                let (force_n, mut gradient) = self.during(since_onset - delay);
                // A delay acts like a later onset: its derivatives enter through the derivative by
                // the onset.
                let [by_onset, by_shape @ .., _] = &mut gradient;
                by_shape.iter_mut().zip(by).for_each(|(g, by)| *g += *by_onset * by);
                (force_n, gradient)
            }
            Then::Slides(..) | Then::Rests(_) => self.after(since_onset),
        }
    }

    /// On the stick line before the slip, continued to any time.
    pub(crate) fn before(&self, since_onset: f32) -> (f32, Gradient) {
        let c = &self.cycle;
        (c.static_n + c.rate * since_onset, [-c.rate, since_onset, 1.0, 0.0, 0.0, 0.0])
    }

    /// On the ellipse: `F − Fp = d cos ωτ + q sin ωτ`, plus the term of the rate change.
    fn during(&self, since_onset: f32) -> (f32, Gradient) {
        let c = &self.cycle;
        let (sin, cos) = math::sin_cos(c.omega * since_onset);
        let from_centre = c.half_drop_n * cos + self.q * sin;
        let force_rate = c.rate * cos - c.half_drop_n * c.omega * sin;
        let by_rate = sin / c.omega;
        let by_inverse_omega = c.omega * (self.q * sin - force_rate * since_onset);
        let by_rate_change = (1.0 - cos) * self.ramp;
        let force_n = c.static_n - c.half_drop_n + from_centre + c.rate_change * by_rate_change;
        (force_n, [-force_rate, by_rate, 1.0, cos - 1.0, by_inverse_omega, by_rate_change])
    }

    /// On the stick line after the slip, continued to any time.
    pub(crate) fn after(&self, since_onset: f32) -> (f32, Gradient) {
        let c = &self.cycle;
        let Rest { time, by, force_n, force_by } = self.rest();
        let [by_rate, by_static, by_drop, by_inverse_omega] = by;
        let since_rest = since_onset - time;
        let rate = c.rate + c.rate_change;
        // At the stop 1 − cos ω T = 2 cos² φ = 2 d²/a². The rate change shifts the stop as well,
        // with no effect on the force: it goes on at the winch's rate either way.
        let by_rate_change = since_rest + 2.0 * c.half_drop_n * c.half_drop_n / self.a2 * self.ramp;
        let gradient = [
            -rate,
            since_rest - rate * by_rate,
            force_by[0] - rate * by_static,
            force_by[1] - rate * by_drop,
            -rate * by_inverse_omega,
            by_rate_change,
        ];
        (force_n + c.rate * since_rest + c.rate_change * by_rate_change, gradient)
    }

    /// The stop on a taut cable; on a slack one the time at which it is taut again.
    fn rest(&self) -> Rest {
        let c = &self.cycle;
        let (d, q) = (c.half_drop_n, self.q);
        let (delay, delayed_by) = match self.slack {
            Some(Slack { taut, then: Then::Rests(by), .. }) => {
                return Rest { time: taut, by, force_n: 0.0, force_by: [0.0; 2] };
            }
            Some(Slack { then: Then::Slides(delay, by), .. }) => (delay, by),
            None => (0.0, ByShape::default()),
        };
        // Derivatives of T_slide (25), from φ = atan(q / d).
        let part = 2.0 / (c.omega * self.a2);
        let mut by =
            [part * d / c.omega, 0.0, -part * q, c.omega * (self.slide - delay + part * q * d)];
        by.iter_mut().zip(delayed_by).for_each(|(by, delayed)| *by += delayed);
        Rest { time: self.slide, by, force_n: c.static_n - 2.0 * d, force_by: [1.0, -2.0] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::tests::dff8_13;

    #[test]
    fn force_and_rate_are_continuous_where_the_pieces_meet() {
        let c = dff8_13();
        let shape = c.shape();
        let h = 1e-3;
        for time in [c.onset, shape.stop()] {
            let f = |t| shape.force(t).0;
            assert!((f(time - h) - f(time + h)).abs() < 2.1 * h * c.rate);
            let rates = [(f(time) - f(time - 0.01)) / 0.01, (f(time + 0.01) - f(time)) / 0.01];
            assert!((rates[0] - rates[1]).abs() < 5.0, "{rates:?}");
        }
    }

    #[test]
    fn the_gradient_is_the_difference_quotient() {
        let steps = [1e-3, 1e-2, 0.1, 0.1, 1e-3, 0.1];
        for time in [0.0, 3.6, 4.9, 5.5, 8.0] {
            let bent = CycleParams { rate_change: 3.0, ..dff8_13() };
            let (_, gradient) = bent.shape().force(time);
            for (i, step) in steps.into_iter().enumerate() {
                let at = |sign: f32| {
                    let mut c = bent;
                    let mut inverse_omega = bent.inverse_omega();
                    let field = match i {
                        0 => &mut c.onset,
                        1 => &mut c.rate,
                        2 => &mut c.static_n,
                        3 => &mut c.half_drop_n,
                        4 => &mut inverse_omega,
                        _ => &mut c.rate_change,
                    };
                    *field += sign * step;
                    c.omega = 1.0 / inverse_omega;
                    c.shape().force(time).0
                };
                let quotient = (at(1.0) - at(-1.0)) / (2.0 * step);
                let error = (gradient[i] - quotient).abs();
                assert!(
                    error < 0.02 * gradient[i].abs() + 0.2,
                    "{time} {i} {} {quotient}",
                    gradient[i]
                );
            }
        }
    }

    /// `F'' + ω² (F − Fp) = bend / T_slide` in small steps, to the stop, `F' = k w`.
    #[test]
    fn a_winch_that_gains_speed_shifts_the_stop() {
        let steady = dff8_13();
        for rate_change in [-2.0_f32, 2.0] {
            let cycle = CycleParams { rate_change, ..steady };
            let gain = f64::from(rate_change / steady.slide_time());
            let (omega, centre_n) = (f64::from(cycle.omega), f64::from(cycle.dynamic_n()));
            let h = 1e-4;
            let (mut t, mut force_n) = (0.0, f64::from(cycle.static_n));
            let mut force_rate = f64::from(cycle.rate);
            while t < 0.1 || force_rate < f64::from(cycle.rate) + gain * t {
                let pull = |force_n: f64| omega * omega * (centre_n - force_n) + gain;
                let half = force_rate + 0.5 * h * pull(force_n);
                force_n += h * half;
                force_rate = half + 0.5 * h * pull(force_n);
                t += h;
            }
            // The stick line through the stop, where the closed form has its own.
            let (got_n, _) = cycle.shape().after(t as f32);
            let moved_n = force_n - f64::from(steady.restick_n());
            assert!(moved_n.abs() > 0.5, "{moved_n}");
            assert!((f64::from(got_n) - force_n).abs() < 0.15 * moved_n.abs(), "{got_n} {force_n}");
        }
    }
}
