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
//! When the block stops on a slack cable, (7) holds until it reaches zero, at the
//! speed `v0`; then `F = 0` until the winch has taken up what the block slid on,
//! `v0² M / (2 Fp w)` later, and `F = k w (t - t1)` from there on. The mass is known,
//! so this time belongs to the same five unknowns.
//!
//! The gradients are these formulas' own; the Fisher matrix is their sum of
//! squares over the samples. Aperture, steps and faults are not in it.

use std::f64::consts::PI;

use floe_core::units::STANDARD_GRAVITY_M_PER_S2 as GRAVITY_M_PER_S2;

use super::scene::Scene;
use super::truth::TrueEvent;

/// Number of unknowns.
pub(super) const UNKNOWNS: usize = 5;
/// Loading rate, `Fs`, `Fp`, `omega`: places of the unknowns after `t0`.
pub(super) const RATE: usize = 1;
const STATIC: usize = 2;
const DYNAMIC: usize = 3;
pub(super) const OMEGA: usize = 4;

pub(super) type Matrix<const N: usize = UNKNOWNS> = [[f64; N]; N];

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

/// An event whose block stops on a slack cable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlackEvent {
    /// Up to the slack; its re-stick does not happen.
    pub taut: LinearEvent,
    /// Mass of the block, kg.
    pub mass_kg: f64,
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

    /// The bound for samples at `times_s` with white noise of `noise_n`, all five
    /// unknown; `None` where the samples cannot tell them apart.
    #[must_use]
    pub fn bound(&self, times_s: impl Iterator<Item = f64>, noise_n: f64) -> Option<ForceBound> {
        let fisher = fisher(times_s.map(|t| self.gradient(t)));
        Some(ForceBound::new(&inverse(fisher)?, noise_n))
    }

    /// The bound with `k w` and `omega` known from elsewhere.
    #[must_use]
    pub fn bound_with_known_rate(
        &self,
        times_s: impl Iterator<Item = f64>,
        noise_n: f64,
    ) -> Option<ForceBound> {
        let mut fisher = fisher(times_s.map(|t| self.gradient(t)));
        // What is known has no connection with the rest.
        let known = |i: usize| i == RATE || i == OMEGA;
        for (i, row) in fisher.iter_mut().enumerate() {
            for (j, cell) in row.iter_mut().enumerate().filter(|(j, _)| known(i) || known(*j)) {
                *cell = if i == j { 1.0 } else { 0.0 };
            }
        }
        Some(ForceBound::new(&inverse(fisher)?, noise_n))
    }
}

impl SlackEvent {
    /// Times from the onset until the force reaches zero and until it rises
    /// again, s; `None` if it does not reach zero.
    fn slack_s(&self) -> Option<(f64, f64)> {
        let LinearEvent { loading_rate_n_per_s, dynamic_force_n, omega_rad_per_s, .. } = self.taut;
        let (a, b, square) = self.taut.axes();
        let under = square - dynamic_force_n * dynamic_force_n;
        if under < 0.0 {
            return None;
        }
        let angle = b.atan2(a) + PI - under.sqrt().atan2(dynamic_force_n);
        let stiffness = omega_rad_per_s * omega_rad_per_s * self.mass_kg;
        let winch = loading_rate_n_per_s / stiffness;
        let speed = winch + omega_rad_per_s * under.sqrt() / stiffness;
        let starts_s = angle / omega_rad_per_s;
        let lasts_s = speed * speed * self.mass_kg / (2.0 * dynamic_force_n * winch);
        Some((starts_s, starts_s + lasts_s))
    }

    /// The event with one unknown moved.
    fn moved(mut self, unknown: usize, by: f64) -> Self {
        let taut = &mut self.taut;
        match unknown {
            RATE => taut.loading_rate_n_per_s += by,
            STATIC => taut.static_force_n += by,
            DYNAMIC => taut.dynamic_force_n += by,
            OMEGA => taut.omega_rad_per_s += by,
            _ => taut.onset_s += by,
        }
        self
    }

    /// Derivatives of the time at which the force rises again, by central
    /// differences: of seconds after the onset, which does not depend on it.
    fn rise_gradient(&self) -> Option<[f64; UNKNOWNS]> {
        let e = &self.taut;
        let scales =
            [1.0, e.loading_rate_n_per_s, e.static_force_n, e.dynamic_force_n, e.omega_rad_per_s];
        let mut gradient = [0.0; UNKNOWNS];
        for (i, (slot, scale)) in gradient.iter_mut().zip(scales).enumerate() {
            let h = 1e-6 * scale;
            let rise = |by: f64| self.moved(i, by).slack_s().map(|slack| slack.1);
            *slot = (rise(h)? - rise(-h)?) / (2.0 * h);
        }
        Some(gradient)
    }

    /// Derivatives of the force at times by the five unknowns.
    fn gradients(
        &self,
        times_s: impl Iterator<Item = f64>,
    ) -> Option<impl Iterator<Item = [f64; UNKNOWNS]>> {
        let (starts_s, rises_s) = self.slack_s()?;
        let rise = self.rise_gradient()?;
        let (taut, rate) = (self.taut, self.taut.loading_rate_n_per_s);
        Some(times_s.map(move |time_s| {
            let t = time_s - taut.onset_s;
            if t < 0.0 {
                return taut.gradient(time_s);
            }
            if t < starts_s {
                return taut.slip_gradient(t);
            }
            if t < rises_s {
                return [0.0; UNKNOWNS];
            }
            let mut gradient = rise.map(|d| -rate * d);
            gradient[0] -= rate;
            gradient[RATE] += t - rises_s;
            gradient
        }))
    }

    /// As [`LinearEvent::bound`].
    #[must_use]
    pub fn bound(&self, times_s: impl Iterator<Item = f64>, noise_n: f64) -> Option<ForceBound> {
        Some(ForceBound::new(&inverse(fisher(self.gradients(times_s)?))?, noise_n))
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

/// Sum of the products of the gradients at the samples.
pub(super) fn fisher(gradients: impl Iterator<Item = [f64; UNKNOWNS]>) -> Matrix {
    let mut fisher = [[0.0; UNKNOWNS]; UNKNOWNS];
    for gradient in gradients {
        for (row, g) in fisher.iter_mut().zip(gradient) {
            for (cell, h) in row.iter_mut().zip(gradient) {
                *cell += g * h;
            }
        }
    }
    fisher
}

/// Inverse of a symmetric positive definite matrix, by Gauss-Jordan on the
/// matrix scaled to ones on its diagonal; `None` if it is singular.
pub(super) fn inverse<const N: usize>(matrix: Matrix<N>) -> Option<Matrix<N>> {
    let mut scale = [0.0; N];
    for (i, s) in scale.iter_mut().enumerate() {
        if matrix[i][i] <= 0.0 {
            return None;
        }
        *s = matrix[i][i].sqrt().recip();
    }
    let mut left = matrix;
    let mut right = [[0.0; N]; N];
    for i in 0..N {
        for j in 0..N {
            left[i][j] *= scale[i] * scale[j];
        }
        right[i][i] = 1.0;
    }
    for i in 0..N {
        // Pivots are what the unknowns before leave: no exchange is needed.
        let pivot = left[i][i];
        if pivot < 1e-13 {
            return None;
        }
        for j in 0..N {
            left[i][j] /= pivot;
            right[i][j] /= pivot;
        }
        for other in (0..N).filter(|&other| other != i) {
            let factor = left[other][i];
            for j in 0..N {
                left[other][j] -= factor * left[i][j];
                right[other][j] -= factor * right[i][j];
            }
        }
    }
    for i in 0..N {
        for j in 0..N {
            right[i][j] *= scale[i] * scale[j];
        }
    }
    Some(right)
}

/// Sets the bounds of the events of a scene with white noise that is linear and
/// stays the same; leaves the others without.
pub fn set_bounds(scene: &Scene, events: &mut [TrueEvent]) {
    let noise_n = scene.measurement.white_n;
    let changes = scene.winch_profile.is_some() || scene.breaking.is_some();
    if noise_n <= 0.0 || changes || !scene.is_linear() {
        return;
    }
    let onsets: Vec<f64> = events.iter().map(|e| e.onset_s).collect();
    for (i, event) in events.iter_mut().enumerate() {
        let end_s = onsets.get(i + 1).copied().unwrap_or(scene.duration_s);
        let first = ((event.onset_s - event.stick_s).max(0.0) * scene.rate_hz).ceil() as u64;
        let last = (end_s * scene.rate_hz).ceil() as u64;
        let times_s = (first..last.min(scene.sample_count())).map(|n| n as f64 / scene.rate_hz);
        if let Some(bound) = event_bound(scene, event, times_s) {
            let force_of_one_n = event.weight_n * scene.slope_rad().cos();
            event.mu_s_bound = Some(bound.static_n / force_of_one_n);
            event.mu_bound = Some(bound.dynamic_n / force_of_one_n);
        }
    }
}

/// `None` also for a cable that is taut again while the block still moves.
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

#[cfg(test)]
mod tests {
    use super::*;

    fn dff8_13() -> LinearEvent {
        LinearEvent {
            onset_s: 0.0,
            loading_rate_n_per_s: 360.0,
            static_force_n: 1.24 * 630.0,
            dynamic_force_n: 0.78 * 630.0,
            omega_rad_per_s: (23_000.0_f64 / (630.0 / 9.806_65)).sqrt(),
        }
    }

    fn slack() -> SlackEvent {
        let (static_force_n, dynamic_force_n) = (630.0, 252.0);
        SlackEvent {
            taut: LinearEvent { static_force_n, dynamic_force_n, ..dff8_13() },
            mass_kg: 630.0 / 9.806_65,
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

    /// The model of the header on its own, by the unknowns in their order; with
    /// a mass, of a block that stops on a slack cable.
    fn force_n(unknowns: &[f64; 5], mass_kg: Option<f64>, time_s: f64) -> f64 {
        let [onset_s, rate, fs, fp, omega] = *unknowns;
        let t = time_s - onset_s;
        let (a, b) = (fs - fp, rate / omega);
        let slip_s = 2.0 / omega * (PI - a.atan2(b));
        let slip_n = |t: f64| fp + a * (omega * t).cos() + b * (omega * t).sin();
        let Some(mass_kg) = mass_kg else {
            let rest_n = 2.0 * fp - fs + rate * (t - slip_s);
            return if t < 0.0 {
                fs + rate * t
            } else if t < slip_s {
                slip_n(t)
            } else {
                rest_n
            };
        };
        // Where the force is zero, by bisection up to its lowest point.
        let (mut low, mut high) = (0.0, PI / omega);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if slip_n(middle) > 0.0 { low = middle } else { high = middle }
        }
        let winch = rate / (omega * omega * mass_kg);
        let falling = omega * (-a * (omega * low).sin() + b * (omega * low).cos());
        let speed = winch - falling / (omega * omega * mass_kg);
        let deceleration = fp / mass_kg;
        let stop_s = speed / deceleration;
        let slack_m = 0.5 * deceleration * stop_s * stop_s - winch * stop_s;
        let rises_s = low + stop_s + slack_m / winch;
        if t < 0.0 {
            fs + rate * t
        } else if t < low {
            slip_n(t)
        } else {
            (rate * (t - rises_s)).max(0.0)
        }
    }

    /// Compares a gradient with differences of the model.
    fn assert_derivatives(event: &LinearEvent, mass_kg: Option<f64>, time_s: f64, found: [f64; 5]) {
        let (rate, omega) = (event.loading_rate_n_per_s, event.omega_rad_per_s);
        let unknowns = [event.onset_s, rate, event.static_force_n, event.dynamic_force_n, omega];
        for (i, analytic) in found.into_iter().enumerate() {
            let moved = |h: f64| {
                let mut unknowns = unknowns;
                unknowns[i] += h;
                force_n(&unknowns, mass_kg, time_s)
            };
            let h = 1e-5;
            let numeric = (moved(h) - moved(-h)) / (2.0 * h);
            let close = (numeric - analytic).abs() < 1e-5 * (1.0 + analytic.abs());
            assert!(close, "{time_s} {i}: {numeric} {analytic}");
        }
    }

    #[test]
    fn gradients_are_derivatives() {
        let (taut, slack) = (dff8_13(), slack());
        let times_s = [-1.0, -0.1, 0.03, 0.09, 0.15, 0.3, 0.85, 1.2, 2.0, 3.0];
        for (time_s, of_slack) in
            times_s.into_iter().zip(slack.gradients(times_s.into_iter()).unwrap())
        {
            assert_derivatives(&taut, None, time_s, taut.gradient(time_s));
            assert_derivatives(&slack.taut, Some(slack.mass_kg), time_s, of_slack);
        }
        assert!(slack.slack_s().unwrap().1 < 2.0, "the last times must be on the line after");
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
