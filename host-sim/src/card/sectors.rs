//! Finding records in whatever was read from a card.

use std::io::{Read, Seek, SeekFrom};

use floe_firmware::record::{MAGIC, Record, RecordError, SECTOR_LEN, Sector};

use super::stretch::{self, Key};
use crate::error::InputError;

/// What a scan found.
#[derive(Clone, Debug, Default)]
pub struct Found {
    /// Every record once: by test, then by number.
    pub places: Vec<Place>,
    /// Sectors with the mark but a wrong checksum: torn or damaged.
    pub damaged: u64,
    /// Numbers between the first and the last record that are not there.
    pub lost: u64,
    /// Sectors of a newer version.
    pub newer: u64,
    /// Sectors with a right checksum and a content that no logger writes.
    pub unsound: u64,
    /// Records that are there more than once, as in a file that was copied twice.
    pub repeated: u64,
}

/// Where a record is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Place {
    /// Whose it is.
    pub key: Key,
    /// Its number.
    pub sector: u32,
    content: u64,
    /// Its first byte in the input.
    pub offset: u64,
}

/// Looks at every sector.
///
/// # Errors
/// The input cannot be read.
pub fn scan(input: &mut (impl Read + Seek)) -> Result<Found, InputError> {
    let failed = |e: std::io::Error| InputError::new(format!("cannot be read: {e}"));
    // There are devices that give bytes for ever; none of them has an end.
    let end = input.seek(SeekFrom::End(0)).map_err(failed)?;
    input.seek(SeekFrom::Start(0)).map_err(failed)?;
    let mut input = input.take(end);
    let mut found = Found::default();
    let mut buffer = vec![0; 2048 * SECTOR_LEN];
    let mut offset = 0;
    loop {
        let count = fill(&mut input, &mut buffer).map_err(failed)?;
        for (sector, at) in buffer[..count].chunks_exact(SECTOR_LEN).zip(0_u64..) {
            found.take(sector, offset + at * SECTOR_LEN as u64);
        }
        offset += count as u64;
        if count < buffer.len() {
            break;
        }
    }
    found.put_in_order();
    Ok(found)
}

/// Reads until the buffer is full or the input ends.
fn fill(input: &mut impl Read, buffer: &mut [u8]) -> std::io::Result<usize> {
    let mut count = 0;
    while count < buffer.len() {
        match input.read(&mut buffer[count..])? {
            0 => break,
            more => count += more,
        }
    }
    Ok(count)
}

impl Found {
    fn take(&mut self, bytes: &[u8], offset: u64) {
        // The directory's entry of the file begins with the same letters, then a
        // space where a record has its version.
        if !bytes.starts_with(&MAGIC) || bytes.get(MAGIC.len()) == Some(&b' ') {
            return;
        }
        let Ok(sector): Result<&Sector, _> = bytes.try_into() else { return };
        match Record::decode(sector) {
            Ok(record) if stretch::is_in_order(&record) => self.places.push(Place {
                key: Key::new(&record),
                sector: record.sector,
                content: stretch::hash(bytes),
                offset,
            }),
            Err(RecordError::Version(_)) => self.newer += 1,
            Ok(_) | Err(RecordError::Unsound) => self.unsound += 1,
            Err(RecordError::Corrupt | RecordError::Empty) => self.damaged += 1,
        }
    }

    fn put_in_order(&mut self) {
        let all = self.places.len();
        self.places.sort();
        self.places.dedup_by_key(|place| (place.key, place.sector, place.content));
        self.repeated = (all - self.places.len()) as u64;
        let mut numbers: Vec<u32> = self.places.iter().map(|place| place.sector).collect();
        numbers.sort_unstable();
        numbers.dedup();
        if let (Some(first), Some(last)) = (numbers.first(), numbers.last()) {
            self.lost = u64::from(last - first) + 1 - numbers.len() as u64;
        }
    }
}
