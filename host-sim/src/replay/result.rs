//! The result of a replay, field by field as in its JSON.
//!
//! Forces in N, times in s, angles in rad. What is unknown is `None` (`null`);
//! every number is finite.

use serde::Serialize;

/// Name and version of this format; changes when a meaning changes.
pub const SCHEMA: &str = "floe-replay/1";

/// Everything a replay found.
#[derive(Clone, Debug, Serialize)]
pub struct ReplayResult {
    /// [`SCHEMA`].
    pub schema: &'static str,
    /// The log and what happened to its samples.
    pub log: LogSummary,
    /// What was pulled.
    pub test: TestSummary,
    /// The coefficients; `null` fields before the first event.
    pub estimate: EstimateSummary,
    /// Standard deviation of the noise on the force.
    pub noise_n: Option<f64>,
    /// Mean rate of the force at rest.
    pub loading_rate_n_per_s: Option<f64>,
    /// Natural frequency while sliding.
    pub omega_rad_per_s: Option<f64>,
    /// Stiffness of the cable.
    pub stiffness_n_per_m: Option<f64>,
    /// Mean time from onset to onset.
    pub recurrence_s: Option<f64>,
    /// Every event, in order.
    pub events: Vec<EventSummary>,
}

/// The log and what happened to its samples.
#[derive(Clone, Debug, Serialize)]
pub struct LogSummary {
    /// As given on the command line.
    pub path: String,
    /// `csv`, `toa5`, `cr10` or `floe`.
    pub format: String,
    /// Samples per second used.
    pub rate_hz: f64,
    /// Samples read, without duplicates.
    pub samples: u64,
    /// From the first to the last sample.
    pub duration_s: f64,
    /// Sampling periods without a sample.
    pub missing: u64,
    /// Samples whose period was taken already.
    pub duplicates: u64,
    /// Sentinels, NaN and spikes.
    pub rejected: u64,
    /// Samples at the end of the range.
    pub saturated: u64,
    /// What else a reader should know, one sentence each (a truncated last line,
    /// stamps that do not fit the rate, ...).
    pub warnings: Vec<String>,
}

/// What was pulled.
#[derive(Clone, Debug, Serialize)]
pub struct TestSummary {
    /// Name of the test, if the log gives one.
    pub test_id: Option<String>,
    /// Weight of the block.
    pub weight_n: f64,
    /// Slope of the ice, uphill positive.
    pub slope_rad: f64,
}

/// The two coefficients.
#[derive(Clone, Debug, Serialize)]
pub struct EstimateSummary {
    /// Static.
    pub mu_s: CoefficientSummary,
    /// Dynamic.
    pub mu: CoefficientSummary,
    /// Events that count.
    pub events: u64,
}

/// A mean with its uncertainty.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct CoefficientSummary {
    /// Mean over the events.
    pub mean: Option<f64>,
    /// Its standard error, with the variation between events in it.
    pub std_error: Option<f64>,
    /// Standard deviation between events, noise removed.
    pub spread: Option<f64>,
}

/// One event.
#[derive(Clone, Debug, Serialize)]
pub struct EventSummary {
    /// From 0.
    pub index: u32,
    /// In the log's own time, between samples.
    pub onset_s: f64,
    /// In the log's own time, between samples.
    pub stop_s: f64,
    /// `Fs`.
    pub static_force_n: f64,
    /// `Fp`.
    pub dynamic_force_n: f64,
    /// Largest force.
    pub peak_force_n: f64,
    /// `Fe`.
    pub restick_force_n: f64,
    /// Static coefficient.
    pub mu_s: Option<f64>,
    /// One standard deviation.
    pub mu_s_std: Option<f64>,
    /// Dynamic coefficient.
    pub mu: Option<f64>,
    /// One standard deviation.
    pub mu_std: Option<f64>,
    /// Time of rest before the onset.
    pub stick_s: Option<f64>,
    /// Time of motion.
    pub slip_s: f64,
    /// `k w`.
    pub loading_rate_n_per_s: f64,
    /// Natural frequency.
    pub omega_rad_per_s: Option<f64>,
    /// Whether the cable went slack.
    pub slack: bool,
    /// `good`, `unresolved`, `slack` or `clipped`.
    pub quality: String,
    /// Why a coefficient is missing.
    pub reason: Option<String>,
}
