//! States of block and cable, and the parameters of a phase.

use serde::{Deserialize, Serialize};

use super::terms::HoldTime;

/// State of block and cable.
///
/// ```text
///            F = Fs                 F = 0
///   Stick ───────────► Slip ◄────────────────► SlackSliding
///     ▲  ◄─────────────  │       taut again         │ v = 0
///     │      v = 0                                  ▼
///     └◄──────────────── taut again, paid out ─► SlackStuck
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Phase {
    /// The block rests and the cable is being stretched: `F' = k w` (4).
    Stick,
    /// The block slides on a taut cable: the ellipse (7).
    Slip,
    /// The block slides on a slack cable: `F = 0`.
    SlackSliding,
    /// The block rests while the winch takes up the slack: `F = 0`.
    SlackStuck,
}

impl Phase {
    /// Whether the block moves.
    #[must_use]
    pub fn is_moving(self) -> bool {
        matches!(self, Self::Slip | Self::SlackSliding)
    }
}

/// Mechanical state at one moment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// Time from the start of the record, s.
    pub time_s: f64,
    /// Force in the cable `F`, N, never below zero.
    pub force_n: f64,
    /// Slack in the cable, m, zero while it is taut.
    pub slack_m: f64,
    /// Speed of the block `v`, m/s.
    pub speed_m_per_s: f64,
    /// Distance of the block from the start `x`, m.
    pub position_m: f64,
    /// When the block last came to rest, s.
    pub rest_since_s: f64,
    /// Age of the contacts between block and ice, s, for a law of friction that has one.
    pub contact_s: f64,
}

/// Why a segment of motion ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// The force reached `Fs`.
    Onset,
    /// The block came to rest.
    Stop,
    /// The force reached zero while the block moved.
    Slack,
    /// The slack is taken up.
    Taut,
    /// None of these: a parameter changes here, or the segment is only a part of a phase.
    Continue,
}

/// Parameters that are constant during a segment in closed form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mechanics {
    /// Weight of the block `Mg`, N.
    pub weight_n: f64,
    /// Mass of the block `M`, kg.
    pub mass_kg: f64,
    /// Slope of the ice, rad.
    pub slope_rad: f64,
    /// Stiffness `k`, N/m.
    pub stiffness_n_per_m: f64,
    /// Take-up speed `w`, m/s; negative: the winch pays out.
    pub winch_m_per_s: f64,
    /// Force that starts a slip `Fs`, N, after the reference time of rest.
    pub reference_static_force_n: f64,
    /// Force that balances sliding friction and slope `Fp`, N.
    pub dynamic_force_n: f64,
    /// Dynamic coefficient.
    pub mu: f64,
    /// Dependence of `Fs` on the time of rest, if there is one.
    pub hold: Option<HoldTime>,
}

impl Mechanics {
    /// `omega = sqrt(k/M)`, rad/s.
    #[must_use]
    pub fn omega_rad_per_s(&self) -> f64 {
        (self.stiffness_n_per_m / self.mass_kg).sqrt()
    }

    /// Rate of the force while the block rests, `k w` (4), N/s.
    #[must_use]
    pub fn loading_rate_n_per_s(&self) -> f64 {
        self.stiffness_n_per_m * self.winch_m_per_s
    }

    /// Force that would start a slip at the time of `state`, `Fs`, N.
    #[must_use]
    pub fn static_force_n(&self, state: &State) -> f64 {
        let Some(hold) = self.hold else { return self.reference_static_force_n };
        let rest_s = (state.time_s - state.rest_since_s).max(f64::MIN_POSITIVE);
        let growth = hold.per_decade * (rest_s / hold.reference_s).log10();
        let force_n = self.reference_static_force_n + self.weight_n * self.slope_rad.cos() * growth;
        force_n.max(self.dynamic_force_n)
    }
}
