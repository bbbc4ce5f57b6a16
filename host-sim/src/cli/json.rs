//! `--json [FILE]`, the same in every command: bare, the result goes to standard output
//! and nothing else does; with a file, what a person reads still goes there.

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
        match (&self.json, self.file()) {
            (None, _) => output::print(&text()),
            (Some(_), None) => output::print(&json(result)?),
            (Some(_), Some(path)) => {
                output::replace(path, &json(result)?)?;
                output::print(&text())
            }
        }
    }
}

/// A result as text with a line end.
///
/// # Errors
/// A result that JSON cannot hold.
pub fn json(result: &impl Serialize) -> Result<String, InputError> {
    let text = serde_json::to_string_pretty(result);
    text.map(|text| text + "\n").map_err(|error| InputError::new(error.to_string()))
}
