//! What can be wrong with the chip, and when.

use serde::{Deserialize, Serialize};

/// One kind of trouble.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Trouble {
    /// It does not answer.
    Silent,
    /// It answers, but this much too late.
    Late {
        /// Delay of every answer.
        ns: u64,
    },
    /// Conversions take this much longer.
    Slow {
        /// Added to the conversion time.
        ns: u64,
    },
    /// It gives the same conversion again and again.
    Stuck,
    /// It converts, but always gets the same code.
    Frozen,
    /// Full scale.
    Saturated,
    /// A dip of the supply: all registers at their power-up values, once.
    BrownOut,
    /// Bits of one register flip, once.
    Upset {
        /// Address of the register.
        register: usize,
        /// Bits that flip.
        mask: u8,
    },
    /// It sends random bytes: without being asked where it can, and for every answer.
    Babbling,
}

/// A byte of whatever comes to a babbling chip's mind.
pub(super) fn noise(place: u64) -> u8 {
    (place.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 56) as u8
}

/// Troubles by sample number of the load cell.
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
    /// Adds a trouble for the samples `from..to`.
    #[must_use]
    pub fn with(mut self, from: u64, to: u64, trouble: Trouble) -> Self {
        self.entries.push(Entry { from, to, trouble, done: false });
        self
    }

    /// All of them so many samples later.
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

    /// A brown-out or upset that is due and has not happened yet.
    pub(super) fn take_glitch(&mut self, sample: u64) -> Option<Trouble> {
        let glitch = |t| matches!(t, Trouble::BrownOut | Trouble::Upset { .. });
        let entry =
            self.entries.iter_mut().find(|e| !e.done && e.from <= sample && glitch(e.trouble))?;
        entry.done = true;
        Some(entry.trouble)
    }
}
