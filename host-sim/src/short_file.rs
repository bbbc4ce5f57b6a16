//! Texts that somebody writes: scenes, and lists of tests.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// Longest of them: a list of 100 000 tests. There are devices that have no end.
const LONGEST: u64 = 16 << 20;

/// The text of a file.
///
/// # Errors
/// It cannot be read, is no text, or longer than anybody writes.
pub(crate) fn read(path: &Path) -> io::Result<String> {
    let mut text = String::new();
    let length = File::open(path)?.take(LONGEST + 1).read_to_string(&mut text)?;
    if length as u64 > LONGEST {
        return Err(io::Error::other("longer than 16 MiB, which no scene and no list is"));
    }
    Ok(text)
}
