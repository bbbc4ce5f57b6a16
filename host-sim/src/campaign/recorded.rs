//! A campaign of recorded logs: a directory, a list of files, or a table of them.

use std::collections::HashMap;
use std::collections::hash_map::Entry as Slot;
use std::fs::{self, File};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::Read;
use std::path::{Path, PathBuf};

use floe_firmware::line::{Line, LineError};

use crate::error::{InputError, excerpt};
use crate::log::Log;
use crate::replay::replay_with;
use crate::replay::test::configure;
use crate::rounding::counted;
use crate::short_file;

use super::manifest::{self, Entry};
use super::{EventRecord, TestRecord, remedy};

/// Extensions of files in a directory that are taken for logs.
const EXTENSIONS: [&str; 4] = ["csv", "dat", "txt", "log"];

/// The logs of a campaign.
#[derive(Clone, Debug)]
pub struct Logs {
    /// One for each test.
    pub entries: Vec<Entry>,
    /// Files that were not read, with the reason, one sentence each.
    pub notes: Vec<String>,
}

/// The logs of a campaign. In a directory, files are recognized by name (`.csv`, `.dat`, `.txt`,
/// `.log`), with the information in its `tests.csv`. A list names one file per line, relative to
/// the list, with comments after `#`; a table has the form of `tests.csv`. The console output that
/// `floe recover` writes next to each log is skipped, and a log written in two forms counts once.
///
/// # Errors
/// A path that cannot be read, a log that is named twice, or no log.
pub fn logs(path: &Path) -> Result<Logs, InputError> {
    let found = if path.is_dir() { in_directory(path) } else { listed(path) };
    let logs = found.map_err(|error| error.within(path.display()))?;
    if logs.entries.is_empty() {
        let none = "no logs: give a directory with .csv, .dat, .txt or .log files, or a list";
        return Err(InputError::new(none).within(path.display()));
    }
    Ok(logs)
}

fn in_directory(folder: &Path) -> Result<Logs, InputError> {
    let table = folder.join(manifest::NAME);
    // A broken link counts as present.
    let mut entries = if table.symlink_metadata().is_ok() {
        tabled(&table).map_err(|error| error.within(manifest::NAME))?
    } else {
        Vec::new()
    };
    let (mut logs, mut notes) = content(folder)?;
    logs.retain(|path| *path != table);
    let mut known = HashMap::new();
    for entry in &entries {
        known.entry(identity(&entry.path)).or_insert_with(|| entry.path.clone());
    }
    for path in logs {
        match known.entry(identity(&path)) {
            Slot::Vacant(free) => {
                free.insert(path.clone());
                entries.push(Entry { path, ..Entry::default() });
            }
            // The log is in the table already.
            Slot::Occupied(same) if same.get().file_name() == path.file_name() => {}
            Slot::Occupied(same) => {
                let (path, same) = (path.display(), same.get().display());
                notes.push(format!("{path} is the log {same} again: it counts once"));
            }
        }
    }
    Ok(Logs { entries, notes })
}

/// The logs of a directory by name, including those that cannot be opened, which are reported
/// later; and the files not read, one sentence each.
fn content(folder: &Path) -> Result<(Vec<PathBuf>, Vec<String>), InputError> {
    let (mut logs, mut notes) = (Vec::new(), Vec::new());
    let (mut folders, mut others) = (0_u64, Vec::new());
    for entry in fs::read_dir(folder).map_err(InputError::unreadable)? {
        let path = entry.map_err(InputError::unreadable)?.path();
        match path.metadata() {
            Ok(there) if there.is_dir() => folders += 1,
            _ if !has_name_of_log(&path) => others.push(path),
            Ok(there) if !there.is_file() => {
                notes.push(format!("{} is no file and was not read", path.display()));
            }
            _ if is_said(&path) => {}
            _ => logs.push(path),
        }
    }
    logs.sort();
    if folders > 0 {
        let (folder, folders) = (folder.display(), counted(folders, "folder"));
        notes.push(format!(
            "{folder}: {folders} in it not looked into: a campaign takes one folder"
        ));
    }
    if let Some(first) = others.iter().min() {
        let others = counted(others.len() as u64, "other file");
        notes.push(format!(
            "{others} not read, such as {}: the names of logs end in .csv, .dat, .txt or .log",
            first.display()
        ));
    }
    Ok((logs, notes))
}

/// Identifies a log on any path: its path without links; for the second form of a test written by
/// `floe recover`, the path of the CSV.
fn identity(path: &Path) -> PathBuf {
    let path = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    let csv = path.with_extension("csv");
    if csv.is_file() && head(&path).starts_with("\"TOA5\",\"floe\",\"floe\",") { csv } else { path }
}

/// Rejects a log named on two lines, unless each line uses another force of it.
fn once(entries: &[Entry]) -> Result<(), InputError> {
    let mut lines = HashMap::new();
    for Entry { path, log, line, .. } in entries {
        let key = (identity(path), log.array_id, log.column.as_ref());
        if let Some(first) = lines.insert(key, line) {
            return Err(InputError::new(format!(
                "line {line}: the log {} stands in line {first} already: leave one of them out",
                excerpt(path.file_name().unwrap_or_default().as_encoded_bytes())
            )));
        }
    }
    Ok(())
}

fn tabled(table: &Path) -> Result<Vec<Entry>, InputError> {
    let text = short_file::read(table).map_err(InputError::unreadable)?;
    let entries = manifest::read(&text, table.parent().unwrap_or(Path::new(".")))?;
    once(&entries).map(|()| entries)
}

fn listed(path: &Path) -> Result<Logs, InputError> {
    let list = short_file::read(path).map_err(InputError::unreadable)?;
    if manifest::is_manifest(&list) {
        return Ok(Logs { entries: tabled(path)?, notes: Vec::new() });
    }
    let folder = path.parent().unwrap_or(Path::new("."));
    let names = (1..).zip(list.lines().map(str::trim));
    let names = names.filter(|(_, name)| !name.is_empty() && !name.starts_with('#'));
    let entry = |(line, name)| Entry { path: folder.join(name), line, ..Entry::default() };
    let entries: Vec<Entry> = names.clone().map(entry).collect();
    if let (Some((_, first)), false) =
        (names.clone().next(), entries.iter().any(|it| it.path.is_file()))
    {
        let first = excerpt(first.as_bytes());
        return Err(InputError::new(format!(
            "no line of it names a file, such as {first}; a list names one log a line, a table begins \
             with a line of column names, 'file' among them, and a log itself goes to floe replay"
        )));
    }
    once(&entries)?;
    Ok(Logs { entries, notes: Vec::new() })
}

fn has_name_of_log(path: &Path) -> bool {
    let extension = path.extension().and_then(|extension| extension.to_str());
    extension.is_some_and(|e| EXTENSIONS.contains(&e.to_ascii_lowercase().as_str()))
}

/// The beginning of a file; empty if it cannot be read.
fn head(path: &Path) -> String {
    let mut head = Vec::new();
    let _ = File::open(path).and_then(|file| file.take(512).read_to_end(&mut head));
    String::from_utf8_lossy(&head).into_owned()
}

/// Whether a file contains the output of a logger's console, or would if there were any.
fn is_said(path: &Path) -> bool {
    let head = head(path);
    let is_line =
        |text| !matches!(Line::parse(text), Err(LineError::NoChecksum | LineError::Checksum));
    match head.lines().next() {
        Some(first) => is_line(first),
        None => {
            path.extension().is_some_and(|e| e == "txt") && path.with_extension("csv").is_file()
        }
    }
}

/// Replays one log; the weight and other inputs must be in its metadata or in the table.
///
/// # Errors
/// A log that cannot be used, with its name.
pub fn evaluate(entry: &Entry, test: u32) -> Result<TestRecord, InputError> {
    let read = read(entry, test);
    read.map_err(|error| remedy::of_error(&error).within(entry.path.display()))
}

fn read(entry: &Entry, test: u32) -> Result<TestRecord, InputError> {
    let path = &entry.path;
    let file = File::open(path).map_err(InputError::unopened)?;
    let mut log = Log::from_reader(Box::new(file), &entry.log.settled_by(&entry.test))?;
    let config = configure(&log, &entry.test)?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let around = entry.test.around();
    let mut forces = DefaultHasher::new();
    let result = replay_with(&name, &mut log, &config, around, |_, step| {
        (step.sample.index, step.sample.force_n.map(f32::to_bits)).hash(&mut forces);
    })?;
    let said = log.metadata();
    let mut events: Vec<EventRecord> = Vec::with_capacity(result.events.found());
    let kept = result.events.for_each(|measured| {
        events.push(EventRecord { measured, true_mu_s: None, true_mu: None });
        Ok(())
    });
    kept.map_err(InputError::new)?;
    let notes = entry.notes.clone();
    Ok(TestRecord {
        campaign: 0,
        test,
        test_id: notes.test_id.or(result.test.test_id).unwrap_or(name.into_owned()),
        path: Some(path.display().to_string()),
        weight_n: result.test.weight_n,
        winch_m_per_s: entry.test.winch_m_per_s.or(said.winch_m_per_s),
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
        warnings: result.log.warnings.iter().map(|it| remedy::of_text(it)).collect(),
        synthetic: result.log.synthetic,
        forces: forces.finish(),
        events,
    })
}
