//! Results of the comparison, in the form of the JSON file.

use serde::{Deserialize, Serialize};

/// Name and version of the format; changes if a meaning changes.
pub const SCHEMA: &str = "floe-bench/1";

/// The whole comparison.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct BenchResult {
    /// [`SCHEMA`].
    pub schema: String,
    /// Computer on which the comparison ran.
    pub host: Host,
    /// First seed of a scene's records, which are numbered 1, 2, ...
    pub first_seed: u64,
    /// Time to read a sample and keep the largest, ns.
    pub one_pass_ns: f64,
    /// Results, one per scene and method.
    pub rows: Vec<Row>,
}

/// Computer on which the comparison ran.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct Host {
    /// Name of the processor, if the system provides it.
    pub processor: Option<String>,
    /// Whether the program was built without optimisation, so that times are meaningless.
    pub debug_build: bool,
}

/// Results of one method in one scene.
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
    /// Whether the method answers during the record.
    pub streams: bool,
    /// Number of true events.
    pub events: usize,
    /// Harmonic mean of precision and recall of the events.
    pub f1: f64,
    /// Percentage of the true events with values for both coefficients.
    pub read_percent: f64,
    /// Errors of `mu_s`; `None` without any value.
    pub mu_s: Option<Errors>,
    /// Errors of `mu`.
    pub mu: Option<Errors>,
    /// Mean time from the true onset to the method's report of a slip, ms.
    pub onset_delay_ms: Option<f64>,
    /// Time per sample, ns: shortest of several runs over the same samples, which excludes other
    /// load of the computer.
    pub ns_per_sample: f64,
    /// Bytes kept between samples, at the end of the longest record.
    pub state_bytes: usize,
    /// Longest time for one sample, ns, from each sample's shortest time in several runs, which
    /// excludes other load of the computer.
    pub worst_tick_ns: Option<f64>,
    /// Instructions on the board, if counted in the emulator: `cargo xtask bench --docs`.
    pub board: Option<Instructions>,
}

/// Instructions per step on the board, a Cortex-M4F, over the first record of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
pub struct Instructions {
    /// Mean.
    pub mean: u64,
    /// Largest value of all steps.
    pub worst: u64,
}

/// Errors of one coefficient.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
pub struct Errors {
    /// Root-mean-square error relative to each event's Cramér-Rao bound.
    pub over_bound: Option<f64>,
    /// Root-mean-square error, percent of the mean coefficient.
    pub rms_percent: f64,
    /// Mean error, percent of the mean coefficient.
    pub bias_percent: f64,
    /// 95th percentile of the absolute error, percent.
    pub p95_percent: f64,
    /// Percentage of the events whose stated 95 % interval covers the truth.
    pub coverage_percent: Option<f64>,
}
