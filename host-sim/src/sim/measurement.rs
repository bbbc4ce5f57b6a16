//! What lies between the force in the cable and the log.

use serde::{Deserialize, Serialize};

use super::scene::SceneError;
use super::validate::not_negative;

/// Measurement terms, each off unless given.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Measurement {
    /// Standard deviation of white noise on each sample, N.
    pub white_n: f64,
}

impl Measurement {
    pub(super) fn validate(&self) -> Result<(), SceneError> {
        not_negative("measurement.white_n", self.white_n)
    }
}
