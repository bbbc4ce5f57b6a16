//! The weight of a block from a recording of the block on the tripod.

use floe_core::SampleFlag;
use floe_core::signal::calibrate::Calibrator;
use floe_firmware::weighing::{Unrest, Weighing};
use serde::Serialize;

use crate::error::InputError;
use crate::log::Log;
use crate::replay::known::{KnownOptions, Zero};
use crate::rounding::significant;

pub mod record;
mod resolution;
use record::{LeftOut, RARE, Record, Settled};

/// Name and version of this format; changes when a meaning changes.
pub const SCHEMA: &str = "floe-weigh/1";

/// Longest stretch for estimating the step of the readings, s.
const LONGEST_S: f64 = 64.0;

/// Lowest sampling rate that shows a swing: two samples per period of the fastest one that is
/// searched, 1.6 Hz in the force.
const SLOWEST_HZ: f64 = 3.2;

/// Standard deviations from zero above which a load counts as one.
const SURE: f64 = 5.0;

/// The weight. The board computes the same numbers, but without the contribution of the readings'
/// step, which is negligible there, and without leaving out readings.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Weight {
    /// [`SCHEMA`].
    pub schema: &'static str,
    /// The remark of a simulator on its log; `null` for a measured log.
    pub synthetic: Option<String>,
    /// Weight without the excess of the swing, N.
    pub weight_n: f64,
    /// One standard deviation, N, including the effect of the readings' step, without the
    /// uncertainties of zero and span.
    pub weight_std_n: f64,
    /// Period of the swing, there and back, s; `null` if none is seen.
    pub swing_period_s: Option<f64>,
    /// Largest angle of the swing, rad.
    pub swing_amplitude_rad: Option<f64>,
    /// Excess of the mean due to the swing, N.
    pub excess_n: f64,
    /// Zero of the load cell that was subtracted, N, from the log.
    pub zero_n: f64,
    /// Length of the part that was used, at the end of the log, s.
    pub duration_s: f64,
    /// Scatter of means of a quarter of a second about the fit, N.
    pub scatter_n: f64,
    /// Readings far from all others, which were not used.
    pub left_out: Vec<LeftOut>,
    /// Number of readings at or beyond the end of the range, which were not used.
    pub saturated: usize,
}

/// Computes the weight from a log.
///
/// # Errors
/// The log cannot be read or is too slow to show a swing, the load does not rest at its end or is
/// beyond the range, or the readings never change.
pub fn weigh(log: &mut Log, calibrator: &Calibrator) -> Result<Weight, InputError> {
    check_rate(log.rate_hz())?;
    let zero = zero(log)?;
    let Settled { forces_n, left_out, saturated, log_s } = read(log, calibrator)?;
    let mut weighing = Weighing::new(log.rate_hz() as f32);
    forces_n.iter().for_each(|&force_n| weighing.add(force_n));
    let refused = |unrest| {
        let remedy = remedy(unrest, weighing.duration_s());
        InputError::new(match left_out.as_slice() {
            [] => remedy,
            some => format!("{remedy}; left out: {}", record::sentence(some)),
        })
    };
    let rest = weighing.rest().map_err(refused)?;
    let known = f64::from;
    // The zero at the middle of the part used, which is at the end of the log.
    let zero_n = zero.at(1.0 - 0.5 * known(rest.duration_s) / log_s.max(known(rest.duration_s)));
    let load = rest.load(zero_n as f32).map_err(refused)?;
    let used_s = known(rest.duration_s).min(LONGEST_S);
    let step_std_n = resolution::std_n(&forces_n, (used_s * log.rate_hz()).round() as usize);
    let std_n = known(load.std).hypot(step_std_n.unwrap_or(0.0));
    check(known(load.value), std_n)?;
    if step_std_n.is_none() {
        return Err(unchanging(load.value));
    }
    Ok(Weight {
        schema: SCHEMA,
        synthetic: log.metadata().synthetic.clone(),
        weight_n: known(load.value),
        weight_std_n: std_n,
        swing_period_s: load.swing.map(|swing| known(swing.period_s)),
        swing_amplitude_rad: load.swing.map(|swing| known(swing.amplitude_rad)),
        excess_n: load.swing.map_or(0.0, |swing| known(swing.excess)),
        zero_n,
        duration_s: known(rest.duration_s),
        scatter_n: known(rest.scatter),
        left_out,
        saturated,
    })
}

fn check_rate(rate_hz: f64) -> Result<(), InputError> {
    if rate_hz >= SLOWEST_HZ {
        return Ok(());
    }
    Err(InputError::new(format!(
        "{} samples a second do not show whether the block swings, which adds to its weight: \
         record {SLOWEST_HZ} or more",
        significant(rate_hz)
    )))
}

/// The zero stated in the log, as a replay subtracts it.
fn zero(log: &Log) -> Result<Zero, InputError> {
    let known = KnownOptions::default();
    known.inputs(&log.metadata().known).iter().try_for_each(|input| input.check(log))?;
    Ok(known.zero(log))
}

/// The last readings and those left out; an error if more than a few are beyond the range.
fn read(log: &mut Log, calibrator: &Calibrator) -> Result<Settled, InputError> {
    let mut record = Record::new(log.rate_hz());
    let mut next = None;
    while let Some(sample) = log.next_sample()? {
        let index = sample.raw.index;
        // A repeated row is no further reading.
        let Some(missing) = index.checked_sub(*next.get_or_insert(index)) else { continue };
        // A longer gap empties the window just the same.
        for _ in 0..missing.min(10_000) {
            record.push(sample.time_s, Err(SampleFlag::Rejected));
        }
        next = Some(index + 1);
        record.push(sample.time_s, calibrator.force_n(sample.raw.reading));
    }
    let settled = record.settle();
    match settled.saturated * RARE > settled.forces_n.len() {
        true => Err(overloaded(settled.saturated, settled.forces_n.len())),
        false => Ok(settled),
    }
}

fn check(value: f64, std: f64) -> Result<(), InputError> {
    if value > SURE * std {
        return Ok(());
    }
    Err(InputError::new(if value < -SURE * std {
        format!(
            "the force is {value:.2} N, below zero: tare the empty hook, or turn the sign of the span"
        )
    } else {
        format!("nothing hangs there: {value:.2} ± {std:.2} N")
    }))
}

/// The error for readings at the end of the range, which have no mean.
fn overloaded(saturated: usize, readings: usize) -> InputError {
    InputError::new(format!(
        "{saturated} of the last {readings} readings are at or beyond the end of the range of the \
         load cell ('# range_n:') or of its converter: correct the range, or weigh with a cell \
         that carries more"
    ))
}

/// The error for readings that are all equal, whose step is unknown.
fn unchanging(force_n: f32) -> InputError {
    InputError::new(format!(
        "every reading is {force_n} N: their step, and how far off the weight may be, is not known; \
         record in finer steps, or give the weight to replay with --weight-std-n, a step / sqrt(12)"
    ))
}

fn remedy(unrest: Unrest, duration_s: f32) -> String {
    match unrest {
        Unrest::Short => format!(
            "only {duration_s:.1} s without a gap at the end: record the hanging block for 8 s at \
             least, better for 40 s"
        ),
        Unrest::Drifts(slope) => format!(
            "the force drifts by {slope:.3} N a second: wait until the block hangs still, then \
             record again"
        ),
        Unrest::Moves => "this is no rest: a block on the tripod swings by 15 degrees at most; \
                          calm it and record again"
            .to_string(),
    }
}
