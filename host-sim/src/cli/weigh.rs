//! `floe weigh`: determines the block's weight from a recording of it on the tripod.

use std::path::Path;

use floe_core::Config;
use floe_core::signal::calibrate::Calibrator;

use clap::builder::NonEmptyStringValueParser;

use crate::error::InputError;
use crate::log::{Log, LogOptions};
use crate::replay::given;
use crate::replay::test::{TestOptions, calibration};
use crate::rounding::{counted, digits, own_digits};
use crate::weigh::record::sentence;
use crate::weigh::{Weight, weigh};

use super::input::open;
use super::json::Json;
use super::output;

/// Weigh a block: from a recording of it on the tripod, its swing averaged
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Examples:
  floe weigh tripod.csv
  floe weigh tripod.csv --unit counts --tare-counts 4120 --counts-per-n 812.5 --json

The last 64 s count. What a steady swing adds is taken off; a load that drifts or is pulled is
refused. The standard deviation is that of the weighing, without the zero's and the span's: when
the same cell pulls the block afterwards, the span cancels. Where the noise is no larger than the
step of the readings, the step is in it: step / sqrt(12). Readings far from all others and
readings at the end of the range, one in fifty at most, are left out, and that is said. A zero in
the log (# zero_before_n, # zero_after_n) is taken off, as 'floe replay' does.")]
pub struct Args {
    /// The log: a file, or - for standard input
    #[arg(value_parser = NonEmptyStringValueParser::new(), value_name = "LOG")]
    log: Option<String>,
    #[command(flatten)]
    log_options: LogOptions,
    /// Converter code at zero force, for --unit counts
    #[arg(long, value_name = "C", allow_negative_numbers = true)]
    tare_counts: Option<i32>,
    /// Converter codes per newton, for --unit counts
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    counts_per_n: Option<f64>,
    #[command(flatten)]
    json: Json,
}

/// Runs the command.
///
/// # Errors
/// One line for the user.
pub fn run(args: &Args) -> Result<(), InputError> {
    let (path, json) = args.json.with_log(args.log.as_deref())?;
    let outputs: Vec<&Path> = json.file().into_iter().collect();
    let older = output::check(&outputs, &[Path::new(&path)])?;
    let (weight, warnings) = measure(&path, args).map_err(|error| error.within(&path))?;
    output::warn(&path, &warnings);
    json.print(&weight, || text(&weight))?;
    older.tell();
    Ok(())
}

/// The weight, and assumptions about the log.
fn measure(path: &str, args: &Args) -> Result<(Weight, Vec<String>), InputError> {
    let (tare_counts, counts_per_n) = (args.tare_counts, args.counts_per_n);
    let given = TestOptions { tare_counts, counts_per_n, ..TestOptions::default() };
    let mut log = Log::from_reader(open(path, false)?, &args.log_options.settled_by(&given))?;
    let calibration = calibration(&log, &given)?;
    let range_n = log.metadata().range_n.map(|range_n| range_n as f32);
    let config = Config { calibration, range_n, ..Config::default() };
    let weight = weigh(&mut log, &Calibrator::new(&config))?;
    Ok((weight, [log.warnings(), given::calibration(&log, &calibration)].concat()))
}

fn text(weight: &Weight) -> String {
    let swing = match weight.swing_period_s.zip(weight.swing_amplitude_rad) {
        Some((period_s, amplitude_rad)) => format!(
            "{period_s:.2} s, {:.1}°; {:.2} N of excess taken off",
            amplitude_rad.to_degrees(),
            weight.excess_n
        ),
        None => "none seen".to_string(),
    };
    let Weight { duration_s, scatter_n, .. } = weight;
    // The uncertainty is shown even if it is small, since a weighing is never exact.
    let std_n = weight.weight_std_n;
    let weight_n = format!("{:.*} ± {}", digits(std_n), weight.weight_n, own_digits(std_n));
    let mut rest = String::new();
    if weight.zero_n != 0.0 {
        rest += &format!("zero          {:.2} N taken off, as the log says\n", weight.zero_n);
    }
    if !weight.left_out.is_empty() {
        rest += &format!("left out      {}\n", sentence(&weight.left_out));
    }
    if weight.saturated > 0 {
        rest += &format!("saturated     {}\n", counted(weight.saturated as u64, "reading"));
    }
    format!(
        "{}weight        {weight_n} N\n\
         swing         {swing}\n\
         record        {duration_s:.1} s, scatter {scatter_n:.2} N in a quarter of a second\n{rest}",
        output::simulated(weight.synthetic.as_deref())
    )
}
