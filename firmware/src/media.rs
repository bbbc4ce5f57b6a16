//! Recognizes the format of a card: a FAT file system, with or without a partition table, or
//! another format that is reported by name.

use core::cell::Cell;
use core::fmt;

use embedded_sdmmc::{Block, BlockCount, BlockDevice, BlockIdx};

use crate::store::CardState;

const SIGNATURE_AT: usize = 510;
const PARTITION_AT: usize = 446;
/// Fewest clusters of FAT16; with fewer the file system is FAT12.
const FEWEST_CLUSTERS: u32 = 4085;

/// Signature in the FAT32 sector with the number of free clusters, and the position of that number.
const COUNT_MARK: u32 = 0x6141_7272;
const COUNT_MARK_AT: usize = 484;
const COUNT_AT: usize = 488;

/// Error: the card failed, or writing is blocked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Failed;

impl fmt::Display for Failed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("the card failed")
    }
}

impl core::error::Error for Failed {}

/// A card with FAT. If it has no partition table, one is simulated.
#[derive(Debug)]
pub struct Media<D> {
    device: D,
    /// Blocks of a file system that begins at block 0, or 0 if there is a partition table.
    whole: Cell<u32>,
    /// Block behind the file system. The driver takes the unused end of the table of a full FAT16
    /// for free clusters.
    end: Cell<u32>,
    /// Free blocks as recorded by the file system, if it records them.
    free: Cell<Option<u32>>,
    /// Whether writing is blocked: after a failure the file system may know nothing, or only half, of
    /// what it would overwrite. For example it takes a directory that it cannot read for one without
    /// the file, and would make a second one.
    is_shut: Cell<bool>,
}

impl<D: BlockDevice> Media<D> {
    /// A card that has not been examined yet.
    pub const fn new(device: D) -> Self {
        let (whole, end) = (Cell::new(0), Cell::new(0));
        Self { device, whole, end, free: Cell::new(None), is_shut: Cell::new(false) }
    }

    /// Blocks writing until the card is examined, because it may be a different card; or permits
    /// writing after a failed read that does not matter.
    pub fn shut(&self, is_shut: bool) {
        self.is_shut.set(is_shut);
    }

    /// Whether writing is blocked.
    pub fn is_shut(&self) -> bool {
        self.is_shut.get()
    }

    /// Blocks writing after a failure.
    fn check<E>(&self, done: Result<(), E>) -> Result<(), Failed> {
        done.map_err(|_| {
            self.shut(true);
            Failed
        })
    }

    /// Free blocks as recorded by the file system; `None` if it does not record them.
    pub fn free_blocks(&self) -> Option<u32> {
        self.free.get()
    }

    /// Examines the card, which may have been exchanged, and permits writing again.
    ///
    /// # Errors
    /// Why the card cannot hold a log.
    pub fn look(&self) -> Result<(), CardState> {
        self.whole.set(0);
        self.is_shut.set(false);
        let blocks = self.device.num_blocks().map_err(|_| CardState::NoCard)?;
        let first = self.block(0)?;
        if is_file_system(&first) {
            self.judge(&first, 0)?;
            self.whole.set(blocks.0);
            return Ok(());
        }
        match first.get(PARTITION_AT..SIGNATURE_AT) {
            Some([0 | 0x80, _, _, _, kind, _, _, _, a, b, c, d, ..])
                if is_signed(&first) && *kind != 0 =>
            {
                let start = u32::from_le_bytes([*a, *b, *c, *d]);
                self.judge(&self.block(start)?, start)
            }
            _ => Err(CardState::NotFat),
        }
    }

    /// Checks that a file system is FAT16 or FAT32, and reads the number of its free blocks.
    fn judge(&self, first: &[u8; 512], start: u32) -> Result<(), CardState> {
        self.end.set(start.saturating_add(judge(first)?));
        self.free.set(self.count_free(first, start));
        Ok(())
    }

    fn count_free(&self, first: &[u8; 512], start: u32) -> Option<u32> {
        // FAT16 (its table's length is a 16-bit field) has no number of free clusters.
        let is_fat32 = word(first, 22) == 0;
        let place = Some(start.wrapping_add(word(first, 48))).filter(|_| is_fat32)?;
        let clusters = free_clusters(&self.block(place).ok()?)?;
        Some(clusters.saturating_mul(first[13].into()))
    }

    fn block(&self, number: u32) -> Result<[u8; 512], CardState> {
        let mut blocks = [Block::new()];
        let read = self.device.read(&mut blocks, BlockIdx(number));
        let [Block { contents }] = blocks;
        read.map(|()| contents).map_err(|_| CardState::Unreadable)
    }
}

fn is_signed(block: &[u8; 512]) -> bool {
    block[SIGNATURE_AT..] == [0x55, 0xAA]
}

/// Whether a block begins with a file system's jump instruction and contains its name.
fn is_file_system(block: &[u8; 512]) -> bool {
    let jumps = matches!(block[..3], [0xEB, _, 0x90] | [0xE9, ..]);
    let named = is_exfat(block) || [54, 82].iter().any(|&at| block[at..].starts_with(b"FAT"));
    is_signed(block) && jumps && named
}

fn is_exfat(block: &[u8; 512]) -> bool {
    block[3..].starts_with(b"EXFAT   ")
}

/// Checks that the first block of a file system is one of FAT16 or FAT32; returns the number of its
/// blocks.
fn judge(block: &[u8; 512]) -> Result<u32, CardState> {
    if is_exfat(block) {
        return Err(CardState::ExFat);
    }
    let (word, long) = (|at| word(block, at), |at| long(block, at));
    let either = |short: u32, long: u32| if short == 0 { long } else { short };
    let (per_cluster, tables) = (u32::from(block[13]), u32::from(block[16]));
    // NTFS has no tables.
    if word(11) != 512 || per_cluster == 0 || tables == 0 || !is_signed(block) {
        return Err(CardState::NotFat);
    }
    // All blocks before the clusters: reserved ones, tables, and the root directory of FAT16.
    let tables = tables.saturating_mul(either(word(22), long(36)));
    let before = word(14).saturating_add(tables).saturating_add(word(17) / 16);
    let all = either(word(19), long(32));
    let clusters = all.saturating_sub(before) / per_cluster;
    if clusters < FEWEST_CLUSTERS { Err(CardState::Fat12) } else { Ok(all) }
}

/// Free clusters from the FAT32 sector with their number; `None` if invalid or unknown.
fn free_clusters(block: &[u8; 512]) -> Option<u32> {
    const UNKNOWN: u32 = u32::MAX;
    let is_count = long(block, COUNT_MARK_AT) == COUNT_MARK;
    Some(long(block, COUNT_AT)).filter(|&count| is_count && count != UNKNOWN)
}

#[inline(always)]
fn word(block: &[u8; 512], at: usize) -> u32 {
    u32::from(u16::from_le_bytes([block[at], block[at + 1]]))
}

#[inline(always)]
fn long(block: &[u8; 512], at: usize) -> u32 {
    word(block, at) | word(block, at + 2) << 16
}

/// A partition table with one partition, which begins at block 1.
fn table(blocks: u32) -> Block {
    let mut block = Block::new();
    // Type FAT32 with logical blocks; the first block of the file system gives its actual type.
    block.contents[PARTITION_AT + 4] = 0x0C;
    block.contents[PARTITION_AT + 8] = 1;
    block.contents[PARTITION_AT + 12..PARTITION_AT + 16].copy_from_slice(&blocks.to_le_bytes());
    block.contents[SIGNATURE_AT..].copy_from_slice(&[0x55, 0xAA]);
    block
}

impl<D: BlockDevice> BlockDevice for Media<D> {
    type Error = Failed;

    fn read(&self, blocks: &mut [Block], start: BlockIdx) -> Result<(), Failed> {
        self.check(match (self.whole.get(), start.0.checked_sub(1)) {
            (0, _) => self.device.read(blocks, start),
            (_, Some(before)) => self.device.read(blocks, BlockIdx(before)),
            (whole, None) => match blocks.split_first_mut() {
                Some((first, [])) => {
                    *first = table(whole);
                    Ok(())
                }
                Some((first, rest)) => {
                    *first = table(whole);
                    self.device.read(rest, BlockIdx(0))
                }
                None => Ok(()),
            },
        })
    }

    fn write(&self, blocks: &[Block], start: BlockIdx) -> Result<(), Failed> {
        let simulated = u32::from(self.whole.get() != 0);
        // The simulated table is never written.
        let Some(place) = start.0.checked_sub(simulated) else { return Ok(()) };
        if self.is_shut() || place >= self.end.get() {
            return Err(Failed);
        }
        self.check(self.device.write(blocks, BlockIdx(place)))
    }

    fn num_blocks(&self) -> Result<BlockCount, Failed> {
        let more = u32::from(self.whole.get() != 0);
        let count = self.device.num_blocks().map_err(|_| Failed)?;
        Ok(BlockCount(count.0.saturating_add(more)))
    }
}

#[cfg(test)]
mod tests;
