//! One event of a replay.

use floe_core::{Coefficient, Event, Losses};
use serde::{Deserialize, Serialize};

use super::numbers::{short, short_or_null, short_pair};
use super::{known, pair};

/// One event.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct EventSummary {
    /// From 0.
    pub index: u32,
    /// In the log's own time, between samples.
    pub onset_s: f64,
    /// In the log's own time, between samples.
    pub stop_s: f64,
    /// `Fs`.
    #[serde(with = "short")]
    pub static_force_n: f64,
    /// `Fp`.
    #[serde(with = "short")]
    pub dynamic_force_n: f64,
    /// Largest force.
    #[serde(with = "short")]
    pub peak_force_n: f64,
    /// `Fe`.
    #[serde(with = "short")]
    pub restick_force_n: f64,
    /// Static coefficient.
    #[serde(with = "short_or_null")]
    pub mu_s: Option<f64>,
    /// One standard deviation, the random part alone.
    #[serde(with = "short_or_null")]
    pub mu_s_std: Option<f64>,
    /// Dynamic coefficient.
    #[serde(with = "short_or_null")]
    pub mu: Option<f64>,
    /// One standard deviation, the random part alone.
    #[serde(with = "short_or_null")]
    pub mu_std: Option<f64>,
    /// Time of rest before the onset.
    #[serde(with = "short_or_null")]
    pub stick_s: Option<f64>,
    /// Time of motion.
    #[serde(with = "short")]
    pub slip_s: f64,
    /// `k w`.
    #[serde(with = "short")]
    pub loading_rate_n_per_s: f64,
    /// Natural frequency.
    #[serde(with = "short_or_null")]
    pub omega_rad_per_s: Option<f64>,
    /// Whether the cable went slack.
    pub slack: bool,
    /// `good`, `unresolved`, `slack` or `clipped`.
    pub quality: String,
    /// Why a coefficient is missing.
    pub reason: Option<String>,
    /// Systematic standard deviation of `mu_s`: the part common to all events.
    #[serde(with = "short_or_null")]
    pub mu_s_systematic_std: Option<f64>,
    /// Systematic standard deviation of `mu`.
    #[serde(with = "short_or_null")]
    pub mu_systematic_std: Option<f64>,
    /// Random and systematic part of `mu_s` combined.
    #[serde(with = "short_or_null")]
    pub mu_s_combined_std: Option<f64>,
    /// Random and systematic part of `mu` combined.
    #[serde(with = "short_or_null")]
    pub mu_combined_std: Option<f64>,
    /// The 95 % interval of `mu_s`.
    #[serde(with = "short_pair")]
    pub mu_s_ci95: Option<[f64; 2]>,
    /// The 95 % interval of `mu`.
    #[serde(with = "short_pair")]
    pub mu_ci95: Option<[f64; 2]>,
    /// How far the block slid, m.
    #[serde(with = "short_or_null")]
    pub slip_length_m: Option<f64>,
    /// Work against the friction, J.
    #[serde(with = "short_or_null")]
    pub energy_j: Option<f64>,
    /// When the slip began, ISO 8601 (UTC) to the millisecond; `null` when the log has no date.
    pub onset_time: Option<String>,
    /// One standard deviation of the slip length, random and systematic part combined.
    #[serde(with = "short_or_null")]
    pub slip_length_m_std: Option<f64>,
    /// One standard deviation of the energy, random and systematic part combined.
    #[serde(with = "short_or_null")]
    pub energy_j_std: Option<f64>,
}

impl EventSummary {
    /// An event with its times in the log's seconds.
    #[must_use]
    pub fn new(event: &Event, onset_s: f64, stop_s: f64) -> Self {
        let mut summary = Self {
            index: event.index,
            onset_s,
            stop_s,
            static_force_n: f64::from(event.static_force_n),
            dynamic_force_n: f64::from(event.dynamic_force_n),
            peak_force_n: f64::from(event.peak_force_n),
            restick_force_n: f64::from(event.restick_force_n),
            mu_s: known(event.mu_s.map(|c| c.value)),
            mu_s_std: known(event.mu_s.map(|c| c.std)),
            mu: known(event.mu.map(|c| c.value)),
            mu_std: known(event.mu.map(|c| c.std)),
            stick_s: known(event.stick_s),
            slip_s: f64::from(event.slip_s),
            loading_rate_n_per_s: f64::from(event.loading_rate_n_per_s),
            omega_rad_per_s: known(event.omega_rad_per_s),
            slack: event.slack,
            quality: event.quality.to_string(),
            reason: event.reason.map(|reason| reason.to_string()),
            ..Self::default()
        };
        summary.set_uncertainties([event.mu_s, event.mu]);
        summary
    }

    /// Applies the losses of the cable to an event that has none, and a drift of the zero (a
    /// standard deviation in units of the coefficients) where the event has a smaller one.
    pub fn put_on(&mut self, losses: Losses, drift_std: f32) {
        let coefficients = losses.put_on([
            coefficient(self.mu_s, self.mu_s_std, self.mu_s_systematic_std),
            coefficient(self.mu, self.mu_std, self.mu_systematic_std),
        ]);
        self.set_uncertainties(coefficients.map(|it| it.map(|it| may_have_drifted(it, drift_std))));
    }

    /// Sets the systematic and combined uncertainties of the coefficients that are known.
    fn set_uncertainties(&mut self, [mu_s, mu]: [Option<Coefficient>; 2]) {
        if let Some(it) = mu_s {
            self.mu_s_systematic_std = known(Some(it.systematic_std));
            self.mu_s_combined_std = known(Some(it.combined_std()));
            self.mu_s_ci95 = pair(Some(it.ci95()));
        }
        if let Some(it) = mu {
            self.mu_systematic_std = known(Some(it.systematic_std));
            self.mu_combined_std = known(Some(it.combined_std()));
            self.mu_ci95 = pair(Some(it.ci95()));
        }
    }

    /// Whether the event deserves a remark.
    #[must_use]
    pub fn is_odd(&self) -> bool {
        self.reason.is_some() || self.quality != "good"
    }
}

fn may_have_drifted(it: Coefficient, std: f32) -> Coefficient {
    let known_std = it.systematic_std;
    let systematic_std = if known_std < std { known_std.hypot(std) } else { known_std };
    Coefficient { systematic_std, ..it }
}

fn coefficient(
    value: Option<f64>,
    std: Option<f64>,
    systematic: Option<f64>,
) -> Option<Coefficient> {
    let [value, std, systematic_std] = [value?, std?, systematic?].map(|it| it as f32);
    Some(Coefficient { value, std, systematic_std })
}
