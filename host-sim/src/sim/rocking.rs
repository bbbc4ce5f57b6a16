//! A block that rocks while it slips.

use serde::{Deserialize, Serialize};

use super::check::{SceneError, above_zero, between};

/// The pressure on the ice, and with it the friction, oscillates while the block slips: a factor
/// `1 + fraction sin(ratio omega t)`, `t` from the onset. The truth's `mu` is the average over the
/// distance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rocking {
    /// Amplitude, 0 to 0.5.
    pub fraction: f64,
    /// Frequency over the natural frequency of the block on its cable, at most 1000.
    pub ratio: f64,
}

impl Rocking {
    pub(super) fn validate(&self) -> Result<(), SceneError> {
        between("rocking.fraction", self.fraction, 0.0, 0.5)?;
        above_zero("rocking.ratio", self.ratio, 1000.0)
    }

    /// Friction over its value without this term.
    #[must_use]
    pub fn factor(&self, omega_rad_per_s: f64, since_onset_s: f64) -> f64 {
        1.0 + self.fraction * (self.ratio * omega_rad_per_s * since_onset_s).sin()
    }
}
