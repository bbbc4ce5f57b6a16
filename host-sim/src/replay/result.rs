//! The result of a replay; its fields are those of the JSON.
//!
//! Forces in N, times in s, angles in rad. An unknown value is `None` (`null`); every number is
//! finite.

use floe_core::{Config, Counters, Effect, Estimate, Finding, Report};
use serde::Serialize;

mod change;
mod event;
mod numbers;

use super::budget::{BudgetLine, lines};
use super::events::Events;
use super::quantities::Quantities;
use super::stretches::Stretches;
use crate::rounding::digits;
pub use change::ChangeSummary;
pub use event::EventSummary;
use numbers::short;
pub(super) use numbers::{short_or_null, short_pair};

/// Name and version of this format; changes when a meaning changes.
pub const SCHEMA: &str = "floe-replay/2";

/// The result of a replay.
#[derive(Clone, Debug, Serialize)]
pub struct ReplayResult {
    /// [`SCHEMA`].
    pub schema: &'static str,
    /// The log and what happened to its samples.
    pub log: LogSummary,
    /// What was pulled.
    pub test: TestSummary,
    /// The two coefficients; all fields `null` before the first event.
    pub estimate: EstimateSummary,
    /// Systematic uncertainty of the means, input by input; empty without events.
    pub budget: Vec<BudgetLine>,
    /// Standard deviation of the noise on the force.
    #[serde(with = "short_or_null")]
    pub noise_n: Option<f64>,
    /// Quantities other than the coefficients.
    #[serde(flatten)]
    pub quantities: Quantities,
    /// Drift of the load cell's zero, one standard deviation; `None` where no drift is seen.
    #[serde(with = "short_or_null")]
    pub zero_n: Option<f64>,
    /// Where the block or its friction changed, in order.
    pub changes: Vec<ChangeSummary>,
    /// Stretches of the log that belong to no event: `steady`, `not_understood`.
    #[serde(flatten)]
    pub stretches: Stretches,
    /// Effects beyond the linear model: which were looked for, and which the data show.
    pub effects: Vec<EffectSummary>,
    /// Every event, in order.
    pub events: Events,
}

/// An effect beyond the linear model.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EffectSummary {
    /// Name, as in `--effects`.
    pub name: &'static str,
    /// Whether it was looked for.
    pub enabled: bool,
    /// Whether the data show it.
    pub found: bool,
    /// Numbers of the effect, if it has any.
    pub parameters: Vec<ParameterSummary>,
}

/// A number of an effect.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ParameterSummary {
    /// Name of the number, with its unit.
    pub name: &'static str,
    /// Its value.
    #[serde(with = "short")]
    pub value: f64,
    /// One standard deviation.
    #[serde(with = "short")]
    pub std: f64,
}

impl From<&Finding> for EffectSummary {
    fn from(finding: &Finding) -> Self {
        let known = finding.parameters.iter().flatten();
        let finite = known.filter(|it| it.value.is_finite() && it.std.is_finite());
        let parameters = finite.map(|it| ParameterSummary {
            name: it.name,
            value: it.value.into(),
            std: it.std.into(),
        });
        Self {
            name: finding.effect.name(),
            enabled: finding.enabled,
            found: finding.found,
            parameters: parameters.collect(),
        }
    }
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
    /// Other warnings for a reader, one sentence each (a truncated last line, stamps that do not
    /// fit the rate, ...).
    pub warnings: Vec<String>,
    /// The line of a simulator that made the log, with the seed; `None` for a measured log.
    pub synthetic: Option<String>,
}

/// What was pulled.
#[derive(Clone, Debug, Serialize)]
pub struct TestSummary {
    /// Name of the test, if the log gives one.
    pub test_id: Option<String>,
    /// Weight of the block, or the normal force under the ice.
    #[serde(with = "short")]
    pub weight_n: f64,
    /// Slope of the ice, uphill positive.
    #[serde(with = "short")]
    pub slope_rad: f64,
    /// Mass of a block under the ice, where it is not weight over gravity.
    #[serde(with = "short_or_null")]
    pub mass_kg: Option<f64>,
}

/// The two coefficients.
#[derive(Clone, Debug, Serialize)]
pub struct EstimateSummary {
    /// Static coefficient.
    pub mu_s: CoefficientSummary,
    /// Dynamic coefficient.
    pub mu: CoefficientSummary,
    /// Events that count.
    pub events: u64,
}

/// A mean with its uncertainty.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct CoefficientSummary {
    /// Mean over the events.
    #[serde(with = "short_or_null")]
    pub mean: Option<f64>,
    /// Standard error of the mean: the random part, which includes the variation between events.
    #[serde(with = "short_or_null")]
    pub std_error: Option<f64>,
    /// Standard deviation between events, noise removed.
    #[serde(with = "short_or_null")]
    pub spread: Option<f64>,
    /// Systematic standard deviation: the part common to all events.
    #[serde(with = "short_or_null")]
    pub systematic_std: Option<f64>,
    /// Random and systematic part combined.
    #[serde(with = "short_or_null")]
    pub combined_std: Option<f64>,
    /// The 95 % interval.
    #[serde(with = "short_pair")]
    pub ci95: Option<[f64; 2]>,
    /// Why there is no mean, or no uncertainty of it.
    pub reason: Option<&'static str>,
}

impl ReplayResult {
    /// The effects that the data show; none where no event counts.
    pub fn effects_found(&self) -> impl Iterator<Item = &EffectSummary> {
        self.effects.iter().filter(|it| it.found && self.estimate.events > 0)
    }

    /// Whether the cable sags. Then it is softer during a slip than during loading, and the two
    /// stiffnesses differ.
    #[must_use]
    pub fn sags(&self) -> bool {
        self.effects_found().any(|effect| effect.name == Effect::Sag.name())
    }

    /// Assembles the result.
    #[must_use]
    pub fn new(
        log: LogSummary,
        test: TestSummary,
        (config, report): (&Config, &Report),
        mut events: Events,
        mut changes: Vec<ChangeSummary>,
    ) -> Self {
        // The final ratio is more accurate than the one at the time of the change.
        if let (Some(last), Some(known)) = (changes.last_mut(), &report.change) {
            last.weight_ratio = known.weight_ratio.into();
            last.weight_ratio_std = known.weight_ratio_std.into();
        }
        let omega = report.omega_rad_per_s.filter(|_| events.counts.determine_omega());
        let quantities = Quantities::new(config, report, omega);
        events.finish(quantities, [report.mu_s.into(), report.mu.into()]);
        let quantities = quantities.with(&events, (config, report));
        Self {
            schema: SCHEMA,
            log,
            test,
            estimate: EstimateSummary {
                mu_s: report.mu_s.into(),
                mu: report.mu.into(),
                events: report.mu_s.or(report.mu).map_or(0, |estimate| estimate.events.into()),
            },
            budget: lines(config, report),
            noise_n: known(report.noise_n),
            quantities,
            zero_n: known(report.zero_n),
            changes,
            stretches: Stretches::default(),
            effects: Vec::new(),
            events,
        }
    }
}

/// The sentence about a drift of the zero of this standard deviation.
#[must_use]
pub fn zero_sentence(zero_n: f64) -> String {
    let decimals = digits(zero_n);
    format!(
        "the zero of the load cell may have moved by {zero_n:.decimals$} N, which is in the budget; \
         take it before and after a test (--zero-before-n, --zero-after-n)"
    )
}

impl From<Counters> for LogSummary {
    /// Fills in the counters only.
    fn from(counters: Counters) -> Self {
        Self {
            samples: counters.samples.into(),
            missing: counters.missing.into(),
            duplicates: counters.duplicates.into(),
            rejected: counters.rejected.into(),
            saturated: counters.saturated.into(),
            ..Self::default()
        }
    }
}

impl From<Option<Estimate>> for CoefficientSummary {
    fn from(estimate: Option<Estimate>) -> Self {
        let reason = match estimate.map_or(0, |e| e.events) {
            0 => Some("no event gives a value"),
            1 => Some("one event does not tell how much friction varies between events"),
            _ => None,
        };
        Self {
            mean: known(estimate.map(|e| e.mean)),
            std_error: known(estimate.and_then(|e| e.std_error)),
            spread: known(estimate.and_then(|e| e.spread)),
            systematic_std: known(estimate.map(|e| e.systematic_std)),
            combined_std: known(estimate.and_then(|e| e.combined_std())),
            ci95: pair(estimate.and_then(|e| e.ci95())),
            reason,
        }
    }
}

/// A finite value; `None` for NaN and infinity.
pub(super) fn known(value: Option<f32>) -> Option<f64> {
    value.filter(|value| value.is_finite()).map(f64::from)
}

fn pair(ends: Option<(f32, f32)>) -> Option<[f64; 2]> {
    let (low, high) = ends?;
    Some([known(Some(low))?, known(Some(high))?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_short_and_what_is_not_finite_as_null() {
        let estimate = |mean| Estimate {
            mean,
            std_error: Some(3e-4),
            freedom: f32::INFINITY,
            systematic_std: 4e-4,
            common_std: 0.0,
            spread: None,
            events: 3,
        };
        let text =
            |mean| serde_json::to_string(&CoefficientSummary::from(Some(estimate(mean)))).unwrap();
        assert_eq!(
            text(0.78),
            r#"{"mean":0.78,"std_error":0.0003,"spread":null,"systematic_std":0.0004,"combined_std":0.0005,"ci95":[0.77902,0.78097993],"reason":null}"#
        );
        assert!(text(f32::NAN).starts_with(r#"{"mean":null,"std_error":0.0003,"spread":null"#));
        let test =
            |weight_n| TestSummary { test_id: None, weight_n, slope_rad: 0.0, mass_kg: None };
        let text = |weight_n| serde_json::to_string(&test(weight_n)).unwrap();
        assert_eq!(
            text(0.3_f32.into()),
            r#"{"test_id":null,"weight_n":0.3,"slope_rad":0.0,"mass_kg":null}"#
        );
        assert_eq!(
            text(f64::NAN),
            r#"{"test_id":null,"weight_n":null,"slope_rad":0.0,"mass_kg":null}"#
        );
    }
}
