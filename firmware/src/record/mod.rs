//! The log on the card: sectors of 512 bytes, each readable without the others.
//!
//! A sector holds eight samples (half a second), the identity of their test, all settings of the
//! computation, counters, and the messages of that time as text, including events. Its last four
//! bytes are the CRC-32 of all others; its number is its position in the file. A torn or lost
//! sector costs its own half second only.
//!
//! | at | contents (little endian) |
//! |---|---|
//! | 0 | `FLOE`, version, number of samples, length of the text (u16) |
//! | 8 | sector, run, first index of the part, clock in Hz, overruns, faults (u32) |
//! | 32 | rate, weight, slope, winch (0: unknown), range (0: unknown) (f32) |
//! | 52 | tare, lowest, highest code (i32), codes per newton (f32) |
//! | 68 | name, 16 bytes |
//! | 84 | length of the header (u16), 1 while a test runs, source of the weight, kind, track (u8), 2 spare |
//! | 92 | identity of the test, start of the part in Unix ms (u64) |
//! | 108 | part, sampling periods lost before it (u32) |
//! | 116 | effects looked for, effects compiled in (u32) |
//! | 124 | standard deviations: weight, slope, zero, span, damping (f32) |
//! | 144 | zero before and after, N (f32) |
//! | 152 | snow mm; block's length, width, height m; cable's length m, its AE N (f32) |
//! | 176 | standard deviation of the winch's speed, m/s (f32) |
//! | 180 | samples: index, stamp (u32), code (i24), state (u8) |
//! | 276 | text |
//! | 508 | CRC-32 (ISO-HDLC) |
//!
//! Samples begin at the end of the header, the text 96 bytes later. All ones means unknown, and
//! fields beyond the end of a shorter header are unknown. A header can therefore grow, and readers
//! skip fields that they do not know. The header of version 1 has 84 bytes.

mod bytes;
mod fields;

use core::fmt;

use crc::{CRC_32_ISO_HDLC, Crc, NoTable};
use heapless::{String, Vec};

use crate::sample::Sample;
use crate::settings::Settings;
use crate::wall_clock::WallClock;
use bytes::{Reader, Writer};

/// Bytes in a sector, and in a block of any card.
pub const SECTOR_LEN: usize = 512;
/// Samples in a sector.
pub const SECTOR_SAMPLES: usize = 8;
/// Room for text, bytes.
pub const TEXT_LEN: usize = CRC_AT - HEADER_LEN - SAMPLES_LEN;
/// Room for the text of any version, bytes; version 1 has the most.
const LONGEST_TEXT: usize = CRC_AT - FIRST_LEN - SAMPLES_LEN;

/// Version of the layout.
pub const VERSION: u8 = 2;
/// First bytes of every sector.
pub const MAGIC: [u8; 4] = *b"FLOE";

/// Length of the header in version 1, bytes.
const FIRST_LEN: usize = 84;
const HEADER_LEN: usize = 180;
const SAMPLES_LEN: usize = 12 * SECTOR_SAMPLES;
const CRC_AT: usize = SECTOR_LEN - 4;

/// The bytes of a sector.
pub type Sector = [u8; SECTOR_LEN];

/// A part of a test without interruption: a reset or a loss of power ends it, and the next one
/// begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// Unique identity of the test, created at its start. `None` in logs of version 1.
    pub id: Option<u64>,
    /// Number of the test on its card, from 1; in a sector without samples that of the last test.
    pub run: u32,
    /// Number of the part, from 0.
    pub number: u32,
    /// Sampling periods lost between the previous part and this one; `None` if no clock measured
    /// them.
    pub gap: Option<u32>,
    /// Index of the first sample of the part.
    pub first_index: u32,
    /// Start of the part's first sample, ms since 1970 (UTC), if known.
    pub start_ms: Option<u64>,
}

impl Default for Part {
    /// No test yet, nothing lost.
    fn default() -> Self {
        Self { id: None, run: 0, number: 0, gap: Some(0), first_index: 0, start_ms: None }
    }
}

/// The content of a sector.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Record {
    /// Number of the sector in the file.
    pub sector: u32,
    /// Part of the test that the samples belong to.
    pub part: Part,
    /// Whether the test was still running when the sector was written; false in its last sector and
    /// between tests.
    pub running: bool,
    /// Ticks per second of the samples' stamps.
    pub clock_hz: u32,
    /// Samples since power-up that were lost because the queue was full.
    pub overruns: u32,
    /// Readings since power-up that the converter failed to deliver.
    pub adc_faults: u32,
    /// Settings of the test.
    pub settings: Settings,
    /// The samples.
    pub samples: Vec<Sample, SECTOR_SAMPLES>,
    /// Live lines, each with a line feed; at most [`TEXT_LEN`] bytes are written.
    pub text: String<LONGEST_TEXT>,
}

/// Why a sector is not a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RecordError {
    /// Never written: all zero.
    Empty,
    /// Checksum or magic is wrong: a torn sector, or other data.
    Corrupt,
    /// The checksum is right, but a logger does not write such values.
    Unsound,
    /// Written by a newer version.
    Version(u8),
}

impl fmt::Display for RecordError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => f.write_str("empty sector"),
            Self::Corrupt => f.write_str("corrupt sector"),
            Self::Unsound => f.write_str("sector that no logger writes"),
            Self::Version(v) => write!(f, "sector of log version {v}, this reads {VERSION}"),
        }
    }
}

impl core::error::Error for RecordError {}

impl Record {
    /// The bytes of the record.
    #[must_use]
    pub fn encode(&self) -> Sector {
        let mut sector = [0; SECTOR_LEN];
        let mut out = Writer { bytes: &mut sector, at: 0 };
        let text = self.text.get(..TEXT_LEN).unwrap_or(&self.text);
        out.put(MAGIC);
        out.put([VERSION, self.samples.len() as u8]);
        out.put((text.len() as u16).to_le_bytes());
        fields::put_first(&mut out, self);
        out.put((HEADER_LEN as u16).to_le_bytes());
        fields::put_second(&mut out, self);
        out.at = HEADER_LEN;
        self.samples.iter().for_each(|sample| fields::put_sample(&mut out, sample));
        out.at = HEADER_LEN + SAMPLES_LEN;
        text.bytes().for_each(|byte| out.put([byte]));
        out.at = CRC_AT;
        let sum = checksum(out.bytes);
        out.put_u32(sum);
        sector
    }

    /// Decodes a sector.
    ///
    /// # Errors
    /// The sector is empty, damaged, of a newer version, or not from a logger.
    pub fn decode(sector: &Sector) -> Result<Self, RecordError> {
        if sector.iter().all(|&byte| byte == 0) {
            return Err(RecordError::Empty);
        }
        let mut from = Reader { bytes: sector, at: CRC_AT, end: SECTOR_LEN };
        let sum = from.u32();
        if sector[..4] != MAGIC || sum != checksum(sector) {
            return Err(RecordError::Corrupt);
        }
        from.at = 4;
        let [version, samples] = from.take();
        let text_len = usize::from(u16::from_le_bytes(from.take()));
        let header_len = match version {
            1 => FIRST_LEN,
            VERSION => usize::from(u16::from_le_bytes([sector[FIRST_LEN], sector[FIRST_LEN + 1]])),
            newer => return Err(RecordError::Version(newer)),
        };
        from.end = header_len;
        Self::read(from, samples, text_len).ok_or(RecordError::Unsound)
    }

    /// Time of the record's last sample, ms since 1970 (UTC), if known.
    #[must_use]
    pub fn last_ms(&self) -> Option<u64> {
        let mut clock = WallClock::default();
        clock.set(self.part.start_ms?, self.part.first_index);
        clock.at(self.samples.last()?.index)
    }

    fn read(mut from: Reader<'_>, samples: u8, text_len: usize) -> Option<Self> {
        let header_len = from.end;
        let text_at = header_len + SAMPLES_LEN;
        let room = CRC_AT.checked_sub(text_at)?;
        let samples = usize::from(samples);
        if header_len < FIRST_LEN || samples > SECTOR_SAMPLES || text_len > room {
            return None;
        }
        let mut record = Self::default();
        fields::take_first(&mut from, &mut record)?;
        from.at = FIRST_LEN + 2;
        fields::take_second(&mut from, &mut record);
        (from.at, from.end) = (header_len, text_at);
        record.samples = (0..samples).map(|_| fields::take_sample(&mut from)).collect();
        let text = from.bytes.get(text_at..text_at + text_len)?;
        record.text = fields::ascii(text)?;
        record.settings.is_sound().then_some(record)
    }
}

fn checksum(sector: &Sector) -> u32 {
    const CRC: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);
    CRC.checksum(&sector[..CRC_AT])
}
