//! `--json [FILE]`, the same in every command: bare, the result goes to standard output
//! and nothing else does; with a file, what a person reads still goes there.

use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::error::InputError;

use super::input::STANDARD;
use super::output;

/// The option.
#[derive(Clone, Debug, Default, clap::Args)]
pub struct Json {
    /// Write JSON to FILE, or to standard output and nothing else there
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = STANDARD)]
    pub json: Option<PathBuf>,
}

impl Json {
    /// The file, if one is named.
    #[must_use]
    pub fn file(&self) -> Option<&Path> {
        self.json.as_deref().filter(|path| *path != Path::new(STANDARD))
    }

    /// The log, and where its result goes. In `--json LOG` without another log, what looks
    /// like the output is the log.
    ///
    /// # Errors
    /// There is no log.
    pub fn with_log(&self, log: Option<&str>) -> Result<(String, Self), InputError> {
        if let Some(log) = log {
            return Ok((log.to_string(), self.clone()));
        }
        let log = self.file().filter(|file| file.is_file()).and_then(Path::to_str);
        let log = log.ok_or_else(|| {
            InputError::new("no log given: name a file, or - for standard input (see --help)")
        })?;
        Ok((log.to_string(), Self { json: Some(STANDARD.into()) }))
    }

    /// Writes a result where it was asked for; `text` is for a person.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn print(
        &self,
        result: &impl Serialize,
        text: impl FnOnce() -> String,
    ) -> Result<(), InputError> {
        self.print_by(result, |out| out.write_all(text().as_bytes()))
    }

    /// The same with a text that is written piece by piece.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn print_by(
        &self,
        result: &impl Serialize,
        text: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<(), InputError> {
        match (&self.json, self.file()) {
            (None, _) => output::print_by(text),
            (Some(_), None) => output::print_by(|out| write(result, &mut BufWriter::new(out))),
            (Some(_), Some(path)) => {
                output::stream(path, |out| write(result, out))?;
                output::print_by(text)
            }
        }
    }
}

/// A result with a line end.
pub(super) fn write(result: &impl Serialize, out: &mut impl Write) -> io::Result<()> {
    serde_json::to_writer_pretty(&mut *out, result)?;
    out.write_all(b"\n")?;
    out.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_went_wrong_is_told_as_it_was() {
        struct Gone;
        impl Write for Gone {
            fn write(&mut self, _: &[u8]) -> io::Result<usize> {
                Err(io::ErrorKind::BrokenPipe.into())
            }
            fn flush(&mut self) -> io::Result<()> {
                Ok(())
            }
        }
        for value in [serde_json::json!(1), serde_json::json!({"a": []})] {
            assert_eq!(write(&value, &mut Gone).unwrap_err().kind(), io::ErrorKind::BrokenPipe);
        }
    }
}
