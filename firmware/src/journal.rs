//! Collects samples and lines in sectors.

use heapless::String;

use crate::line::LINE_LEN;
use crate::record::{Part, Record, TEXT_LEN};
use crate::sample::Sample;
use crate::settings::Settings;
use crate::store::{CardState, Store};

/// Room for lines that wait for a sector: two events and some text, or any single line.
const WAITING_LEN: usize = 1024;
const _: () = assert!(LINE_LEN < WAITING_LEN);

/// Fills sectors and passes them to a store.
#[derive(Debug)]
// The small fields come first, as in `App`.
#[repr(C)]
pub struct Journal<S> {
    sectors: u32,
    failures: u32,
    record: Record,
    waiting: String<WAITING_LEN>,
    store: S,
}

impl<S: Store> Journal<S> {
    /// A journal that appends to the store's contents.
    pub fn new(store: S, clock_hz: u32) -> Self {
        // The record is created in place, because it is large.
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

    /// Continues after the last record of the card, between tests.
    pub fn recall(&mut self, last: &Record) {
        self.record.part = last.part;
        self.record.settings = last.settings.clone();
    }

    /// Starts a part of a test: all further samples belong to it.
    pub fn begin(&mut self, part: Part, settings: &Settings) {
        self.record.part = part;
        self.record.running = true;
        self.record.settings = settings.clone();
    }

    /// Sets when the first sample of the part was taken, ms since 1970 (UTC).
    pub fn date(&mut self, start_ms: Option<u64>) {
        self.record.part.start_ms = start_ms;
    }

    /// Ends the test: writes the waiting data, marked as the end of the test.
    pub fn end(&mut self) {
        self.record.running = false;
        self.flush()
    }

    /// Adds a sample, and writes the sector if it is full.
    pub fn sample(&mut self, sample: Sample) {
        // Cannot fail: a full sector was written and emptied at once.
        let _ = self.record.samples.push(sample);
        if self.record.samples.is_full() {
            self.fill();
        }
    }

    /// Adds a line for the next sector with room. If too much text waits already, it is written
    /// first.
    pub fn line(&mut self, text: &str) {
        if WAITING_LEN - self.waiting.len() <= text.len() {
            self.flush();
        }
        // Cannot fail: there is room for any line.
        let _ = self.waiting.push_str(text);
        let _ = self.waiting.push('\n');
    }

    /// Sets the counters stored in the next sectors.
    pub fn counters(&mut self, overruns: u32, adc_faults: u32) {
        self.record.overruns = overruns;
        self.record.adc_faults = adc_faults;
    }

    /// Writes all waiting samples and lines, even to a sector that is not full. Data that cannot be
    /// written are lost, and the sector is counted as a failure.
    pub fn flush(&mut self) {
        while !self.record.samples.is_empty() || !self.waiting.is_empty() {
            self.fill();
        }
    }

    /// Writes one sector, with as many waiting lines as fit.
    fn fill(&mut self) {
        self.take_waiting();
        self.write();
        self.record.samples.clear();
        self.record.text.clear();
    }

    /// Writes a sector without samples, to keep settings that changed between tests. Waiting lines
    /// stay for the next test.
    pub fn remember(&mut self, settings: &Settings) {
        self.record.settings = settings.clone();
        self.write();
    }

    /// The last record in the store.
    pub fn last(&mut self) -> Option<Record> {
        self.store.last()
    }

    /// Performs a step of the card's own work, and returns the card's state.
    pub fn tend(&mut self) -> CardState {
        self.store.tend()
    }

    /// The store of the sectors.
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
                    // Longer than the room of any sector: the rest follows in the next one.
                    self.take_part();
                }
                return;
            }
            // Cannot fail: the length was checked.
            let _ = self.record.text.push_str(line);
            self.waiting.drain(..=end);
        }
    }

    /// Moves as much text as fits into an empty sector.
    fn take_part(&mut self) {
        // Lines during a test are ASCII, so the text can be cut at any byte.
        let Some(part) = self.waiting.get(..TEXT_LEN) else { return self.waiting.clear() };
        // Cannot fail: the part has exactly the size of the room.
        let _ = self.record.text.push_str(part);
        self.waiting.drain(..TEXT_LEN);
    }

    fn write(&mut self) {
        self.record.sector = self.store.next_sector();
        match self.store.write(&self.record.encode()) {
            Ok(()) => self.sectors = self.sectors.saturating_add(1),
            Err(_) => self.failures = self.failures.saturating_add(1),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::Sector;
    use crate::store::StoreError;

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

    /// No part of a line is lost, however long the line is.
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
            journal.flush();
            said += &line(length);
            said.push('\n');
        }
        assert_eq!(kept(&journal), said);
    }

    /// More text comes at the end of a test than usually waits for a sector.
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
        journal.end();
        assert_eq!(kept(&journal), said);
    }

    /// With one line per sample, text that does not fit into a sector waits for the next.
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
            journal.sample(sample);
        }
        journal.end();
        let sectors = journal.store().0.iter().map(|sector| Record::decode(sector).unwrap());
        assert_eq!(sectors.filter(|record| record.samples.is_empty()).count(), 0);
        assert_eq!(kept(&journal), (line + "\n").repeat(20));
    }

    fn kept(journal: &Journal<Sectors>) -> std::string::String {
        assert_eq!(journal.failures(), 0);
        let sectors = journal.store().0.iter();
        sectors.map(|sector| Record::decode(sector).unwrap().text.to_string()).collect()
    }
}
