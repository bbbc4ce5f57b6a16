//! What the block and the cable are doing, and the pieces of a test.

use serde::{Deserialize, Serialize};

/// What the block and the cable are doing.
///
/// ```text
///            F = Fs                 F = 0
///   Stick ───────────► Slip ◄────────────────► SlackSliding
///     ▲  ◄─────────────  │       taut again         │ v = 0
///     │      v = 0                                  ▼
///     └───────────────── taut again ────────── SlackStuck
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
    /// Way of the block since the start `x`, m.
    pub position_m: f64,
}

/// Why a piece of motion ended.
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
    /// Nothing happened: a parameter changes here, or the piece is only a part.
    Continue,
}

/// What holds while a piece of motion lasts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mechanics {
    /// Mass of the block `M`, kg.
    pub mass_kg: f64,
    /// Stiffness `k`, N/m.
    pub stiffness_n_per_m: f64,
    /// Take-up speed `w`, m/s, not below zero.
    pub winch_m_per_s: f64,
    /// Force that starts a slip `Fs`, N.
    pub static_force_n: f64,
    /// Force that balances sliding friction and slope `Fp`, N.
    pub dynamic_force_n: f64,
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
}
