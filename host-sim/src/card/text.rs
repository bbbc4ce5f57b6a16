//! The first test of a board's log as the text of a CSV log, for all readers of such logs.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{self, Read};
use std::vec;

use floe_firmware::record::{Record, Sector};
use floe_firmware::sample::Sample;
use floe_firmware::settings::Settings;

use super::stretch::Key;
use super::summary::{no_record, unused};
use super::write::{head, row, said};
use super::{Found, Place, decode, put_together, sectors};
use crate::error::InputError;
use crate::rounding::counted;

/// The column of the readings, in counts of the converter.
pub const COLUMN: &str = "counts";

/// The lines of a test, generated while they are read.
#[derive(Debug)]
pub struct Text {
    settings: Settings,
    first_index: u32,
    samples: vec::IntoIter<Sample>,
    text: Vec<u8>,
    given: usize,
}

/// Collects the records of the first test in any order.
#[derive(Debug, Default)]
struct First {
    /// Keys of all recordings with samples.
    keys: BTreeSet<Key>,
    /// Sectors of the first recording, and of earlier ones without samples, by their offset.
    sectors: BTreeMap<u64, (Key, Sector)>,
}

impl First {
    fn take(&mut self, place: &Place, record: &Record, sector: &Sector) {
        if !record.samples.is_empty() && self.keys.insert(place.key) {
            let first = self.keys.first().copied();
            self.sectors.retain(|_, (key, _)| first.is_none_or(|first| *key <= first));
        }
        if self.keys.first().is_none_or(|first| place.key <= *first) {
            self.sectors.insert(place.offset, (place.key, *sector));
        }
    }
}

impl Text {
    /// Reads a log to its end and takes the first test, as `floe recover` does. Also returns
    /// remarks on the rest of the log.
    ///
    /// # Errors
    /// The log cannot be read, or contains no test.
    pub fn read(mut input: impl Read) -> Result<(Self, Vec<String>), InputError> {
        let mut first = First::default();
        let found = sectors::scan(&mut input, |place, record, sector| {
            first.take(place, record, sector);
        })?;
        if found.places.is_empty() {
            return Err(no_record(&found));
        }
        let mut places = found.places.clone();
        places.retain(|place| first.sectors.contains_key(&place.offset));
        let mut settings = None;
        let tests = put_together(&places, |place| {
            let (_, sector) = first.sectors.get(&place.offset).ok_or_else(|| no_record(&found))?;
            let record = decode(sector, place.offset)?;
            if !record.samples.is_empty() {
                settings.get_or_insert_with(|| record.settings.clone());
            }
            Ok(record)
        })?;
        let others = (first.keys.len() + tests.len()).saturating_sub(2) as u64;
        let (Some(test), Some(settings)) = (tests.into_iter().next(), settings) else {
            return Err(InputError::new("holds settings of a floe logger, and no test"));
        };
        let mut told = told(&found, others);
        told.extend(zero_taken_after(test.settings.zero.after_n, settings.zero.after_n));
        let text = said(&test.lines) + &head(&test.part, &settings, &test.lines);
        let (first_index, samples) = (test.part.first_index, test.samples.into_iter());
        Ok((Self { settings, first_index, samples, text: text.into_bytes(), given: 0 }, told))
    }
}

/// Remarks on the other contents of a log.
fn told(found: &Found, others: u64) -> Vec<String> {
    let recordings = (others > 0).then(|| {
        let more = counted(others, "more recording");
        format!("{more} beside it: floe recover takes them apart")
    });
    let again = match found.repeated {
        0 => None,
        1 => Some("1 record is there again, and was left out".to_string()),
        more => Some(format!("{more} records are there again, and were left out")),
    };
    let unused = unused(found).into_iter().map(|sectors| format!("{sectors}: left out"));
    recordings.into_iter().chain(again).chain(unused).collect()
}

/// Remark on a zero that was not known to the board during the test.
fn zero_taken_after(zero_n: Option<f32>, known_n: Option<f32>) -> Option<String> {
    let zero_n = zero_n.filter(|_| known_n.map(f32::to_bits) != zero_n.map(f32::to_bits))?;
    Some(format!(
        "a zero of {zero_n:.2} N was taken after the test; it is not taken off here, as the board \
         did not know it: floe recover keeps it with the test"
    ))
}

impl Read for Text {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.given == self.text.len() {
            self.given = 0;
            self.text.clear();
            if let Some(sample) = self.samples.next() {
                self.text = row(&self.settings, self.first_index, &sample).into_bytes();
            }
        }
        let left = self.text.get(self.given..).unwrap_or_default();
        let count = left.len().min(buffer.len());
        buffer[..count].copy_from_slice(&left[..count]);
        self.given += count;
        Ok(count)
    }
}
