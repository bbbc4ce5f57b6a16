//! The block on a cable: Pritchard, Knoke and Echert (2012), equations (4) to (31).
//!
//! A cycle is five numbers, and a sixth that is zero while the winch turns steadily.
//! While the block rests the force rises at the loading
//! rate `k w` (4) until `Fs` (1). It then slides on the ellipse around `Fp` (7, 15)
//! and rests again at `Fe = 2 Fp − Fs` (16), where the next line starts.
//!
//! ```text
//!  F   Fs ......peak
//!      /|        ╲                    d = Fs − Fp   half the drop
//!     / | Fp ......╲..........        q = k w / ω
//!    /  |            ╲        /       a² = d² + q²               (10)
//!   /   | Fe ..........╲_____/        φ = atan(q / d)
//!     onset          stop             T_slide = (π + 2 φ) / ω    (25)
//! ```
//!
//! Any unit of time will do, as long as the rate, ω and the times agree; the fit
//! uses sampling periods. Exactness: `tests/equations.rs` integrates the equations
//! of motion by brute force and compares.

use crate::math;

/// Number of unknowns of a cycle.
pub const UNKNOWNS: usize = 6;

/// One stick-slip cycle: stick line, slip, stick line.
///
/// `rate` and `omega` are above zero, `half_drop_n` at or above zero.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cycle {
    /// Time at which the slip begins.
    pub onset: f32,
    /// Loading rate `k w`, N per unit of time.
    pub rate: f32,
    /// `Fs`, N.
    pub static_n: f32,
    /// `d = Fs − Fp = (mu_s − mu) M g cos α`, N.
    pub half_drop_n: f32,
    /// Natural frequency while sliding, rad per unit of time.
    pub omega: f32,
    /// Loading rate after the slip minus `rate`: the winch or the sag changed it.
    pub bend: f32,
}

/// What several formulas of one [`Cycle`] share.
#[derive(Clone, Copy, Debug)]
pub struct Shape {
    cycle: Cycle,
    /// `q = k w / ω`, N.
    q: f32,
    /// `a² = d² + q²` (10), N².
    a2: f32,
    /// `T_slide` (25).
    slide: f32,
}

/// Gradient of the force with respect to the unknowns of the fit: onset, rate, `Fs`,
/// `d`, swing `1/ω` and bend. The swing, not ω: times are proportional to it, so what
/// few samples tell of it is close to a normal distribution.
pub type Gradient = [f32; UNKNOWNS];

impl Cycle {
    /// `Fp`, centre of the ellipse (6), N.
    #[must_use]
    pub fn dynamic_n(&self) -> f32 {
        self.static_n - self.half_drop_n
    }

    /// `Fe = 2 Fp − Fs` (16), N.
    #[must_use]
    pub fn restick_n(&self) -> f32 {
        self.static_n - 2.0 * self.half_drop_n
    }

    /// Half-length `a` of the ellipse's force axis (10), N.
    #[must_use]
    pub fn amplitude_n(&self) -> f32 {
        math::sqrt(self.shape().a2)
    }

    /// Largest force of the cycle, `Fp + a`, N.
    #[must_use]
    pub fn peak_n(&self) -> f32 {
        self.dynamic_n() + self.amplitude_n()
    }

    /// Time from the onset to the largest force, `φ / ω`.
    #[must_use]
    pub fn peak_time(&self) -> f32 {
        math::atan2(self.rate / self.omega, self.half_drop_n) / self.omega
    }

    /// Swing `1/ω`: the time in which the slide turns by one radian.
    #[must_use]
    pub fn swing(&self) -> f32 {
        1.0 / self.omega
    }

    /// Time of sliding, `T_slide` (25).
    #[must_use]
    pub fn slide_time(&self) -> f32 {
        self.shape().slide
    }

    /// Time of rest that loads the cable from `Fe` to `Fs`, `T_static` (22).
    #[must_use]
    pub fn rest_time(&self) -> f32 {
        2.0 * self.half_drop_n / self.rate
    }

    /// Precomputes what the force and its gradient need.
    #[must_use]
    pub fn shape(&self) -> Shape {
        let q = self.rate / self.omega;
        let phase = math::atan2(q, self.half_drop_n);
        let slide = (core::f32::consts::PI + 2.0 * phase) / self.omega;
        Shape { cycle: *self, q, a2: self.half_drop_n * self.half_drop_n + q * q, slide }
    }
}

impl Shape {
    /// Time at which the block rests again.
    #[must_use]
    pub fn stop(&self) -> f32 {
        self.cycle.onset + self.slide
    }

    /// Force at a time (4, 7), N, and its gradient.
    #[must_use]
    pub fn force(&self, time: f32) -> (f32, Gradient) {
        let since_onset = time - self.cycle.onset;
        if since_onset <= 0.0 {
            self.before(since_onset)
        } else if since_onset < self.slide {
            self.during(since_onset)
        } else {
            self.after(since_onset)
        }
    }

    /// On the stick line before the slip, continued to any time.
    #[must_use]
    pub fn before(&self, since_onset: f32) -> (f32, Gradient) {
        let c = &self.cycle;
        (c.static_n + c.rate * since_onset, [-c.rate, since_onset, 1.0, 0.0, 0.0, 0.0])
    }

    /// On the ellipse: `F − Fp = d cos ωτ + q sin ωτ`.
    fn during(&self, since_onset: f32) -> (f32, Gradient) {
        let c = &self.cycle;
        let (sin, cos) = math::sin_cos(c.omega * since_onset);
        let from_centre = c.half_drop_n * cos + self.q * sin;
        let force_rate = c.rate * cos - c.half_drop_n * c.omega * sin;
        let by_rate = sin / c.omega;
        let by_swing = c.omega * (self.q * sin - force_rate * since_onset);
        let force_n = c.static_n - c.half_drop_n + from_centre;
        (force_n, [-force_rate, by_rate, 1.0, cos - 1.0, by_swing, 0.0])
    }

    /// On the stick line after the slip, continued to any time.
    #[must_use]
    pub fn after(&self, since_onset: f32) -> (f32, Gradient) {
        let c = &self.cycle;
        let (d, q, a2) = (c.half_drop_n, self.q, self.a2);
        let since_stop = since_onset - self.slide;
        let rate = c.rate + c.bend;
        // Derivatives of T_slide, from φ = atan(q / d).
        let part = 2.0 / (c.omega * a2);
        let slide_by_rate = part * d / c.omega;
        let slide_by_drop = -part * q;
        let slide_by_swing = c.omega * (self.slide + part * q * d);
        let gradient = [
            -rate,
            since_stop - rate * slide_by_rate,
            1.0,
            -2.0 - rate * slide_by_drop,
            -rate * slide_by_swing,
            since_stop,
        ];
        (c.static_n - 2.0 * d + rate * since_stop, gradient)
    }

    /// Slope of the line before the slip, and its gradient.
    #[must_use]
    pub fn slope_before(&self) -> (f32, Gradient) {
        (self.cycle.rate, [0.0, 1.0, 0.0, 0.0, 0.0, 0.0])
    }

    /// Slope of the line after the slip, and its gradient.
    #[must_use]
    pub fn slope_after(&self) -> (f32, Gradient) {
        (self.cycle.rate + self.cycle.bend, [0.0, 1.0, 0.0, 0.0, 0.0, 1.0])
    }
}

/// `mu` from a force at sliding, or `mu_s` from one at the onset (26 to 28):
/// `F = W (sin α + mu cos α)`.
#[must_use]
pub fn coefficient(force_n: f32, weight_n: f32, slope_rad: f32) -> f32 {
    let (sin, cos) = math::sin_cos(slope_rad);
    (force_n / weight_n - sin) / cos
}

/// Speed of the block while it slides (13), m/s: `v = w + (ω a / k) sin ω(t − t0)`.
///
/// `force_rate_n_per_s` is the force's rate at that moment; `F' = k (w − v)`.
#[must_use]
pub fn speed_m_per_s(winch_m_per_s: f32, stiffness_n_per_m: f32, force_rate_n_per_s: f32) -> f32 {
    winch_m_per_s - force_rate_n_per_s / stiffness_n_per_m
}

/// Smallest speed the slip would reach if it went on (31), m/s: always below zero,
/// so the block always sticks again.
#[must_use]
pub fn least_speed_m_per_s(cycle: &Cycle, winch_m_per_s: f32, stiffness_n_per_m: f32) -> f32 {
    winch_m_per_s - cycle.omega * cycle.amplitude_n() / stiffness_n_per_m
}

#[cfg(test)]
mod tests {
    use super::*;

    /// DFF8-13 in sampling periods of 1/16 s.
    fn dff8_13() -> Cycle {
        let (static_n, half_drop_n) = (781.2, 289.8);
        Cycle { onset: 3.3, rate: 22.5, static_n, half_drop_n, omega: 1.1828, bend: 0.0 }
    }

    #[test]
    fn the_published_test_takes_its_published_times() {
        let c = dff8_13();
        assert!((c.slide_time() / 16.0 - 0.173).abs() < 0.001, "{}", c.slide_time() / 16.0);
        assert!((c.rest_time() / 16.0 - 1.61).abs() < 0.001);
        assert!((c.restick_n() - 201.6).abs() < 1e-3);
    }

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
            let bent = Cycle { bend: 3.0, ..dff8_13() };
            let (_, gradient) = bent.shape().force(time);
            for (i, step) in steps.into_iter().enumerate() {
                let at = |sign: f32| {
                    let mut c = bent;
                    let mut swing = bent.swing();
                    let field = match i {
                        0 => &mut c.onset,
                        1 => &mut c.rate,
                        2 => &mut c.static_n,
                        3 => &mut c.half_drop_n,
                        4 => &mut swing,
                        _ => &mut c.bend,
                    };
                    *field += sign * step;
                    c.omega = 1.0 / swing;
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

    #[test]
    fn leaving_out_the_slope_makes_both_coefficients_too_high() {
        let (weight, slope) = (630.0_f32, 0.1_f32.atan());
        let force = |mu: f32| weight * (slope.sin() + mu * slope.cos());
        for (mu, excess) in [(0.56, 0.17), (0.91, 0.10)] {
            assert!((coefficient(force(mu), weight, slope) - mu).abs() < 1e-6);
            let naive = coefficient(force(mu), weight, 0.0);
            assert!((naive / mu - 1.0 - excess).abs() < 0.01, "{naive}");
        }
    }
}
