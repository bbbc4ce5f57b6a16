//! The emulator's working directory.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicU32, Ordering};

use crate::Result;
use crate::shell::target;

/// A temporary directory, deleted when dropped.
#[derive(Debug)]
pub struct Directory(PathBuf);

impl Directory {
    /// Creates an empty directory.
    ///
    /// # Errors
    /// The directory cannot be created.
    pub fn new() -> Result<Self> {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let name = format!("emulate-{}-{number}", std::process::id());
        let directory = Self(target().join(name));
        fs::create_dir_all(&directory.0).map_err(|e| e.to_string())?;
        Ok(directory)
    }

    /// Creates the FIFOs for both directions of the converter's line.
    ///
    /// # Errors
    /// `mkfifo` fails.
    pub fn make_fifos(&self) -> Result<()> {
        for fifo in ["adc.in", "adc.out"] {
            let made = Command::new("mkfifo").arg(self.path(fifo)).status();
            if !made.is_ok_and(|status| status.success()) {
                return Err("cannot make a FIFO: is mkfifo installed?".into());
            }
        }
        Ok(())
    }

    /// Links a file into the directory under another name.
    ///
    /// # Errors
    /// The file does not exist.
    pub fn link(&self, file: &Path, name: &str) -> Result<()> {
        let file = file.canonicalize().map_err(|e| format!("{}: {e}", file.display()))?;
        std::os::unix::fs::symlink(file, self.path(name)).map_err(|e| e.to_string())
    }

    /// Path of the directory.
    pub fn place(&self) -> &Path {
        &self.0
    }

    /// Path of a file in the directory.
    pub fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    /// Writes a file.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn write(&self, name: &str, text: &str) -> Result<()> {
        fs::write(self.path(name), text).map_err(|e| e.to_string())
    }
}

impl Drop for Directory {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}
