//! The board's lines, kept as they came.

use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use crate::error::{InputError, printable_line};

/// A new file for lines.
#[derive(Debug)]
pub struct Save {
    file: File,
    path: PathBuf,
}

impl Save {
    /// Makes the file.
    ///
    /// # Errors
    /// It is there already, or cannot be made.
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

    /// Adds a line at once: the power may fail. What would command a terminal is written
    /// as `\u001b`.
    ///
    /// # Errors
    /// The file cannot be written any more.
    pub fn line(&mut self, text: &str) -> Result<(), InputError> {
        self.file.write_all(format!("{}\n", printable_line(text)).as_bytes()).map_err(|error| {
            InputError::new(format!("cannot be written: {error}")).within(self.path.display())
        })
    }
}
