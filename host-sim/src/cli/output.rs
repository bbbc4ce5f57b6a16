//! Writing results: never half a file, never over an input, and nothing to a terminal
//! that is not text.
//!
//! One rule for every command. Before any work [`check`] refuses an output that is an
//! input or another output, by whatever path or link, or a file that is no older result;
//! one that is is replaced as a whole once the new one is complete, keeps its mode, and
//! [`Older::tell`] says so.

use std::collections::BTreeSet;
use std::fs::{self, File, Metadata};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, Once};

use crate::error::{InputError, printable_line, printable_text};

use super::input::STANDARD;
use super::theirs;

/// Bytes that are written to a file at once.
const BUFFER: usize = 1 << 16;

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

/// Only a write tells.
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

/// Puts a line on standard error; if nobody can read it there, there is nobody to tell.
pub fn tell(line: &str) {
    let _ = writeln!(io::stderr(), "{line}");
}

/// Outputs that were there before, and as what.
#[derive(Clone, Debug, PartialEq, Eq)]
#[must_use = "what is replaced is said"]
pub struct Older(Vec<(PathBuf, &'static str)>);

impl Older {
    /// Says, once all is written, that they have been replaced.
    pub fn tell(&self) {
        for (path, what) in &self.0 {
            say(&format!("{}: the {what} that was there has been replaced", path.display()));
        }
    }
}

/// Refuses outputs that cannot be written, or that are one of `inputs`, standard input
/// or output, each other, or a file that is none of floe's. Gives those that are there already.
///
/// # Errors
/// Names the first such output and what is wrong with it.
pub fn check(outputs: &[&Path], inputs: &[&Path]) -> Result<Older, InputError> {
    let older = apart(outputs, inputs)?;
    outputs.iter().try_for_each(|path| theirs::refuse(path)).map(|()| older)
}

/// The same of a log and of what is written beside it: it may replace a simulated log only.
///
/// # Errors
/// As [`check`].
pub fn check_log(log: &Path, beside: &[&Path], inputs: &[&Path]) -> Result<Older, InputError> {
    let older = apart(&[&[log], beside].concat(), inputs)?;
    theirs::refuse_but_simulated(log)?;
    beside.iter().try_for_each(|path| theirs::refuse(path)).map(|()| older)
}

/// Refuses outputs that cannot be written, or are read or written already.
fn apart(outputs: &[&Path], inputs: &[&Path]) -> Result<Older, InputError> {
    let standard = ["/dev/stdin", "/dev/stdout"].map(Path::new);
    let taken = inputs.iter().copied().chain(standard);
    let mut taken: Vec<Identity> = taken.filter_map(Identity::of).collect();
    for path in outputs {
        refuse_standard(path)?;
        let refuse = |why: &str| Err(InputError::new(why).within(path.display()));
        if path.is_dir() {
            return refuse("is a directory; name a file to write");
        }
        if !directory(path).is_dir() {
            return refuse("its directory does not exist; make it first");
        }
        if let Some(identity) = Identity::of(path) {
            if taken.contains(&identity) {
                return refuse("is read or written already by this command; name another output");
            }
            taken.push(identity);
        }
    }
    let older = |path: &&Path| Some((path.to_path_buf(), kind(path)?));
    Ok(Older(outputs.iter().filter_map(older).collect()))
}

/// What would be replaced, if anything is there.
fn kind(path: &Path) -> Option<&'static str> {
    match path.exists() {
        true => path.is_file().then_some("file"),
        false => path.is_symlink().then_some("link to nowhere"),
    }
}

/// Refuses `-` for an output that is a file or a folder.
///
/// # Errors
/// It is `-`.
pub fn refuse_standard(path: &Path) -> Result<(), InputError> {
    if path != Path::new(STANDARD) {
        return Ok(());
    }
    Err(InputError::new(
        "-: only --json goes to standard output; name a file (./- is one called -)",
    ))
}

/// Makes a folder for outputs, if it is not there.
///
/// # Errors
/// It cannot be made.
pub fn make_folder(folder: &Path) -> Result<(), InputError> {
    fs::create_dir_all(folder)
        .map_err(|e| InputError::new(format!("cannot be made: {e}")).within(folder.display()))
}

/// Refuses a folder that cannot be made, or that would be made where one of `outputs` is.
///
/// # Errors
/// Says what is in its place.
pub fn check_folder(folder: &Path, outputs: &[&Path]) -> Result<(), InputError> {
    refuse_standard(folder)?;
    let refuse = |why: &str| Err(InputError::new(why).within(folder.display()));
    if folder.is_file() {
        return refuse("is a file; name a directory");
    }
    let taken: Vec<Identity> = outputs.iter().filter_map(|path| Identity::of(path)).collect();
    if folder.ancestors().filter_map(Identity::of).any(|place| taken.contains(&place)) {
        return refuse("is written already by this command as a file; name another directory");
    }
    Ok(())
}

/// What makes a file the same by any path.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Identity {
    /// An existing file: its file system and its number there.
    #[cfg(unix)]
    Node(u64, u64),
    /// A file that is not there yet, or one of a system without such numbers.
    Place(PathBuf),
}

impl Identity {
    /// `None` for what several may write at once: a terminal, `/dev/null`.
    fn of(path: &Path) -> Option<Self> {
        match fs::metadata(path) {
            Ok(there) => Self::of_existing(path, &there),
            Err(_) => {
                let place = directory(path).canonicalize().ok()?;
                Some(Self::Place(place.join(path.file_name()?)))
            }
        }
    }

    #[cfg(unix)]
    fn of_existing(_: &Path, there: &Metadata) -> Option<Self> {
        use std::os::unix::fs::{FileTypeExt, MetadataExt};
        let shared = there.file_type().is_char_device();
        (!shared).then(|| Self::Node(there.dev(), there.ino()))
    }

    #[cfg(not(unix))]
    fn of_existing(path: &Path, _: &Metadata) -> Option<Self> {
        path.canonicalize().ok().map(Self::Place)
    }
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
    // A link to a file stays a link; one that leads nowhere is not followed.
    let target = path.canonicalize().unwrap_or_else(|_| path.to_path_buf());
    let written = match fs::metadata(&target) {
        // A device or a pipe is written to, not replaced.
        Ok(old) if !old.is_file() => File::options().write(true).open(&target).and_then(|file| {
            let mut out = BufWriter::with_capacity(BUFFER, file);
            write(&mut out).and_then(|()| out.flush())
        }),
        Ok(old) => replace_whole(&target, Some(&old), write),
        Err(_) => replace_whole(&target, None, write),
    };
    written.map_err(|e| InputError::new(format!("cannot be written: {e}")).within(path.display()))
}

fn replace_whole(
    path: &Path,
    old: Option<&Metadata>,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> io::Result<()> {
    let new = Unfinished::beside(path);
    let fill = |file: File| {
        let mut out = BufWriter::with_capacity(BUFFER, file);
        write(&mut out).and_then(|()| out.flush())?;
        if let Some(old) = old {
            out.get_ref().set_permissions(old.permissions())?;
        }
        out.get_ref().sync_all()
    };
    File::create_new(&new.0).and_then(fill).and_then(|()| fs::rename(&new.0, path))
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
            // Renamed, if all went well; what went wrong is told by the first error.
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

/// Where a file is, or will be.
fn directory(path: &Path) -> &Path {
    path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}
