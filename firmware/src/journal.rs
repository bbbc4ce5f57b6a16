//! Samples and lines to sectors.

use heapless::String;

use crate::line::LINE_LEN;
use crate::record::{Part, Record, SECTOR_SAMPLES, TEXT_LEN};
use crate::sample::Sample;
use crate::settings::Settings;
use crate::store::{CardState, Store, StoreError};

/// Room for lines that wait for a sector: two events and some words, or any line.
const WAITING_LEN: usize = 1024;
const _: () = assert!(LINE_LEN < WAITING_LEN);

/// Fills sectors and hands them on.
#[derive(Debug)]
// The small fields first, as in `App`.
#[repr(C)]
pub struct Journal<S> {
    sectors: u32,
    failures: u32,
    record: Record,
    waiting: String<WAITING_LEN>,
    store: S,
}

impl<S: Store> Journal<S> {
    /// Goes on behind what is on the card.
    pub fn new(store: S, clock_hz: u32) -> Self {
        // The record is made where it stays: it is large.
        let mut new = Self {
            store,
            record: Record::default(),
            waiting: String::new(),
            sectors: 0,
            failures: 0,
        };
        new.record.clock_hz = clock_hz;
        new
    }

    /// Goes on as the card left off, between tests.
    pub fn recall(&mut self, last: &Record) {
        self.record.part = last.part;
        self.record.settings = last.settings.clone();
    }

    /// Everything from here on belongs to this part of a test.
    pub fn begin(&mut self, part: Part, settings: &Settings) {
        self.record.part = part;
        self.record.running = true;
        self.record.settings = settings.clone();
    }

    /// The test is over: what waits is written, and it says so.
    ///
    /// # Errors
    /// As [`Journal::flush`].
    pub fn end(&mut self) -> Result<(), StoreError> {
        self.record.running = false;
        self.flush()
    }

    /// Adds a sample; a full sector is written.
    pub fn sample(&mut self, sample: Sample) -> Result<(), StoreError> {
        // Cannot fail: a full sector has been written and emptied.
        let _ = self.record.samples.push(sample);
        if self.record.samples.len() < SECTOR_SAMPLES { Ok(()) } else { self.fill() }
    }

    /// Adds a line for the next sectors that have room. Where too much waits already, that is
    /// written first.
    pub fn line(&mut self, text: &str) {
        if WAITING_LEN - self.waiting.len() <= text.len() {
            // What cannot be written is counted.
            let _ = self.flush();
        }
        // Cannot fail: there is room for any line.
        let _ = self.waiting.push_str(text);
        let _ = self.waiting.push('\n');
    }

    /// Counters for the next sectors.
    pub fn counters(&mut self, overruns: u32, adc_faults: u32) {
        self.record.overruns = overruns;
        self.record.adc_faults = adc_faults;
    }

    /// Writes what there is, if there is anything, full or not. What cannot be
    /// written is lost and counted.
    pub fn flush(&mut self) -> Result<(), StoreError> {
        let mut result = Ok(());
        while !self.record.samples.is_empty() || !self.waiting.is_empty() {
            result = result.and(self.fill());
        }
        result
    }

    /// Writes one sector, with as many of the lines that wait as it has room for.
    fn fill(&mut self) -> Result<(), StoreError> {
        self.take_waiting();
        let result = self.write();
        self.record.samples.clear();
        self.record.text.clear();
        result
    }

    /// A sector of its own for settings changed between tests, so that they survive.
    /// What waits to be told waits for the next test.
    ///
    /// # Errors
    /// They are not on the card.
    pub fn remember(&mut self, settings: &Settings) -> Result<(), StoreError> {
        self.record.settings = settings.clone();
        self.write()
    }

    /// The last record of earlier times.
    pub fn last(&mut self) -> Option<Record> {
        self.store.last()
    }

    /// Does a little of the card's own work; says what it is like.
    pub fn tend(&mut self) -> CardState {
        self.store.tend()
    }

    /// The card.
    pub fn store(&self) -> &S {
        &self.store
    }

    /// Sectors written.
    pub fn sectors(&self) -> u32 {
        self.sectors
    }

    /// Sectors that could not be written.
    pub fn failures(&self) -> u32 {
        self.failures
    }

    fn take_waiting(&mut self) {
        while let Some(end) = self.waiting.bytes().position(|byte| byte == b'\n') {
            let Some(line) = self.waiting.get(..=end) else { return };
            if self.record.text.len() + line.len() > TEXT_LEN {
                if self.record.text.is_empty() {
                    // Longer than any sector's room: the next one has the rest.
                    self.take_part();
                }
                return;
            }
            // Cannot fail: there is room.
            let _ = self.record.text.push_str(line);
            self.waiting.drain(..=end);
        }
    }

    /// As much as fits into an empty sector.
    fn take_part(&mut self) {
        // What a board says during a test is ASCII: any place is between letters.
        let Some(part) = self.waiting.get(..TEXT_LEN) else { return self.waiting.clear() };
        // Cannot fail: there is room for just that.
        let _ = self.record.text.push_str(part);
        self.waiting.drain(..TEXT_LEN);
    }

    fn write(&mut self) -> Result<(), StoreError> {
        self.record.sector = self.store.next_sector();
        let result = self.store.write(&self.record.encode());
        match result {
            Ok(()) => self.sectors = self.sectors.saturating_add(1),
            Err(_) => self.failures = self.failures.saturating_add(1),
        }
        result
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::Sector;

    #[derive(Default)]
    struct Sectors(Vec<Sector>);

    impl Store for Sectors {
        fn last(&mut self) -> Option<Record> {
            None
        }

        fn next_sector(&self) -> u32 {
            self.0.len() as u32
        }

        fn write(&mut self, sector: &Sector) -> Result<(), StoreError> {
            self.0.push(*sector);
            Ok(())
        }
    }

    /// Nothing of a line is lost, however long it is.
    #[test]
    fn a_line_longer_than_a_sectors_room_goes_on_in_the_next() {
        let mut journal = Journal::new(Sectors::default(), 1_000_000);
        let lengths = [1, 100, TEXT_LEN - 1, TEXT_LEN, TEXT_LEN + 1, crate::line::LINE_LEN, 3];
        let line = |length: usize| {
            "0123456789".chars().cycle().take(length).collect::<std::string::String>()
        };
        let mut said = std::string::String::new();
        for length in lengths {
            journal.line(&line(length));
            journal.flush().unwrap();
            said += &line(length);
            said.push('\n');
        }
        assert_eq!(kept(&journal), said);
    }

    /// At the end of a test comes more than waits for a sector otherwise.
    #[test]
    fn nothing_is_lost_however_much_is_said_at_once() {
        let mut journal = Journal::new(Sectors::default(), 1_000_000);
        let mut said = std::string::String::new();
        for letter in ["a", "b", "c", "d", "e", "f"] {
            let line = letter.repeat(300);
            journal.line(&line);
            said += &line;
            said.push('\n');
        }
        journal.end().unwrap();
        assert_eq!(kept(&journal), said);
    }

    /// A sector a sample: what it has no room for waits for the next.
    #[test]
    fn no_sector_is_without_samples_while_others_have_room() {
        let mut journal = Journal::new(Sectors::default(), 1_000_000);
        let line = "e".repeat(TEXT_LEN + 80);
        for index in 0..28 * 20 {
            if index % 28 == 0 {
                journal.line(&line);
            }
            let reading = Ok(floe_core::Counts(0));
            let sample = Sample { index, stamp: 0, input: crate::adc::Input::Bridge, reading };
            journal.sample(sample).unwrap();
        }
        journal.end().unwrap();
        let sectors = journal.store().0.iter().map(|sector| Record::decode(sector).unwrap());
        assert_eq!(sectors.filter(|record| record.samples.is_empty()).count(), 0);
        assert_eq!(kept(&journal), (line + "\n").repeat(20));
    }

    fn kept(journal: &Journal<Sectors>) -> std::string::String {
        let sectors = journal.store().0.iter();
        sectors.map(|sector| Record::decode(sector).unwrap().text.to_string()).collect()
    }
}
