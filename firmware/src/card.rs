//! The log file on an SD card with a FAT file system.
//!
//! The file is created once, filled with zeros and then only written in place, one 512-byte block
//! per sector. No metadata change while logging, so that loss of power can cost a sector but never
//! the file system. For a slow card the board extends the file in steps while it already logs;
//! until it is complete, a power cut can leave a cluster chain longer than the file, which any file
//! system check repairs.

use embedded_sdmmc::{BlockDevice, Mode, RawDirectory, RawFile, RawVolume, TimeSource, Timestamp};
use embedded_sdmmc::{VolumeIdx, VolumeManager};

use crate::media::{Failed, Media};
use crate::record::{Record, SECTOR_LEN, Sector};
use crate::store::{CardState, Store, StoreError};

/// Name of the file.
const FILE: &str = "FLOE.LOG";

/// Calls between two checks of a card that is missing or to which nothing was written in between:
/// it may have been inserted, removed or exchanged.
const CALLS: u32 = 16;

/// First number of the handles; its value does not matter.
const FIRST_HANDLE: u32 = 0;

/// Storage of sectors in the log file on a card.
#[expect(missing_debug_implementations, reason = "the volume manager has none")]
pub struct CardLog<D: BlockDevice> {
    open: Option<Open>,
    state: CardState,
    /// Number of sectors of the complete file, sectors present, and sectors per step.
    sectors: u32,
    made: u32,
    step: u32,
    next: u32,
    calls: u32,
    volumes: Volumes<D>,
}

/// File system driver with one open directory, file and volume.
type Volumes<D> = VolumeManager<Media<D>, NoClock, 1, 1, 1>;

struct Open {
    volume: RawVolume,
    root: RawDirectory,
    file: RawFile,
}

/// Time source of the file system: always the earliest date of FAT.
#[derive(Clone, Copy, Debug)]
struct NoClock;

impl TimeSource for NoClock {
    fn get_timestamp(&self) -> Timestamp {
        Timestamp {
            year_since_1970: 10,
            zero_indexed_month: 0,
            zero_indexed_day: 0,
            hours: 0,
            minutes: 0,
            seconds: 0,
        }
    }
}

type Error = embedded_sdmmc::Error<Failed>;

impl<D: BlockDevice> CardLog<D> {
    /// A log of `sectors` sectors (half a second each). The card is opened when the last record is
    /// read, and again by [`Store::tend`] if that fails.
    #[inline]
    pub fn new(device: D, sectors: u32) -> Self {
        let volumes = Volumes::new_with_limits(Media::new(device), NoClock, FIRST_HANDLE);
        let (open, state) = (None, CardState::NoCard);
        Self { volumes, open, state, sectors, made: 0, step: sectors, next: 0, calls: 0 }
    }

    /// Extends the file by `sectors` sectors per step.
    #[must_use]
    pub fn in_steps_of(self, sectors: u32) -> Self {
        Self { step: sectors, ..self }
    }

    fn ensure_open(&mut self) {
        if self.open.is_some() {
            return;
        }
        match self.try_open() {
            Ok(open) => {
                self.open = Some(open);
                match self.find_end() {
                    Some(end) => {
                        self.next = end;
                        self.see_state();
                    }
                    None => {
                        self.give_up();
                        self.state = CardState::Unreadable;
                    }
                }
            }
            Err(state) => {
                let failed = self.volumes.device(|media| media.is_shut());
                self.state = if failed { CardState::Unreadable } else { state };
            }
        }
    }

    fn try_open(&mut self) -> Result<Open, CardState> {
        // Discards what was read from another card.
        self.volumes.device(|media| media.look())?;
        let volume = self.volumes.open_raw_volume(VolumeIdx(0)).map_err(|_| CardState::NotFat)?;
        let root = self.volumes.open_root_dir(volume).map_err(|_| {
            let _ = self.volumes.close_volume(volume);
            CardState::Unreadable
        })?;
        match self.open_file(root) {
            Ok(file) => Ok(Open { volume, root, file }),
            Err(_) => {
                let _ = self.volumes.close_dir(root);
                let _ = self.volumes.close_volume(volume);
                Err(CardState::NoRoom)
            }
        }
    }

    fn open_file(&mut self, root: RawDirectory) -> Result<RawFile, Error> {
        let mode = Mode::ReadWriteCreateOrAppend;
        let file = self.volumes.open_file_in_dir(root, FILE, mode)?;
        // The file may be new, or its extension was interrupted.
        match self.measure(file).and_then(|()| self.lengthen(file)) {
            Ok(()) => Ok(file),
            Err(error) => {
                let _ = self.volumes.close_file(file);
                Err(error)
            }
        }
    }

    /// Reads the length of the file. Free space is checked by the file system's own count first,
    /// because scanning the table of a large full card takes longer than the watchdog allows.
    fn measure(&mut self, file: RawFile) -> Result<(), Error> {
        self.made = self.volumes.file_length(file)? / SECTOR_LEN as u32;
        let missing = self.sectors.saturating_sub(self.made);
        let free = self.volumes.device(|media| media.free_blocks());
        if free.is_some_and(|free| free < missing) {
            return Err(embedded_sdmmc::Error::NotEnoughSpace);
        }
        Ok(())
    }

    /// Extends the file by one step unless it is complete.
    fn lengthen(&mut self, file: RawFile) -> Result<(), Error> {
        if self.made >= self.sectors {
            return Ok(());
        }
        let end = self.made.saturating_add(self.step).min(self.sectors);
        self.volumes.file_seek_from_start(file, self.made * SECTOR_LEN as u32)?;
        for _ in self.made..end {
            self.volumes.write(file, &[0; SECTOR_LEN])?;
        }
        self.volumes.flush_file(file)?;
        self.made = end;
        Ok(())
    }

    fn see_state(&mut self) {
        self.state = if self.made < self.sectors {
            let percent = self.made / (self.sectors / 100).max(1);
            CardState::Making(percent.min(99) as u8)
        } else if self.next >= self.made {
            CardState::Full
        } else {
            CardState::Ready
        };
    }

    /// Closes the card after an error. Writing is blocked first: another card may be in the slot,
    /// and closing the file would write the old card's directory to it.
    fn give_up(&mut self) {
        self.volumes.device(|media| media.shut(true));
        self.close();
        self.state = CardState::NoCard;
        self.calls = 0;
    }

    /// First sector that was never written, by bisection, since sectors are written in order. A
    /// single damaged sector counts as written if the next one is. `None` if a needed sector cannot
    /// be read: taken for empty, it would let tests behind it be overwritten.
    fn find_end(&mut self) -> Option<u32> {
        let (mut low, mut high) = (0, self.made);
        while low < high {
            let middle = low + (high - low) / 2;
            let used = match self.is_used(middle) {
                Some(true) => true,
                here => self.is_used(middle + 1)? || here?,
            };
            if used { low = middle + 1 } else { high = middle }
        }
        Some(low)
    }

    /// Whether a sector was written; `None` if it cannot be read.
    fn is_used(&mut self, sector: u32) -> Option<bool> {
        if sector >= self.made {
            return Some(false);
        }
        self.read(sector).map(|bytes| bytes.iter().any(|&byte| byte != 0))
    }

    fn read(&mut self, sector: u32) -> Option<Sector> {
        let file = self.open.as_ref()?.file;
        let mut bytes = [0; SECTOR_LEN];
        self.volumes.file_seek_from_start(file, sector.checked_mul(SECTOR_LEN as u32)?).ok()?;
        let read = self.volumes.read(file, &mut bytes);
        // A sector that cannot be read does not matter to those that are written.
        self.volumes.device(|media| media.shut(false));
        (read.ok()? == SECTOR_LEN).then_some(bytes)
    }

    fn close(&mut self) {
        if let Some(Open { volume, root, file }) = self.open.take() {
            let _ = self.volumes.close_file(file);
            let _ = self.volumes.close_dir(root);
            let _ = self.volumes.close_volume(volume);
        }
    }
}

impl<D: BlockDevice> Store for CardLog<D> {
    fn last(&mut self) -> Option<Record> {
        self.ensure_open();
        let newest = self.next.checked_sub(1)?;
        let mut near = (newest.saturating_sub(4)..=newest).rev();
        // A second attempt, because an older record may have other settings, or a test that goes on.
        let mut last = near.find_map(|sector| {
            let bytes = self.read(sector).or_else(|| self.read(sector))?;
            Record::decode(&bytes).ok()
        })?;
        // A test that has filled the log cannot be resumed.
        last.running &= self.next < self.sectors;
        Some(last)
    }

    fn tend(&mut self) -> CardState {
        self.calls += 1;
        let is_due = self.calls >= CALLS;
        if is_due {
            self.calls = 0;
        }
        match self.open.as_ref().map(|open| open.file) {
            Some(file) if self.made < self.sectors => match self.lengthen(file) {
                Ok(()) => self.see_state(),
                Err(_) => self.give_up(),
            },
            _ if !is_due => {}
            None if self.state != CardState::NoRoom => self.ensure_open(),
            // Without writes, check that the card is still present.
            _ if self.volumes.device(|media| media.look()).is_err() => self.give_up(),
            _ => {}
        }
        self.state
    }

    fn next_sector(&self) -> u32 {
        self.next
    }

    fn write(&mut self, sector: &Sector) -> Result<(), StoreError> {
        let Some(open) = &self.open else { return Err(StoreError::NoCard) };
        if self.next >= self.made {
            return Err(StoreError::Full);
        }
        let written = self
            .volumes
            .file_seek_from_start(open.file, self.next * SECTOR_LEN as u32)
            .and_then(|()| self.volumes.write(open.file, sector));
        if written.is_err() {
            self.give_up();
            return Err(StoreError::Write);
        }
        self.next += 1;
        self.calls = 0;
        self.see_state();
        Ok(())
    }
}
