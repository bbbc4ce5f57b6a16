//! The board's log as the text of a CSV log, for everything that reads those.

use std::collections::BTreeSet;
use std::io::{self, Read};
use std::sync::{Arc, Mutex};

use floe_firmware::record::{Record, RecordError, SECTOR_LEN, Sector};

use super::stretch::{self, Key, Next, Reached};
use super::write::{head, row};

/// The column of the readings, in counts of the converter.
pub const COLUMN: &str = "counts";

/// What a reader of the text should know, complete at its end.
#[derive(Clone, Debug, Default)]
pub struct Told(Arc<Mutex<Aside>>);

/// What is not in the text.
#[derive(Debug, Default)]
struct Aside {
    damaged: u64,
    unsound: u64,
    newer: u64,
    repeated: u64,
    others: BTreeSet<Key>,
    torn_off: u64,
    /// The zero after the test, taken once its samples were all there.
    zero_after_n: Option<f32>,
}

impl Told {
    /// In words.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let Ok(aside) = self.0.lock() else { return Vec::new() };
        let others = aside.others.len() as u64;
        let say = |count: u64, what: &str| (count > 0).then(|| format!("{count} {what}"));
        [
            say(others, "more recordings are in it: floe recover takes them apart"),
            say(aside.torn_off, "records of the same test do not go on with it: floe recover"),
            say(aside.repeated, "records are there again, and were left out"),
            say(aside.damaged, "damaged sectors were left out"),
            say(aside.unsound, "sectors that no logger writes were left out"),
            say(aside.newer, "sectors of a newer version were left out"),
        ]
        .into_iter()
        .flatten()
        .chain(aside.zero_after_n.map(|zero_n| {
            format!(
                "a zero of {zero_n:.2} N was taken after the test; it is not taken off here, as the \
                 board did not know it: floe recover keeps it with the test"
            )
        }))
        .collect()
    }

    fn count(&self, add: impl FnOnce(&mut Aside)) {
        if let Ok(mut aside) = self.0.lock() {
            add(&mut aside);
        }
    }
}

/// Turns records into lines while they are read. Only the first test of the log is
/// given; `floe recover` takes them apart.
#[derive(Debug)]
pub struct Text<R> {
    input: R,
    key: Option<Key>,
    reached: Option<Reached>,
    told: Told,
    text: Vec<u8>,
    given: usize,
    done: bool,
}

impl<R: Read> Text<R> {
    /// Reads from the start of a log file.
    pub fn new(input: R) -> Self {
        let (told, text) = (Told::default(), Vec::new());
        Self { input, key: None, reached: None, told, text, given: 0, done: false }
    }

    /// What there is to know beside the text.
    #[must_use]
    pub fn told(&self) -> Told {
        self.told.clone()
    }

    /// The next sector as text. Damaged and empty sectors have none.
    fn refill(&mut self) -> io::Result<()> {
        let mut sector: Sector = [0; SECTOR_LEN];
        match self.input.read_exact(&mut sector) {
            Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => self.done = true,
            Err(error) => return Err(error),
            Ok(()) => match Record::decode(&sector) {
                Ok(record) if stretch::is_in_order(&record) => self.take(&record),
                Err(RecordError::Empty) => {}
                Err(RecordError::Corrupt) => self.told.count(|aside| aside.damaged += 1),
                Ok(_) | Err(RecordError::Unsound) => self.told.count(|aside| aside.unsound += 1),
                Err(RecordError::Version(_)) => self.told.count(|aside| aside.newer += 1),
            },
        }
        Ok(())
    }

    fn take(&mut self, record: &Record) {
        let key = Key::new(record);
        let Some(sample) = record.samples.first() else {
            // Settings that were changed after the test.
            let zero_n = record.settings.zero.after_n.filter(|_| self.key == Some(key));
            return self.told.count(|aside| aside.zero_after_n = zero_n.or(aside.zero_after_n));
        };
        if self.key.is_none() {
            self.key = Some(key);
            self.text.extend(head(&record.part, &record.settings).bytes());
        }
        if self.key != Some(key) {
            return self.told.count(|aside| {
                aside.others.insert(key);
            });
        }
        match self.reached.map_or(Next::Follows, |reached| reached.next(sample)) {
            Next::Follows => {}
            Next::StepsBack => return self.told.count(|aside| aside.repeated += 1),
            Next::OtherClock => return self.told.count(|aside| aside.torn_off += 1),
        }
        self.reached = Reached::end_of(record);
        for sample in &record.samples {
            let line = row(&record.settings, record.part.first_index, sample);
            self.text.extend(line.bytes());
        }
    }
}

impl<R: Read> Read for Text<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        while self.given == self.text.len() && !self.done {
            self.text.clear();
            self.given = 0;
            self.refill()?;
        }
        let left = self.text.get(self.given..).unwrap_or_default();
        let count = left.len().min(buffer.len());
        buffer[..count].copy_from_slice(&left[..count]);
        self.given += count;
        Ok(count)
    }
}
