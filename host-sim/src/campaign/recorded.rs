//! A campaign of recorded logs: a directory, or a list of files.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use crate::error::InputError;
use crate::log::{Log, LogOptions};
use crate::replay::replay;
use crate::replay::test::{TestOptions, configure};

use super::{EventRecord, TestRecord};

/// Names of files in a directory that are taken for logs.
const EXTENSIONS: [&str; 3] = ["csv", "dat", "txt"];

/// The logs of a directory by name (`.csv`, `.dat`, `.txt`), or the files named
/// in a list, one a line, relative to the list; `#` begins a comment.
///
/// # Errors
/// A path that cannot be read, or no log at all.
pub fn logs(path: &Path) -> Result<Vec<PathBuf>, InputError> {
    let refused = |why: String| InputError::new(why).within(path.display());
    let unreadable = |error: std::io::Error| refused(format!("cannot be read: {error}"));
    let mut logs = Vec::new();
    if path.is_dir() {
        for entry in fs::read_dir(path).map_err(unreadable)? {
            logs.push(entry.map_err(unreadable)?.path());
        }
        logs.retain(|log| log.is_file() && is_log(log));
        logs.sort();
    } else {
        let list = fs::read_to_string(path).map_err(unreadable)?;
        let folder = path.parent().unwrap_or(Path::new("."));
        let names = list.lines().map(str::trim).filter(|l| !l.is_empty() && !l.starts_with('#'));
        logs.extend(names.map(|name| folder.join(name)));
    }
    if logs.is_empty() {
        return Err(refused("no logs: give a directory with .csv or .dat files, or a list".into()));
    }
    Ok(logs)
}

fn is_log(path: &Path) -> bool {
    let extension = path.extension().and_then(|extension| extension.to_str());
    extension.is_some_and(|e| EXTENSIONS.contains(&e))
}

/// Replays one log; weight and all else must be in its metadata.
///
/// # Errors
/// A log that cannot be used, by its name.
pub fn evaluate(path: &Path, test: u32) -> Result<TestRecord, InputError> {
    read(path, test).map_err(|error| error.within(path.display()))
}

fn read(path: &Path, test: u32) -> Result<TestRecord, InputError> {
    let file = File::open(path).map_err(|e| InputError::new(format!("cannot be opened: {e}")))?;
    let mut log = Log::from_reader(Box::new(file), &LogOptions::default())?;
    let config = configure(&log, &TestOptions::default())?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let result = replay(&name, &mut log, &config, |_, _| {})?;
    let said = log.metadata();
    let untold = |measured| EventRecord { measured, true_mu_s: None, true_mu: None };
    Ok(TestRecord {
        campaign: 0,
        test,
        test_id: result.test.test_id.unwrap_or(name.into_owned()),
        weight_n: result.test.weight_n,
        winch_m_per_s: said.winch_m_per_s,
        slope_rad: result.test.slope_rad,
        snow_mm: said.snow_mm,
        mu_s: result.estimate.mu_s,
        mu: result.estimate.mu,
        event_count: result.events.len(),
        events: result.events.into_iter().map(untold).collect(),
    })
}
