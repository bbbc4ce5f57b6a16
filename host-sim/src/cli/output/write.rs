//! Writing a file as a whole: the old one stays until the new one is complete, and keeps its mode.

use std::collections::BTreeSet;
use std::fs::{self, File, Metadata};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, Once};

use crate::error::InputError;

use super::behind::{self, Behind};
use super::directory;

/// Makes a folder for outputs, if it is not there, and none above it.
///
/// # Errors
/// It cannot be made.
pub fn make_folder(folder: &Path) -> Result<(), InputError> {
    if folder.is_dir() {
        return Ok(());
    }
    fs::create_dir(folder)
        .map_err(|e| InputError::new(format!("cannot be made: {e}")).within(folder.display()))
}

/// Replaces a file as a whole: the old one stays until the new one is complete.
///
/// # Errors
/// The file cannot be written; then nothing has changed.
pub fn replace(path: &Path, text: &str) -> Result<(), InputError> {
    stream(path, |out| out.write_all(text.as_bytes()))
}

/// Replaces a file as a whole by what `write` writes, piece by piece. Gives what that gives.
///
/// # Errors
/// The file cannot be written, or an [`InputError`] of `write` as it is; then nothing has changed.
pub fn stream<T>(
    path: &Path,
    write: impl FnOnce(&mut Behind) -> io::Result<T>,
) -> Result<T, InputError> {
    // A link to a file stays a link; one that leads nowhere is not followed.
    let target = path.canonicalize().unwrap_or_else(|_| path.to_path_buf());
    let fill = |file: File| behind::fill(file, write);
    let written = match fs::metadata(&target).ok() {
        // A device or a pipe is written to, not replaced.
        Some(old) if !old.is_file() => {
            File::options().write(true).open(&target).and_then(fill).map(|(made, _)| made)
        }
        old => replace_whole(&target, old.as_ref(), fill),
    };
    written.map_err(|error| {
        error.downcast().unwrap_or_else(|error| {
            InputError::new(format!("cannot be written: {error}")).within(path.display())
        })
    })
}

fn replace_whole<T>(
    path: &Path,
    old: Option<&Metadata>,
    fill: impl FnOnce(File) -> io::Result<(T, File)>,
) -> io::Result<T> {
    let new = Unfinished::beside(path);
    let (made, file) = fill(File::create_new(&new.0)?)?;
    if let Some(old) = old {
        file.set_permissions(old.permissions())?;
    }
    file.sync_all()?;
    fs::rename(&new.0, path).map(|()| made)
}

/// A file that is being written. It is gone when this is, and when the program is
/// stopped by a signal.
struct Unfinished(PathBuf);

static UNFINISHED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

impl Unfinished {
    fn beside(path: &Path) -> Self {
        static HANDLER: Once = Once::new();
        // Without a handler an interrupt leaves the file, under a name that says so.
        HANDLER.call_once(|| drop(ctrlc::set_handler(remove_unfinished)));
        // The longest name that any file system takes is 255 bytes.
        let name: String =
            path.file_name().unwrap_or_default().to_string_lossy().chars().take(50).collect();
        let path = directory(path).join(format!(".{name}.{}.part", std::process::id()));
        if let Ok(mut all) = UNFINISHED.lock() {
            all.insert(path.clone());
        }
        Self(path)
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        if let Ok(mut all) = UNFINISHED.lock() {
            // After a success it has been renamed; after a failure the first error is reported.
            let _ = fs::remove_file(&self.0);
            all.remove(&self.0);
        }
    }
}

/// What a signal does.
fn remove_unfinished() {
    if let Ok(all) = UNFINISHED.lock() {
        for path in all.iter() {
            let _ = fs::remove_file(path);
        }
        // As shells report an interrupt. Nobody may begin another file meanwhile.
        std::process::exit(130);
    }
    std::process::exit(130);
}
