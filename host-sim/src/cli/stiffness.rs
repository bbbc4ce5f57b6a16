//! `floe stiffness`: the cable's stiffness from a pull against a post.

use std::path::Path;

use floe_core::Reading;

use crate::error::InputError;
use crate::log::{Log, LogOptions};
use crate::stiffness::{Measured, Pull, Stiffness, stiffness};

use super::input::open;
use super::json::Json;
use super::output;

/// Stiffness of the cable from a log of a pull against a fixed post
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Examples:
  floe stiffness post.csv --winch-m-per-s 0.0157
  floe stiffness post.csv --winch-m-per-s 0.0157 --cable-length-m 24.5 --json post.json")]
pub struct Args {
    /// The log: a file, or - for standard input
    #[arg(value_name = "LOG")]
    log: Option<String>,
    /// Take-up speed of the winch, m/s [default: as the log says]
    #[arg(long, value_name = "W")]
    winch_m_per_s: Option<f64>,
    /// Its standard deviation, m/s
    #[arg(long, value_name = "S", default_value_t = 0.0)]
    winch_std_m_per_s: f64,
    /// Free length of the cable, m, for AE [default: as the log says]
    #[arg(long, value_name = "L")]
    cable_length_m: Option<f64>,
    /// Its standard deviation, m
    #[arg(long, value_name = "S", default_value_t = 0.0)]
    cable_length_std_m: f64,
    #[command(flatten)]
    log_options: LogOptions,
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
    let found = measure(&path, args).map_err(|error| error.within(&path))?;
    json.print(&found, || text(&found))?;
    older.tell();
    Ok(())
}

fn measure(path: &str, args: &Args) -> Result<Stiffness, InputError> {
    let mut log = Log::from_reader(open(path, false)?, &args.log_options)?;
    let mut samples = Vec::new();
    while let Some(sample) = log.next_sample()? {
        match sample.raw.reading {
            Reading::Force(force) => samples.push((sample.time_s, f64::from(force.0))),
            Reading::Bad(_) => {}
            Reading::Counts(_) => {
                return Err(InputError::new("a pull in counts: give a log in units of force"));
            }
        }
    }
    let none = "no rise of the force to put a line through: is this a pull against a post?";
    stiffness(&samples, &pull(args, &log)?).ok_or_else(|| InputError::new(none))
}

fn pull(args: &Args, log: &Log) -> Result<Pull, InputError> {
    let said = log.metadata();
    let unknown = "the winch's speed is not known: give --winch-m-per-s W, \
                   or put '# winch_m_per_s: W' into the log";
    let speed = args.winch_m_per_s.or(said.winch_m_per_s);
    let length = args.cable_length_m.or(said.cable_length_m);
    let positive = |name: &str, value: f64, std_error: f64| {
        let good = value.is_finite() && value > 0.0 && std_error.is_finite() && std_error >= 0.0;
        let why = || InputError::new(format!("{name} {value} ± {std_error}: must be above zero"));
        if good { Ok(Measured { value, std_error }) } else { Err(why()) }
    };
    let speed = speed.ok_or_else(|| InputError::new(unknown))?;
    Ok(Pull {
        winch_m_per_s: positive("the winch's speed", speed, args.winch_std_m_per_s)?,
        cable_length_m: length
            .map(|length| positive("the cable's length", length, args.cable_length_std_m))
            .transpose()?,
    })
}

fn text(found: &Stiffness) -> String {
    let line = |name: &str, m: Measured, scale: f64, unit: &str| {
        format!("{name:<13} {:.3} ± {:.3} {unit}\n", m.value * scale, m.std_error * scale)
    };
    let mut text = line("stiffness k", found.stiffness_n_per_m, 1e-3, "kN/m");
    if let Some(ae) = found.ae_n {
        text += &line("AE = k L", ae, 1e-3, "kN");
    }
    text += &line("loading rate", found.loading_rate_n_per_s, 1.0, "N/s");
    let (from, to) = found.range_n;
    let (n, residual_n) = (found.samples, found.residual_n);
    text + &format!(
        "line          {n} samples, {from:.0} to {to:.0} N, scatter {residual_n:.2} N\n"
    )
}
