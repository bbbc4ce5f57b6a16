//! Texts that somebody writes: scenes, and lists of tests.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use encoding_rs_io::DecodeReaderBytes;

use crate::log::open::refuse_binary;

/// Longest of them: a list of 100 000 tests. There are devices that have no end.
const LONGEST: u64 = 16 << 20;

/// The text of a file, without the mark with which a spreadsheet says that it is UTF-8 or UTF-16.
///
/// # Errors
/// It cannot be read, is no text, or longer than anybody writes.
pub(crate) fn read(path: &Path) -> io::Result<String> {
    let mut bytes = Vec::new();
    File::open(path)?.take(LONGEST + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > LONGEST {
        return Err(io::Error::other("longer than 16 MiB, which no scene and no list is"));
    }
    let mut text = String::new();
    let read = DecodeReaderBytes::new(bytes.as_slice()).read_to_string(&mut text);
    read.map_err(|_| match refuse_binary(&bytes) {
        Err(binary) => io::Error::other(binary),
        Ok(()) => io::Error::other("no text in UTF-8; save it as that"),
    })?;
    Ok(text.strip_prefix('\u{feff}').map(str::to_string).unwrap_or(text))
}
