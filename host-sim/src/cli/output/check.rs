//! Checks outputs before any work. An output is rejected if it is an input or another output, on
//! any path or link, or a file that is not an older result.

use std::fs::{self, Metadata};
use std::path::{Path, PathBuf};

use super::super::input::STANDARD;
use crate::error::InputError;

use super::{directory, say, theirs};

/// Outputs that exist already, with their kind.
#[derive(Clone, Debug, PartialEq, Eq)]
#[must_use = "what is replaced is said"]
pub struct Older(Vec<(PathBuf, &'static str)>);

impl Older {
    /// Reports the replaced files, after all is written.
    pub fn tell(&self) {
        for (path, what) in &self.0 {
            say(&format!("{}: the {what} that was there has been replaced", path.display()));
        }
    }
}

/// Rejects outputs that cannot be written, that are one of `inputs`, standard input or output, or
/// each other, or that are files of other programs. Returns the existing ones.
///
/// # Errors
/// The first such output, with the reason.
pub fn check(outputs: &[&Path], inputs: &[&Path]) -> Result<Older, InputError> {
    let older = apart(outputs, inputs)?;
    outputs.iter().try_for_each(|path| theirs::refuse(path)).map(|()| older)
}

/// Checks a simulated log and the outputs next to it, as [`check`] does; the log may replace a
/// simulated log only.
///
/// # Errors
/// The first output that is rejected, with the reason.
pub fn check_log(log: &Path, beside: &[&Path], inputs: &[&Path]) -> Result<Older, InputError> {
    let older = apart(&[&[log], beside].concat(), inputs)?;
    theirs::refuse_but_simulated(log)?;
    beside.iter().try_for_each(|path| theirs::refuse(path)).map(|()| older)
}

/// Rejects outputs that cannot be written, or are read or written already.
fn apart(outputs: &[&Path], inputs: &[&Path]) -> Result<Older, InputError> {
    refuse_own_output(inputs)?;
    let standard = ["/dev/stdin", "/dev/stdout"].map(Path::new);
    let taken = inputs.iter().copied().chain(standard);
    let mut taken: Vec<Identity> = taken.filter_map(Identity::of).collect();
    for path in outputs {
        refuse_standard(path)?;
        if path.is_dir() {
            refuse(path, "is a directory; name a file to write")?;
        }
        refuse_nowhere(path)?;
        refuse_protected(path)?;
        if let Some(identity) = Identity::of(path) {
            if taken.contains(&identity) {
                let why = "is read or written already by this command; name another output";
                refuse(path, why)?;
            }
            taken.push(identity);
        }
    }
    let older = |path: &&Path| Some((path.to_path_buf(), kind(path)?));
    Ok(Older(outputs.iter().filter_map(older).collect()))
}

/// Rejects an input to which standard output is appended, as in `floe replay x.csv >> x.csv`.
fn refuse_own_output(inputs: &[&Path]) -> Result<(), InputError> {
    let out = Path::new("/dev/stdout");
    let Some(own) = Identity::of(out).filter(|_| out.is_file()) else { return Ok(()) };
    let read = |path: &Path| match path == Path::new(STANDARD) {
        true => Identity::of(Path::new("/dev/stdin")),
        false => Identity::of(path),
    };
    match inputs.iter().find(|path| read(path).as_ref() == Some(&own)) {
        Some(path) => refuse(path, "is where standard output goes; send that to another file"),
        None => Ok(()),
    }
}

/// The error for an output, with its path.
///
/// # Errors
/// Always.
pub fn refuse<T>(path: &Path, why: &str) -> Result<T, InputError> {
    Err(InputError::new(why).within(path.display()))
}

/// Kind of an existing file that would be replaced.
fn kind(path: &Path) -> Option<&'static str> {
    match path.exists() {
        true => path.is_file().then_some("file"),
        false => path.is_symlink().then_some("link to nowhere"),
    }
}

/// Rejects a file or folder in a directory that does not exist.
///
/// # Errors
/// There is no such directory.
pub fn refuse_nowhere(path: &Path) -> Result<(), InputError> {
    match directory(path).is_dir() {
        true => Ok(()),
        false => refuse(path, "its directory does not exist; make it first"),
    }
}

/// Rejects a file that its owner has made read-only: replacing it would not ask.
fn refuse_protected(path: &Path) -> Result<(), InputError> {
    match path.metadata() {
        Ok(there) if there.is_file() && there.permissions().readonly() => {
            refuse(path, "is there already and read-only; name another file, or make it writable")
        }
        _ => Ok(()),
    }
}

/// Rejects `-` for an output that is a file or a folder.
///
/// # Errors
/// The path is `-`.
pub fn refuse_standard(path: &Path) -> Result<(), InputError> {
    if path != Path::new(STANDARD) {
        return Ok(());
    }
    Err(InputError::new(
        "-: only --json goes to standard output; name a file (./- is one called -)",
    ))
}

/// Rejects a folder that cannot be created, that would be created at the path of one of `outputs`,
/// or whose own directory does not exist.
///
/// # Errors
/// The file or output at that path.
pub fn check_folder(folder: &Path, outputs: &[&Path]) -> Result<(), InputError> {
    refuse_standard(folder)?;
    if folder.is_file() {
        return refuse(folder, "is a file; name a directory");
    }
    let taken: Vec<Identity> = outputs.iter().filter_map(|path| Identity::of(path)).collect();
    if folder.ancestors().filter_map(Identity::of).any(|place| taken.contains(&place)) {
        let why = "is written already by this command as a file; name another directory";
        return refuse(folder, why);
    }
    refuse_nowhere(folder)
}

/// Identity of a file, on any path.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Identity {
    /// An existing file: numbers of its file system and in it.
    #[cfg(unix)]
    Node(u64, u64),
    /// A file that does not exist yet, or on a system without such numbers.
    Place(PathBuf),
}

impl Identity {
    /// `None` for files that several may write at once: a terminal, `/dev/null`.
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
