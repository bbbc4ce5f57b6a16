//! The log on the card: sectors of 512 bytes that each stand alone.
//!
//! A sector holds eight samples (half a second), what identifies their test for
//! ever, everything that they were computed with, the counters, and what was said
//! meanwhile as text (the events among it). Its last four bytes are the CRC-32 of the
//! others, its number is its place in the file. A torn or lost sector costs its own
//! half second, no more.
//!
//! | at | what (little endian) |
//! |---|---|
//! | 0 | `FLOE`, version, number of samples, length of the text (u16) |
//! | 8 | sector, run, first index of the part, clock in Hz, overruns, faults (u32) |
//! | 32 | rate, weight, slope, winch (0: unknown), range (0: unknown) (f32) |
//! | 52 | tare, lowest, highest code (i32), codes per newton (f32) |
//! | 68 | name, 16 bytes |
//! | 84 | length of the header (u16), 1 while a test runs, source of the weight, kind, track (u8), 2 spare |
//! | 92 | identity of the test, start of the test in Unix ms (u64) |
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
//! Samples begin where the header ends, and the text 96 bytes later. All ones is
//! unknown, and a header that ends earlier says nothing of the rest: so a header can
//! grow, readers skip what they do not know, and version 1 is one of 84 bytes.

mod bytes;
mod fields;

use core::fmt;

use crc::{CRC_32_ISO_HDLC, Crc, NoTable};
use heapless::{String, Vec};

use crate::sample::Sample;
use crate::settings::Settings;
use crate::wall_clock::WallClock;
use bytes::{Reader, Writer};

/// Bytes in a sector of any card.
pub const SECTOR_LEN: usize = 512;
/// Samples in a sector.
pub const SECTOR_SAMPLES: usize = 8;
/// Room for text.
pub const TEXT_LEN: usize = CRC_AT - HEADER_LEN - SAMPLES_LEN;
/// Room for text in version 1, and for all that was ever written.
const LONGEST_TEXT: usize = CRC_AT - FIRST_LEN - SAMPLES_LEN;

/// Version of this layout.
pub const VERSION: u8 = 2;
/// What every sector begins with.
pub const MAGIC: [u8; 4] = *b"FLOE";

/// The header of version 1.
const FIRST_LEN: usize = 84;
const HEADER_LEN: usize = 180;
const SAMPLES_LEN: usize = 12 * SECTOR_SAMPLES;
const CRC_AT: usize = SECTOR_LEN - 4;

/// A sector as it is on the card.
pub type Sector = [u8; SECTOR_LEN];

/// An unbroken part of a test: a reset or a power cut ends one, and the next begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// Identity of the test, made when it was started: no other has it. `None` in
    /// logs of version 1.
    pub id: Option<u64>,
    /// Number of the test on its card, from 1; of the last one when there are no
    /// samples.
    pub run: u32,
    /// Number of the part, from 0.
    pub number: u32,
    /// Sampling periods lost between the part before and this one; `None` if no
    /// clock could tell.
    pub gap: Option<u32>,
    /// Index of the first sample of the part.
    pub first_index: u32,
    /// When the test was started, ms since 1970 (UTC), if the board knew.
    pub start_ms: Option<u64>,
}

impl Default for Part {
    /// No test yet.
    fn default() -> Self {
        Self { id: None, run: 0, number: 0, gap: Some(0), first_index: 0, start_ms: None }
    }
}

/// The content of a sector.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Record {
    /// Place in the file.
    pub sector: u32,
    /// Whose samples these are.
    pub part: Part,
    /// Whether the test was running when the sector was written: not in its last
    /// sector, nor between tests.
    pub running: bool,
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
    /// Live lines, each with a line feed; at most [`TEXT_LEN`] bytes are written.
    pub text: String<LONGEST_TEXT>,
}

/// Why a sector is not a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RecordError {
    /// Never written: all zero.
    Empty,
    /// Something else, or torn.
    Corrupt,
    /// The checksum is right, the content is none that a logger writes.
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
    /// The sector to write.
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

    /// Reads a sector back.
    ///
    /// # Errors
    /// It is empty, damaged, of a newer version, or none of a logger's.
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

    /// When its last sample was taken, ms since 1970 (UTC), if the board knew.
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
