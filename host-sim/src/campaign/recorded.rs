//! A campaign of recorded logs: a directory, a list of files, or a table of them.

use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};

use floe_firmware::line::{Line, LineError};

use crate::error::{InputError, excerpt};
use crate::log::Log;
use crate::replay::replay_with;
use crate::replay::test::configure;
use crate::short_file;

use super::manifest::{self, Entry};
use super::{EventRecord, TestRecord};

/// Names of files in a directory that are taken for logs.
const EXTENSIONS: [&str; 4] = ["csv", "dat", "txt", "log"];

/// The logs of a directory by name (`.csv`, `.dat`, `.txt`, `.log`), with what its
/// `tests.csv` says of them; the files named in a list, one a line, relative to the list,
/// `#` begins a comment; or those of a table like `tests.csv`. What a logger said, as
/// `floe recover` leaves it beside each log, is no log.
///
/// # Errors
/// A path that cannot be read, or no log at all.
pub fn logs(path: &Path) -> Result<Vec<Entry>, InputError> {
    let found = if path.is_dir() { in_directory(path) } else { listed(path) };
    let logs = found.map_err(|error| error.within(path.display()))?;
    if logs.is_empty() {
        let none = "no logs: give a directory with .csv or .dat files, or a list";
        return Err(InputError::new(none).within(path.display()));
    }
    Ok(logs)
}

fn unreadable(error: std::io::Error) -> InputError {
    InputError::new(format!("cannot be read: {error}"))
}

fn in_directory(folder: &Path) -> Result<Vec<Entry>, InputError> {
    let table = folder.join(manifest::NAME);
    let mut entries = if table.is_file() {
        listed(&table).map_err(|e| e.within(manifest::NAME))?
    } else {
        Vec::new()
    };
    let mut others: Vec<PathBuf> = Vec::new();
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        others.push(entry.map_err(unreadable)?.path());
    }
    let named = |path: &PathBuf| entries.iter().any(|entry| entry.path == *path);
    others.retain(|path| *path != table && path.is_file() && is_log(path) && !named(path));
    others.sort();
    entries.extend(others.into_iter().map(|path| Entry { path, ..Entry::default() }));
    Ok(entries)
}

fn listed(path: &Path) -> Result<Vec<Entry>, InputError> {
    let list = short_file::read(path).map_err(unreadable)?;
    let folder = path.parent().unwrap_or(Path::new("."));
    if manifest::is_manifest(&list) {
        return manifest::read(&list, folder);
    }
    let names = list.lines().map(str::trim).filter(|l| !l.is_empty() && !l.starts_with('#'));
    let entry = |name| Entry { path: folder.join(name), ..Entry::default() };
    let entries: Vec<Entry> = names.clone().map(entry).collect();
    if let (Some(first), false) = (names.clone().next(), entries.iter().any(|it| it.path.is_file()))
    {
        let first = excerpt(first.as_bytes());
        return Err(InputError::new(format!(
            "no line of it names a file, such as {first}; a list names one log a line, and a log \
             itself goes to floe replay"
        )));
    }
    Ok(entries)
}

fn is_log(path: &Path) -> bool {
    let extension = path.extension().and_then(|extension| extension.to_str());
    let known = |e: &str| EXTENSIONS.contains(&e.to_ascii_lowercase().as_str());
    extension.is_some_and(known) && !is_said(path)
}

/// Whether a file holds the lines of a logger's console.
fn is_said(path: &Path) -> bool {
    let mut head = Vec::new();
    let read = File::open(path).and_then(|file| file.take(512).read_to_end(&mut head));
    let head = String::from_utf8_lossy(&head);
    let first = head.lines().next().unwrap_or_default();
    let is_line =
        |text| !matches!(Line::parse(text), Err(LineError::NoChecksum | LineError::Checksum));
    read.is_ok() && is_line(first)
}

/// Replays one log; weight and all else must be in its metadata or in the table.
///
/// # Errors
/// A log that cannot be used, by its name.
pub fn evaluate(entry: &Entry, test: u32) -> Result<TestRecord, InputError> {
    read(entry, test).map_err(|error| error.within(entry.path.display()))
}

fn read(entry: &Entry, test: u32) -> Result<TestRecord, InputError> {
    let path = &entry.path;
    let file = File::open(path).map_err(|e| InputError::new(format!("cannot be opened: {e}")))?;
    let mut log = Log::from_reader(Box::new(file), &entry.log)?;
    let config = configure(&log, &entry.test)?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let around = entry.test.around(&log);
    let result = replay_with(&name, &mut log, &config, around, |_, _| {})?;
    let said = log.metadata();
    let untold = |measured| EventRecord { measured, true_mu_s: None, true_mu: None };
    let mut events: Vec<EventRecord> = Vec::with_capacity(result.events.found());
    let kept = result.events.for_each(|event| {
        events.push(untold(event));
        Ok(())
    });
    kept.map_err(|e| InputError::new(e.to_string()))?;
    let notes = entry.notes.clone();
    Ok(TestRecord {
        campaign: 0,
        test,
        test_id: notes.test_id.or(result.test.test_id).unwrap_or(name.into_owned()),
        weight_n: result.test.weight_n,
        winch_m_per_s: notes.winch_m_per_s.or(said.winch_m_per_s),
        slope_rad: result.test.slope_rad,
        snow_mm: notes.snow_mm.or(said.snow_mm),
        kind: notes.kind.or_else(|| said.kind.clone()),
        track: notes.track.or_else(|| said.track.clone()),
        cable_length_m: notes.cable_length_m.or(said.cable_length_m),
        start_time: log.start().and_then(|start| start.after(0.0)),
        temperature_c: said.temperature_c,
        supply_v: said.supply_v,
        hold_s: TestRecord::mean_hold_s(&events),
        mu_s: result.estimate.mu_s,
        mu: result.estimate.mu,
        event_count: events.len(),
        warnings: result.log.warnings,
        events,
    })
}
