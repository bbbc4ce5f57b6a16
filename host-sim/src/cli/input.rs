//! Opening a log.

use std::fs::File;
use std::io::{IsTerminal, Read};
use std::path::Path;

use indicatif::{ProgressBar, ProgressStyle};

use crate::error::InputError;

/// Stands for standard input, or standard output.
pub const STANDARD: &str = "-";
/// Logs from this size on show a progress bar.
const LONG_LOG_BYTES: u64 = 16 << 20;

/// Opens a log, or standard input for `-`; a long file shows its progress on a terminal.
///
/// # Errors
/// The file cannot be opened.
pub fn open(path: &str, quiet: bool) -> Result<Box<dyn Read + Send>, InputError> {
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
