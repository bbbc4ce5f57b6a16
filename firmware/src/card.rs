//! The log file on an SD card with a FAT file system.
//!
//! The file is made once, full of zeros, and then only written in place, one
//! 512-byte block per sector: no metadata changes while logging, so that pulling
//! the battery can cost a sector but never the file system.

use embedded_sdmmc::{BlockDevice, Mode, RawDirectory, RawFile, RawVolume, TimeSource, Timestamp};
use embedded_sdmmc::{VolumeIdx, VolumeManager};

use crate::record::{Record, SECTOR_LEN, Sector};
use crate::store::{Store, StoreError};

/// Name of the file.
const FILE: &str = "FLOE.LOG";

/// A file that has been written for longer than this many unsuccessful tries is
/// opened again.
const TRIES: u32 = 8;

/// The card.
#[expect(missing_debug_implementations, reason = "the volume manager has none")]
pub struct CardLog<D: BlockDevice> {
    volumes: VolumeManager<D, NoClock>,
    open: Option<Open>,
    sectors: u32,
    next: u32,
    failed: u32,
}

struct Open {
    volume: RawVolume,
    root: RawDirectory,
    file: RawFile,
}

/// The board has no calendar: files carry the first date that FAT knows.
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

type Error<D> = embedded_sdmmc::Error<<D as BlockDevice>::Error>;

impl<D: BlockDevice> CardLog<D> {
    /// A log of so many sectors (a half second each). The card is looked for when
    /// its last record is asked for, and again when something is to be written.
    #[inline]
    pub fn new(device: D, sectors: u32) -> Self {
        let volumes = VolumeManager::new(device, NoClock);
        Self { volumes, open: None, sectors, next: 0, failed: 0 }
    }

    fn ensure_open(&mut self) -> bool {
        if self.open.is_none() {
            self.open = self.try_open().ok();
            if self.open.is_some() {
                self.next = self.find_end();
            }
        }
        self.open.is_some()
    }

    fn try_open(&mut self) -> Result<Open, Error<D>> {
        let volume = self.volumes.open_raw_volume(VolumeIdx(0))?;
        let root = self.volumes.open_root_dir(volume).inspect_err(|_| {
            let _ = self.volumes.close_volume(volume);
        })?;
        match self.open_file(root) {
            Ok(file) => Ok(Open { volume, root, file }),
            Err(error) => {
                let _ = self.volumes.close_dir(root);
                let _ = self.volumes.close_volume(volume);
                Err(error)
            }
        }
    }

    fn open_file(&mut self, root: RawDirectory) -> Result<RawFile, Error<D>> {
        match self.volumes.open_file_in_dir(root, FILE, Mode::ReadWriteAppend) {
            Err(embedded_sdmmc::Error::NotFound) => self.make_file(root)?,
            Ok(file) if self.volumes.file_length(file)? == self.length() => return Ok(file),
            // Making the file was cut short: make the rest.
            Ok(file) => self.fill(file)?,
            Err(error) => return Err(error),
        }
        self.volumes.open_file_in_dir(root, FILE, Mode::ReadWriteAppend)
    }

    fn make_file(&mut self, root: RawDirectory) -> Result<(), Error<D>> {
        let file = self.volumes.open_file_in_dir(root, FILE, Mode::ReadWriteCreate)?;
        self.fill(file)
    }

    fn fill(&mut self, file: RawFile) -> Result<(), Error<D>> {
        let there = self.volumes.file_length(file)?;
        self.volumes.file_seek_from_start(file, there)?;
        let mut result = Ok(());
        for _ in there / SECTOR_LEN as u32..self.sectors {
            result = result.and_then(|()| self.volumes.write(file, &[0; SECTOR_LEN]));
        }
        result.and(self.volumes.close_file(file))
    }

    fn length(&self) -> u32 {
        self.sectors * SECTOR_LEN as u32
    }

    /// First sector that was never written. Sectors are written in order, so
    /// halving finds it; a damaged one in the middle still counts as written.
    fn find_end(&mut self) -> u32 {
        let (mut low, mut high) = (0, self.sectors);
        while low < high {
            let middle = low + (high - low) / 2;
            let used = [middle, middle + 1].iter().any(|&sector| self.is_used(sector));
            if used { low = middle + 1 } else { high = middle }
        }
        low
    }

    fn is_used(&mut self, sector: u32) -> bool {
        self.read(sector).is_some_and(|bytes| bytes.iter().any(|&byte| byte != 0))
    }

    fn read(&mut self, sector: u32) -> Option<Sector> {
        let file = self.open.as_ref()?.file;
        let mut bytes = [0; SECTOR_LEN];
        self.volumes.file_seek_from_start(file, sector.checked_mul(SECTOR_LEN as u32)?).ok()?;
        let read = self.volumes.read(file, &mut bytes).ok()?;
        (read == SECTOR_LEN).then_some(bytes)
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
        near.find_map(|sector| Record::decode(&self.read(sector)?).ok())
    }

    fn next_sector(&self) -> u32 {
        self.next
    }

    fn write(&mut self, sector: &Sector) -> Result<(), StoreError> {
        // A card that is gone is looked for now and then, not at every sector.
        if self.open.is_none() {
            self.failed += 1;
            if !self.failed.is_multiple_of(TRIES) || !self.ensure_open() {
                return Err(StoreError::NoCard);
            }
        }
        let Some(open) = &self.open else { return Err(StoreError::NoCard) };
        if self.next >= self.sectors {
            return Err(StoreError::Full);
        }
        let written = self
            .volumes
            .file_seek_from_start(open.file, self.next * SECTOR_LEN as u32)
            .and_then(|()| self.volumes.write(open.file, sector));
        if written.is_err() {
            self.close();
            return Err(StoreError::Write);
        }
        self.next += 1;
        Ok(())
    }
}
