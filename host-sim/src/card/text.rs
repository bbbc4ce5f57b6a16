//! The board's log as the text of a CSV log, for everything that reads those.

use std::io::{self, Read};

use floe_firmware::record::{Record, SECTOR_LEN, Sector};

use super::write::{head, row};

/// The column of the readings, in counts of the converter.
pub const COLUMN: &str = "counts";

/// Turns records into lines while they are read. Only the first test of the log is
/// given; `floe recover` takes them apart.
#[derive(Debug)]
pub struct Text<R> {
    input: R,
    run: Option<u32>,
    text: Vec<u8>,
    given: usize,
    done: bool,
}

impl<R: Read> Text<R> {
    /// Reads from the start of a log file.
    pub fn new(input: R) -> Self {
        Self { input, run: None, text: Vec::new(), given: 0, done: false }
    }

    /// The next sector as text. Damaged and empty sectors have none.
    fn refill(&mut self) -> io::Result<()> {
        let mut sector: Sector = [0; SECTOR_LEN];
        match self.input.read_exact(&mut sector) {
            Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => self.done = true,
            Err(error) => return Err(error),
            Ok(()) => {
                if let Ok(record) = Record::decode(&sector) {
                    self.take(&record);
                }
            }
        }
        Ok(())
    }

    fn take(&mut self, record: &Record) {
        if record.samples.is_empty() {
            return;
        }
        if self.run.is_none() {
            self.run = Some(record.run);
            self.text.extend(head(&record.settings).bytes());
        }
        if self.run != Some(record.run) {
            self.done = true;
            return;
        }
        for sample in &record.samples {
            let line = row(&record.settings, record.first_index, sample);
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
