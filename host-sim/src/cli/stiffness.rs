//! `floe stiffness`: the cable's stiffness from pulls against a post.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use floe_core::Reading;
use serde::Serialize;

use clap::builder::NonEmptyStringValueParser;

use crate::error::{InputError, printable_line};
use crate::log::{Log, LogOptions};
use crate::replay::known::KnownOptions;
use crate::replay::test::TestOptions;
use crate::rounding::{counted, plus_minus};
use crate::stiffness::{Measured, Pull, Stiffness, Together, stiffness, straight_part, together};

use super::input::open;
use super::json::Json;
use super::output;

/// Stiffness of the cable from logs of pulls against a fixed post
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Examples:
  floe stiffness post.csv --winch-m-per-s 0.0157
  floe stiffness post.csv --winch-m-per-s 0.0157 --cable-length-m 24.5 --json post.json
  floe stiffness post-5m.csv post-15m.csv --cable-length-m 5,15 --extension fig8.csv

Several pulls of one length give their mean; of several lengths, AE of the cable and the stiffness k0
of its ends and splices: 1/k = 1/k0 + L/AE.")]
pub struct Args {
    /// The logs: files, or - for standard input
    #[arg(value_parser = NonEmptyStringValueParser::new(), value_name = "LOG")]
    logs: Vec<String>,
    /// Take-up speed of the winch, m/s [default: as the log says]
    #[arg(long, value_name = "W", allow_negative_numbers = true)]
    winch_m_per_s: Option<f64>,
    /// Its standard deviation, m/s [default: as the log says, else 0]
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    winch_std_m_per_s: Option<f64>,
    /// Free length of the cable, m, for AE; one for all logs or one for each
    /// [default: as the log says]
    #[arg(long, value_name = "L", value_delimiter = ',', allow_negative_numbers = true)]
    cable_length_m: Vec<f64>,
    /// Its standard deviation, m [default: 0]
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    cable_length_std_m: Option<f64>,
    /// Write what the winch has taken up and the force, m and N, of every sample on a line
    #[arg(long, value_name = "FILE.csv")]
    extension: Option<PathBuf>,
    #[command(flatten)]
    log_options: LogOptions,
    #[command(flatten)]
    json: Json,
}

/// A pull against a post.
struct Found {
    path: String,
    pull: Pull,
    stiffness: Stiffness,
    /// Description by the simulator, if the pull was simulated.
    synthetic: Option<String>,
    /// Time, s, and force, N.
    samples: Vec<(f64, f64)>,
}

/// Name and version of the JSON format; changes if a meaning changes.
const SCHEMA: &str = "floe-stiffness/1";

/// A single pull as JSON.
#[derive(Serialize)]
struct Alone<'a> {
    schema: &'static str,
    synthetic: Option<&'a str>,
    #[serde(flatten)]
    stiffness: Stiffness,
}

/// Several pulls as JSON.
#[derive(Serialize)]
struct Several<'a> {
    schema: &'static str,
    pulls: Vec<One<'a>>,
    together: Option<Together>,
}

#[derive(Serialize)]
struct One<'a> {
    path: &'a str,
    cable_length_m: Option<f64>,
    synthetic: Option<&'a str>,
    #[serde(flatten)]
    stiffness: Stiffness,
}

/// Runs the command.
///
/// # Errors
/// One line for the user.
pub fn run(args: &Args) -> Result<(), InputError> {
    let (first, json) = args.json.with_log(args.logs.first().map(String::as_str))?;
    let others = args.logs.iter().skip(1).cloned();
    let paths: Vec<String> = [first].into_iter().chain(others).collect();
    let outputs: Vec<&Path> = json.file().into_iter().chain(args.extension.as_deref()).collect();
    let inputs: Vec<&Path> = paths.iter().map(Path::new).collect();
    let older = output::check(&outputs, &inputs)?;
    let found = measure_all(&paths, args)?;
    tell_twice(&found);
    if let Some(path) = &args.extension {
        output::replace(path, &extension(&found))?;
    }
    print(&found, &json)?;
    older.tell();
    Ok(())
}

fn measure_all(paths: &[String], args: &Args) -> Result<Vec<Found>, InputError> {
    let lengths = args.cable_length_m.len();
    if lengths > 1 && lengths != paths.len() {
        let logs = counted(paths.len() as u64, "log");
        let why = format!("{lengths} lengths of the cable for {logs}: give one, or one each");
        return Err(InputError::new(why));
    }
    let one = |(number, path): (usize, &String)| {
        measure(path, args, number).map_err(|error| error.within(path))
    };
    paths.iter().enumerate().map(one).collect()
}

fn print(found: &[Found], json: &Json) -> Result<(), InputError> {
    if let [one] = found {
        let (synthetic, stiffness) = (one.synthetic.as_deref(), one.stiffness);
        let alone = Alone { schema: SCHEMA, synthetic, stiffness };
        return json.print(&alone, || output::simulated(synthetic) + &text(&stiffness));
    }
    let lengths = found.iter().map(|it| Some((it.stiffness, it.length_m()?)));
    let together = lengths.collect::<Option<Vec<_>>>().and_then(|all| together(&all));
    let pulls = found.iter().map(Found::one).collect();
    let several = Several { schema: SCHEMA, pulls, together };
    json.print(&several, || several_text(found, together.as_ref()))
}

impl Found {
    fn length_m(&self) -> Option<f64> {
        self.pull.cable_length_m.map(|length| length.value)
    }

    fn one(&self) -> One<'_> {
        One {
            path: &self.path,
            cable_length_m: self.length_m(),
            synthetic: self.synthetic.as_deref(),
            stiffness: self.stiffness,
        }
    }
}

/// Warns of equal pulls, because their mean would seem too accurate.
fn tell_twice(found: &[Found]) {
    for (later, it) in found.iter().enumerate() {
        if let Some(first) = found.iter().take(later).find(|other| other.samples == it.samples) {
            let (first, path) = (&first.path, &it.path);
            output::say(&format!(
                "warning: {path}: holds the samples of {first}: the same pull counts twice, and \
                 the ± of the mean is too small"
            ));
        }
    }
}

fn measure(path: &str, args: &Args, number: usize) -> Result<Found, InputError> {
    let (winch_m_per_s, winch_std_m_per_s) = (args.winch_m_per_s, args.winch_std_m_per_s);
    let known = KnownOptions { winch_std_m_per_s, ..KnownOptions::default() };
    let given = TestOptions { winch_m_per_s, known: Box::new(known), ..TestOptions::default() };
    let mut log = Log::from_reader(open(path, false)?, &args.log_options.settled_by(&given))?;
    let (mut samples, mut next) = (Vec::new(), 0);
    while let Some(sample) = log.next_sample()? {
        // A repeated row is no further reading.
        if sample.raw.index < next {
            continue;
        }
        next = sample.raw.index + 1;
        match sample.raw.reading {
            Reading::Force(force) => samples.push((sample.time_s, f64::from(force.0))),
            Reading::Bad(_) => {}
            Reading::Counts(_) => {
                return Err(InputError::new("a pull in counts: give a log in units of force"));
            }
        }
    }
    let none = "no rise of the force to put a line through: is this a pull against a post?";
    let pull = pull(args, number, &log)?;
    let stiffness = stiffness(&samples, &pull).ok_or_else(|| InputError::new(none))?;
    let mut warnings = log.warnings();
    if pull.cable_length_m.is_none() && args.cable_length_std_m.is_some() {
        let unused = "--cable-length-std-m is not used without the length: --cable-length-m L";
        warnings.push(unused.to_string());
    }
    output::warn(path, &warnings);
    let synthetic = log.metadata().synthetic.clone();
    Ok(Found { path: path.to_string(), pull, stiffness, synthetic, samples })
}

fn pull(args: &Args, number: usize, log: &Log) -> Result<Pull, InputError> {
    let said = log.metadata();
    let unknown = "the winch's speed is not known: give --winch-m-per-s W, \
                   or put '# winch_m_per_s: W' into the log";
    let speed = args.winch_m_per_s.or(said.winch_m_per_s);
    let given = args.cable_length_m.get(number).or(args.cable_length_m.first());
    let length = given.copied().or(said.cable_length_m);
    let mut known = said.known;
    let speed_std =
        args.winch_std_m_per_s.or(known.field("winch_std_m_per_s").and_then(|std| *std));
    let positive = |name: &str, value: f64, std_error: f64| {
        let refuse = |why: String| Err(InputError::new(format!("{name} {why}")));
        if !value.is_finite() || value <= 0.0 {
            return refuse(format!("{value}: must be a number above zero"));
        }
        if !std_error.is_finite() || std_error < 0.0 {
            return refuse(format!("± {std_error}: must be a number not below zero"));
        }
        Ok(Measured { value, std_error })
    };
    let speed = speed.ok_or_else(|| InputError::new(unknown))?;
    let length_std = args.cable_length_std_m.unwrap_or(0.0);
    Ok(Pull {
        winch_m_per_s: positive("the winch's speed", speed, speed_std.unwrap_or(0.0))?,
        cable_length_m: length
            .map(|length| positive("the cable's length", length, length_std))
            .transpose()?,
    })
}

/// Force against the cable taken up since the start of the line: the paper's Fig. 8.
fn extension(found: &[Found]) -> String {
    let mut text = "pull,extension_m,force_n\n".to_string();
    for (pull, it) in found.iter().enumerate() {
        let line = straight_part(&it.samples);
        let start_s = line.first().map_or(0.0, |sample| sample.0);
        for (time_s, force_n) in line {
            let extension_m = it.pull.winch_m_per_s.value * (time_s - start_s);
            let _ = writeln!(text, "{pull},{extension_m:.6},{force_n:.3}");
        }
    }
    text
}

fn several_text(found: &[Found], together: Option<&Together>) -> String {
    let mut text = format!("{:>9} {:>17}  log\n", "L, m", "k, kN/m");
    for it in found {
        let k = it.stiffness.stiffness_n_per_m;
        let length = it.length_m().map_or("?".to_string(), |length_m| format!("{length_m:.2}"));
        let k = plus_minus(k.value / 1e3, k.std_error / 1e3);
        let said = it.synthetic.as_ref().map(|said| format!(", SIMULATED: {said}"));
        let said = said.unwrap_or_default();
        let _ = writeln!(text, "{length:>9} {k:>17}  {}{said}", printable_line(&it.path));
    }
    let Some(together) = together else {
        return text + "together      unknown: every pull needs the length of its cable\n";
    };
    let pulls = together.pulls;
    if let Some(k) = together.stiffness_n_per_m {
        text += &line(&format!("mean of {pulls}"), k, 1e-3, "kN/m");
        return text;
    }
    match together.ae_n {
        Some(ae) => text += &line("AE", ae, 1e-3, "kN"),
        None => text += "AE            unknown: k does not surely fall with the length\n",
    }
    match together.end_stiffness_n_per_m {
        Some(k0) => text += &line("k0, its ends", k0, 1e-3, "kN/m"),
        None => text += "k0, its ends  stiffer than can be told\n",
    }
    text
}

fn line(name: &str, m: Measured, scale: f64, unit: &str) -> String {
    format!("{name:<13} {} {unit}\n", plus_minus(m.value * scale, m.std_error * scale))
}

fn text(found: &Stiffness) -> String {
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
