//! Friction that falls from the static to the dynamic value over a range of speed.

use serde::{Deserialize, Serialize};

use super::check::{SceneError, positive};

/// `mu(v) = mu + (mu_s - mu) exp(-(v / falling_m_per_s)²)`. The onset is smooth: the
/// truth's `mu_s` is the peak of the force over the normal force, its `mu` the average
/// over the distance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stribeck {
    /// Speed over which the friction falls, m/s.
    pub falling_m_per_s: f64,
}

impl Stribeck {
    pub(super) fn validate(&self) -> Result<(), SceneError> {
        positive("stribeck.falling_m_per_s", self.falling_m_per_s)
    }

    /// Share of `mu_s - mu` that remains at a speed.
    #[must_use]
    pub fn left(&self, speed_m_per_s: f64) -> f64 {
        (-(speed_m_per_s / self.falling_m_per_s).powi(2)).exp()
    }
}
