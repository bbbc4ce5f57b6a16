//! Opens logs.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use indicatif::{ProgressBar, ProgressBarIter};

use crate::error::InputError;

use super::progress;

/// Name of standard input or standard output.
pub const STANDARD: &str = "-";
/// Size of a file from which progress is shown, bytes.
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

/// Opens a file; for a long one progress is shown on a terminal.
///
/// # Errors
/// The file cannot be opened.
pub fn open_file(path: &Path, quiet: bool) -> Result<ProgressBarIter<File>, InputError> {
    if path.is_dir() {
        return Err(InputError::new("is a directory; name one log file"));
    }
    let file = File::open(path).map_err(InputError::unopened)?;
    let bytes = file.metadata().map_or(0, |metadata| metadata.len());
    let bar = match bytes >= LONG_BYTES && !quiet {
        true => progress::bar(bytes, "{bytes} of {total_bytes}, {eta} left"),
        false => ProgressBar::hidden(),
    };
    Ok(bar.wrap_read(file))
}
