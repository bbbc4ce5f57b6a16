//! `floe campaign`: trends over many tests.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, SyncSender, channel, sync_channel};
use std::time::{Duration, Instant};

use rayon::ScopeFifo;

use crate::campaign::event_table::EventTable;
use crate::campaign::manifest;
use crate::campaign::recorded::Logs;
use crate::campaign::summary::Summary;
use crate::campaign::{TestRecord, programme, recorded};
use crate::columnar;
use crate::error::InputError;
use crate::report::render_campaign;
use crate::rounding::counted;

use super::json::Json;
use super::output::{self, Older};
use super::progress;

/// Most tests that a thread computes before it hands them over.
const PIECE: u64 = 16;
/// Pieces that are computed, or wait to be written; bounds the memory.
const AHEAD: usize = 32;

/// Evaluate many tests: means, trends against weight, pull rate and snow
#[derive(Clone, Debug, clap::Args)]
#[command(after_help = "\
Examples:
  floe campaign logs/ --report campaign.html --parquet events.parquet
  floe campaign --repeat 40 --json campaign.json

Without DIR or LIST, a programme of 25 tests is simulated from the published trends.
A list names one log a line, relative to itself. Logs must say their weight (# weight_n:), and
what is known of winch_m_per_s, snow_mm, kind and track, or a table tests.csv says it: a line of
column names (file, array_id, column, unit, weight_n, mass_kg, slope_deg, winch_m_per_s, snow_mm,
kind, track, cable_length_m, test_id), then a line for each log. A log that cannot be used is
reported and left out.")]
pub struct Args {
    /// Directory with logs, or a file that lists them
    #[arg(value_name = "DIR|LIST")]
    logs: Option<PathBuf>,
    /// Seed of the simulated programme
    #[arg(long, value_name = "N", default_value_t = 1, conflicts_with = "logs")]
    seed: u64,
    /// Simulate this many programmes
    #[arg(long, value_name = "N", default_value_t = 1, conflicts_with = "logs",
          value_parser = clap::value_parser!(u32).range(1..=10_000_000))]
    repeat: u32,
    /// Stop at a log that cannot be used
    #[arg(long)]
    strict: bool,
    /// Threads to use [default: one for each core]; the result is the same
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Write figures and tables to look at, one HTML file
    #[arg(long, value_name = "FILE.html")]
    report: Option<PathBuf>,
    /// Write all events as one Parquet table
    #[arg(long, value_name = "FILE.parquet")]
    parquet: Option<PathBuf>,
    #[command(flatten)]
    json: Json,
}

/// Source of the tests.
enum Source {
    Programme { seed: u64, tests: u64 },
    Logs(Logs),
}

impl Source {
    fn new(args: &Args) -> Result<Self, InputError> {
        match &args.logs {
            Some(path) => recorded::logs(path).map(Self::Logs),
            None => {
                let tests = u64::from(args.repeat) * u64::from(programme::TESTS);
                Ok(Self::Programme { seed: args.seed, tests })
            }
        }
    }

    /// All files that are read: the list, the table in the directory, and every log.
    fn files(&self, args: &Args) -> Vec<PathBuf> {
        let logs = match self {
            Self::Programme { .. } => &[],
            Self::Logs(logs) => logs.entries.as_slice(),
        };
        let lists = args.logs.iter().flat_map(|path| [path.clone(), path.join(manifest::NAME)]);
        lists.chain(logs.iter().map(|entry| entry.path.clone())).collect()
    }

    fn len(&self) -> u64 {
        match self {
            Self::Programme { tests, .. } => *tests,
            Self::Logs(logs) => logs.entries.len() as u64,
        }
    }

    fn evaluate(&self, number: u64) -> Result<TestRecord, InputError> {
        let per = u64::from(programme::TESTS);
        match self {
            Self::Programme { seed, .. } => {
                programme::evaluate(*seed, (number / per) as u32, (number % per) as u32)
            }
            Self::Logs(logs) => match logs.entries.get(number as usize) {
                Some(log) => recorded::evaluate(log, number as u32),
                None => Err(InputError::new("no such log")),
            },
        }
    }
}

/// Runs the command.
///
/// # Errors
/// One line for the user.
pub fn run(args: &Args) -> Result<(), InputError> {
    let source = Source::new(args)?;
    let older = check(args, &source)?;
    let started = Instant::now();
    let (mut tests, mut events) = (Vec::new(), 0);
    let left_out = evaluate_all(args, &source, |test| {
        events += test.event_count as u64;
        tests.push(test);
    })?;
    let left_out: Vec<String> = left_out.iter().map(ToString::to_string).collect();
    for problem in &left_out {
        output::say(&format!("left out: {problem}"));
    }
    let seed = args.logs.is_none().then_some(args.seed);
    let summary = Summary { left_out, ..Summary::new(&tests, events, seed) };
    if let Source::Logs(logs) = &source {
        tell_notes(logs, &tests, !summary.records.is_empty());
    }
    write(args, &summary, &tests)?;
    older.tell();
    tell_counts(&summary, started.elapsed());
    Ok(())
}

/// Refuses outputs that would overwrite an input or a foreign file. Returns the results to replace.
fn check(args: &Args, source: &Source) -> Result<Older, InputError> {
    let outputs = [args.json.file(), args.report.as_deref(), args.parquet.as_deref()];
    let outputs: Vec<&Path> = outputs.into_iter().flatten().collect();
    let inputs = source.files(args);
    let inputs: Vec<&Path> = inputs.iter().map(PathBuf::as_path).collect();
    let older = output::check(&outputs, &inputs)?;
    refuse_other_table(args).map(|()| older)
}

fn tell_counts(summary: &Summary, took: Duration) {
    let left_out = match summary.left_out.len() {
        0 => String::new(),
        count => format!(", {count} left out"),
    };
    let tests = counted(summary.tests as u64, "test");
    let (events, seconds) = (counted(summary.events, "event"), took.as_secs_f64());
    output::tell(&format!("{tests}, {events} in {seconds:.2} s{left_out}"));
}

/// Refuses a name for the table of events that ends with `.csv`.
fn refuse_other_table(args: &Args) -> Result<(), InputError> {
    let Some(path) = &args.parquet else { return Ok(()) };
    if output::ends_with(path, "csv") {
        let why = "--parquet writes no CSV: name a file that ends with .parquet";
        return output::refuse(path, why);
    }
    Ok(())
}

/// Prints the files not read, the assumptions about the logs, and logs with equal numbers. The JSON
/// has the assumptions where the tests are `listed`.
fn tell_notes(logs: &Logs, tests: &[TestRecord], listed: bool) {
    const MOST: usize = 20;
    let said = tests.iter().flat_map(TestRecord::doubts);
    let mut notes: Vec<String> = logs.notes.iter().cloned().chain(said).collect();
    for (later, test) in tests.iter().enumerate() {
        if let Some(first) = tests.iter().take(later).find(|it| it.is_same_as(test)) {
            // Two forces of one log are two tests.
            let one_log = first.path == test.path;
            let [first, second] =
                [first, test].map(|it| if one_log { &it.test_id } else { it.file() });
            notes.push(format!(
                "{first} and {second} give the same numbers, force by force: is a log there twice?"
            ));
        }
    }
    for note in notes.iter().take(MOST) {
        output::say(&format!("note: {note}"));
    }
    if notes.len() > MOST {
        let more = notes.len() - MOST;
        let where_else = if listed { "; --json has those of the logs" } else { "" };
        output::say(&format!("and {more} more notes{where_else}"));
    }
}

/// Evaluates every test in order; the events go to the Parquet table if there is one, the tests
/// without their events to `keep`. Returns the logs left out.
fn evaluate_all(
    args: &Args,
    source: &Source,
    mut keep: impl FnMut(TestRecord),
) -> Result<Vec<InputError>, InputError> {
    let Some(path) = &args.parquet else {
        return in_order(args, source, |mut test| {
            test.events = Vec::new();
            keep(test);
            Ok(())
        });
    };
    output::stream(path, |out| {
        let mut table = EventTable::new(out, &about(args)).map_err(columnar::io_error)?;
        let left_out = in_order(args, source, |mut test| {
            let events = std::mem::take(&mut test.events);
            keep(test.clone());
            table.push(TestRecord { events, ..test }).map_err(columnar::io_error)
        })?;
        table.finish().map_err(columnar::io_error).map(|()| left_out)
    })
}

/// Entries for the metadata of the table.
fn about(args: &Args) -> Vec<(&'static str, String)> {
    match &args.logs {
        Some(logs) => vec![("logs", logs.display().to_string())],
        None => vec![("seed", args.seed.to_string())],
    }
}

/// A test, or why it cannot be evaluated.
type Evaluated = Result<TestRecord, InputError>;

/// Computes in parallel and hands over in order, while the next tests are computed. Returns the
/// tests left out; if all are left out, returns the first error.
fn in_order<E: From<InputError>>(
    args: &Args,
    source: &Source,
    mut take: impl FnMut(TestRecord) -> Result<(), E>,
) -> Result<Vec<InputError>, E> {
    let threads = args.threads.map_or(0, usize::from);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(InputError::new)?;
    let bar = progress::bar(source.len(), "{pos} of {len} tests, {eta} left");
    let stop = args.strict || args.logs.is_none();
    let mut left_out = Vec::new();
    std::thread::scope(|scope| {
        let (sender, pieces) = sync_channel(AHEAD);
        scope.spawn(move || pool.in_place_scope_fifo(|pool| start_all(source, pool, &sender)));
        for test in pieces.into_iter().flatten().flatten() {
            bar.inc(1);
            match test {
                Ok(test) => take(test)?,
                Err(problem) if stop => return Err(problem.into()),
                Err(problem) => left_out.push(problem),
            }
        }
        match left_out.first() {
            Some(first) if left_out.len() as u64 == source.len() => Err(first.clone().into()),
            _ => Ok(left_out),
        }
    })
}

/// Starts piece after piece, in order, as far ahead as `pieces` has room.
fn start_all<'a>(
    source: &'a Source,
    pool: &ScopeFifo<'a>,
    pieces: &SyncSender<Receiver<Vec<Evaluated>>>,
) {
    let tests = source.len();
    // Of a few logs each is a piece: one may take as long as all others.
    let size = tests.div_ceil(AHEAD as u64 * PIECE).clamp(1, PIECE);
    for first in (0..tests).step_by(size as usize) {
        let (sender, piece) = channel();
        let numbers = first..(first + size).min(tests);
        pool.spawn_fifo(move |_| {
            // After an error the receiver is gone.
            let _ = sender.send(numbers.map(|number| source.evaluate(number)).collect());
        });
        if pieces.send(piece).is_err() {
            return;
        }
    }
}

fn write(args: &Args, summary: &Summary, tests: &[TestRecord]) -> Result<(), InputError> {
    if let Some(path) = &args.report {
        output::replace(path, &render_campaign(summary, tests))?;
    }
    args.json.print(summary, || summary.text())
}
