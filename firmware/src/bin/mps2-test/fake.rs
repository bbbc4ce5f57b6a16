//! Neighbours that the tests know everything about.

use core::convert::Infallible;

use embedded_io::{ErrorType, Read, ReadReady, Write};
use floe_core::Counts;
use floe_firmware::adc::{AdcFault, BridgeAdc};
use floe_firmware::record::{Record, Sector};
use floe_firmware::store::{Store, StoreError};

/// Codes per newton of [`SawAdc`].
pub const CODES_PER_N: i32 = 5000;

/// A converter that sees a block stick and slip every two seconds: the force
/// rises for 28 samples and falls in three, with a little noise.
#[derive(Debug, Default)]
pub struct SawAdc {
    sample: Option<u32>,
}

impl SawAdc {
    /// Code of a sample.
    pub fn code(sample: u32) -> i32 {
        let force_n = match (sample % 32) as i32 {
            phase @ 0..28 => 200 + 22 * phase,
            28 => 700,
            29 => 480,
            30 => 260,
            _ => 205,
        };
        let noise = (sample.wrapping_mul(2_654_435_761) >> 18) as i32 - (1 << 13);
        force_n * CODES_PER_N + noise
    }
}

impl BridgeAdc for SawAdc {
    fn tick(&mut self) -> Result<Option<Counts>, AdcFault> {
        let taken = self.sample.map(|sample| Counts(Self::code(sample)));
        self.sample = Some(self.sample.map_or(0, |sample| sample + 1));
        Ok(taken)
    }
}

/// Somebody who has typed everything already and does not look.
#[derive(Debug)]
pub struct Typed(pub &'static [u8]);

impl ErrorType for Typed {
    type Error = Infallible;
}

impl ReadReady for Typed {
    fn read_ready(&mut self) -> Result<bool, Infallible> {
        Ok(!self.0.is_empty())
    }
}

impl Read for Typed {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Infallible> {
        let Some((first, rest)) = self.0.split_first() else { return Ok(0) };
        self.0 = rest;
        buffer[0] = *first;
        Ok(1)
    }
}

impl Write for Typed {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

/// A card that checks what it gets and keeps only the counts.
#[derive(Debug, Default)]
pub struct CheckedStore {
    next: u32,
    last_index: Option<u32>,
    /// Samples in the log.
    pub samples: u32,
    /// Indices that the log lacks.
    pub missing: u32,
    /// Overruns as the last sector says.
    pub overruns: u32,
}

impl Store for CheckedStore {
    fn last(&mut self) -> Option<Record> {
        None
    }

    fn next_sector(&self) -> u32 {
        self.next
    }

    fn write(&mut self, sector: &Sector) -> Result<(), StoreError> {
        let record = Record::decode(sector).expect("a sector that cannot be read back");
        assert_eq!(record.sector, self.next);
        for sample in &record.samples {
            let code = sample.reading.expect("a bad reading").0;
            assert_eq!(code, SawAdc::code(sample.index), "sample {}", sample.index);
            self.missing += self.last_index.map_or(0, |last| sample.index - last - 1);
            self.last_index = Some(sample.index);
            self.samples += 1;
        }
        self.overruns = record.overruns;
        self.next += 1;
        Ok(())
    }
}
