//! Live lines: what the board says, one line each, readable by people and
//! programs.
//!
//! `KIND,field,field,...*HHHH`: the fields of a kind are fixed in order and may
//! grow at the end; an empty field is unknown; `HHHH` is the CRC-16/XMODEM of all
//! that stands before the asterisk. Numbers are written with the fewest digits
//! that give the same `f32` back, so a decoded event is the board's bit for bit.

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
        /// All that the test is computed with.
        settings: Settings,
    },
    /// `S`: a sample during a test.
    Sample(LiveSample),
    /// `P`: the earlier sample with this index was a spike.
    Spike(u32),
    /// `A`: a first answer on a slip; its `E` follows.
    About(About),
    /// `E`: an event is complete.
    Event(Event),
    /// `C`: the block or its friction has changed.
    Change(Change),
    /// `F`: a stretch without events: a constant force, or what was not understood.
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
    /// `M`: the mean of a number of readings, for taring and self test.
    Mean(Mean),
    /// `G`: the block's weight so far.
    Weighed(Weighed),
    /// `N`: what somebody wrote down.
    Note(&'a str),
    /// `W`: what the winch does from now on.
    Mark {
        /// From the start of the test.
        index: u32,
        /// Moving or held.
        winch: Winch,
    },
    /// `Y`: what time it is.
    Sync {
        /// From the start of the test.
        index: u32,
        /// Milliseconds since 1970 (UTC).
        unix_ms: u64,
    },
    /// `K`: how cold the board is, and how its battery does.
    Climate {
        /// From the start of the test.
        index: u32,
        /// Temperature of the converter, °C.
        temperature_c: Option<f32>,
        /// Supply, V.
        supply_v: Option<f32>,
    },
    /// `I`: an answer, in words.
    Info(&'a str),
    /// `!`: something is wrong, in words.
    Trouble(&'a str),
}

/// A sample as it is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LiveSample {
    /// From the start of the test.
    pub index: u32,
    /// N; `None` if unusable.
    pub force_n: Option<f32>,
    /// What the pipeline made of it.
    pub flag: SampleFlag,
    /// What the block is doing.
    pub phase: Phase,
    /// Missing indices right before.
    pub gap: u32,
    /// Rate of the force, N/s, by central difference: of the sample two before.
    pub rate_n_per_s: Option<f32>,
}

/// A weighing as it is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weighed {
    /// Length of the record that counts, s; 64 at most.
    pub duration_s: f32,
    /// The load in N, or what stands in the way.
    pub load: Result<Load, Hindrance>,
}

/// A first answer as it is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct About {
    /// The newest sample when it was known.
    pub index: u32,
    /// The coefficients so far.
    pub answer: Provisional,
}

impl About {
    /// Is that event the slip that this was about, or a later one? The event of the
    /// slip before comes later than the first answer on this one.
    #[must_use]
    pub fn is_followed_by(&self, event: &Event) -> bool {
        // The shortest slip ends within the period before its first sample off the
        // line, and that one is believed when the next sample is no spike.
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
    /// Samples lost because the main loop was away too long.
    pub overruns: u32,
    /// Most samples that ever waited in the queue.
    pub deepest: u32,
    /// Readings that the converter owed.
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

/// The mean of a number of readings.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Mean {
    /// What was measured.
    pub input: Input,
    /// How many codes.
    pub count: u32,
    /// Readings that failed.
    pub failed: u32,
    /// Mean code.
    pub mean: f32,
    /// Standard deviation of the codes.
    pub deviation: f32,
    /// Different codes among them.
    pub different: u32,
}

/// Why a line is not one of ours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineError {
    /// No `*HHHH` at its end.
    NoChecksum,
    /// The checksum is another.
    Checksum,
    /// A kind that this version does not know.
    UnknownKind,
    /// A field is missing or not what it should be.
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
