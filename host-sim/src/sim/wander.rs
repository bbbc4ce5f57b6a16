//! Friction that drifts at random in the course of a test.

use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use serde::{Deserialize, Serialize};

use super::check::{SceneError, between, positive};

/// Factor `1 + y` on both coefficients, `y` a stationary Gaussian process whose correlation falls
/// by `e` over `events` events.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Wander {
    /// Standard deviation of `y`, 0 to 0.2.
    pub fraction: f64,
    /// Correlation length in events.
    pub events: f64,
}

impl Wander {
    pub(super) fn validate(&self) -> Result<(), SceneError> {
        between("wander.fraction", self.fraction, 0.0, 0.2)?;
        positive("wander.events", self.events)
    }

    /// The value after `before`; `None` at the start.
    pub(super) fn next(&self, before: Option<f64>, random: &mut ChaCha8Rng) -> f64 {
        let z: f64 = StandardNormal.sample(random);
        let kept = before.map_or(0.0, |_| (-1.0 / self.events).exp());
        let fresh = (1.0 - kept * kept).sqrt() * self.fraction;
        // Keeps the coefficients positive.
        (kept * before.unwrap_or(0.0) + fresh * z).max(-0.9)
    }
}
