//! The interface between journal and storage.

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

/// State of the card.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum CardState {
    /// No card answers.
    #[default]
    NoCard,
    /// The card answers, but cannot be read.
    Unreadable,
    /// exFAT, the format of large cards as sold.
    ExFat,
    /// FAT12, the format of very small cards as sold.
    Fat12,
    /// No file system that a camera uses.
    NotFat,
    /// The log's file cannot be created: no free space, or a full directory.
    NoRoom,
    /// The log's file is being extended; percentage done.
    Making(u8),
    /// The log's file is complete, and full of records.
    Full,
    /// The log's file is complete and has room.
    Ready,
}

impl CardState {
    /// The state as text for the console.
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

/// Storage for sectors, filled in order.
pub trait Store {
    /// The last record written before power-up.
    fn last(&mut self) -> Option<Record>;

    /// Performs a small step of other work: checks for a card from time to time, and extends the
    /// log's file. Returns the card's state.
    fn tend(&mut self) -> CardState {
        CardState::Ready
    }

    /// Number of the sector that the next write will fill.
    fn next_sector(&self) -> u32;

    /// Writes the next sector through to the medium.
    ///
    /// # Errors
    /// The sector was not written; writing it again is allowed.
    fn write(&mut self, sector: &Sector) -> Result<(), StoreError>;
}

/// Storage of a board without a card.
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
