//! Information in a report about its creation.

use std::ffi::OsString;
use std::io::{self, Read};
use std::sync::{Arc, Mutex};
use std::time::{SystemTime, UNIX_EPOCH};

use sha2::{Digest, Sha256};

use crate::log::start::Start;
use crate::report::Provenance;

/// Checksum of a stream, computed while it is read.
#[derive(Clone, Debug, Default)]
pub struct Checksum(Arc<Mutex<(Sha256, bool)>>);

/// A stream that adds the bytes read to a checksum.
#[derive(Debug)]
pub struct Summed<R> {
    input: R,
    checksum: Checksum,
}

impl<R: Read> Summed<R> {
    /// Wraps a stream.
    pub fn new(input: R, checksum: &Checksum) -> Self {
        Self { input, checksum: checksum.clone() }
    }
}

impl<R: Read> Read for Summed<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.input.read(buffer)?;
        if let Ok(mut sum) = self.checksum.0.lock() {
            sum.0.update(buffer.get(..count).unwrap_or_default());
            sum.1 |= count == 0 && !buffer.is_empty();
        }
        Ok(count)
    }
}

impl Checksum {
    /// The checksum in hexadecimal, if the stream was read to its end.
    #[must_use]
    pub fn hex(&self) -> Option<String> {
        let sum = self.0.lock().ok()?;
        let bytes = sum.0.clone().finalize();
        sum.1.then(|| bytes.iter().map(|byte| format!("{byte:02x}")).collect())
    }
}

/// Provenance of this run.
#[must_use]
pub fn provenance(checksum: &Checksum) -> Provenance {
    let now = SystemTime::now().duration_since(UNIX_EPOCH).ok();
    Provenance {
        command: command_line(std::env::args_os()),
        commit: option_env!("FLOE_COMMIT"),
        sha256: checksum.hex(),
        made_at: now
            .and_then(|now| Start { unix_s: now.as_secs() as f64, is_utc: true }.after(0.0))
            .map(|text| text.replace(".000", "")),
    }
}

/// The command as a user would type it; invalid text, as in a path, has replacement characters.
pub fn command_line(arguments: impl Iterator<Item = OsString>) -> String {
    let plain = |text: &str| {
        let safe = |c: char| c.is_alphanumeric() || "-_./=:,+@%".contains(c);
        !text.is_empty() && text.chars().all(safe)
    };
    let quoted = |argument: OsString| {
        let text = argument.to_string_lossy().into_owned();
        if plain(&text) { text } else { format!("'{}'", text.replace('\'', "'\\''")) }
    };
    let arguments = arguments.skip(1).map(quoted);
    ["floe".to_string()].into_iter().chain(arguments).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_can_be_typed_again() {
        let line = ["/x/floe", "replay", "my log.csv", "--column", "it's"].map(OsString::from);
        assert_eq!(command_line(line.into_iter()), "floe replay 'my log.csv' --column 'it'\\''s'");
    }

    #[test]
    fn the_checksum_is_of_the_whole_stream() {
        let checksum = Checksum::default();
        let mut input = Summed::new(&b"abc"[..], &checksum);
        let mut buffer = [0; 2];
        input.read_exact(&mut buffer).unwrap();
        assert_eq!(checksum.hex(), None);
        io::copy(&mut input, &mut io::sink()).unwrap();
        let known = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(checksum.hex().as_deref(), Some(known));
    }
}
