//! Stand-ins for converter, console and card with known behaviour.

use core::convert::Infallible;

use embedded_io::{ErrorType, Read, ReadReady, Write};
use floe_core::Counts;
use floe_firmware::adc::{AdcFault, BridgeAdc};
use floe_firmware::record::{Record, Sector};
use floe_firmware::store::{Store, StoreError};

/// Codes per newton of [`SawAdc`].
pub const CODES_PER_N: i32 = 5000;

/// A converter on a block that sticks and slips every two seconds: the force rises for 28 samples
/// and falls for three, with a little noise.
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

/// A console whose whole input is typed in advance and whose output is discarded.
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

/// A store that checks every sector and keeps only counts.
#[derive(Debug, Default)]
pub struct CheckedStore {
    next: u32,
    last_index: Option<u32>,
    /// Number of samples in the log.
    pub samples: u32,
    /// Number of indices missing from the log.
    pub missing: u32,
    /// Overruns as stated in the last sector.
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
