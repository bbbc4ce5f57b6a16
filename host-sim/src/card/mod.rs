//! The board's log back from its card: a log file, or an image of the whole card.
//!
//! Every sector of 512 bytes that carries the mark and a right checksum is a
//! record, wherever it lies; the file system is not looked at, so that a card with
//! a broken one gives as much. Records are put together by what identifies their
//! test, in the order of their numbers; what does not fit together is taken apart
//! and said.

mod sectors;
mod stretch;
mod summary;
mod text;
mod write;

use std::collections::BTreeSet;
use std::io::{Read, Seek, SeekFrom};

use floe_firmware::record::{Part, Record, SECTOR_LEN, Sector};
use floe_firmware::sample::Sample;
use floe_firmware::settings::Settings;

use crate::error::InputError;
use stretch::{Next, Reached};

pub use sectors::{Found, Place, is_log};
use summary::no_record;
pub use summary::{summary, weight};
pub use text::{COLUMN, Text};
pub use write::{csv, toa5};

/// One recording of a card: a test, or what a reset left of it.
#[derive(Clone, Debug)]
pub struct Test {
    /// What identifies it.
    pub part: Part,
    /// Name for files: number, and name if it has one; no other recording of the
    /// card has it.
    pub stem: String,
    /// What it was computed with on the board.
    pub settings: Settings,
    /// Its samples, in order.
    pub samples: Vec<Sample>,
    /// What the board said meanwhile.
    pub lines: String,
    /// Samples that the board lost because it was busy, during the test.
    pub overruns: u32,
    /// Why it is not the end of the recording before it, if its number says so.
    pub split: Option<&'static str>,
    reached: Option<Reached>,
    overruns_before: u32,
}

impl Test {
    fn new(record: &Record, split: Option<&'static str>) -> Self {
        Self {
            part: record.part,
            stem: String::new(),
            settings: record.settings.clone(),
            samples: Vec::new(),
            lines: String::new(),
            overruns: 0,
            split,
            reached: None,
            overruns_before: record.overruns,
        }
    }

    fn add(&mut self, record: &Record) {
        self.reached = Reached::end_of(record).or(self.reached);
        self.samples.extend(record.samples.iter().copied());
        self.lines.push_str(&record.text);
        self.overruns = record.overruns.wrapping_sub(self.overruns_before);
        // A zero that was taken after the test belongs to it.
        let after_n = record.settings.zero.after_n;
        self.settings.zero.after_n = after_n.or(self.settings.zero.after_n);
    }

    /// Indices between the first and the last sample that are not there.
    #[must_use]
    pub fn missing(&self) -> u64 {
        let first = self.part.first_index;
        let last = self.samples.last().map_or(first, |s| s.index.wrapping_add(1));
        u64::from(last.wrapping_sub(first)).saturating_sub(self.samples.len() as u64)
    }

    fn plain_stem(&self) -> String {
        let name = self.settings.name.replace(' ', "_");
        let dash = if name.is_empty() { "" } else { "-" };
        let part = match self.part.number {
            0 => String::new(),
            number => format!(".part{}", u64::from(number) + 1),
        };
        format!("test-{:04}{dash}{name}{part}", self.part.run)
    }
}

/// Reads every test of a file or image.
///
/// # Errors
/// It cannot be read, or there is no record in it.
pub fn tests(mut input: impl Read + Seek) -> Result<(Vec<Test>, Found), InputError> {
    // There are devices that give bytes for ever; none of them has an end.
    let end = input.seek(SeekFrom::End(0)).map_err(|error| InputError::unreadable(&error))?;
    input.seek(SeekFrom::Start(0)).map_err(|error| InputError::unreadable(&error))?;
    let found = sectors::scan(&mut input.by_ref().take(end), |_, _, _| {})?;
    if found.places.is_empty() {
        return Err(no_record(&found));
    }
    let mut tests = put_together(&found.places, |place| read_at(&mut input, place.offset))?;
    name(&mut tests);
    Ok((tests, found))
}

/// Recordings of the records at these places, which are in order.
fn put_together(
    places: &[Place],
    mut read: impl FnMut(&Place) -> Result<Record, InputError>,
) -> Result<Vec<Test>, InputError> {
    let mut tests: Vec<Test> = Vec::new();
    for places in places.chunk_by(|a, b| a.key == b.key) {
        let begin = tests.len();
        for place in places {
            take(&mut tests, begin, &read(place)?);
        }
    }
    // A test that was only ever broken off before its first sample is none.
    tests.retain(|test| !test.samples.is_empty());
    Ok(tests)
}

/// Adds a record to the recording that it goes on with, of those from `begin` on.
fn take(tests: &mut Vec<Test>, begin: usize, record: &Record) {
    let Some(sample) = record.samples.first() else {
        // Without samples: last words, or settings that were changed between tests.
        if let Some(test) = tests.get_mut(begin..).and_then(<[Test]>::last_mut) {
            test.add(record);
        }
        return;
    };
    /// More recordings of one name at once are no logger's, and would cost time.
    const OPEN: usize = 8;
    let open = begin.max(tests.len().saturating_sub(OPEN));
    let mut why = None;
    for test in tests.iter_mut().skip(open) {
        match test.reached.map_or(Next::Follows, |reached| reached.next(sample)) {
            Next::Follows => return test.add(record),
            Next::StepsBack => why = Some("its samples step back"),
            Next::OtherClock => why = Some("its clock is another"),
        }
    }
    let mut test = Test::new(record, why);
    test.add(record);
    tests.push(test);
}

/// Gives every recording a name that no other has, whatever file system it is for.
fn name(tests: &mut [Test]) {
    let mut used = BTreeSet::new();
    for test in tests {
        let plain = test.plain_stem();
        let others = (2_u32..).map(|count| format!("{plain}.{count}"));
        let mut names = std::iter::once(plain.clone()).chain(others);
        let free = names.find(|name| used.insert(name.to_ascii_lowercase()));
        test.stem = free.unwrap_or(plain);
    }
}

fn read_at(input: &mut (impl Read + Seek), offset: u64) -> Result<Record, InputError> {
    let mut sector: Sector = [0; SECTOR_LEN];
    let read = input.seek(SeekFrom::Start(offset)).and_then(|_| input.read_exact(&mut sector));
    read.map_err(|e| InputError::new(format!("cannot be read at byte {offset}: {e}")))?;
    decode(&sector, offset)
}

fn decode(sector: &Sector, offset: u64) -> Result<Record, InputError> {
    Record::decode(sector).map_err(|e| InputError::new(format!("changed at byte {offset}: {e}")))
}
