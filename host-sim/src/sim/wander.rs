//! Friction that wanders in the course of a test.

use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use serde::{Deserialize, Serialize};

use super::check::{SceneError, between, positive};

/// Both coefficients times `1 + y`, `y` a normal process that remembers: its correlation
/// falls by `e` over so many events.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Wander {
    /// Standard deviation of `y`, 0 to 0.2.
    pub fraction: f64,
    /// Events over which it is remembered.
    pub events: f64,
}

impl Wander {
    pub(super) fn validate(&self) -> Result<(), SceneError> {
        between("wander.fraction", self.fraction, 0.0, 0.2)?;
        positive("wander.events", self.events)
    }

    /// The value after another one; `None` at the start.
    pub(super) fn next(&self, before: Option<f64>, random: &mut ChaCha8Rng) -> f64 {
        let z: f64 = StandardNormal.sample(random);
        let kept = before.map_or(0.0, |_| (-1.0 / self.events).exp());
        let fresh = (1.0 - kept * kept).sqrt() * self.fraction;
        // Friction stays friction.
        (kept * before.unwrap_or(0.0) + fresh * z).max(-0.9)
    }
}
