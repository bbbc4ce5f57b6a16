//! What is on a card: a FAT file system with or without a partition table, or something
//! else, named as what it is.

use core::cell::Cell;

use embedded_sdmmc::{Block, BlockCount, BlockDevice, BlockIdx};

use crate::store::CardState;

const SIGNATURE_AT: usize = 510;
const PARTITION_AT: usize = 446;
/// FAT12 ends where FAT16 begins.
const FEWEST_CLUSTERS: u32 = 4085;

/// A card; one without a partition table looks as if it had one.
#[derive(Debug)]
pub struct Media<D> {
    device: D,
    /// Blocks of the file system that begins at block 0, or 0.
    whole: Cell<u32>,
}

impl<D: BlockDevice> Media<D> {
    /// Nothing is known of the card yet.
    pub const fn new(device: D) -> Self {
        Self { device, whole: Cell::new(0) }
    }

    /// Looks at the card, in case it is another one now.
    ///
    /// # Errors
    /// Why no log can be kept on it.
    pub fn look(&self) -> Result<(), CardState> {
        self.whole.set(0);
        let blocks = self.device.num_blocks().map_err(|_| CardState::NoCard)?;
        let first = self.block(0)?;
        if is_file_system(&first) {
            judge(&first)?;
            self.whole.set(blocks.0);
            return Ok(());
        }
        match first.get(PARTITION_AT..SIGNATURE_AT) {
            Some([0 | 0x80, _, _, _, kind, _, _, _, a, b, c, d, ..])
                if is_signed(&first) && *kind != 0 =>
            {
                judge(&self.block(u32::from_le_bytes([*a, *b, *c, *d]))?)
            }
            _ => Err(CardState::NotFat),
        }
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

/// The jump at the beginning of a file system's first block, and its name.
fn is_file_system(block: &[u8; 512]) -> bool {
    let jumps = matches!(block[..3], [0xEB, _, 0x90] | [0xE9, ..]);
    let named = is_exfat(block) || [54, 82].iter().any(|&at| block[at..].starts_with(b"FAT"));
    is_signed(block) && jumps && named
}

fn is_exfat(block: &[u8; 512]) -> bool {
    block[3..].starts_with(b"EXFAT   ")
}

/// Whether a file system's first block is one of FAT16 or FAT32.
fn judge(block: &[u8; 512]) -> Result<(), CardState> {
    if is_exfat(block) {
        return Err(CardState::ExFat);
    }
    let word = |at: usize| u32::from(u16::from_le_bytes([block[at], block[at + 1]]));
    let long = |at: usize| word(at) | word(at + 2) << 16;
    let either = |short: u32, long: u32| if short == 0 { long } else { short };
    let per_cluster = u32::from(block[13]);
    if word(11) != 512 || per_cluster == 0 || !is_signed(block) {
        return Err(CardState::NotFat);
    }
    // Reserved, the tables, the root directory of FAT16; the rest is clusters.
    let tables = u32::from(block[16]).saturating_mul(either(word(22), long(36)));
    let before = word(14).saturating_add(tables).saturating_add(word(17) / 16);
    let clusters = either(word(19), long(32)).saturating_sub(before) / per_cluster;
    if clusters < FEWEST_CLUSTERS { Err(CardState::Fat12) } else { Ok(()) }
}

/// A table with one partition, which begins behind it.
fn table(blocks: u32) -> Block {
    let mut block = Block::new();
    // FAT32 by logical block; what it really is the file system's first block says.
    block.contents[PARTITION_AT + 4] = 0x0C;
    block.contents[PARTITION_AT + 8] = 1;
    block.contents[PARTITION_AT + 12..PARTITION_AT + 16].copy_from_slice(&blocks.to_le_bytes());
    block.contents[SIGNATURE_AT..].copy_from_slice(&[0x55, 0xAA]);
    block
}

impl<D: BlockDevice> BlockDevice for Media<D> {
    type Error = D::Error;

    fn read(&self, blocks: &mut [Block], start: BlockIdx) -> Result<(), D::Error> {
        match (self.whole.get(), start.0.checked_sub(1)) {
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
        }
    }

    fn write(&self, blocks: &[Block], start: BlockIdx) -> Result<(), D::Error> {
        match (self.whole.get(), start.0.checked_sub(1)) {
            (0, _) => self.device.write(blocks, start),
            (_, Some(before)) => self.device.write(blocks, BlockIdx(before)),
            // Nobody writes the table.
            (_, None) => Ok(()),
        }
    }

    fn num_blocks(&self) -> Result<BlockCount, D::Error> {
        let more = u32::from(self.whole.get() != 0);
        self.device.num_blocks().map(|count| BlockCount(count.0.saturating_add(more)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::cell::RefCell;

    #[derive(Debug)]
    struct Disk(RefCell<Vec<[u8; 512]>>);

    impl BlockDevice for Disk {
        type Error = core::fmt::Error;

        fn read(&self, blocks: &mut [Block], start: BlockIdx) -> Result<(), core::fmt::Error> {
            for (number, block) in (start.0 as usize..).zip(blocks) {
                block.contents = *self.0.borrow().get(number).ok_or(core::fmt::Error)?;
            }
            Ok(())
        }

        fn write(&self, blocks: &[Block], start: BlockIdx) -> Result<(), core::fmt::Error> {
            for (number, block) in (start.0 as usize..).zip(blocks) {
                *self.0.borrow_mut().get_mut(number).ok_or(core::fmt::Error)? = block.contents;
            }
            Ok(())
        }

        fn num_blocks(&self) -> Result<BlockCount, core::fmt::Error> {
            let count = self.0.borrow().len() as u32;
            if count == 0 { Err(core::fmt::Error) } else { Ok(BlockCount(count)) }
        }
    }

    /// First block of a FAT file system: blocks, blocks of a table, of a cluster.
    fn fat(blocks: u32, table: u16, cluster: u8) -> [u8; 512] {
        let mut block = [0; 512];
        block[..3].copy_from_slice(&[0xEB, 0x3C, 0x90]);
        block[11..14].copy_from_slice(&[0, 2, cluster]);
        block[14..18].copy_from_slice(&[1, 0, 2, 0]);
        block[22..24].copy_from_slice(&table.to_le_bytes());
        block[32..36].copy_from_slice(&blocks.to_le_bytes());
        block[54..62].copy_from_slice(b"FAT16   ");
        block[510..].copy_from_slice(&[0x55, 0xAA]);
        block
    }

    fn look(first: [u8; 512], second: [u8; 512]) -> Result<(), CardState> {
        Media::new(Disk(RefCell::new(vec![first, second]))).look()
    }

    fn exfat() -> [u8; 512] {
        let mut block = [0; 512];
        block[..11].copy_from_slice(b"\xEB\x76\x90EXFAT   ");
        block[510..].copy_from_slice(&[0x55, 0xAA]);
        block
    }

    #[test]
    fn what_is_on_a_card_has_a_name() {
        let none = Media::new(Disk(RefCell::new(vec![])));
        assert_eq!(none.look(), Err(CardState::NoCard));
        assert_eq!(look([0; 512], [0; 512]), Err(CardState::NotFat));
        assert_eq!(look([0xFF; 512], [0; 512]), Err(CardState::NotFat));
        assert_eq!(look(exfat(), [0; 512]), Err(CardState::ExFat));
        assert_eq!(look(table(1).contents, exfat()), Err(CardState::ExFat));
        assert_eq!(look(fat(4000, 12, 1), [0; 512]), Err(CardState::Fat12));
        assert_eq!(look(table(1).contents, fat(9000, 40, 1)), Ok(()));
        assert_eq!(look(fat(9000, 40, 1), [0; 512]), Ok(()));
        let mut far = table(1).contents;
        far[PARTITION_AT + 9] = 1;
        assert_eq!(look(far, [0; 512]), Err(CardState::Unreadable));
    }

    #[test]
    fn a_file_system_without_a_table_gets_one() {
        let media = Media::new(Disk(RefCell::new(vec![fat(9000, 40, 1), [7; 512]])));
        media.look().unwrap();
        let mut blocks = [Block::new(), Block::new(), Block::new()];
        media.read(&mut blocks, BlockIdx(0)).unwrap();
        assert_eq!(blocks[0].contents, table(2).contents);
        assert_eq!((blocks[1].contents, blocks[2].contents), (fat(9000, 40, 1), [7; 512]));
        media.write(&blocks[..1], BlockIdx(2)).unwrap();
        assert_eq!(media.device.0.borrow()[1], table(2).contents);
        assert_eq!(media.num_blocks().unwrap().0, 3);
    }
}
