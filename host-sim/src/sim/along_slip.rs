//! Friction that changes along each slip.

use serde::{Deserialize, Serialize};

use super::check::{SceneError, between, not_below};

/// `mu (1 + fraction cos(2 pi s / length_m))`, `s` the distance slid since the onset.
/// The truth's `mu` is the average over the distance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AlongSlip {
    /// Amplitude over `mu`, -0.5 to 0.5.
    pub fraction: f64,
    /// Wave length, m, at least 1e-5.
    pub length_m: f64,
}

impl AlongSlip {
    pub(super) fn validate(&self) -> Result<(), SceneError> {
        between("along_slip.fraction", self.fraction, -0.5, 0.5)?;
        not_below("along_slip.length_m", self.length_m, 1e-5)
    }

    /// Coefficient over its value without this term, after a distance slid.
    #[must_use]
    pub fn factor(&self, slid_m: f64) -> f64 {
        1.0 + self.fraction * (std::f64::consts::TAU * slid_m / self.length_m).cos()
    }
}
