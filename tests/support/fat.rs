//! A memory card with a FAT16 file system, whose power can be cut at any byte.

use std::cell::{Cell, RefCell};
use std::ops::Range;
use std::rc::Rc;

use embedded_sdmmc::{Block, BlockCount, BlockDevice, BlockIdx};

const SECTOR: usize = 512;
/// First sector of the partition.
pub const START: u32 = 8;
const SECTORS: u16 = 8400;
const FAT_SECTORS: u16 = 33;
const ROOT_ENTRIES: u16 = 512;

const TABLE: usize = START as usize + 1;
const ROOT: usize = TABLE + 2 * FAT_SECTORS as usize;
/// Sectors of the files' contents.
pub const FILES: Range<u32> = (ROOT as u32 + ROOT_ENTRIES as u32 / 16)..(START + SECTORS as u32);

/// A card whose first file is a picture of one sector that belongs to the user.
#[must_use]
pub fn with_picture() -> Vec<u8> {
    let mut card = formatted();
    let mut put = |at: usize, bytes: &[u8]| card[at..at + bytes.len()].copy_from_slice(bytes);
    put(ROOT * SECTOR, b"PICTURE JPG\x20");
    // First cluster and length of the picture.
    put(ROOT * SECTOR + 26, &[2, 0, 0, 2, 0, 0]);
    for table in 0..2 {
        put((TABLE + table * usize::from(FAT_SECTORS)) * SECTOR + 4, &[0xFF, 0xFF]);
    }
    put(FILES.start as usize * SECTOR, &[0xA5; SECTOR]);
    card
}

/// Directory entry and content of the picture.
#[must_use]
pub fn picture(card: &[u8]) -> [&[u8]; 2] {
    let [entry, content] = [ROOT * SECTOR, FILES.start as usize * SECTOR];
    [&card[entry..entry + 32], &card[content..content + SECTOR]]
}

/// An empty card: partition table and file system.
#[must_use]
pub fn formatted() -> Vec<u8> {
    let mut card = vec![0; SECTOR * (START as usize + usize::from(SECTORS))];
    let mut put = |sector: usize, at: usize, bytes: &[u8]| {
        let at = sector * SECTOR + at;
        card[at..at + bytes.len()].copy_from_slice(bytes);
    };
    // One partition of type 6, FAT16.
    let mut entry = [0; 16];
    entry[4] = 0x06;
    entry[8..12].copy_from_slice(&START.to_le_bytes());
    entry[12..16].copy_from_slice(&u32::from(SECTORS).to_le_bytes());
    put(0, 446, &entry);
    put(0, 510, &[0x55, 0xAA]);

    let boot = START as usize;
    put(boot, 0, &[0xEB, 0x3C, 0x90]);
    put(boot, 3, b"MSDOS5.0");
    put(boot, 11, &(SECTOR as u16).to_le_bytes());
    // A cluster is a sector; one sector before the two tables.
    put(boot, 13, &[1, 1, 0, 2]);
    put(boot, 17, &ROOT_ENTRIES.to_le_bytes());
    put(boot, 19, &SECTORS.to_le_bytes());
    put(boot, 21, &[0xF8]);
    put(boot, 22, &FAT_SECTORS.to_le_bytes());
    put(boot, 24, &[32, 0, 64, 0]);
    put(boot, 28, &START.to_le_bytes());
    put(boot, 36, &[0x80, 0, 0x29, 1, 2, 3, 4]);
    put(boot, 43, b"NO NAME    FAT16   ");
    put(boot, 510, &[0x55, 0xAA]);
    for table in 0..2 {
        let sector = TABLE + table * usize::from(FAT_SECTORS);
        put(sector, 0, &[0xF8, 0xFF, 0xFF, 0xFF]);
    }
    card
}

/// The partition alone, for `fsck.fat`.
#[must_use]
pub fn partition(card: &[u8]) -> &[u8] {
    &card[SECTOR * START as usize..]
}

/// Content of the rest of a sector after an interrupted write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rest {
    /// The previous content.
    Old,
    /// All ones: erased.
    Erased,
    /// Random bytes.
    Noise,
}

/// A card in its slot.
#[derive(Clone, Debug)]
pub struct SimCard {
    bytes: Rc<RefCell<Vec<u8>>>,
    written: Rc<Cell<u64>>,
    cut: Rc<Cell<Option<(u64, Rest)>>>,
    is_new: Rc<Cell<bool>>,
    is_unreadable: Rc<Cell<bool>>,
    fails_after: Rc<Cell<Option<u32>>>,
}

/// Error: the power is off, or the card does not answer.
#[derive(Clone, Copy, Debug)]
pub struct Dead;

impl core::fmt::Display for Dead {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("the card does not answer")
    }
}

impl core::error::Error for Dead {}

impl SimCard {
    /// A card with the given content.
    #[must_use]
    pub fn new(bytes: Vec<u8>) -> Self {
        let (written, cut) = (Rc::default(), Rc::default());
        let (is_new, is_unreadable, fails_after) = (Rc::default(), Rc::default(), Rc::default());
        let bytes = Rc::new(RefCell::new(bytes));
        Self { bytes, written, cut, is_new, is_unreadable, fails_after }
    }

    /// Exchanges the card for one with the given content, which does not answer the first access,
    /// because it has not been initialized. Returns the content of the previous card.
    pub fn exchange(&self, bytes: Vec<u8>) -> Vec<u8> {
        self.is_new.set(true);
        self.bytes.replace(bytes)
    }

    /// Sets whether the files can be read.
    pub fn set_readable(&self, is_readable: bool) {
        self.is_unreadable.set(!is_readable);
    }

    /// Lets one access fail, after `count` others that succeed.
    pub fn fail_once_after(&self, count: u32) {
        self.fails_after.set(Some(count));
    }

    fn answer(&self) -> Result<(), Dead> {
        let fails = self.fails_after.get() == Some(0);
        self.fails_after.set(self.fails_after.get().and_then(|left| left.checked_sub(1)));
        if fails {
            return Err(Dead);
        }
        if self.is_dead() || self.is_new.replace(false) { Err(Dead) } else { Ok(()) }
    }

    /// Lets the power fail after `bytes` more bytes have been written.
    pub fn cut_after(&self, bytes: u64, rest: Rest) {
        self.cut.set(Some((self.written.get() + bytes, rest)));
    }

    /// Whether the power has failed.
    #[must_use]
    pub fn is_dead(&self) -> bool {
        self.cut.get().is_some_and(|(at, _)| self.written.get() >= at)
    }

    /// Restores the power.
    pub fn revive(&self) {
        self.cut.set(None);
    }

    /// Number of bytes written since the card was created.
    #[must_use]
    pub fn written(&self) -> u64 {
        self.written.get()
    }

    /// Content of the card.
    #[must_use]
    pub fn content(&self) -> Vec<u8> {
        self.bytes.borrow().clone()
    }

    fn write_block(&self, block: &Block, at: usize) -> Result<(), Dead> {
        let mut bytes = self.bytes.borrow_mut();
        let place = bytes.get_mut(at..at + SECTOR).ok_or(Dead)?;
        let before = self.written.get();
        self.written.set(before + SECTOR as u64);
        let Some((cut, rest)) = self.cut.get().filter(|(cut, _)| *cut < before + SECTOR as u64)
        else {
            place.copy_from_slice(&block.contents);
            return Ok(());
        };
        let whole = (cut - before) as usize;
        place[..whole].copy_from_slice(&block.contents[..whole]);
        let noise = |i: usize| (cut as usize * 31 + i * 167 + i * i * 13) as u8;
        for (i, byte) in place.iter_mut().enumerate().skip(whole) {
            match rest {
                Rest::Old => {}
                Rest::Erased => *byte = 0xFF,
                Rest::Noise => *byte = noise(i),
            }
        }
        Err(Dead)
    }
}

impl BlockDevice for SimCard {
    type Error = Dead;

    fn read(&self, blocks: &mut [Block], start: BlockIdx) -> Result<(), Dead> {
        self.answer()?;
        if self.is_unreadable.get() && FILES.contains(&start.0) {
            return Err(Dead);
        }
        let bytes = self.bytes.borrow();
        for (block, index) in blocks.iter_mut().zip(start.0 as usize..) {
            let from = bytes.get(index * SECTOR..(index + 1) * SECTOR).ok_or(Dead)?;
            block.contents.copy_from_slice(from);
        }
        Ok(())
    }

    fn write(&self, blocks: &[Block], start: BlockIdx) -> Result<(), Dead> {
        for (block, index) in blocks.iter().zip(start.0 as usize..) {
            self.answer()?;
            self.write_block(block, index * SECTOR)?;
        }
        Ok(())
    }

    fn num_blocks(&self) -> Result<BlockCount, Dead> {
        self.answer()?;
        Ok(BlockCount((self.bytes.borrow().len() / SECTOR) as u32))
    }
}
