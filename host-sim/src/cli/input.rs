//! Opening a log.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use indicatif::{ProgressBar, ProgressBarIter};

use crate::error::InputError;

use super::progress;

/// Stands for standard input, or standard output.
pub const STANDARD: &str = "-";
/// Files from this size on show how far they are read.
const LONG_BYTES: u64 = 16 << 20;

/// Opens a log, or standard input for `-`.
///
/// # Errors
/// The file cannot be opened.
pub fn open(path: &str, quiet: bool) -> Result<Box<dyn Read + Send>, InputError> {
    if path == STANDARD {
        return Ok(Box::new(std::io::stdin()));
    }
    Ok(Box::new(open_file(Path::new(path), quiet)?))
}

/// Opens a file; a long one shows on a terminal how far it is read.
///
/// # Errors
/// The file cannot be opened.
pub fn open_file(path: &Path, quiet: bool) -> Result<ProgressBarIter<File>, InputError> {
    if path.is_dir() {
        return Err(InputError::new("is a directory; name one log file"));
    }
    let file = File::open(path).map_err(|error| {
        let missing = error.kind() == std::io::ErrorKind::NotFound;
        let what =
            if missing { "no such file".into() } else { format!("cannot be opened: {error}") };
        InputError::new(what)
    })?;
    let bytes = file.metadata().map_or(0, |metadata| metadata.len());
    let bar = match bytes >= LONG_BYTES && !quiet {
        true => progress::bar(bytes, "{bytes} of {total_bytes}, {eta} left"),
        false => ProgressBar::hidden(),
    };
    Ok(bar.wrap_read(file))
}
