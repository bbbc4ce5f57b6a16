//! `floe replay`: a recorded log to `mu_s` and `mu`.

use std::fs::File;
use std::io::{IsTerminal, Read};
use std::path::{Path, PathBuf};

use floe_core::Step;
use indicatif::{ProgressBar, ProgressStyle};

use crate::error::InputError;
use crate::log::{Format, Log, LogOptions, Unit};
use crate::replay::result::ReplayResult;
use crate::replay::test::{TestOptions, configure};
use crate::replay::{replay_with_zero, table};
use crate::report::{self, Recorder};

use super::output;

/// Logs from this size on show a progress bar.
const LONG_LOG_BYTES: u64 = 16 << 20;
const STANDARD: &str = "-";

/// Replay a recorded log: from its samples to the friction coefficients
#[derive(Clone, Debug, Default, clap::Args)]
#[command(after_help = "\
A csv log has a header line with a time column (time_s, t_s, t, time) and a force column
(force_n, force_kn, or --column NAME). Lines that begin with # are comments; '# key: value'
gives weight_n, slope_deg, winch_m_per_s, cable_length_m, snow_mm, range_n, rate_hz,
tare_counts, counts_per_n, test_id, and how well they are known (weight_std_n, slope_std_deg,
zero_std_n, span_std_percent, damping_std, winch_std_m_per_s, weight_from, zero_before_n,
zero_after_n), before or among the first 4096 samples.
Readings of -6999, 6999, -99999, NaN, infinity or nothing are bad samples: counted, not used
(in counts only the last three). A time or any other text that is not a number is an error.")]
pub struct Args {
    /// The log: a file, or - for standard input
    log: Option<String>,
    /// Format of the log [default: recognised from its content]
    #[arg(long)]
    format: Option<Format>,
    /// Samples per second, 1 to 2000 [default: from the time stamps, else 16]
    #[arg(long, value_name = "R", allow_negative_numbers = true)]
    rate_hz: Option<f64>,
    /// Name of the force column; for cr10 its place in the row, from 1 (the array number)
    #[arg(long, value_name = "NAME")]
    column: Option<String>,
    /// Unit of the force column [default: as the log says, else N]
    #[arg(long)]
    unit: Option<Unit>,
    /// Array to read of a cr10 log [default: the only one, or the only one with seconds]
    #[arg(long, value_name = "ID")]
    array_id: Option<u32>,
    #[command(flatten)]
    test: TestOptions,
    /// Write the result as JSON to FILE, or to standard output and nothing else there
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = STANDARD)]
    json: Option<PathBuf>,
    /// Write a report to look at, one HTML file
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
    /// Write the events as CSV
    #[arg(long, value_name = "FILE")]
    events: Option<PathBuf>,
    /// No table, progress or warnings; only errors and the files asked for
    #[arg(long)]
    quiet: bool,
}

impl Args {
    fn log_options(&self) -> LogOptions {
        LogOptions {
            format: self.format,
            rate_hz: self.rate_hz,
            column: self.column.clone(),
            unit: self.unit,
            array_id: self.array_id,
        }
    }

    /// `--json LOG` with no other log: what looks like the output is the log.
    fn resolved(&self) -> Result<(Self, &str), InputError> {
        let mut args = self.clone();
        let log = match (&self.log, &self.json) {
            (Some(log), _) => log.as_str(),
            (None, Some(file)) if file.is_file() => {
                args.json = Some(STANDARD.into());
                file.to_str().ok_or_else(no_log)?
            }
            (None, _) => return Err(no_log()),
        };
        Ok((args, log))
    }

    fn outputs(&self) -> impl Iterator<Item = &Path> {
        let json = self.json.as_deref().filter(|path| *path != Path::new(STANDARD));
        [json, self.report.as_deref(), self.events.as_deref()].into_iter().flatten()
    }
}

fn no_log() -> InputError {
    InputError::new("no log given: name a file, or - for standard input (see --help)")
}

/// A result, and what a report needs beside it.
type Findings = (ReplayResult, Option<Recorder>);

/// Runs the command.
///
/// # Errors
/// One line for the user.
pub fn run(args: &Args) -> Result<(), InputError> {
    let (args, path) = args.resolved()?;
    let name = if path == STANDARD { "standard input" } else { path };
    let mut taken = vec![Path::new(path)];
    for output in args.outputs() {
        output::check(output, &taken)?;
        taken.push(output);
    }
    let input = open(path, args.quiet).map_err(|error| error.within(name))?;
    finish(run_on(path, input, &args).map_err(|error| error.within(name))?, &args)
}

/// Name and content of the log in the binary, which says its own weight.
const BUNDLED: (&str, &[u8]) =
    ("host-sim/logs/dff8-13.csv", include_bytes!("../../logs/dff8-13.csv"));

/// The bundled log, with a report beside its table.
///
/// # Errors
/// One line for the user.
pub fn run_bundled() -> Result<(), InputError> {
    let (name, bytes) = BUNDLED;
    let directory = Path::new(if Path::new("target").is_dir() { "target" } else { "." });
    let args = Args { report: Some(directory.join("floe-report.html")), ..Args::default() };
    finish(run_on(name, Box::new(bytes), &args).map_err(|error| error.within(name))?, &args)
}

fn run_on(path: &str, input: Box<dyn Read + Send>, args: &Args) -> Result<Findings, InputError> {
    let mut log = Log::from_reader(input, &args.log_options())?;
    let config = configure(&log, &args.test)?;
    let zero = args.test.known.zero(&log);
    let mut recorder = args.report.as_ref().map(|_| Recorder::new(log.rate_hz()));
    let result = match &mut recorder {
        Some(recorder) => {
            let observe = |time_s: f64, step: &Step| recorder.push(time_s, step);
            replay_with_zero(path, &mut log, &config, zero, observe)?
        }
        None => replay_with_zero(path, &mut log, &config, zero, |_, _| {})?,
    };
    Ok((result, recorder))
}

/// Writes and prints what was asked for.
fn finish((result, recorder): Findings, args: &Args) -> Result<(), InputError> {
    let result = &result;
    if let (Some(path), Some(recorder)) = (&args.report, &recorder) {
        output::replace(path, &report::render(result, recorder))?;
    }
    if let Some(path) = &args.events {
        output::replace(path, &events_csv(result)?)?;
    }
    if !args.quiet {
        for warning in &result.log.warnings {
            eprintln!("floe: warning: {}: {warning}", result.log.path);
        }
    }
    match args.json.as_deref() {
        Some(path) if path == Path::new(STANDARD) => return output::print(&json(result)?),
        Some(path) => output::replace(path, &json(result)?)?,
        None => {}
    }
    if args.quiet {
        return Ok(());
    }
    let written = args.outputs().map(|path| format!("written       {}\n", path.display()));
    output::print(&(table::text(result) + &written.collect::<String>()))
}

fn json(result: &ReplayResult) -> Result<String, InputError> {
    let text = serde_json::to_string_pretty(result);
    text.map(|text| text + "\n").map_err(|error| InputError::new(error.to_string()))
}

fn events_csv(result: &ReplayResult) -> Result<String, InputError> {
    let failed = |error: String| InputError::new(error);
    let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(Vec::new());
    writer.write_record(EVENT_COLUMNS).map_err(|e| failed(e.to_string()))?;
    for event in &result.events {
        let mut event = event.clone();
        // Two empty cells, not one.
        for interval in [&mut event.mu_s_ci95, &mut event.mu_ci95] {
            interval.get_or_insert([f64::NAN; 2]);
        }
        writer.serialize(event).map_err(|e| failed(e.to_string()))?;
    }
    let bytes = writer.into_inner().map_err(|e| failed(e.to_string()))?;
    String::from_utf8(bytes).map_err(|e| failed(e.to_string()))
}

fn open(path: &str, quiet: bool) -> Result<Box<dyn Read + Send>, InputError> {
    if path == STANDARD {
        return Ok(Box::new(std::io::stdin()));
    }
    if Path::new(path).is_dir() {
        return Err(InputError::new("is a directory; name one log file"));
    }
    let file = File::open(path).map_err(|error| {
        let missing = error.kind() == std::io::ErrorKind::NotFound;
        let what =
            if missing { "no such file".into() } else { format!("cannot be opened: {error}") };
        InputError::new(what)
    })?;
    let bytes = file.metadata().map_or(0, |metadata| metadata.len());
    let long = bytes >= LONG_LOG_BYTES && std::io::stderr().is_terminal();
    if long && !quiet { Ok(Box::new(progress(bytes).wrap_read(file))) } else { Ok(Box::new(file)) }
}

/// A bar on standard error that goes away at the end.
fn progress(bytes: u64) -> ProgressBar {
    let style = "{wide_bar} {bytes} of {total_bytes}, {eta} left";
    let style =
        ProgressStyle::with_template(style).unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(bytes).with_style(style).with_finish(indicatif::ProgressFinish::AndClear)
}

/// The fields of an event in their order, so that a file without events has a
/// header too.
const EVENT_COLUMNS: [&str; 29] = [
    "index",
    "onset_s",
    "stop_s",
    "static_force_n",
    "dynamic_force_n",
    "peak_force_n",
    "restick_force_n",
    "mu_s",
    "mu_s_std",
    "mu",
    "mu_std",
    "stick_s",
    "slip_s",
    "loading_rate_n_per_s",
    "omega_rad_per_s",
    "slack",
    "quality",
    "reason",
    "mu_s_systematic_std",
    "mu_systematic_std",
    "mu_s_combined_std",
    "mu_combined_std",
    "mu_s_ci95_low",
    "mu_s_ci95_high",
    "mu_ci95_low",
    "mu_ci95_high",
    "slip_length_m",
    "energy_j",
    "onset_time",
];
