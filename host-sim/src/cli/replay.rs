//! `floe replay`: evaluates a recorded log to `mu_s` and `mu`.

use std::io::{IsTerminal, Read};
use std::path::{Path, PathBuf};

use floe_core::{Config, Step};

use clap::builder::NonEmptyStringValueParser;

use crate::error::{InputError, printable_line};
use crate::log::{Log, LogOptions};
use crate::replay::result::ReplayResult;
use crate::replay::samples::{self, SampleRows};
use crate::replay::test::{Around, TestOptions, configure};
use crate::replay::{event_rows, replay_with, table};
use crate::report::{self, Recorder};

use super::input::{STANDARD, open};
use super::json::Json;
use super::output::{self, Older};
use super::provenance::{Checksum, Summed, provenance};

/// Replay a recorded log: from its samples to the friction coefficients
#[derive(Clone, Debug, Default, clap::Args)]
#[command(after_help = "\
Examples:
  floe replay pull.csv --weight-n 630
  floe replay pull.csv --weight-n 630 --report pull.html --events pull-events.csv
  floe replay pull.csv --mass-kg 64.2 --slope-deg 1.5 --summary
  floe replay pull.dat --array-id 101 --column 6 --weight-n 630 --json | jq .estimate

'floe inspect LOG' shows what is recognised in a log; '# key: value' in it gives weight_n, mass_kg,
normal_n, slope_deg, winch_m_per_s, cable_length_m, snow_mm, range_n, rate_hz, unit (of the force),
tare_counts, counts_per_n, test_id, when the winch was held or turned (winch_marks_s: held 60.25, moving 75.5), and
how well all this is known (weight_std_n, slope_std_deg, zero_std_n, span_std_percent, damping_std,
winch_std_m_per_s, weight_from, zero_before_n, zero_after_n), before or among the first 4096 samples.
Readings of -6999, 6999, -9999, -99999, NaN, infinity or nothing are bad samples: counted, not used (in counts
only the last three).")]
pub struct Args {
    /// The log: a file, or - for standard input
    #[arg(value_parser = NonEmptyStringValueParser::new())]
    log: Option<String>,
    #[command(flatten)]
    log_options: LogOptions,
    #[command(flatten)]
    test: TestOptions,
    #[command(flatten)]
    json: Json,
    /// Write a report to look at, one HTML file
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
    /// Write the events as CSV
    #[arg(long, value_name = "FILE")]
    events: Option<PathBuf>,
    /// Write every sample: time, force, its rate, phase, the block's speed, flag
    #[arg(long, value_name = "FILE.csv|FILE.parquet")]
    samples: Option<PathBuf>,
    /// Write the report's figures as SVG files into DIR
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
    /// The result without the table of events
    #[arg(long)]
    summary: bool,
    /// No table, progress or warnings, nor what is replaced; only errors and the files asked for
    #[arg(long)]
    quiet: bool,
}

impl Args {
    fn outputs(&self) -> impl Iterator<Item = &Path> {
        let named = [&self.report, &self.events, &self.samples].map(|path| path.as_deref());
        [self.json.file()].into_iter().chain(named).flatten()
    }
}

/// A result, and the additional data for a report.
type Findings = (ReplayResult, Option<Recorder>);

/// Runs the command.
///
/// # Errors
/// One line for the user.
pub fn run(args: &Args) -> Result<(), InputError> {
    let (path, json) = args.json.with_log(args.log.as_deref())?;
    let args = Args { json, ..args.clone() };
    let path = path.as_str();
    let name = if path == STANDARD { "standard input" } else { path };
    let outputs: Vec<&Path> = args.outputs().collect();
    let older = output::check(&outputs, &[Path::new(path)])?;
    if let Some(folder) = &args.figures {
        output::check_folder(folder, &outputs)?;
    }
    args.samples.as_deref().map_or(Ok(()), check_samples)?;
    args.events.as_deref().map_or(Ok(()), check_events)?;
    let input = open(path, args.quiet).map_err(|error| error.within(name))?;
    evaluate(name, path, input, &args)?;
    if !args.quiet {
        older.tell();
    }
    Ok(())
}

/// Rejects a file name for the samples whose extension is that of another format.
fn check_samples(path: &Path) -> Result<(), InputError> {
    let is_known = ["csv", "parquet"].iter().any(|end| output::ends_with(path, end));
    if path.extension().is_none() || is_known {
        return Ok(());
    }
    output::refuse(path, "the name of the samples must end in .csv or .parquet")
}

/// Rejects a file name for the events that is that of a Parquet table.
fn check_events(path: &Path) -> Result<(), InputError> {
    if output::ends_with(path, "parquet") {
        let why = "--events writes CSV, and floe campaign --parquet a Parquet table of events";
        return output::refuse(path, why);
    }
    Ok(())
}

/// Name and content of the log in the binary, which contains its weight.
const BUNDLED: (&str, &[u8]) =
    ("host-sim/logs/fig6-7.csv", include_bytes!("../../logs/fig6-7.csv"));

/// Replays the bundled log; in the repository also writes a report to the build's folder.
///
/// # Errors
/// A message of one line.
pub fn run_bundled() -> Result<(), InputError> {
    let (name, bytes) = BUNDLED;
    let in_repository = Path::new(name).is_file() && Path::new("target").is_dir();
    let report = in_repository.then(|| Path::new("target").join("floe-report.html"));
    let args = Args { report, ..Args::default() };
    let older = output::check(&args.outputs().collect::<Vec<_>>(), &[Path::new(name)])?;
    evaluate(name, name, Box::new(bytes), &args)?;
    older.tell();
    if in_repository || !std::io::stdout().is_terminal() {
        return Ok(());
    }
    output::print(
        "\nThis was the bundled log. Your own: floe replay LOG --weight-n W --report FILE.html\n",
    )
}

fn evaluate(
    name: &str,
    path: &str,
    input: Box<dyn Read + Send>,
    args: &Args,
) -> Result<(), InputError> {
    let checksum = Checksum::default();
    // The checksum takes time and is needed in a report only.
    let input: Box<dyn Read + Send> = match args.report {
        Some(_) => Box::new(Summed::new(input, &checksum)),
        None => input,
    };
    let findings = run_on(name, path, input, args)?;
    finish(findings, args, &checksum)
}

fn run_on(
    name: &str,
    path: &str,
    input: Box<dyn Read + Send>,
    args: &Args,
) -> Result<Findings, InputError> {
    let of_log = |error: InputError| error.within(name);
    let mut log =
        Log::from_reader(input, &args.log_options.settled_by(&args.test)).map_err(of_log)?;
    let config = configure(&log, &args.test).map_err(of_log)?;
    let Some(file) = &args.samples else {
        return run_core(path, &mut log, &config, args, |_, _| {}).map_err(of_log);
    };
    let about = about(path, &log, &config);
    let is_parquet = output::ends_with(file, "parquet");
    output::stream(file, |out| {
        let mut table = samples::table(out, is_parquet, &about)?;
        let mut rows = SampleRows::new(config.winch_m_per_s, config.rate_hz);
        let mut put = Ok(());
        let findings = run_core(path, &mut log, &config, args, |time_s, step| {
            if let (Some(row), true) = (rows.push(time_s, step), put.is_ok()) {
                put = table.row(row);
            }
        });
        let findings = findings.map_err(of_log)?;
        put?;
        rows.finish().try_for_each(|row| table.row(row))?;
        table.finish().map(|()| findings)
    })
}

/// Metadata of a table of samples.
fn about(path: &str, log: &Log, config: &Config) -> Vec<(&'static str, String)> {
    let test_id = log.metadata().test_id.clone();
    let entries = [
        ("schema", Some("floe-samples/1".to_string())),
        ("log", Some(path.to_string())),
        ("test_id", test_id),
        ("rate_hz", Some(log.rate_hz().to_string())),
        ("weight_n", Some(config.weight_n.to_string())),
        ("slope_rad", Some(config.slope_rad.to_string())),
        ("winch_m_per_s", config.winch_m_per_s.map(|speed| speed.to_string())),
        ("synthetic", log.metadata().synthetic.clone()),
    ];
    entries.into_iter().filter_map(|(key, value)| Some((key, value?))).collect()
}

fn run_core(
    path: &str,
    log: &mut Log,
    config: &Config,
    args: &Args,
    mut observe: impl FnMut(f64, &Step),
) -> Result<Findings, InputError> {
    let drawn = args.report.is_some() || args.figures.is_some();
    let around = Around { keeps_means: drawn, ..args.test.around() };
    let mut recorder = drawn.then(|| Recorder::new(log.rate_hz()));
    let result = match &mut recorder {
        Some(recorder) => replay_with(path, log, config, around, |time_s, step| {
            recorder.push(time_s, step);
            observe(time_s, step);
        })?,
        None => replay_with(path, log, config, around, observe)?,
    };
    Ok((result, recorder))
}

/// Writes and prints the requested results.
fn finish(
    (result, recorder): Findings,
    args: &Args,
    checksum: &Checksum,
) -> Result<(), InputError> {
    let result = &result;
    let figures = match (&args.figures, &recorder) {
        (Some(folder), Some(recorder)) => Figures::new(folder, result, recorder, args)?,
        _ => Figures::default(),
    };
    if let (Some(path), Some(recorder)) = (&args.report, &recorder) {
        output::replace(path, &report::render(result, recorder, &provenance(checksum)))?;
    }
    figures.write(args.quiet)?;
    if let Some(path) = &args.events {
        output::stream(path, |out| event_rows::write(&result.events, out))?;
    }
    if !args.quiet {
        output::warn(&result.log.path, &result.log.warnings);
    }
    args.json.print_by(result, |out| {
        if args.quiet {
            return Ok(());
        }
        table::write(out, result, !args.summary)?;
        let mut files = args.outputs().chain(figures.files.iter().map(|(path, _)| path.as_path()));
        files.try_for_each(|path| {
            let path = path.display().to_string();
            out.write_all(format!("written       {}\n", printable_line(&path)).as_bytes())
        })
    })
}

/// The report's figures as files.
#[derive(Default)]
struct Figures {
    files: Vec<(PathBuf, String)>,
    older: Option<Older>,
}

impl Figures {
    /// Draws the figures, and rejects files that would overwrite another output or the log.
    fn new(
        folder: &Path,
        result: &ReplayResult,
        recorder: &Recorder,
        args: &Args,
    ) -> Result<Self, InputError> {
        output::make_folder(folder)?;
        let drawn = report::figures(result, recorder).into_iter();
        let files: Vec<_> = drawn.map(|(name, svg)| (folder.join(name), svg)).collect();
        let paths: Vec<&Path> = files.iter().map(|(path, _)| path.as_path()).collect();
        let others: Vec<&Path> = args.log.iter().map(Path::new).chain(args.outputs()).collect();
        let older = output::check(&paths, &others)?;
        Ok(Self { files, older: Some(older) })
    }

    fn write(&self, quiet: bool) -> Result<(), InputError> {
        self.files.iter().try_for_each(|(path, svg)| output::replace(path, svg))?;
        if let Some(older) = self.older.as_ref().filter(|_| !quiet) {
            older.tell();
        }
        Ok(())
    }
}
