//! The Cramér-Rao bound of one event: the smallest standard deviations that an
//! estimate from its samples can have, whatever the method.
//!
//! Model: white noise of known size on the samples from the stop before the
//! event to the onset after it; five unknowns, onset time `t0`, loading rate
//! `k w`, `Fs`, `Fp`, `omega`. With `A = Fs - Fp`, `B = k w / omega`,
//! `T = (2/omega)(pi - atan2(A, B))` (25) and time `t` since the onset:
//!
//! - before: `F = Fs + k w t`
//! - slip: `F = Fp + A cos omega t + B sin omega t` (7)
//! - after: `F = 2 Fp - Fs + k w (t - T)` (16)
//!
//! The gradients are these formulas' own; the Fisher matrix is their sum of
//! squares over the samples. Aperture, steps, faults and slack are not in it.

use std::f64::consts::PI;

use super::scene::Scene;
use super::truth::TrueEvent;

/// Number of unknowns.
const UNKNOWNS: usize = 5;
/// Loading rate, `Fs`, `Fp`, `omega`: places of the unknowns after `t0`.
const RATE: usize = 1;
const STATIC: usize = 2;
const DYNAMIC: usize = 3;
const OMEGA: usize = 4;

type Vector = [f64; UNKNOWNS];
type Matrix = [Vector; UNKNOWNS];

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

    /// Derivatives of the force at a time by the five unknowns.
    #[must_use]
    pub fn gradient(&self, time_s: f64) -> [f64; 5] {
        let t = time_s - self.onset_s;
        let rate = self.loading_rate_n_per_s;
        if t < 0.0 {
            [-rate, t, 1.0, 0.0, 0.0]
        } else if t < self.slip_s() {
            self.slip_gradient(t)
        } else {
            self.rest_gradient(t)
        }
    }

    fn slip_gradient(&self, t: f64) -> Vector {
        let (a, b, _) = self.axes();
        let omega = self.omega_rad_per_s;
        let (sin, cos) = (omega * t).sin_cos();
        let turn = b * cos - a * sin;
        [-omega * turn, sin / omega, cos, 1.0 - cos, t * turn - b / omega * sin]
    }

    fn rest_gradient(&self, t: f64) -> Vector {
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

    /// The bound for samples at `times_s` with white noise of `noise_n`, all five
    /// unknown; `None` where the samples cannot tell them apart.
    #[must_use]
    pub fn bound(&self, times_s: impl Iterator<Item = f64>, noise_n: f64) -> Option<ForceBound> {
        let covariance = inverse(self.fisher(times_s))?;
        Some(Self::forces(&covariance, noise_n))
    }

    /// The bound with `k w` and `omega` known from elsewhere.
    #[must_use]
    pub fn bound_with_known_rate(
        &self,
        times_s: impl Iterator<Item = f64>,
        noise_n: f64,
    ) -> Option<ForceBound> {
        let mut fisher = self.fisher(times_s);
        // What is known has no connection with the rest.
        let known = |i: usize| i == RATE || i == OMEGA;
        for (i, row) in fisher.iter_mut().enumerate() {
            for (j, cell) in row.iter_mut().enumerate().filter(|(j, _)| known(i) || known(*j)) {
                *cell = if i == j { 1.0 } else { 0.0 };
            }
        }
        Some(Self::forces(&inverse(fisher)?, noise_n))
    }

    fn fisher(&self, times_s: impl Iterator<Item = f64>) -> Matrix {
        let mut fisher = [[0.0; UNKNOWNS]; UNKNOWNS];
        for gradient in times_s.map(|t| self.gradient(t)) {
            for (row, g) in fisher.iter_mut().zip(gradient) {
                for (cell, h) in row.iter_mut().zip(gradient) {
                    *cell += g * h;
                }
            }
        }
        fisher
    }

    fn forces(covariance: &Matrix, noise_n: f64) -> ForceBound {
        ForceBound {
            static_n: noise_n * covariance[STATIC][STATIC].sqrt(),
            dynamic_n: noise_n * covariance[DYNAMIC][DYNAMIC].sqrt(),
        }
    }
}

/// Inverse of a symmetric positive definite matrix, by Gauss-Jordan on the
/// matrix scaled to ones on its diagonal; `None` if it is singular.
fn inverse(matrix: Matrix) -> Option<Matrix> {
    let mut scale = [0.0; UNKNOWNS];
    for (i, s) in scale.iter_mut().enumerate() {
        if matrix[i][i] <= 0.0 {
            return None;
        }
        *s = matrix[i][i].sqrt().recip();
    }
    let mut left = matrix;
    let mut right = [[0.0; UNKNOWNS]; UNKNOWNS];
    for i in 0..UNKNOWNS {
        for j in 0..UNKNOWNS {
            left[i][j] *= scale[i] * scale[j];
        }
        right[i][i] = 1.0;
    }
    for i in 0..UNKNOWNS {
        // Pivots are what the unknowns before leave: no exchange is needed.
        let pivot = left[i][i];
        if pivot < 1e-13 {
            return None;
        }
        for j in 0..UNKNOWNS {
            left[i][j] /= pivot;
            right[i][j] /= pivot;
        }
        for other in (0..UNKNOWNS).filter(|&other| other != i) {
            let factor = left[other][i];
            for j in 0..UNKNOWNS {
                left[other][j] -= factor * left[i][j];
                right[other][j] -= factor * right[i][j];
            }
        }
    }
    for i in 0..UNKNOWNS {
        for j in 0..UNKNOWNS {
            right[i][j] *= scale[i] * scale[j];
        }
    }
    Some(right)
}

/// Sets the bounds of the events of a linear scene with white noise; leaves the
/// others without.
pub fn set_bounds(scene: &Scene, events: &mut [TrueEvent]) {
    let noise_n = scene.measurement.white_n;
    if noise_n <= 0.0 || !scene.is_linear() {
        return;
    }
    let onsets: Vec<f64> = events.iter().map(|e| e.onset_s).collect();
    let force_of_one = |e: &TrueEvent| e.weight_n * scene.slope_rad().cos();
    for (i, event) in events.iter_mut().enumerate().filter(|(_, e)| !e.slack) {
        let linear = LinearEvent {
            onset_s: event.onset_s,
            loading_rate_n_per_s: event.loading_rate_n_per_s,
            static_force_n: event.static_force_n,
            dynamic_force_n: event.dynamic_force_n,
            omega_rad_per_s: event.omega_rad_per_s,
        };
        let end_s = onsets.get(i + 1).copied().unwrap_or(scene.duration_s);
        let first = ((event.onset_s - event.stick_s).max(0.0) * scene.rate_hz).ceil() as u64;
        let last = (end_s * scene.rate_hz).ceil() as u64;
        let times_s = (first..last.min(scene.sample_count())).map(|n| n as f64 / scene.rate_hz);
        if let Some(bound) = linear.bound(times_s, noise_n) {
            event.mu_s_bound = Some(bound.static_n / force_of_one(event));
            event.mu_bound = Some(bound.dynamic_n / force_of_one(event));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dff8_13() -> LinearEvent {
        LinearEvent {
            onset_s: 0.0,
            loading_rate_n_per_s: 360.0,
            static_force_n: 1.24 * 630.0,
            dynamic_force_n: 0.78 * 630.0,
            omega_rad_per_s: (23_000.0_f64 / (630.0 / 9.81)).sqrt(),
        }
    }

    /// Root-mean-square of the bounds over sampling phases, in units of sigma:
    /// `Fs`, `Fp`, and `Fs` with rate and omega known.
    fn mean_bounds(event: LinearEvent) -> (f64, f64, f64) {
        let phases = 64;
        let (mut squares, mut known) = ((0.0, 0.0), 0.0);
        for phase in 0..phases {
            let shift = f64::from(phase) / f64::from(phases) / 16.0;
            let end = event.slip_s() + event.stick_s();
            let first = ((-event.stick_s() - shift) * 16.0).ceil() as i64;
            let last = ((end - shift) * 16.0).floor() as i64;
            let times = || (first..=last).map(|n| n as f64 / 16.0 + shift);
            let bound = event.bound(times(), 1.0).unwrap();
            squares.0 += bound.static_n.powi(2);
            squares.1 += bound.dynamic_n.powi(2);
            known += event.bound_with_known_rate(times(), 1.0).unwrap().static_n.powi(2);
        }
        let root = |square: f64| (square / f64::from(phases)).sqrt();
        (root(squares.0), root(squares.1), root(known))
    }

    #[test]
    fn gradients_are_derivatives() {
        let event = dff8_13();
        let force = |e: &LinearEvent, time_s: f64| {
            let t = time_s - e.onset_s;
            let (a, b, _) = e.axes();
            let (sin, cos) = (e.omega_rad_per_s * t).sin_cos();
            if t < 0.0 {
                e.static_force_n + e.loading_rate_n_per_s * t
            } else if t < e.slip_s() {
                e.dynamic_force_n + a * cos + b * sin
            } else {
                let rest_n = 2.0 * e.dynamic_force_n - e.static_force_n;
                rest_n + e.loading_rate_n_per_s * (t - e.slip_s())
            }
        };
        for time_s in [-1.0, -0.1, 0.03, 0.09, 0.15, 0.3, 1.2] {
            let gradient = event.gradient(time_s);
            for (i, analytic) in gradient.into_iter().enumerate() {
                let moved = |h: f64| {
                    let mut e = event;
                    match i {
                        0 => e.onset_s += h,
                        RATE => e.loading_rate_n_per_s += h,
                        STATIC => e.static_force_n += h,
                        DYNAMIC => e.dynamic_force_n += h,
                        _ => e.omega_rad_per_s += h,
                    }
                    force(&e, time_s)
                };
                let h = 1e-5;
                let numeric = (moved(h) - moved(-h)) / (2.0 * h);
                let tolerance = 1e-5 * (1.0 + analytic.abs());
                assert!(
                    (numeric - analytic).abs() < tolerance,
                    "{time_s} {i}: {numeric} {analytic}"
                );
            }
        }
    }

    #[test]
    fn bounds_agree_with_the_published_figures_of_the_model() {
        let (static_n, dynamic_n, known_n) = mean_bounds(dff8_13());
        println!("DFF8-13: mu_s {static_n:.3}, mu {dynamic_n:.3}, known {known_n:.3} sigma/Mg");
        assert!((static_n - 0.32).abs() < 0.02 && (dynamic_n - 0.14).abs() < 0.01);
        assert!((known_n - 0.20).abs() < 0.01);
    }

    #[test]
    fn a_slip_without_samples_has_no_bound() {
        let event = dff8_13();
        let times = [-1.0, -0.5, -0.01, 0.2, 0.5, 1.0].into_iter();
        assert_eq!(event.bound(times, 1.0), None);
    }
}
