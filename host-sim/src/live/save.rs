//! Saves the board's lines unchanged.

use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use crate::error::{InputError, printable_line};

/// A new file for the lines.
#[derive(Debug)]
pub struct Save {
    file: File,
    path: PathBuf,
}

impl Save {
    /// Creates the file.
    ///
    /// # Errors
    /// The file exists already, or cannot be created.
    pub fn create(path: &Path) -> Result<Self, InputError> {
        let file = File::create_new(path).map_err(|error| {
            let why = if error.kind() == ErrorKind::AlreadyExists {
                "is there already; name a new file".to_string()
            } else {
                format!("cannot be made: {error}")
            };
            InputError::new(why).within(path.display())
        })?;
        Ok(Self { file, path: path.to_path_buf() })
    }

    /// Appends a line at once, because the power may fail. Control characters are written as
    /// `\u001b`.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn line(&mut self, text: &str) -> Result<(), InputError> {
        self.file.write_all(format!("{}\n", printable_line(text)).as_bytes()).map_err(|error| {
            InputError::new(format!("cannot be written: {error}")).within(self.path.display())
        })
    }
}
