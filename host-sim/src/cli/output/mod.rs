//! Writing results: never half a file, never over an input, and nothing to a terminal
//! that is not text.
//!
//! One rule for every command: before any work [`check()`] refuses files that must not be replaced.
//! An older result is replaced once the new one is complete ([`stream`]), and [`Older::tell`] says so.

mod behind;
mod check;
mod theirs;
mod write;

use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::Path;

use crate::error::{InputError, printable_line, printable_text};

pub use behind::Behind;
pub use check::{Older, check, check_folder, check_log, refuse, refuse_nowhere, refuse_standard};
pub use write::{make_folder, replace, stream};

/// A line over everything else of a log that was computed; nothing for a measured one.
pub fn simulated(said: Option<&str>) -> String {
    said.map(|said| format!("SIMULATED     {said}\n")).unwrap_or_default()
}

/// Writes to standard output, fit for a terminal. A reader that has gone away
/// (`| head`) is no error.
///
/// # Errors
/// Standard output cannot be written.
pub fn print(text: &str) -> Result<(), InputError> {
    print_by(|out| out.write_all(text.as_bytes()))
}

/// The same of what is written in pieces, each of them whole letters.
///
/// # Errors
/// Standard output cannot be written.
pub fn print_by(write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), InputError> {
    // The buffer hands on whole pieces.
    let mut out = BufWriter::new(Printable(std::io::stdout().lock()));
    let written = write(&mut out).and_then(|()| out.flush());
    match written {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(InputError::new(format!("standard output cannot be written: {error}")))
        }
        _ => Ok(()),
    }
}

/// Whether the reader of standard output has gone away, asked without writing.
#[cfg(unix)]
#[must_use]
pub fn nobody_reads() -> bool {
    use rustix::event::{PollFd, PollFlags, Timespec, poll};
    let out = io::stdout();
    let mut asked = [PollFd::new(&out, PollFlags::empty())];
    let at_once = Timespec { tv_sec: 0, tv_nsec: 0 };
    let gone = PollFlags::ERR | PollFlags::HUP;
    poll(&mut asked, Some(&at_once)).is_ok() && asked.iter().any(|it| it.revents().intersects(gone))
}

/// Always false: on other systems only a failed write shows it.
#[cfg(not(unix))]
#[must_use]
pub fn nobody_reads() -> bool {
    false
}

/// Lets through only what is fit for a terminal.
struct Printable<W>(W);

impl<W: Write> Write for Printable<W> {
    fn write(&mut self, piece: &[u8]) -> io::Result<usize> {
        let text = String::from_utf8_lossy(piece);
        self.0.write_all(printable_text(&text).as_bytes()).map(|()| piece.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

/// Says a line on standard error, fit for a terminal.
pub fn say(line: &str) {
    tell(&format!("floe: {}", printable_line(line)));
}

/// Says what is doubtful about a log on standard error.
pub fn warn(path: &str, warnings: &[String]) {
    for warning in warnings {
        say(&format!("warning: {path}: {warning}"));
    }
}

/// Puts a line on standard error. A failure is ignored: nobody reads it.
pub fn tell(line: &str) {
    let _ = writeln!(io::stderr(), "{line}");
}

/// Whether the name of a file ends so.
pub fn ends_with(path: &Path, extension: &str) -> bool {
    path.extension().is_some_and(|end| end.eq_ignore_ascii_case(extension))
}

/// Where a file is, or will be.
fn directory(path: &Path) -> &Path {
    path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}
