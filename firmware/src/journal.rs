//! Samples and lines to sectors.

use heapless::String;

use crate::record::{Record, SECTOR_SAMPLES};
use crate::sample::Sample;
use crate::settings::Settings;
use crate::store::{Store, StoreError};

/// Room for lines that wait for a sector: two events and some words.
const WAITING_LEN: usize = 1024;

/// Fills sectors and hands them on.
#[derive(Debug)]
pub struct Journal<S> {
    store: S,
    record: Record,
    waiting: String<WAITING_LEN>,
    sectors: u32,
    failures: u32,
    lines_lost: u32,
}

impl<S: Store> Journal<S> {
    /// Goes on behind what is on the card.
    pub fn new(store: S, clock_hz: u32) -> Self {
        let record = Record { clock_hz, ..Record::default() };
        let waiting = String::new();
        Self { store, record, waiting, sectors: 0, failures: 0, lines_lost: 0 }
    }

    /// Everything from here on belongs to this test.
    pub fn begin(&mut self, run: u32, first_index: u32, settings: &Settings) {
        self.record.run = run;
        self.record.first_index = first_index;
        self.record.settings = settings.clone();
    }

    /// Adds a sample; a full sector is written.
    pub fn sample(&mut self, sample: Sample) -> Result<(), StoreError> {
        // Cannot fail: a full sector has been written and emptied.
        let _ = self.record.samples.push(sample);
        if self.record.samples.len() < SECTOR_SAMPLES { Ok(()) } else { self.flush() }
    }

    /// Adds a line for the next sectors that have room.
    pub fn line(&mut self, text: &str) {
        let room = WAITING_LEN - self.waiting.len();
        if room <= text.len() {
            self.lines_lost = self.lines_lost.saturating_add(1);
            return;
        }
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
            self.take_waiting();
            result = result.and(self.write());
            self.record.samples.clear();
            self.record.text.clear();
        }
        result
    }

    /// A sector of its own for changed settings, so that they survive.
    pub fn remember(&mut self, settings: &Settings) -> Result<(), StoreError> {
        let result = self.flush();
        self.record.settings = settings.clone();
        result.and(self.write())
    }

    /// The last record of earlier times.
    pub fn last(&mut self) -> Option<Record> {
        self.store.last()
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
        while let Some(end) = self.waiting.find('\n') {
            let Some(line) = self.waiting.get(..=end) else { return };
            if self.record.text.push_str(line).is_err() {
                // A line longer than a sector's room can never be stored.
                if !self.record.text.is_empty() {
                    return;
                }
                self.lines_lost = self.lines_lost.saturating_add(1);
            }
            self.waiting.drain(..=end);
        }
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
