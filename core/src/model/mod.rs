//! The block on a cable: Pritchard, Knoke and Echert (2012), equations (4) to (31).
//!
//! A cycle has five parameters, and a sixth that is zero while the winch turns steadily. While the
//! block rests, the force rises at the loading rate `k w` (4) until `Fs` (1). The block then slides
//! on the ellipse around `Fp` (7, 15) and rests again at `Fe = 2 Fp − Fs` (16), where the next line
//! starts.
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
//! If `a > Fp` the cable goes slack on the way (`model/slack.rs`).
//!
//! The unit of time is free, as long as the rate, ω and the times agree; the fit uses sampling
//! periods. Exactness: `tests/equations/main.rs` compares with a numerical integration of the
//! equations of motion.

pub mod corner;
pub(crate) mod elongation;
mod shape;
pub(crate) mod slack;

pub use crate::model::shape::Shape;

use crate::num::math;

/// One stick-slip cycle: stick line, slip, stick line.
///
/// `rate` and `omega` are above zero, `half_drop_n` at or above zero.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CycleParams {
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
    /// Loading rate after the slip less that before it: the winch or the cable changed during the
    /// slip.
    pub rate_change: f32,
}

impl CycleParams {
    /// `Fp`, centre of the ellipse (6), N.
    #[must_use]
    pub fn dynamic_n(&self) -> f32 {
        self.static_n - self.half_drop_n
    }

    /// `Fe = 2 Fp − Fs` (16), N; zero when the block comes to rest on a slack cable.
    #[must_use]
    pub fn restick_n(&self) -> f32 {
        math::larger(self.static_n - 2.0 * self.half_drop_n, 0.0)
    }

    /// Half-length `a` of the ellipse's force axis (10), N.
    #[must_use]
    pub fn amplitude_n(&self) -> f32 {
        let q = self.rate / self.omega;
        math::hypotenuse(self.half_drop_n, q)
    }

    /// Largest force of the cycle, `Fp + a`, N.
    #[must_use]
    pub fn peak_n(&self) -> f32 {
        self.dynamic_n() + self.amplitude_n()
    }

    /// Swing `1/ω`: the time in which the phase of the slide advances by one radian.
    pub(crate) fn inverse_omega(&self) -> f32 {
        1.0 / self.omega
    }

    /// Time of sliding: `T_slide` (25) on a taut cable.
    #[must_use]
    pub fn slide_time(&self) -> f32 {
        self.shape().slide_time()
    }

    /// Does the cable stay taut?
    #[inline(never)]
    pub(crate) fn is_taut(&self) -> bool {
        let (q, centre_n) = (self.rate / self.omega, self.dynamic_n());
        centre_n >= 0.0 && self.half_drop_n * self.half_drop_n + q * q <= centre_n * centre_n
    }

    /// Time of rest that loads a taut cable from `Fe` to `Fs`, `T_static` (22).
    #[must_use]
    pub fn rest_time(&self) -> f32 {
        2.0 * self.half_drop_n / self.rate
    }
}

/// `mu` from a force at sliding, or `mu_s` from one at the onset (26 to 28):
/// `F = W (sin α + mu cos α)`; `slope` is the sine and cosine of α.
#[must_use]
pub fn coefficient(force_n: f32, weight_n: f32, slope: (f32, f32)) -> f32 {
    let (sin, cos) = slope;
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
pub fn least_speed_m_per_s(cycle: &CycleParams, winch_m_per_s: f32, stiffness_n_per_m: f32) -> f32 {
    winch_m_per_s - cycle.omega * cycle.amplitude_n() / stiffness_n_per_m
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// DFF8-13 in sampling periods of 1/16 s.
    pub(crate) fn dff8_13() -> CycleParams {
        let (static_n, half_drop_n) = (781.2, 289.8);
        CycleParams {
            onset: 3.3,
            rate: 22.5,
            static_n,
            half_drop_n,
            omega: 1.1828,
            rate_change: 0.0,
        }
    }

    #[test]
    fn the_published_test_takes_its_published_times() {
        let c = dff8_13();
        assert!((c.slide_time() / 16.0 - 0.173).abs() < 0.001, "{}", c.slide_time() / 16.0);
        assert!((c.rest_time() / 16.0 - 1.61).abs() < 0.001);
        assert!((c.restick_n() - 201.6).abs() < 1e-3);
    }

    #[test]
    fn leaving_out_the_slope_makes_both_coefficients_too_high() {
        let (weight, (sin, cos)) = (630.0_f32, 0.1_f32.atan().sin_cos());
        let force = |mu: f32| weight * (sin + mu * cos);
        for (mu, excess) in [(0.56, 0.17), (0.91, 0.10)] {
            assert!((coefficient(force(mu), weight, (sin, cos)) - mu).abs() < 1e-6);
            let naive = coefficient(force(mu), weight, (0.0, 1.0));
            assert!((naive / mu - 1.0 - excess).abs() < 0.01, "{naive}");
        }
    }
}
