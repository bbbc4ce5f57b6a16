//! Tests of the card's states on a card in memory.

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

/// First block of a FAT file system; arguments: blocks in total, per table, and per cluster.
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

/// First two blocks of a FAT32 file system with clusters of four blocks, of which `free` are
/// free.
fn counted(free: u32) -> [[u8; 512]; 2] {
    let (mut first, mut count) = (fat(90_000, 0, 4), [0; 512]);
    first[36..40].copy_from_slice(&200_u32.to_le_bytes());
    first[48] = 1;
    count[..4].copy_from_slice(b"RRaA");
    count[484..488].copy_from_slice(b"rrAa");
    count[488..492].copy_from_slice(&free.to_le_bytes());
    count[510..].copy_from_slice(&[0x55, 0xAA]);
    [first, count]
}

#[test]
fn what_is_free_is_the_file_systems_own_count() {
    let free = |[first, second]: [[u8; 512]; 2]| {
        let media = Media::new(Disk(RefCell::new(vec![first, second])));
        assert_eq!(media.look(), Ok(()));
        media.free_blocks()
    };
    assert_eq!(free(counted(0)), Some(0));
    assert_eq!(free(counted(1000)), Some(4000));
    assert_eq!(free(counted(u32::MAX)), None, "not known");
    assert_eq!(free([counted(7)[0], [0; 512]]), None, "another sector");
    assert_eq!(free([fat(9000, 40, 1), counted(7)[1]]), None, "FAT16");
}

#[test]
fn what_is_written_to_a_shut_card_goes_nowhere() {
    let media = Media::new(Disk(RefCell::new(vec![fat(9000, 40, 1), [7; 512]])));
    media.look().unwrap();
    let before = media.device.0.borrow().clone();
    let block = [Block::new()];
    media.shut(true);
    assert_eq!(media.write(&block, BlockIdx(2)), Err(Failed));
    assert_eq!(*media.device.0.borrow(), before);
    media.look().unwrap();
    media.write(&block, BlockIdx(2)).unwrap();
    assert_eq!(media.device.0.borrow()[1], [0; 512]);
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

/// The first block of NTFS has no tables and a length of zero where FAT has its own.
fn ntfs() -> [u8; 512] {
    let mut block = [0; 512];
    block[..14].copy_from_slice(b"\xEB\x52\x90NTFS    \x00\x02\x08");
    block[21] = 0xF8;
    block[36..40].copy_from_slice(&[0x80, 0, 0x80, 0]);
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
    assert_eq!(look(table(1).contents, ntfs()), Err(CardState::NotFat));
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
