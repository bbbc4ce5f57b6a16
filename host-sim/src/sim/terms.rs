//! Terms of a scene beyond the linear block on a cable. Each is off unless its
//! table is in the scene, and what is off is not computed.

use serde::{Deserialize, Serialize};

use super::check::{SceneError, between, not_below, not_negative, positive};
pub use super::winch::WinchProfile;

/// Snow on the ice: adds to both coefficients.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Snow {
    /// Depth, mm; goes into the log's metadata only.
    pub depth_mm: f64,
    /// Added to `mu_s`.
    pub mu_s_offset: f64,
    /// Added to `mu`.
    pub mu_offset: f64,
}

/// Coefficients that differ from event to event, normally distributed and
/// independent; a draw with `mu_s < mu` or `mu` at or below zero is repeated.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Variation {
    /// Standard deviation of `mu_s` over its mean.
    pub mu_s_fraction: f64,
    /// Standard deviation of `mu` over its mean.
    pub mu_fraction: f64,
}

/// `mu_s` grows with the time of rest `t`:
/// `mu_s(t) = mu_s + per_decade log10(t / reference_s)`, never below `mu`.
///
/// Sukhorukov and Løset's 0.6 at 5 s and 1.26 at 960 s are 0.289 per decade.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HoldTime {
    /// Time of rest at which the scene's `mu_s` holds, s.
    pub reference_s: f64,
    /// Growth over a factor of ten in time.
    pub per_decade: f64,
}

/// `mu(v) = mu + per_decade log10(1 + v / reference)`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RateDependence {
    /// Speed at which the law bends, m/s, at least 1e-12.
    pub reference_m_per_s: f64,
    /// Change over a factor of ten in speed; negative weakens.
    pub per_decade: f64,
}

/// The cable sags: `1/k_eff = 1/k + q² L³/(12 F³)` (Ernst), until the cable
/// lies on the ice at `F = q L²/(8 h)`; below that force, the stiffness stays.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sag {
    /// Weight of the cable per length `q`, N/m.
    pub weight_n_per_m: f64,
    /// Height of the cable's ends above the ice `h`, m.
    pub height_m: f64,
}

/// The block breaks: its weight changes once.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Breaking {
    /// When, s.
    pub at_s: f64,
    /// Weight from then on, N.
    pub weight_n: f64,
}

/// The rafting beam tilts as the block moves up.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tilt {
    /// Change of the slope per way of the block, degrees per metre.
    pub deg_per_m: f64,
}

/// Drag of the water on a block pulled under the ice, or of the air.
/// Ours: the paper leaves it out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Drag {
    /// Force over speed squared, N s²/m².
    pub n_s2_per_m2: f64,
    /// Force over speed, N s/m.
    pub n_s_per_m: f64,
}

/// The block creeps before the slip, at
/// `onset_fraction w exp((F - Fs) / range_n)`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Creep {
    /// Speed at the onset over that of the winch, 0 to below 1.
    pub onset_fraction: f64,
    /// Force below `Fs` over which the creep falls by `e`, N.
    pub range_n: f64,
}

/// Now and then only a part of the contact slips: at `F = Fp + u (Fs - Fp)`, `u`
/// even between 0 and 1, the force drops by a part of `2 (Fs - Fp)`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PartialSlips {
    /// Part of the events that are partial.
    pub probability: f64,
    /// Their drop over that of a full slip (at vanishing winch speed).
    pub drop_fraction: f64,
}

/// The block hangs from a tripod and swings: what a weighing records.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Weighing {
    /// Amplitude at the start, degrees, below 60.
    pub swing_deg: f64,
    /// Length of the pendulum, m.
    pub length_m: f64,
    /// Decay of the swing, 1/s, at most 1000.
    pub damping_per_s: f64,
}

impl HoldTime {
    pub(super) fn validate(&self) -> Result<(), SceneError> {
        positive("hold_time.reference_s", self.reference_s)?;
        not_negative("hold_time.per_decade", self.per_decade)
    }
}

impl RateDependence {
    pub(super) fn validate(&self, mu: f64) -> Result<(), SceneError> {
        not_below("rate_dependence.reference_m_per_s", self.reference_m_per_s, 1e-12)?;
        // Four decades above the reference must leave some friction.
        between("rate_dependence.per_decade", self.per_decade, -mu / 4.0, 10.0)
    }
}
