//! The log on the card: sectors of 512 bytes that each stand alone.
//!
//! A sector holds eight samples (half a second), everything that they were
//! computed with, the counters, and what was said meanwhile as text (the events
//! among it). Its last four bytes are the CRC-32 of the others, its number is its
//! place in the file. A torn or lost sector costs its own half second, no more.
//!
//! | at | what (little endian) |
//! |---|---|
//! | 0 | `FLOE`, version, number of samples, length of the text (u16) |
//! | 8 | sector, run, first index of the run, clock in Hz, overruns, faults (u32) |
//! | 32 | rate, weight, slope, winch (0: unknown), range (0: unknown) (f32) |
//! | 52 | tare, lowest, highest code (i32), codes per newton (f32) |
//! | 68 | name, 16 bytes |
//! | 84 | samples: index, stamp (u32), code (i24), state (u8) |
//! | 180 | text |
//! | 508 | CRC-32 (ISO-HDLC) |

use core::fmt;

use crc::{CRC_32_ISO_HDLC, Crc, NoTable};
use floe_core::{Calibration, Config, Counts, InputStd};
use heapless::{String, Vec};

use crate::adc::{AdcFault, Input};
use crate::sample::Sample;
use crate::settings::{NAME_LEN, Settings};

/// Bytes in a sector of any card.
pub const SECTOR_LEN: usize = 512;
/// Samples in a sector.
pub const SECTOR_SAMPLES: usize = 8;
/// Room for text.
pub const TEXT_LEN: usize = CRC_AT - TEXT_AT;

/// Version of this layout.
pub const VERSION: u8 = 1;
/// What every sector begins with.
pub const MAGIC: [u8; 4] = *b"FLOE";

const TEXT_AT: usize = 84 + 12 * SECTOR_SAMPLES;
const CRC_AT: usize = SECTOR_LEN - 4;

/// A sector as it is on the card.
pub type Sector = [u8; SECTOR_LEN];

/// The content of a sector.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Record {
    /// Place in the file.
    pub sector: u32,
    /// Number of the test, from 1; of the last one when there are no samples.
    pub run: u32,
    /// Index of the first sample of the test.
    pub first_index: u32,
    /// Ticks per second of the stamps.
    pub clock_hz: u32,
    /// Samples lost since power-up because nobody fetched them.
    pub overruns: u32,
    /// Readings since power-up that the converter owed.
    pub adc_faults: u32,
    /// What the test is computed with.
    pub settings: Settings,
    /// The samples.
    pub samples: Vec<Sample, SECTOR_SAMPLES>,
    /// Live lines, each with a line feed.
    pub text: String<TEXT_LEN>,
}

/// Why a sector is not a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RecordError {
    /// Never written: all zero.
    Empty,
    /// Something else, or torn.
    Corrupt,
    /// Written by a newer version.
    Version(u8),
}

impl fmt::Display for RecordError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => f.write_str("empty sector"),
            Self::Corrupt => f.write_str("corrupt sector"),
            Self::Version(v) => write!(f, "sector of log version {v}, this reads {VERSION}"),
        }
    }
}

impl core::error::Error for RecordError {}

impl Record {
    /// The sector to write.
    #[must_use]
    pub fn encode(&self) -> Sector {
        let mut sector = [0; SECTOR_LEN];
        let mut out = Cursor { bytes: &mut sector, at: 0 };
        out.put(MAGIC);
        out.put([VERSION, self.samples.len() as u8]);
        out.put((self.text.len() as u16).to_le_bytes());
        let numbers = [self.sector, self.run, self.first_index, self.clock_hz];
        numbers.iter().for_each(|n| out.put(n.to_le_bytes()));
        out.put(self.overruns.to_le_bytes());
        out.put(self.adc_faults.to_le_bytes());
        put_settings(&mut out, &self.settings);
        for sample in &self.samples {
            put_sample(&mut out, sample);
        }
        out.at = TEXT_AT;
        self.text.bytes().for_each(|byte| out.put([byte]));
        out.at = CRC_AT;
        let sum = checksum(out.bytes);
        out.put(sum.to_le_bytes());
        sector
    }

    /// Reads a sector back.
    ///
    /// # Errors
    /// It is empty, damaged or of another version.
    pub fn decode(sector: &Sector) -> Result<Self, RecordError> {
        if sector.iter().all(|&byte| byte == 0) {
            return Err(RecordError::Empty);
        }
        let mut from = Reader { bytes: sector, at: CRC_AT };
        let sum = from.u32();
        if sector[..4] != MAGIC || sum != checksum(sector) {
            return Err(RecordError::Corrupt);
        }
        from.at = 4;
        let [version, samples] = from.take();
        if version != VERSION {
            return Err(RecordError::Version(version));
        }
        let text_len = usize::from(u16::from_le_bytes(from.take()));
        let record = Self {
            sector: from.u32(),
            run: from.u32(),
            first_index: from.u32(),
            clock_hz: from.u32(),
            overruns: from.u32(),
            adc_faults: from.u32(),
            settings: take_settings(&mut from),
            samples: (0..usize::from(samples).min(SECTOR_SAMPLES))
                .map(|_| take_sample(&mut from))
                .collect(),
            text: take_text(sector, text_len).ok_or(RecordError::Corrupt)?,
        };
        Ok(record)
    }
}

fn put_settings(out: &mut Cursor<'_>, settings: &Settings) {
    let Config { rate_hz, weight_n, slope_rad, winch_m_per_s, range_n, calibration, std: _ } =
        settings.config;
    let unknown_as_zero = |value: Option<f32>| value.unwrap_or(0.0);
    let floats =
        [rate_hz, weight_n, slope_rad, unknown_as_zero(winch_m_per_s), unknown_as_zero(range_n)];
    floats.iter().for_each(|x| out.put(x.to_le_bytes()));
    out.put(calibration.tare_counts.to_le_bytes());
    out.put(calibration.range_counts.0.to_le_bytes());
    out.put(calibration.range_counts.1.to_le_bytes());
    out.put(calibration.counts_per_n.to_le_bytes());
    let mut name = [0; NAME_LEN];
    name.iter_mut().zip(settings.name.bytes()).for_each(|(to, from)| *to = from);
    out.put(name);
}

fn take_settings(from: &mut Reader<'_>) -> Settings {
    let known = |value: f32| (value > 0.0).then_some(value);
    let config = Config {
        rate_hz: from.f32(),
        weight_n: from.f32(),
        slope_rad: from.f32(),
        winch_m_per_s: known(from.f32()),
        range_n: known(from.f32()),
        calibration: {
            let tare_counts = from.i32();
            let range_counts = (from.i32(), from.i32());
            Calibration { tare_counts, counts_per_n: from.f32(), range_counts }
        },
        std: InputStd::default(),
    };
    let bytes: [u8; NAME_LEN] = from.take();
    let text = core::str::from_utf8(&bytes).unwrap_or("");
    let name = String::try_from(text.trim_end_matches('\0')).unwrap_or_default();
    Settings { config, name }
}

fn put_sample(out: &mut Cursor<'_>, sample: &Sample) {
    out.put(sample.index.to_le_bytes());
    out.put(sample.stamp.to_le_bytes());
    let code = sample.reading.map_or(0, |counts| counts.0);
    let [b0, b1, b2, _] = code.to_le_bytes();
    let state = match sample.reading {
        Ok(_) => 0,
        Err(AdcFault::Silent) => 1,
        Err(AdcFault::NotReady) => 2,
        Err(AdcFault::Garbled) => 3,
        Err(AdcFault::Stuck) => 4,
        Err(AdcFault::Registers) => 5,
    };
    out.put([b0, b1, b2, state]);
}

fn take_sample(from: &mut Reader<'_>) -> Sample {
    let (index, stamp) = (from.u32(), from.u32());
    let [b0, b1, b2, state] = from.take();
    let code = i32::from_le_bytes([0, b0, b1, b2]) >> 8;
    let reading = match state {
        0 => Ok(Counts(code)),
        1 => Err(AdcFault::Silent),
        2 => Err(AdcFault::NotReady),
        4 => Err(AdcFault::Stuck),
        5 => Err(AdcFault::Registers),
        _ => Err(AdcFault::Garbled),
    };
    Sample { index, stamp, input: Input::Bridge, reading }
}

fn take_text(sector: &Sector, len: usize) -> Option<String<TEXT_LEN>> {
    let bytes = sector.get(TEXT_AT..TEXT_AT + len.min(TEXT_LEN))?;
    String::try_from(core::str::from_utf8(bytes).ok()?).ok()
}

fn checksum(sector: &Sector) -> u32 {
    const CRC: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);
    CRC.checksum(&sector[..CRC_AT])
}

/// Writes at a place that moves on; beyond the end nothing happens.
struct Cursor<'a> {
    bytes: &'a mut Sector,
    at: usize,
}

impl Cursor<'_> {
    fn put<const N: usize>(&mut self, value: [u8; N]) {
        if let Some(place) = self.bytes.get_mut(self.at..self.at + N) {
            place.copy_from_slice(&value);
        }
        self.at += N;
    }
}

/// Reads at a place that moves on; beyond the end there are zeros.
struct Reader<'a> {
    bytes: &'a Sector,
    at: usize,
}

impl Reader<'_> {
    fn take<const N: usize>(&mut self) -> [u8; N] {
        let bytes = self.bytes.get(self.at..self.at + N);
        self.at += N;
        bytes.and_then(|b| b.try_into().ok()).unwrap_or([0; N])
    }

    fn u32(&mut self) -> u32 {
        u32::from_le_bytes(self.take())
    }

    fn i32(&mut self) -> i32 {
        i32::from_le_bytes(self.take())
    }

    fn f32(&mut self) -> f32 {
        f32::from_le_bytes(self.take())
    }
}
