//! The bound of an event whose block stops on a slack cable.

use std::f64::consts::PI;

use super::fisher::{fisher, inverse};
use super::{DYNAMIC, ForceBound, LinearEvent, OMEGA, RATE, STATIC, UNKNOWNS};

/// An event whose block stops on a slack cable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlackEvent {
    /// The event up to the slack; its re-stick does not happen.
    pub taut: LinearEvent,
    /// Mass of the block, kg.
    pub mass_kg: f64,
}

impl SlackEvent {
    /// Times from the onset until the force reaches zero and until it rises
    /// again, s; `None` if it does not reach zero.
    pub(super) fn slack_s(&self) -> Option<(f64, f64)> {
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

    /// The event with one unknown changed.
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

    /// Derivatives of the time, in seconds after the onset, at which the force rises again, by
    /// central differences; the onset time itself has no effect on it.
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

    /// Partial derivatives of the force at times with respect to the five unknowns.
    pub(super) fn gradients(
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

    /// The bound for samples at `times_s` with white noise of `noise_n`; see
    /// [`LinearEvent::bound`].
    #[must_use]
    pub fn bound(&self, times_s: impl Iterator<Item = f64>, noise_n: f64) -> Option<ForceBound> {
        Some(ForceBound::new(&inverse(fisher(self.gradients(times_s)?))?, noise_n))
    }
}
