//! Reads the board's log from its card: a log file, or an image of the whole card.
//!
//! Every sector of 512 bytes with the signature and a right checksum is a record, at any position.
//! The file system is not used, so a card with a broken one gives as much. Records are combined by
//! the identity of their test, in the order of their numbers; contradicting records become separate
//! recordings, and this is reported.

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
use crate::log::open::unpacker;
use stretch::{Next, Reached};

pub use sectors::{Found, Place, is_log};
use summary::no_record;
pub use summary::{summary, weight};
pub use text::{COLUMN, Text};
pub use write::{csv, toa5};

/// One recording on a card: a test, or a part of one after a reset.
#[derive(Clone, Debug)]
pub struct Test {
    /// Identity of the recording.
    pub part: Part,
    /// Unique name for files: number of the test, and its name if there is one.
    pub stem: String,
    /// Settings of the computation on the board.
    pub settings: Settings,
    /// The samples in order.
    pub samples: Vec<Sample>,
    /// Output of the board during the recording.
    pub lines: String,
    /// Samples lost during the test because the board was busy.
    pub overruns: u32,
    /// Reason why it does not continue the previous recording of the same number, if there is one.
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
        // The clock may have been set during the test.
        self.part.start_ms = self.part.start_ms.or(record.part.start_ms);
        self.overruns = record.overruns.wrapping_sub(self.overruns_before);
        // A zero measured after the test belongs to it.
        let after_n = record.settings.zero.after_n;
        self.settings.zero.after_n = after_n.or(self.settings.zero.after_n);
    }

    /// Number of missing indices between the first and the last sample.
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
/// The input cannot be read, or contains no record.
pub fn tests(mut input: impl Read + Seek) -> Result<(Vec<Test>, Found), InputError> {
    // Some devices deliver bytes endlessly; they and pipes have no end to seek to.
    let end = input.seek(SeekFrom::End(0)).map_err(|error| {
        InputError::new(format!("no file and no card: copy it into a file first ({error})"))
    })?;
    input.seek(SeekFrom::Start(0)).map_err(InputError::unreadable)?;
    let found = sectors::scan(&mut input.by_ref().take(end), |_, _, _| {})?;
    if found.places.is_empty() {
        return Err(packed(&mut input).unwrap_or_else(|| no_record(&found)));
    }
    let mut tests = put_together(&found.places, |place| read_at(&mut input, place.offset))?;
    name(&mut tests);
    Ok((tests, found))
}

/// The remedy for a compressed image.
fn packed(input: &mut (impl Read + Seek)) -> Option<InputError> {
    let mut head = Vec::new();
    input.seek(SeekFrom::Start(0)).and_then(|_| input.take(16).read_to_end(&mut head)).ok()?;
    let tool = unpacker(&head)?;
    Some(InputError::new(format!("is compressed: unpack it first, {tool} FILE > card.img")))
}

/// Recordings from the records at these positions, which are in order.
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
    // A test interrupted before its first sample is left out.
    tests.retain(|test| !test.samples.is_empty());
    Ok(tests)
}

/// Adds a record to the recording that it continues, among those from `begin` on.
fn take(tests: &mut Vec<Test>, begin: usize, record: &Record) {
    let Some(sample) = record.samples.first() else {
        // A record without samples has messages, or settings changed between tests.
        if let Some(test) = tests.get_mut(begin..).and_then(<[Test]>::last_mut) {
            test.add(record);
        }
        return;
    };
    /// Largest number of recordings searched; no logger writes more under one key, and more would
    /// cost time.
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

/// Gives every recording a unique name, also for file systems that ignore case.
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
