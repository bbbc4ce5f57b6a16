//! Text files written by people: scenes, and lists of tests.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use encoding_rs_io::DecodeReaderBytes;

use crate::log::cells::words;
use crate::log::open::refuse_binary;

/// Largest size, bytes: a list of 100 000 tests. A device file may never end.
const LONGEST: u64 = 16 << 20;

/// The text of a file in UTF-8, UTF-16 or Latin-1, without a byte order mark.
///
/// # Errors
/// The file cannot be read, is no text, or is longer than `LONGEST`.
pub(crate) fn read(path: &Path) -> io::Result<String> {
    let mut bytes = Vec::new();
    File::open(path)?.take(LONGEST + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > LONGEST {
        return Err(io::Error::other("longer than 16 MiB, which no scene and no list is"));
    }
    let mut text = String::new();
    if DecodeReaderBytes::new(bytes.as_slice()).read_to_string(&mut text).is_err() {
        refuse_binary(&bytes).map_err(io::Error::other)?;
        text = words(&bytes).into_owned();
    }
    Ok(text.strip_prefix('\u{feff}').map(str::to_string).unwrap_or(text))
}
