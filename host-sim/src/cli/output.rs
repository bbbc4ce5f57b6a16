//! Writing results without ever leaving half a file or the input destroyed.

use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::Path;

use crate::error::InputError;

/// Writes to standard output. A reader that has gone away (`| head`) is no error.
///
/// # Errors
/// Standard output cannot be written.
pub fn print(text: &str) -> Result<(), InputError> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(InputError::new(format!("standard output cannot be written: {error}")))
        }
        _ => Ok(()),
    }
}

/// Refuses an output that cannot be written or that is one of `inputs`, before
/// any work is done.
///
/// # Errors
/// Names the output and what is wrong with it.
pub fn check(path: &Path, inputs: &[&Path]) -> Result<(), InputError> {
    let refuse = |why: &str| Err(InputError::new(why).within(path.display()));
    let same = |input: &Path| match (path.canonicalize(), input.canonicalize()) {
        (Ok(a), Ok(b)) => a == b,
        _ => path == input,
    };
    if inputs.iter().copied().any(same) {
        return refuse("is read or written already by this command; name another output");
    }
    if path.is_dir() {
        return refuse("is a directory; name a file to write");
    }
    if !directory(path).is_dir() {
        return refuse("its directory does not exist; make it first");
    }
    Ok(())
}

/// Replaces a file as a whole: the old one stays until the new one is complete.
///
/// # Errors
/// The file cannot be written; then nothing has changed.
pub fn replace(path: &Path, text: &str) -> Result<(), InputError> {
    stream(path, |out| out.write_all(text.as_bytes()))
}

/// Replaces a file as a whole by what `write` writes, piece by piece.
///
/// # Errors
/// The file cannot be written; then nothing has changed.
pub fn stream(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<(), InputError> {
    let target = path.canonicalize().unwrap_or_else(|_| path.to_path_buf());
    let written = match fs::metadata(&target) {
        // A device or a pipe is written to, not replaced.
        Ok(old) if !old.is_file() => File::options().write(true).open(&target).and_then(|file| {
            let mut out = BufWriter::new(file);
            write(&mut out).and_then(|()| out.flush())
        }),
        _ => replace_whole(&target, write),
    };
    written.map_err(|e| InputError::new(format!("cannot be written: {e}")).within(path.display()))
}

fn replace_whole(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> io::Result<()> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let new = directory(path).join(format!(".{name}.{}.part", std::process::id()));
    let fill = |file: File| {
        let mut out = BufWriter::new(file);
        write(&mut out).and_then(|()| out.flush()).and_then(|()| out.get_ref().sync_all())
    };
    let written = File::create_new(&new).and_then(fill).and_then(|()| fs::rename(&new, path));
    if written.is_err() {
        // What went wrong is told by the first error.
        let _ = fs::remove_file(&new);
    }
    written
}

/// Where a file is, or will be.
fn directory(path: &Path) -> &Path {
    path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}
