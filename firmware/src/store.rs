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

/// A place for sectors, filled from its beginning.
pub trait Store {
    /// The last record of earlier times.
    fn last(&mut self) -> Option<Record>;

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

    fn next_sector(&self) -> u32 {
        0
    }

    fn write(&mut self, _: &Sector) -> Result<(), StoreError> {
        Err(StoreError::NoCard)
    }
}
