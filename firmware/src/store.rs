//! Where sectors go.

use crate::record::{Record, Sector};

/// Why a sector was not stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum StoreError {
    /// No card, or one that cannot be read.
    NoCard,
    /// The card refused to write.
    Write,
    /// The log has reached the end of its file.
    Full,
}

/// What the card is like.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum CardState {
    /// Nobody answers.
    #[default]
    NoCard,
    /// It answers, but nothing can be read.
    Unreadable,
    /// exFAT, as large cards are sold.
    ExFat,
    /// FAT12, as very small cards are sold.
    Fat12,
    /// None of those that a camera knows.
    NotFat,
    /// The log's file cannot be made: no room, or a directory that is full.
    NoRoom,
    /// The log's file is being made longer; so many percent are there.
    Making(u8),
    /// The log's file is whole, and written to its end.
    Full,
    /// The log's file is whole.
    Ready,
}

impl CardState {
    /// In words, for the console.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::NoCard => "no card",
            Self::Unreadable => "the card cannot be read: take another",
            Self::ExFat => "the card is exFAT: format it as FAT32",
            Self::Fat12 => "the card is FAT12: take one of 64 MB up, FAT32",
            Self::NotFat => "no file system on the card: format it as FAT32",
            Self::NoRoom => "no room for FLOE.LOG (96 MiB)",
            Self::Making(_) => "card found; its log file grows",
            Self::Full => "FLOE.LOG is full: put in another card",
            Self::Ready => "card ready",
        }
    }

    /// Whether sectors can be written.
    #[must_use]
    pub fn is_usable(self) -> bool {
        matches!(self, Self::Making(_) | Self::Ready)
    }
}

/// A place for sectors, filled from its beginning.
pub trait Store {
    /// The last record of earlier times.
    fn last(&mut self) -> Option<Record>;

    /// Does a little of what there is to do beside writing: looks for a card now and
    /// then, makes the log's file longer. Returns what the card is like.
    fn tend(&mut self) -> CardState {
        CardState::Ready
    }

    /// Number of the sector that the next write will fill.
    fn next_sector(&self) -> u32;

    /// Writes the next sector, through to the medium.
    ///
    /// # Errors
    /// Nothing was written; the same sector may be tried again.
    fn write(&mut self, sector: &Sector) -> Result<(), StoreError>;
}

/// A board without a card.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoStore;

impl Store for NoStore {
    fn last(&mut self) -> Option<Record> {
        None
    }

    fn tend(&mut self) -> CardState {
        CardState::NoCard
    }

    fn next_sector(&self) -> u32 {
        0
    }

    fn write(&mut self, _: &Sector) -> Result<(), StoreError> {
        Err(StoreError::NoCard)
    }
}
