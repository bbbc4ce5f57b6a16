//! Faults of the chip, and their times.

use serde::{Deserialize, Serialize};

/// A fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Trouble {
    /// The chip does not answer.
    Silent,
    /// The chip answers too late.
    Late {
        /// Delay of every answer.
        ns: u64,
    },
    /// Conversions take longer.
    Slow {
        /// Added to the conversion time.
        ns: u64,
    },
    /// The chip repeats the same conversion.
    Stuck,
    /// The chip converts, but always with the same code.
    Frozen,
    /// The chip converts to full scale.
    Saturated,
    /// A dip of the supply: all registers have their power-up values, once.
    BrownOut,
    /// Bits of one register flip, once.
    Upset {
        /// Address of the register.
        register: usize,
        /// Bits that flip.
        mask: u8,
    },
    /// The chip sends random bytes: without a request where it can, and as every answer.
    Babbling,
}

/// A random byte of a babbling chip.
pub(super) fn noise(place: u64) -> u8 {
    (place.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 56) as u8
}

/// Faults by the sample number of the load cell.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Schedule {
    entries: Vec<Entry>,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Entry {
    from: u64,
    to: u64,
    trouble: Trouble,
    done: bool,
}

impl Schedule {
    /// Adds a fault for the samples `from..to`.
    #[must_use]
    pub fn with(mut self, from: u64, to: u64, trouble: Trouble) -> Self {
        self.entries.push(Entry { from, to, trouble, done: false });
        self
    }

    /// All faults delayed by a number of samples.
    #[must_use]
    pub fn later(mut self, samples: u64) -> Self {
        for entry in &mut self.entries {
            (entry.from, entry.to) = (entry.from + samples, entry.to + samples);
        }
        self
    }

    pub(super) fn at(&self, sample: u64) -> Option<Trouble> {
        let entry = self.entries.iter().find(|e| (e.from..e.to).contains(&sample))?;
        Some(entry.trouble)
    }

    /// Returns a brown-out or upset that is due and has not happened yet.
    pub(super) fn take_glitch(&mut self, sample: u64) -> Option<Trouble> {
        let glitch = |t| matches!(t, Trouble::BrownOut | Trouble::Upset { .. });
        let entry =
            self.entries.iter_mut().find(|e| !e.done && e.from <= sample && glitch(e.trouble))?;
        entry.done = true;
        Some(entry.trouble)
    }
}
