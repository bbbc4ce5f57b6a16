//! `cargo xtask emulate`: runs a log through the firmware in the emulator.
//!
//! ```text
//!  log ─► load cell ─► model of the converter ─► FIFOs ─► firmware in QEMU
//!                                                 console ─► lines ─► result
//! ```
//!
//! Emulated time stands still while the host answers, so a run is as fast as the PC and always
//! gives the same result. In real time (`--live`) the host delays its answers: no sample is lost,
//! and a client of the board's UART communicates with it as with a real board.

mod card;
mod directory;
mod faults;
mod first_day;
pub mod link;
mod live;
pub mod machine;
pub mod nucleo;
pub mod outcome;
pub mod record;
mod troubles;

use std::path::PathBuf;

use floe::cli::output;
use floe::log::{LogOptions, Unit};
use floe::replay::table;
use floe::replay::test::TestOptions;

use crate::Result;
use crate::arm::Route;
use crate::shell::{root, say};
use floe_tests::parallel;
use machine::{Machine, Run, Setup};
use nucleo::Nucleo;
use record::{Record, is_scene};

/// Which board.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Board {
    /// The board that only exists in QEMU: any QEMU 10 or newer.
    #[default]
    #[value(name = "mps2-an386")]
    Mps2,
    /// The NUCLEO-L476RG: the image that is flashed, its peripherals modelled (QEMU 10).
    Nucleo,
}

/// A board with its firmware, ready to run.
enum Ready {
    Mps2(Machine),
    Nucleo(Nucleo),
}

impl Ready {
    fn new(board: Board, forced: Option<Route>) -> Result<Self> {
        Ok(match board {
            Board::Mps2 => Self::Mps2(Machine::prepare(forced)?),
            Board::Nucleo => Self::Nucleo(Nucleo::prepare(forced)?),
        })
    }

    fn run(&self, record: &Record, setup: Setup<'_>) -> Result<Run> {
        match self {
            Self::Mps2(machine) => machine.run(record, setup),
            Self::Nucleo(nucleo) => nucleo.run(record, setup),
        }
    }
}

/// Options of the job.
#[derive(Clone, Debug, clap::Args)]
pub struct Args {
    /// The log, 16 samples per second, or a scene (.toml)
    pub log: PathBuf,
    /// Which board
    #[arg(long, value_enum, default_value_t)]
    pub board: Board,
    /// Name of the force column
    #[arg(long, value_name = "NAME")]
    pub column: Option<String>,
    /// Unit of the force column [default: as the log says, else N]
    #[arg(long)]
    pub unit: Option<Unit>,
    #[command(flatten)]
    pub test: TestOptions,
    /// Write the result as JSON to FILE, or to standard output and nothing else there
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = "-")]
    pub json: Option<PathBuf>,
    /// Log on this image of an SD card [default: none; with --live target/live-card.img]
    #[arg(long, value_name = "IMAGE")]
    pub card: Option<PathBuf>,
    /// Run in real time, the board's UART on this TCP port
    #[arg(long, value_name = "PORT", num_args = 0..=1, default_missing_value = "4004")]
    pub live: Option<u16>,
}

/// Scenes that the board cannot run, because they are sampled at another rate.
const OF_ANOTHER_RATE: [&str; 3] = [
    "host-sim/scenes/honesty/held_hum.toml",
    "host-sim/scenes/honesty/rate_and_state_64.toml",
    "host-sim/scenes/paper/fig5-ellipse.toml",
];

/// Runs every bundled log and every scene with the board's rate, and compares every event with the
/// one computed on this PC.
///
/// # Errors
/// The first difference, or no log or scene was found.
pub fn check_bundled(board: Board, forced: Option<Route>) -> Result<()> {
    let machine = Ready::new(board, forced)?;
    let weight = TestOptions { weight_n: Some(630.0), ..TestOptions::default() };
    let compared = |path: &PathBuf| -> Result<usize> {
        let options = if is_scene(path) { TestOptions::default() } else { weight.clone() };
        let name = path.strip_prefix(root()).unwrap_or(path).display().to_string();
        check(&machine, &name, &Record::read(path, &LogOptions::default(), &options)?)
    };
    let files = bundled()?;
    let counts = parallel::each(&files, compared).into_iter().sum::<Result<usize>>()?;
    let events = counts + check(&machine, "a sawtooth", &Record::stick_slip())?;
    println!("emulated: {} logs and scenes, {events} events bit for bit", files.len() + 1);
    println!("emulated: left out, as of another rate: {}", OF_ANOTHER_RATE.join(", "));
    Ok(())
}

/// Runs a bundled log on the image that is flashed, and compares console and card with the results
/// computed on this PC from the converter's codes, bit for bit.
///
/// # Errors
/// The first difference.
fn check_nucleo(nucleo: &Nucleo) -> Result<()> {
    let path = root().join("host-sim/logs/dff8-13.csv");
    let weight = TestOptions { weight_n: Some(630.0), ..TestOptions::default() };
    let record = Record::read(&path, &LogOptions::default(), &weight)?;
    let image = card::Image::large("nucleo")?;
    let run = nucleo.run(&record, Setup { card: Some(image.path()), ..Setup::default() })?;
    let outcome = outcome::decode(&run.shown)?;
    let same = outcome.compare(&record, &run.delivered)?;
    outcome.check_ticks()?;
    let kept = card::compare(image.path(), &run)?;
    println!("board: dff8-13.csv: {same}; card: {kept}");
    Ok(())
}

/// Tests the image that is flashed: with a log, then with all faults.
///
/// # Errors
/// The failed checks.
pub fn check_board(route: Route) -> Result<()> {
    let nucleo = Nucleo::prepare(Some(route))?;
    let long: [fn(&Nucleo) -> Result<()>; 2] = [check_nucleo, first_day::check_first_day];
    parallel::each(&long, |check| check(&nucleo)).into_iter().collect::<Result<()>>()?;
    check_faults(&nucleo)
}

/// The bundled logs and the scenes with the board's rate, in order.
fn bundled() -> Result<Vec<PathBuf>> {
    let mut found = files(&["host-sim/logs", "host-sim/scenes"].map(|folder| root().join(folder)))?;
    found.retain(|path| !OF_ANOTHER_RATE.iter().any(|name| path.ends_with(name)));
    if found.is_empty() { Err("no bundled logs: nothing to compare".into()) } else { Ok(found) }
}

/// Logs and scenes in some directories and their subdirectories, in order.
fn files(directories: &[PathBuf]) -> Result<Vec<PathBuf>> {
    let mut waiting = directories.to_vec();
    let mut found = Vec::new();
    while let Some(directory) = waiting.pop() {
        let failed = |e: std::io::Error| format!("{}: {e}", directory.display());
        for entry in std::fs::read_dir(&directory).map_err(failed)? {
            let path = entry.map_err(failed)?.path();
            let wanted = ["csv", "dat", "toml"].map(std::ffi::OsStr::new).map(Some);
            if path.is_dir() {
                waiting.push(path);
            } else if wanted.contains(&path.extension()) {
                found.push(path);
            }
        }
    }
    found.sort();
    Ok(found)
}

pub use card::{check_card, tool};
use faults::check_faults;
pub use live::check_live;
pub use troubles::check_troubles;

/// Runs and compares a record; returns the number of events.
fn check(machine: &Ready, name: &str, record: &Record) -> Result<usize> {
    let run = machine.run(record, Setup { samples: record.has_gaps(), ..Setup::default() })?;
    let outcome = outcome::decode(&run.shown)?;
    let same = outcome.compare(record, &run.delivered).map_err(|e| format!("{name}: {e}"))?;
    outcome.check_ticks().map_err(|e| format!("{name}: {e}"))?;
    println!("emulated: {name}: {} samples, {same}", outcome.report.counters.samples);
    Ok(outcome.events.len())
}

fn crc32(bytes: &[u8]) -> u32 {
    crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(bytes)
}

impl Args {
    fn log_options(&self) -> LogOptions {
        LogOptions { column: self.column.clone(), unit: self.unit, ..LogOptions::default() }
    }
}

/// Runs the command.
///
/// # Errors
/// A message of one line.
pub fn run(args: &Args, forced: Option<Route>) -> Result<()> {
    let record = Record::read(&args.log, &args.log_options(), &args.test)?;
    let machine = Ready::new(args.board, forced)?;
    let samples = args.live.is_some() || record.has_gaps();
    let card = match &args.card {
        None if args.live.is_some() => Some(card::of_live_runs()?),
        named => named.clone(),
    };
    let setup = Setup { samples, port: args.live, card: card.as_deref(), cut_at: None };
    let run = machine.run(&record, setup)?;
    let mut outcome = outcome::decode(&run.shown)?;
    // The report of a missing card is expected in a run without an image.
    outcome.troubles.retain(|t| card.is_some() || !t.starts_with("no card"));
    // Answer to the `stop` sent before the test.
    outcome.troubles.retain(|t| t != "no test is running");
    let health = &outcome.health;
    say(&format!(
        "{} samples in {:.1} s, {} lost, at most {} waiting; console {} bytes, CRC-32 {:08x}",
        health.samples,
        run.wall.as_secs_f64(),
        health.overruns,
        health.deepest,
        run.shown.len(),
        crc32(run.shown.as_bytes()),
    ));
    if args.live.is_some() && !outcome.is_whole(&record) {
        say("a person ended the test: not compared with this PC");
    } else {
        say(&outcome.compare(&record, &run.delivered)?);
    }
    if args.live.is_none() {
        outcome.check_ticks()?;
        if let Some(card) = &card {
            say(&format!("card: {}", card::compare(card, &run)?));
        }
    } else if let Some(card) = &card {
        say(&format!("the card: floe recover {} -o tests", card.display()));
    }
    for trouble in &outcome.troubles {
        say(&format!("the board says: {trouble}"));
    }
    let result = outcome.result(&args.log, &record)?;
    let text = serde_json::to_string_pretty(&result).map_err(|e| e.to_string())? + "\n";
    let done = match args.json.as_deref() {
        Some(path) if path.as_os_str() == "-" => output::print(&text),
        Some(path) => output::replace(path, &text),
        None => output::print(&table::text(&result).map_err(|e| e.to_string())?),
    };
    done.map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_out_is_there_and_of_another_rate() {
        for name in OF_ANOTHER_RATE {
            let scene = floe::cli::simulate::read_scene(&root().join(name), None).expect(name);
            assert!((scene.rate_hz - record::RATE_HZ).abs() > 1.0, "{name}");
        }
    }

    #[test]
    fn all_else_is_compared() {
        let found = bundled().expect("logs and scenes");
        let scenes = found.iter().filter(|path| is_scene(path));
        for path in scenes.clone() {
            let scene = floe::cli::simulate::read_scene(path, None).expect("a scene");
            assert!((scene.rate_hz - record::RATE_HZ).abs() < 0.2, "{}", path.display());
        }
        assert!(scenes.clone().count() > 50 && found.len() > scenes.count());
    }

    #[test]
    fn a_folder_that_is_not_there_is_an_error() {
        assert!(files(&[root().join("host-sim/no-such-folder")]).is_err());
    }
}
