//! The Cramér-Rao bound of one event: the smallest standard deviations that an unbiased estimate
//! from the event's samples can have, whatever the method.
//!
//! Model: white noise of known size on the samples from the stop before the event to the onset
//! after it; five unknowns, onset time `t0`, loading rate `k w`, `Fs`, `Fp`, `omega`. With
//! `A = Fs - Fp`, `B = k w / omega`, `T = (2/omega)(pi - atan2(A, B))` (25) and time `t` since the
//! onset:
//!
//! - before: `F = Fs + k w t`
//! - slip: `F = Fp + A cos omega t + B sin omega t` (7)
//! - after: `F = 2 Fp - Fs + k w (t - T)` (16)
//!
//! When the block stops on a slack cable, (7) holds until the force reaches zero, at the speed
//! `v0`; then `F = 0` until the winch has taken up the distance that the block slid on,
//! `v0² M / (2 Fp w)` later, and `F = k w (t - t1)` from there on. The mass is known, so this time
//! is a function of the same five unknowns.
//!
//! The gradients are analytic; the Fisher matrix is the sum of their products over the samples.
//! Aperture, quantization and faults are left out.

use std::f64::consts::PI;

use floe_core::units::STANDARD_GRAVITY_M_PER_S2 as GRAVITY_M_PER_S2;

use super::scene::Scene;
use super::truth::TrueEvent;

mod fisher;
mod slack;
#[cfg(test)]
mod tests;

pub(super) use fisher::{Matrix, fisher, inverse};
pub use slack::SlackEvent;

/// Number of unknowns.
pub(super) const UNKNOWNS: usize = 5;
/// Positions of the loading rate, `Fs`, `Fp` and `omega` among the unknowns; `t0` is at 0.
pub(super) const RATE: usize = 1;
const STATIC: usize = 2;
const DYNAMIC: usize = 3;
pub(super) const OMEGA: usize = 4;

/// A linear event.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearEvent {
    /// Onset `t0`, s.
    pub onset_s: f64,
    /// `k w`, N/s.
    pub loading_rate_n_per_s: f64,
    /// `Fs`, N.
    pub static_force_n: f64,
    /// `Fp`, N.
    pub dynamic_force_n: f64,
    /// `omega`, rad/s.
    pub omega_rad_per_s: f64,
}

impl From<&TrueEvent> for LinearEvent {
    fn from(event: &TrueEvent) -> Self {
        Self {
            onset_s: event.onset_s,
            loading_rate_n_per_s: event.loading_rate_n_per_s,
            static_force_n: event.static_force_n,
            dynamic_force_n: event.dynamic_force_n,
            omega_rad_per_s: event.omega_rad_per_s,
        }
    }
}

/// Standard deviations of the two forces, N.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceBound {
    /// Of `Fs`.
    pub static_n: f64,
    /// Of `Fp`.
    pub dynamic_n: f64,
}

impl LinearEvent {
    /// `A`, `B` and `A² + B²`.
    fn axes(&self) -> (f64, f64, f64) {
        let a = self.static_force_n - self.dynamic_force_n;
        let b = self.loading_rate_n_per_s / self.omega_rad_per_s;
        (a, b, a * a + b * b)
    }

    /// Time of motion (25), s.
    #[must_use]
    pub fn slip_s(&self) -> f64 {
        let (a, b, _) = self.axes();
        2.0 / self.omega_rad_per_s * (PI - a.atan2(b))
    }

    /// Time of rest (22), s.
    #[must_use]
    pub fn stick_s(&self) -> f64 {
        2.0 * self.axes().0 / self.loading_rate_n_per_s
    }

    /// Partial derivatives of the force at a time with respect to the five unknowns.
    #[must_use]
    pub fn gradient(&self, time_s: f64) -> [f64; 5] {
        let t = time_s - self.onset_s;
        if t < 0.0 {
            [-self.loading_rate_n_per_s, t, 1.0, 0.0, 0.0]
        } else if t < self.slip_s() {
            self.slip_gradient(t)
        } else {
            self.rest_gradient(t)
        }
    }

    fn slip_gradient(&self, t: f64) -> [f64; UNKNOWNS] {
        let (a, b, _) = self.axes();
        let omega = self.omega_rad_per_s;
        let (sin, cos) = (omega * t).sin_cos();
        let turn = b * cos - a * sin;
        [-omega * turn, sin / omega, cos, 1.0 - cos, t * turn - b / omega * sin]
    }

    fn rest_gradient(&self, t: f64) -> [f64; UNKNOWNS] {
        let (a, b, square) = self.axes();
        let (rate, omega, slip_s) =
            (self.loading_rate_n_per_s, self.omega_rad_per_s, self.slip_s());
        let per_force = 2.0 / omega * b / square; // -dT/dFs = dT/dFp
        let per_rate = 2.0 / omega * a / omega / square;
        let per_omega = -slip_s / omega - 2.0 / omega * a * b / (omega * square);
        [
            -rate,
            t - slip_s - rate * per_rate,
            -1.0 + rate * per_force,
            2.0 - rate * per_force,
            -rate * per_omega,
        ]
    }

    /// The bound for samples at `times_s` with white noise of `noise_n`, all five parameters
    /// unknown; `None` where the samples do not determine them.
    #[must_use]
    pub fn bound(&self, times_s: impl Iterator<Item = f64>, noise_n: f64) -> Option<ForceBound> {
        let fisher = fisher(times_s.map(|t| self.gradient(t)));
        Some(ForceBound::new(&inverse(fisher)?, noise_n))
    }
}

impl ForceBound {
    pub(super) fn new(covariance: &Matrix, noise_n: f64) -> Self {
        Self {
            static_n: noise_n * covariance[STATIC][STATIC].sqrt(),
            dynamic_n: noise_n * covariance[DYNAMIC][DYNAMIC].sqrt(),
        }
    }
}

/// Sets the bounds of the events of a scene that is linear, has white noise and does not change;
/// events of other scenes keep none.
pub fn set_bounds(scene: &Scene, events: &mut [TrueEvent]) {
    let noise_n = scene.measurement.white_n;
    let changes = scene.winch_profile.is_some() || scene.breaking.is_some();
    if noise_n <= 0.0 || changes || !scene.is_linear() {
        return;
    }
    let onsets: Vec<f64> = events.iter().map(|e| e.onset_s).collect();
    for (i, event) in events.iter_mut().enumerate() {
        let end_s = onsets.get(i + 1).copied().unwrap_or(scene.duration_s);
        let first = ((event.onset_s - event.stick_s).max(0.0) * scene.rate_hz).ceil() as u32;
        let last = (end_s * scene.rate_hz).ceil() as u32;
        let times_s = (first..last.min(scene.sample_count())).map(|n| n as f64 / scene.rate_hz);
        if let Some(bound) = event_bound(scene, event, times_s) {
            let force_of_one_n = event.weight_n * scene.slope_rad().cos();
            event.mu_s_bound = Some(bound.static_n / force_of_one_n);
            event.mu_bound = Some(bound.dynamic_n / force_of_one_n);
        }
    }
}

/// The bound of one event; `None` also for a cable that is taut again while the block still moves.
fn event_bound(
    scene: &Scene,
    event: &TrueEvent,
    times_s: impl Iterator<Item = f64>,
) -> Option<ForceBound> {
    let taut = LinearEvent::from(event);
    let noise_n = scene.measurement.white_n;
    if !event.slack {
        return taut.bound(times_s, noise_n);
    }
    let mass_kg = event.weight_n / GRAVITY_M_PER_S2;
    let stopped_slack = event.slack_m > 0.0;
    if stopped_slack { SlackEvent { taut, mass_kg }.bound(times_s, noise_n) } else { None }
}
