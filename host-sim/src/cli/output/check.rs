//! What may be written: before any work an output is refused that is an input or another
//! output, by whatever path or link, or a file that is no older result.

use std::fs::{self, Metadata};
use std::path::{Path, PathBuf};

use super::super::input::STANDARD;
use crate::error::InputError;

use super::{directory, say, theirs};

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
        if path.is_dir() {
            refuse(path, "is a directory; name a file to write")?;
        }
        if !directory(path).is_dir() {
            refuse(path, "its directory does not exist; make it first")?;
        }
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

fn refuse(path: &Path, why: &str) -> Result<(), InputError> {
    Err(InputError::new(why).within(path.display()))
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

/// Refuses a folder that cannot be made, or that would be made where one of `outputs` is.
///
/// # Errors
/// Says what is in its place.
pub fn check_folder(folder: &Path, outputs: &[&Path]) -> Result<(), InputError> {
    refuse_standard(folder)?;
    if folder.is_file() {
        return refuse(folder, "is a file; name a directory");
    }
    let taken: Vec<Identity> = outputs.iter().filter_map(|path| Identity::of(path)).collect();
    if folder.ancestors().filter_map(Identity::of).any(|place| taken.contains(&place)) {
        return refuse(
            folder,
            "is written already by this command as a file; name another directory",
        );
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
