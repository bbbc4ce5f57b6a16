//! Rate-and-state friction (Dieterich 1979, Ruina 1983).

use serde::{Deserialize, Serialize};

use super::check::{SceneError, between, not_below, positive};

/// `mu(v, θ) = mu + direct ln(v/v0) + evolving ln(v0 θ/D)` with the age of the contacts
/// `θ' = 1 - v θ/D`. The scene's `mu` is the coefficient of steady sliding at `v0`; its `mu_s` has
/// no meaning.
///
/// Below a tenth of the winch's speed the block creeps, with the friction in equilibrium with the
/// force; above that it follows Newton's law, until it slows to half that speed. The onset is
/// smooth: the truth's `mu_s` is the peak of the force over the normal force, its `mu` the average
/// over the distance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RateAndState {
    /// Reference speed `v0`, m/s, at least 1e-12.
    pub reference_m_per_s: f64,
    /// Direct effect `a`.
    pub direct: f64,
    /// Evolution effect `b`.
    pub evolving: f64,
    /// Distance `D` over which the contacts are renewed, m, at least 1e-6.
    pub renewal_m: f64,
}

/// Speeds at which creep becomes a slip and a slip becomes creep, over the winch's speed.
const SLIP: f64 = 0.1;
const REST: f64 = 0.05;

impl RateAndState {
    pub(super) fn validate(&self, mu: f64) -> Result<(), SceneError> {
        not_below("rate_and_state.reference_m_per_s", self.reference_m_per_s, 1e-12)?;
        positive("rate_and_state.direct", self.direct)?;
        not_below("rate_and_state.renewal_m", self.renewal_m, 1e-6)?;
        // Ten factors of e in age or speed must leave the friction above zero.
        between("rate_and_state.direct", self.direct, 1e-4, mu / 20.0)?;
        between("rate_and_state.evolving", self.evolving, 0.0, mu / 10.0)
    }

    /// Speed above which a slip follows Newton's law, m/s.
    #[must_use]
    pub fn slip_m_per_s(&self, winch_m_per_s: f64) -> f64 {
        SLIP * winch_m_per_s
    }

    /// Speed below which a slip becomes creep again, m/s.
    #[must_use]
    pub fn rest_m_per_s(&self, winch_m_per_s: f64) -> f64 {
        REST * winch_m_per_s
    }

    /// Coefficient at a speed and an age of the contacts.
    #[must_use]
    pub fn mu(&self, steady: f64, speed_m_per_s: f64, contact_s: f64) -> f64 {
        // A trial step of the integrator may overshoot.
        let least = 1e-30;
        let speed = (speed_m_per_s / self.reference_m_per_s).max(least).ln();
        steady + self.direct * speed + self.evolving * self.age(contact_s.max(least))
    }

    fn age(&self, contact_s: f64) -> f64 {
        (self.reference_m_per_s * contact_s / self.renewal_m).ln()
    }

    /// Speed at which the friction equals the coefficient `mu`, m/s, at most `most`.
    #[must_use]
    pub fn creep_m_per_s(&self, steady: f64, mu: f64, contact_s: f64, most: f64) -> f64 {
        let age = self.evolving * self.age(contact_s.max(1e-30));
        (self.reference_m_per_s * ((mu - steady - age) / self.direct).exp()).min(most)
    }

    /// Rate of the contacts' age.
    #[must_use]
    pub fn ageing(&self, speed_m_per_s: f64, contact_s: f64) -> f64 {
        1.0 - speed_m_per_s * contact_s / self.renewal_m
    }
}
