//! What the comparison gives, as it is written to JSON.

use serde::{Deserialize, Serialize};

/// Name and version of this format; changes when a meaning changes.
pub const SCHEMA: &str = "floe-bench/1";

/// The whole comparison.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct BenchResult {
    /// [`SCHEMA`].
    pub schema: String,
    /// What it ran on.
    pub host: Host,
    /// Seeds of a scene's records: 1, 2, ...
    pub first_seed: u64,
    /// Time to only look at a sample and keep the largest, ns.
    pub one_pass_ns: f64,
    /// One for each scene and method.
    pub rows: Vec<Row>,
}

/// What the comparison ran on.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct Host {
    /// Name of the processor, if the system says it.
    pub processor: Option<String>,
    /// Whether the program was built without optimisation: then times mean little.
    pub debug_build: bool,
}

/// One method on one scene.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct Row {
    /// Name of the scene.
    pub scene: String,
    /// Whether the model holds exactly and the noise is white.
    pub linear: bool,
    /// White noise, percent of the weight.
    pub noise_percent: f64,
    /// Name of the method.
    pub method: String,
    /// Whether it answers while the samples come.
    pub streams: bool,
    /// True events.
    pub events: usize,
    /// Harmonic mean of precision and recall of the events.
    pub f1: f64,
    /// Share of the true events with a value for both coefficients, percent.
    pub read_percent: f64,
    /// Errors of `mu_s`; `None` without a single value.
    pub mu_s: Option<Errors>,
    /// Errors of `mu`.
    pub mu: Option<Errors>,
    /// Mean time from the true onset until the method says that the block slips, ms.
    pub onset_delay_ms: Option<f64>,
    /// Time per sample, ns: shortest of several runs over the same samples, so that what else
    /// the computer did is left out.
    pub ns_per_sample: f64,
    /// Bytes kept between samples, at the end of the longest record.
    pub state_bytes: usize,
    /// Longest time for one sample, ns; each sample's shortest of several runs, so
    /// that what else the computer did is left out.
    pub worst_tick_ns: Option<f64>,
    /// The same on the board, where the emulator counted: `cargo xtask bench --docs`.
    pub board: Option<Instructions>,
}

/// Instructions of a step on the board, a Cortex-M4F, over the first record of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
pub struct Instructions {
    /// Mean.
    pub mean: u64,
    /// Most of all steps.
    pub worst: u64,
}

/// Errors of one coefficient.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
pub struct Errors {
    /// Root-mean-square of the error over each event's Cramér-Rao bound.
    pub over_bound: Option<f64>,
    /// Root-mean-square error, percent of the mean coefficient.
    pub rms_percent: f64,
    /// Mean error, percent of the mean coefficient.
    pub bias_percent: f64,
    /// Error that 95 % of the events do not exceed, percent.
    pub p95_percent: f64,
    /// Share of the events whose stated 95 % interval holds the truth, percent.
    pub coverage_percent: Option<f64>,
}
