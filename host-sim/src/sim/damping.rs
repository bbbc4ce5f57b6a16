//! Losses in the cable.

use serde::{Deserialize, Serialize};

use super::check::{SceneError, between};

/// A dashpot parallel to the spring: the force at the cell is `k s + c (w - v)`, with `s` the
/// stretch and `c = 2 fraction sqrt(k M)`. While the block rests the force is `c w` more than that
/// of the spring.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CableDamping {
    /// Damping over the critical one, 0 to 2.
    pub critical_fraction: f64,
}

impl CableDamping {
    pub(super) fn validate(&self) -> Result<(), SceneError> {
        between("cable_damping.critical_fraction", self.critical_fraction, 0.0, 2.0)
    }

    /// `c`, N s/m.
    #[must_use]
    pub fn n_s_per_m(&self, stiffness_n_per_m: f64, mass_kg: f64) -> f64 {
        2.0 * self.critical_fraction * (stiffness_n_per_m * mass_kg).sqrt()
    }
}
