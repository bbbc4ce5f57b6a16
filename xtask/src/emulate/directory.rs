//! The emulator's working directory.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicU32, Ordering};

use crate::Result;
use crate::shell::target;

/// Gone at the end.
#[derive(Debug)]
pub struct Directory(PathBuf);

impl Directory {
    /// An empty one.
    ///
    /// # Errors
    /// It cannot be made.
    pub fn new() -> Result<Self> {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let name = format!("emulate-{}-{number}", std::process::id());
        let directory = Self(target().join(name));
        fs::create_dir_all(&directory.0).map_err(|e| e.to_string())?;
        Ok(directory)
    }

    /// Both directions of the converter's line.
    ///
    /// # Errors
    /// There is no `mkfifo`.
    pub fn make_fifos(&self) -> Result<()> {
        for fifo in ["adc.in", "adc.out"] {
            let made = Command::new("mkfifo").arg(self.path(fifo)).status();
            if !made.is_ok_and(|status| status.success()) {
                return Err("cannot make a FIFO: is mkfifo installed?".into());
            }
        }
        Ok(())
    }

    /// A file from elsewhere under a name of its own.
    ///
    /// # Errors
    /// It is not there.
    pub fn link(&self, file: &Path, name: &str) -> Result<()> {
        let file = file.canonicalize().map_err(|e| format!("{}: {e}", file.display()))?;
        std::os::unix::fs::symlink(file, self.path(name)).map_err(|e| e.to_string())
    }

    /// Where it is.
    pub fn place(&self) -> &Path {
        &self.0
    }

    /// A file in it.
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
