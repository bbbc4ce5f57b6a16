//! The board's log back from its card: a log file, or an image of the whole card.
//!
//! Every sector of 512 bytes that carries the mark and a right checksum is a
//! record, wherever it lies; the file system is not looked at, so that a card with
//! a broken one gives as much. Records are put in the order of their numbers.

mod sectors;
mod text;
mod write;

use std::io::{Read, Seek, SeekFrom};

use floe_firmware::record::{Record, SECTOR_LEN, Sector};
use floe_firmware::sample::Sample;
use floe_firmware::settings::Settings;

use crate::error::InputError;

pub use sectors::Found;
pub use text::{COLUMN, Text};
pub use write::{csv, lines, toa5};

/// One test of a card.
#[derive(Clone, Debug)]
pub struct Test {
    /// Number of the test since the card was new.
    pub run: u32,
    /// What it was computed with on the board.
    pub settings: Settings,
    /// Index of its first sample.
    pub first_index: u32,
    /// Its samples, in order.
    pub samples: Vec<Sample>,
    /// What the board said meanwhile.
    pub lines: String,
    /// Samples that the board lost because it was busy, during the test.
    pub overruns: u32,
}

impl Test {
    fn new(record: &Record) -> Self {
        Self {
            run: record.run,
            settings: record.settings.clone(),
            first_index: record.first_index,
            samples: Vec::new(),
            lines: String::new(),
            overruns: 0,
        }
    }

    /// Indices between the first and the last sample that are not there.
    #[must_use]
    pub fn missing(&self) -> u64 {
        let last = self.samples.last().map_or(self.first_index, |s| s.index.wrapping_add(1));
        u64::from(last.wrapping_sub(self.first_index)).saturating_sub(self.samples.len() as u64)
    }

    /// Name for files: number, and name if it has one.
    #[must_use]
    pub fn stem(&self) -> String {
        let name = &self.settings.name;
        let dash = if name.is_empty() { "" } else { "-" };
        format!("test-{:04}{dash}{name}", self.run)
    }
}

/// Reads every test of a file or image.
///
/// # Errors
/// It cannot be read, or there is no record in it.
pub fn tests(mut input: impl Read + Seek) -> Result<(Vec<Test>, Found), InputError> {
    let found = sectors::scan(&mut input)?;
    if found.places.is_empty() {
        return Err(InputError::new("holds no record of a floe logger"));
    }
    let mut tests: Vec<Test> = Vec::new();
    let mut overruns = None;
    for &(_, offset) in &found.places {
        let record = read_at(&mut input, offset)?;
        // Without samples: settings that were changed between tests, or last words.
        let new = tests.last().is_none_or(|test| test.run != record.run);
        if new && !record.samples.is_empty() {
            tests.push(Test::new(&record));
            overruns = Some(record.overruns);
        }
        if let Some(test) = tests.last_mut() {
            test.samples.extend(record.samples.iter().copied());
            test.lines.push_str(&record.text);
            test.overruns = record.overruns.wrapping_sub(overruns.unwrap_or(0));
        }
    }
    Ok((tests, found))
}

fn read_at(input: &mut (impl Read + Seek), offset: u64) -> Result<Record, InputError> {
    let mut sector: Sector = [0; SECTOR_LEN];
    let read = input.seek(SeekFrom::Start(offset)).and_then(|_| input.read_exact(&mut sector));
    read.map_err(|e| InputError::new(format!("cannot be read at byte {offset}: {e}")))?;
    Record::decode(&sector).map_err(|e| InputError::new(format!("changed at byte {offset}: {e}")))
}
