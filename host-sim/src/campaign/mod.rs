//! Evaluation of many tests: trends against weight, pull rate and snow.
//!
//! ```text
//!  programme (simulated) ─┐
//!                         ├─► TestRecord ─► trends, groups, report
//!  recorded logs ─────────┘        │
//!                                  └─► one table of events (Parquet)
//! ```
//!
//! Tests are independent and computed in parallel, and collected in order, so that the result does
//! not depend on the number of threads.

pub mod event_table;
pub mod manifest;
pub mod programme;
pub mod recorded;
mod remedy;
pub mod summary;
pub mod trend;

use serde::Serialize;

use crate::replay::result::{CoefficientSummary, EventSummary};

/// One test of a campaign, evaluated.
#[derive(Clone, Debug, Default, Serialize)]
pub struct TestRecord {
    /// Number of the campaign, from 0.
    pub campaign: u32,
    /// Number of the test in it, from 0.
    pub test: u32,
    /// Name of the test.
    pub test_id: String,
    /// The log; `null` for a simulated test.
    pub path: Option<String>,
    /// Weight of the block, N.
    pub weight_n: f64,
    /// Pull rate, m/s, if known.
    pub winch_m_per_s: Option<f64>,
    /// Slope, rad.
    pub slope_rad: f64,
    /// Depth of the snow, mm, if known.
    pub snow_mm: Option<f64>,
    /// How the block was pulled: `sliding`, `rafting` or `over-riding`, if known.
    pub kind: Option<String>,
    /// The ice under it: `fresh` or `repeated`, if known.
    pub track: Option<String>,
    /// Length of the cable, m, if known.
    pub cable_length_m: Option<f64>,
    /// When the test was started, ISO 8601 (UTC), if known.
    pub start_time: Option<String>,
    /// Mean temperature of the converter, °C, if known.
    pub temperature_c: Option<f64>,
    /// Mean supply of the converter, V, if known.
    pub supply_v: Option<f64>,
    /// Mean time that the block rested before a slip, s.
    pub hold_s: Option<f64>,
    /// Static coefficient.
    pub mu_s: CoefficientSummary,
    /// Dynamic coefficient.
    pub mu: CoefficientSummary,
    /// Number of events.
    pub event_count: usize,
    /// Warnings about the log.
    pub warnings: Vec<String>,
    /// Description by the simulator; `null` for a measured test.
    pub synthetic: Option<String>,
    /// Hash of the forces, to find copies of a log.
    #[serde(skip)]
    pub forces: u64,
    /// All events, until they are written to the table.
    #[serde(skip)]
    pub events: Vec<EventRecord>,
}

impl TestRecord {
    /// What is doubtful about the log, each with the name of the file.
    pub fn doubts(&self) -> impl Iterator<Item = String> {
        self.warnings.iter().map(|it| format!("{}: {it}", self.file()))
    }

    /// The log, or the name of a simulated test.
    #[must_use]
    pub fn file(&self) -> &str {
        self.path.as_deref().unwrap_or(&self.test_id)
    }

    /// Whether another test has exactly the same forces, like a copy of the log.
    #[must_use]
    pub fn is_same_as(&self, other: &Self) -> bool {
        self.event_count > 0 && self.forces == other.forces
    }

    /// Mean rest of some events, s.
    #[must_use]
    pub fn mean_hold_s(events: &[EventRecord]) -> Option<f64> {
        let rests: Vec<f64> = events.iter().filter_map(|event| event.measured.stick_s).collect();
        let sum: f64 = rests.iter().sum();
        (!rests.is_empty()).then(|| sum / rests.len() as f64)
    }

    /// Whether there was snow on the ice, if that is known.
    #[must_use]
    pub fn has_snow(&self) -> Option<bool> {
        self.snow_mm.map(|depth| depth > 0.0)
    }
}

/// Warning for a campaign in which `synthetic` of the tests were simulated.
#[must_use]
pub fn simulated(synthetic: usize, tests: usize) -> Option<String> {
    match synthetic {
        0 => None,
        all if all == tests => Some("computed, not measured".to_owned()),
        some => Some(format!("{some} of {tests} tests, computed, not measured")),
    }
}

/// One event of a test.
#[derive(Clone, Debug)]
pub struct EventRecord {
    /// The event as evaluated by the replay.
    pub measured: EventSummary,
    /// True `mu_s`, for a simulated event.
    pub true_mu_s: Option<f64>,
    /// True `mu`, for a simulated event.
    pub true_mu: Option<f64>,
}
