//! Many tests together: trends against weight, pull rate and snow.
//!
//! ```text
//!  programme (simulated) ─┐
//!                         ├─► TestRecord ─► trends, groups, report
//!  recorded logs ─────────┘        │
//!                                  └─► one table of events (Parquet)
//! ```
//!
//! Tests are independent and are computed in parallel; they are collected in
//! their order, so that the outcome does not depend on the number of threads.

pub mod event_table;
pub mod programme;
pub mod recorded;
pub mod summary;
pub mod trend;

use serde::Serialize;

use crate::replay::result::{CoefficientSummary, EventSummary};

/// One test of a campaign, evaluated.
#[derive(Clone, Debug, Serialize)]
pub struct TestRecord {
    /// Number of the campaign, from 0.
    pub campaign: u32,
    /// Number of the test in it, from 0.
    pub test: u32,
    /// Name of the test.
    pub test_id: String,
    /// Weight of the block, N.
    pub weight_n: f64,
    /// Pull rate, m/s, if known.
    pub winch_m_per_s: Option<f64>,
    /// Slope, rad.
    pub slope_rad: f64,
    /// Depth of the snow, mm, if known.
    pub snow_mm: Option<f64>,
    /// Static coefficient.
    pub mu_s: CoefficientSummary,
    /// Dynamic coefficient.
    pub mu: CoefficientSummary,
    /// Number of events.
    pub event_count: usize,
    /// Every event, until they are in the table.
    #[serde(skip)]
    pub events: Vec<EventRecord>,
}

impl TestRecord {
    /// Whether there was snow on the ice, if that is known.
    #[must_use]
    pub fn has_snow(&self) -> Option<bool> {
        self.snow_mm.map(|depth| depth > 0.0)
    }
}

/// One event of a test.
#[derive(Clone, Debug)]
pub struct EventRecord {
    /// As replayed.
    pub measured: EventSummary,
    /// True `mu_s`, for a simulated event.
    pub true_mu_s: Option<f64>,
    /// True `mu`, for a simulated event.
    pub true_mu: Option<f64>,
}
