//! Finds records in data read from a card.

use std::io::Read;

use floe_firmware::record::{MAGIC, Record, RecordError, SECTOR_LEN, Sector};

use super::stretch::{self, Key};
use crate::error::InputError;

/// Bytes that are read at once.
const PIECE: usize = 2048 * SECTOR_LEN;

/// What a scan found.
#[derive(Clone, Debug, Default)]
pub struct Found {
    /// Every record once, sorted by test, then by number.
    pub places: Vec<Place>,
    /// Sectors with the signature and a wrong checksum: torn or damaged. In a log file, which
    /// contains sectors of the logger only, also those with a damaged signature.
    pub damaged: u64,
    /// Whether the last sector is incomplete, because the file was cut off.
    pub is_cut_off: bool,
    /// Missing numbers between the first and the last record.
    pub lost: u64,
    /// Sectors of a newer version.
    pub newer: u64,
    /// Sectors with a right checksum and values that no logger writes.
    pub unsound: u64,
    /// Repeated records, as in a file that was copied twice.
    pub repeated: u64,
    /// Sectors with data and without the signature, which belong to other files unless this is a
    /// log.
    unmarked: u64,
}

/// Position of a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Place {
    /// Key of the recording.
    pub key: Key,
    /// Number of the record.
    pub sector: u32,
    content: u64,
    /// Offset of the record in the input.
    pub offset: u64,
}

/// Examines every sector; calls `keep` for every record.
///
/// # Errors
/// The input cannot be read.
pub fn scan(
    input: &mut impl Read,
    mut keep: impl FnMut(&Place, &Record, &Sector),
) -> Result<Found, InputError> {
    let mut found = Found::default();
    let mut buffer = Vec::with_capacity(PIECE);
    let mut offset = 0;
    loop {
        buffer.clear();
        let read = input.by_ref().take(PIECE as u64).read_to_end(&mut buffer);
        let count = read.map_err(InputError::unreadable)?;
        let (sectors, rest) = buffer.as_chunks::<SECTOR_LEN>();
        for (sector, at) in sectors.iter().zip(0_u64..) {
            if let Some((place, record)) = found.take(sector, offset + at * SECTOR_LEN as u64) {
                keep(&place, &record, sector);
                found.places.push(place);
            }
        }
        found.is_cut_off |= rest.iter().any(|&byte| byte != 0);
        offset += count as u64;
        if count < PIECE {
            break;
        }
    }
    found.put_in_order();
    Ok(found)
}

/// Whether data begin like a logger's log, possibly after damaged sectors.
#[must_use]
pub fn is_log(start: &[u8]) -> bool {
    let is_record =
        |sector: &Sector| matches!(Record::decode(sector), Ok(_) | Err(RecordError::Version(_)));
    start.starts_with(&MAGIC) || start.as_chunks::<SECTOR_LEN>().0.iter().any(is_record)
}

impl Found {
    fn take(&mut self, sector: &Sector, offset: u64) -> Option<(Place, Record)> {
        // The directory entry of the file begins with the same letters, followed by a space where a
        // record has its version.
        if !sector.starts_with(&MAGIC) || sector.get(MAGIC.len()) == Some(&b' ') {
            self.unmarked += u64::from(sector.iter().any(|&byte| byte != 0));
            return None;
        }
        match Record::decode(sector) {
            Ok(record) if stretch::is_in_order(&record) => {
                let (key, content) = (Key::new(&record), stretch::hash(sector));
                return Some((Place { key, sector: record.sector, content, offset }, record));
            }
            Err(RecordError::Version(_)) => self.newer += 1,
            Ok(_) | Err(RecordError::Unsound) => self.unsound += 1,
            Err(RecordError::Corrupt | RecordError::Empty) => self.damaged += 1,
        }
        None
    }

    fn put_in_order(&mut self) {
        // If a record's number is its position in the input, the input is a log file and contains
        // nothing else.
        let in_place = |it: &Place| it.offset == SECTOR_LEN as u64 * u64::from(it.sector);
        if self.places.iter().any(in_place) {
            self.damaged += self.unmarked;
        }
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
