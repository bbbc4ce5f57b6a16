//! Existing files that no output may replace: all except Floe's own.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;

use crate::error::InputError;
use crate::sim::write::SYNTHETIC;

/// Beginnings of results: JSON, events, samples, extensions, reports, figures.
const RESULTS: [&str; 6] = [
    "{\n  \"schema\": \"floe-",
    "index,onset_s,stop_s,",
    "time_s,force_n,rate_n_per_s,phase,",
    "pull,extension_m,force_n\n",
    "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"/><meta http-equiv=",
    "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"plot ",
];

/// Beginning of a Parquet table, and the text near the end of Floe's.
const PARQUET: (&[u8], &[u8]) = (b"PAR1", b"floe.version");

/// Bytes examined at the beginning and at the end.
const LOOK: u64 = 4096;

/// Rejects replacing a file by a result, unless it is empty or an older result.
///
/// # Errors
/// The file is another one, for example a log that a shell's `*.csv` names as the output.
pub fn refuse(path: &Path) -> Result<(), InputError> {
    unless(path, is_result, "is there already and is no result of floe")
}

/// Rejects replacing a file by a simulated log, unless it is empty or a simulated log.
///
/// # Errors
/// The file is another one, or a simulated log without a mark: the CR10's form has no place for it.
pub fn refuse_but_simulated(path: &Path) -> Result<(), InputError> {
    let why = "is there already and does not begin with '# SYNTHETIC:', as simulated logs do";
    unless(path, |start, _| start.starts_with(SYNTHETIC.as_bytes()), why)
}

fn unless(path: &Path, own: fn(&[u8], &[u8]) -> bool, why: &str) -> Result<(), InputError> {
    // A device or a pipe is written to, not replaced.
    if !path.is_file() {
        return Ok(());
    }
    // A file that cannot be read is rejected, because its contents are unknown.
    if ends(path).is_ok_and(|(start, end)| start.is_empty() || own(&start, &end)) {
        return Ok(());
    }
    Err(InputError::new(format!("{why}; name another file, or remove it")).within(path.display()))
}

fn is_result(start: &[u8], end: &[u8]) -> bool {
    let (begin, said) = PARQUET;
    let says_so = || end.windows(said.len()).any(|it| it == said);
    RESULTS.iter().any(|it| start.starts_with(it.as_bytes()))
        || start.starts_with(begin) && says_so()
}

/// The beginning and the end of a file.
fn ends(path: &Path) -> io::Result<(Vec<u8>, Vec<u8>)> {
    let mut file = File::open(path)?;
    let (mut start, mut end) = (Vec::new(), Vec::new());
    Read::by_ref(&mut file).take(LOOK).read_to_end(&mut start)?;
    let length = file.metadata()?.len();
    file.seek(SeekFrom::Start(length.saturating_sub(LOOK)))?;
    file.take(LOOK).read_to_end(&mut end)?;
    Ok((start, end))
}
