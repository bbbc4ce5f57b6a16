//! The result of a replay, field by field as in its JSON.
//!
//! Forces in N, times in s, angles in rad. What is unknown is `None` (`null`);
//! every number is finite.

use floe_core::{Counters, Estimate, Event, Report};
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
#[derive(Clone, Debug, Default, Serialize)]
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

impl ReplayResult {
    /// Puts the parts together.
    #[must_use]
    pub fn new(
        log: LogSummary,
        test: TestSummary,
        report: &Report,
        events: Vec<EventSummary>,
    ) -> Self {
        Self {
            schema: SCHEMA,
            log,
            test,
            estimate: EstimateSummary {
                mu_s: report.mu_s.into(),
                mu: report.mu.into(),
                events: report.mu_s.or(report.mu).map_or(0, |estimate| estimate.events.into()),
            },
            noise_n: known(report.noise_n),
            loading_rate_n_per_s: known(report.loading_rate_n_per_s),
            omega_rad_per_s: known(report.omega_rad_per_s),
            stiffness_n_per_m: known(report.stiffness_n_per_m),
            recurrence_s: known(report.recurrence_s),
            events,
        }
    }
}

impl From<Counters> for LogSummary {
    /// Only the counts.
    fn from(counters: Counters) -> Self {
        Self {
            samples: counters.samples,
            missing: counters.missing,
            duplicates: counters.duplicates,
            rejected: counters.rejected,
            saturated: counters.saturated,
            ..Self::default()
        }
    }
}

impl From<Option<Estimate>> for CoefficientSummary {
    fn from(estimate: Option<Estimate>) -> Self {
        Self {
            mean: known(estimate.map(|e| e.mean)),
            std_error: known(estimate.map(|e| e.std_error)),
            spread: known(estimate.and_then(|e| e.spread)),
        }
    }
}

impl EventSummary {
    /// An event with its times in the log's seconds.
    #[must_use]
    pub fn new(event: &Event, onset_s: f64, stop_s: f64) -> Self {
        Self {
            index: event.index,
            onset_s,
            stop_s,
            static_force_n: decimal(event.static_force_n),
            dynamic_force_n: decimal(event.dynamic_force_n),
            peak_force_n: decimal(event.peak_force_n),
            restick_force_n: decimal(event.restick_force_n),
            mu_s: known(event.mu_s.map(|c| c.value)),
            mu_s_std: known(event.mu_s.map(|c| c.std)),
            mu: known(event.mu.map(|c| c.value)),
            mu_std: known(event.mu.map(|c| c.std)),
            stick_s: known(event.stick_s),
            slip_s: decimal(event.slip_s),
            loading_rate_n_per_s: decimal(event.loading_rate_n_per_s),
            omega_rad_per_s: known(event.omega_rad_per_s),
            slack: event.slack,
            quality: event.quality.to_string(),
            reason: event.reason.map(|reason| reason.to_string()),
        }
    }
}

/// The shortest decimal that is this `f32`, as `f64`: 0.78 stays 0.78, and turns
/// back into the same `f32`.
#[must_use]
pub fn decimal(value: f32) -> f64 {
    value.to_string().parse().unwrap_or(f64::NAN)
}

/// A number that is known, which a NaN or an infinity is not.
fn known(value: Option<f32>) -> Option<f64> {
    value.filter(|value| value.is_finite()).map(decimal)
}

#[cfg(test)]
#[allow(clippy::float_cmp)] // exact by construction
mod tests {
    use super::*;

    #[test]
    fn decimals_are_short_and_turn_back() {
        for value in [0.78_f32, 1.0e-7, 12345.678, f32::MAX, f32::MIN_POSITIVE] {
            assert_eq!(decimal(value) as f32, value);
        }
        assert_eq!(decimal(0.78), 0.78);
    }

    #[test]
    fn what_is_not_finite_is_null() {
        assert_eq!(known(Some(f32::NAN)), None);
        assert_eq!(known(Some(f32::INFINITY)), None);
        let text = serde_json::to_string(&decimal(f32::NAN)).unwrap();
        assert_eq!(text, "null");
    }
}
