//! Finding records in whatever was read from a card.

use std::io::{Read, Seek, SeekFrom};

use floe_firmware::record::{MAGIC, Record, RecordError, SECTOR_LEN, Sector};

use crate::error::InputError;

/// What a scan found.
#[derive(Clone, Debug, Default)]
pub struct Found {
    /// Number and offset of every record, in order of the numbers.
    pub places: Vec<(u32, u64)>,
    /// Sectors with the mark but a wrong checksum: torn or damaged.
    pub damaged: u64,
    /// Numbers between the first and the last record that are not there.
    pub lost: u64,
    /// Sectors of a newer version.
    pub newer: u64,
}

/// Looks at every sector.
///
/// # Errors
/// The input cannot be read.
pub fn scan(input: &mut (impl Read + Seek)) -> Result<Found, InputError> {
    let failed = |e: std::io::Error| InputError::new(format!("cannot be read: {e}"));
    input.seek(SeekFrom::Start(0)).map_err(failed)?;
    let mut found = Found::default();
    let mut buffer = vec![0; 2048 * SECTOR_LEN];
    let mut offset = 0;
    loop {
        let count = fill(input, &mut buffer).map_err(failed)?;
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
            Ok(record) => self.places.push((record.sector, offset)),
            Err(RecordError::Version(_)) => self.newer += 1,
            Err(RecordError::Corrupt | RecordError::Empty) => self.damaged += 1,
        }
    }

    /// Of two records with one number (an old file's remains) the first stays.
    fn put_in_order(&mut self) {
        self.places.sort_by_key(|&(number, _)| number);
        self.places.dedup_by_key(|&mut (number, _)| number);
        if let (Some(first), Some(last)) = (self.places.first(), self.places.last()) {
            self.lost = u64::from(last.0 - first.0) + 1 - self.places.len() as u64;
        }
    }
}
