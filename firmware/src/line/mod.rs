//! Live lines: the board's messages, one line each, readable by people and programs.
//!
//! A line is `KIND,field,field,...*HHHH`. The order of a kind's fields is fixed, and new fields are
//! added at the end; an empty field is unknown; `HHHH` is the CRC-16/XMODEM of all characters
//! before the asterisk. Numbers have the fewest digits that read back as the same `f32`, so a
//! decoded event equals the board's bit for bit.

mod decimal;
mod fields;
mod parse;
mod write;

use core::fmt;

use crate::weighing::Load;
use crc::{CRC_16_XMODEM, Crc, NoTable};
use floe_core::{Change, Event, Phase, Provisional, Report, SampleFlag, Stretch};
use heapless::String;

pub use decimal::Decimal;

use crate::adc::Input;
use crate::measuring::Hindrance;
use crate::notebook::Winch;
use crate::settings::Settings;

/// Room for the longest line, an `R` with the longest numbers.
pub const LINE_LEN: usize = 640;

/// A line as text, without its end.
pub type Text = String<LINE_LEN>;

/// One message of the board.
#[derive(Clone, Debug, PartialEq)]
pub enum Line<'a> {
    /// `T`: a test starts.
    Start {
        /// Number of the test since the card was new.
        run: u32,
        /// All settings that the test is computed with.
        settings: Settings,
    },
    /// `S`: a sample during a test.
    Sample(LiveSample),
    /// `P`: the earlier sample with this index was a spike.
    Spike(u32),
    /// `A`: a first answer on a slip; the slip's `E` follows.
    About(About),
    /// `E`: an event is complete.
    Event(Event),
    /// `C`: the weight or the friction of the block has changed.
    Change(Change),
    /// `F`: a stretch without events: a steady force, or one that was not understood.
    Stretch(Stretch),
    /// `R`: the result so far.
    Report(Report),
    /// `Z`: the test is over; the last report and event have been sent.
    End {
        /// Number of the test.
        run: u32,
    },
    /// `H`: the health of the board.
    Health(Health),
    /// `M`: the mean of several readings, for the self test.
    Mean(Mean),
    /// `G`: the block's weight so far.
    Weighed(Weighed),
    /// `N`: a note by the user.
    Note(&'a str),
    /// `W`: state of the winch from now on.
    Mark {
        /// Index of the sample from the start of the test.
        index: u32,
        /// Moving or held.
        winch: Winch,
    },
    /// `Y`: the time of day at a sample.
    Sync {
        /// Index of the sample from the start of the test.
        index: u32,
        /// Start of the sample, ms since 1970 (UTC).
        unix_ms: u64,
    },
    /// `K`: temperature and supply voltage of the board.
    Climate {
        /// Index of the sample from the start of the test.
        index: u32,
        /// Temperature of the converter, °C.
        temperature_c: Option<f32>,
        /// Supply, V.
        supply_v: Option<f32>,
    },
    /// `I`: an answer as text.
    Info(&'a str),
    /// `!`: a problem, as text.
    Trouble(&'a str),
}

/// A sample with the results shown live.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LiveSample {
    /// Index from the start of the test.
    pub index: u32,
    /// Force, N; `None` if unusable.
    pub force_n: Option<f32>,
    /// Judgement of the pipeline on the sample.
    pub flag: SampleFlag,
    /// Phase of the block's motion.
    pub phase: Phase,
    /// Missing indices immediately before the sample.
    pub gap: u32,
    /// Rate of the force at the sample two before, N/s, by central difference.
    pub rate_n_per_s: Option<f32>,
}

/// Result of a weighing so far.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weighed {
    /// Length of the record used, s; 64 at most.
    pub duration_s: f32,
    /// The load in N, or the reason for none.
    pub load: Result<Load, Hindrance>,
}

/// First answer on a slip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct About {
    /// Index of the newest sample when the answer was known.
    pub index: u32,
    /// The coefficients so far.
    pub answer: Provisional,
}

impl About {
    /// Whether the event is the slip of this answer or a later one. The event of the previous slip
    /// can come after the first answer on this one.
    #[must_use]
    pub fn is_followed_by(&self, event: &Event) -> bool {
        // The shortest slip ends within the period before its first sample off the line, and that
        // sample is accepted when the next one is no spike.
        const LATEST: u32 = 2;
        event.stop.index.saturating_add(LATEST) >= self.index
    }
}

/// The state of the board.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Health {
    /// Samples since power-up.
    pub samples: u32,
    /// Samples lost because the main loop was too slow to fetch them.
    pub overruns: u32,
    /// Largest number of samples that ever waited in the queue.
    pub deepest: u32,
    /// Readings that the converter failed to deliver.
    pub adc_faults: u32,
    /// Readings at full scale.
    pub saturated: u32,
    /// Mean sampling period by the board's clock, s.
    pub period_s: Option<f32>,
    /// Longest minus shortest period, s.
    pub jitter_s: Option<f32>,
    /// Sectors written to the card.
    pub sectors: u32,
    /// Sectors that could not be written.
    pub store_failures: u32,
}

/// The mean of several readings.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Mean {
    /// What was measured.
    pub input: Input,
    /// Number of codes.
    pub count: u32,
    /// Readings that failed.
    pub failed: u32,
    /// Mean code.
    pub mean: f32,
    /// Standard deviation of the codes.
    pub deviation: f32,
    /// Number of distinct codes.
    pub different: u32,
}

/// Why a text is not a line of a board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineError {
    /// The text does not end with `*HHHH`.
    NoChecksum,
    /// The checksum does not match.
    Checksum,
    /// A kind unknown to this version.
    UnknownKind,
    /// A field is missing or has a wrong form.
    Field,
}

impl fmt::Display for LineError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NoChecksum => "no checksum",
            Self::Checksum => "wrong checksum",
            Self::UnknownKind => "unknown kind of line",
            Self::Field => "missing or bad field",
        })
    }
}

impl core::error::Error for LineError {}

fn checksum(text: &str) -> u16 {
    const CRC: Crc<u16, NoTable> = Crc::<u16, NoTable>::new(&CRC_16_XMODEM);
    CRC.checksum(text.as_bytes())
}

#[cfg(test)]
mod tests;
