//! Lag of a load cell or of its amplifier.

use serde::{Deserialize, Serialize};

use super::check::{SceneError, not_below};

/// First-order lag: `T y' = F - y`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lag {
    /// Time constant `T`, s, at least 1e-5.
    pub time_s: f64,
}

impl Lag {
    pub(super) fn validate(&self) -> Result<(), SceneError> {
        not_below("measurement.lag.time_s", self.time_s, 1e-5)
    }
}

/// Output of the cell at the latest time requested.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lagging {
    pub(super) law: Lag,
    pub(super) at_s: f64,
    value_n: Option<f64>,
}

impl Lagging {
    pub(super) fn new(law: Lag) -> Self {
        Self { law, at_s: 0.0, value_n: None }
    }

    /// Advances to a later time: `weighted` is the weighted integral of the force over the
    /// interval, `now_n` the force at its end. At the start the cell has settled.
    pub(super) fn advance(
        &mut self,
        to_s: f64,
        now_n: f64,
        weighted: impl FnOnce(f64, &dyn Fn(f64) -> f64) -> f64,
    ) -> f64 {
        let time_s = self.law.time_s;
        let from_s = self.at_s;
        let value_n = match self.value_n {
            None => now_n,
            Some(before_n) => {
                let weight = |t: f64| (-(to_s - t) / time_s).exp() / time_s;
                before_n * (-(to_s - from_s) / time_s).exp() + weighted(from_s, &weight)
            }
        };
        (self.at_s, self.value_n) = (to_s, Some(value_n));
        value_n
    }
}
