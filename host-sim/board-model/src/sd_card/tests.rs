//! Tests of the card against its specification.

use super::*;
use crate::rules::Rules;
use crate::rules::tests::RUNNING;
use std::io::Cursor;

struct Host {
    card: SdCard,
    rules: Rules,
    now_ns: u64,
    clock_hz: f64,
}

impl Host {
    fn new() -> Self {
        let disk = Cursor::new(vec![0; 2048 * BLOCK]);
        let card = SdCard::new(Kind::default(), Box::new(disk)).unwrap();
        Self { card, rules: Rules::default(), now_ns: 0, clock_hz: 4e5 }
    }

    fn byte(&mut self, byte: u8, selected: bool) -> u8 {
        self.now_ns += 20_000;
        let (now_ns, clock_hz) = (self.now_ns, self.clock_hz);
        let mut at = At { now_ns, clocks: RUNNING, rules: &mut self.rules };
        self.card.exchange(byte, selected, clock_hz, &mut at)
    }

    fn send(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.byte(byte, true);
        }
    }

    fn wake(&mut self, bytes: u32) {
        for _ in 0..bytes {
            self.byte(0xFF, false);
        }
    }

    /// The response to a command; `None`: no response.
    fn command(&mut self, index: u8, argument: u32) -> Option<u8> {
        let mut bytes = vec![0x40 | index];
        bytes.extend(argument.to_be_bytes());
        bytes.push(crc7(&bytes) << 1 | 1);
        self.send(&bytes);
        (0..8).map(|_| self.byte(0xFF, true)).find(|byte| byte & 0x80 == 0)
    }

    fn take(&mut self, count: usize) -> Vec<u8> {
        (0..count).map(|_| self.byte(0xFF, true)).collect()
    }

    fn ready() -> Self {
        let mut host = Self::new();
        host.wake(10);
        assert_eq!(host.command(0, 0), Some(IDLE));
        assert_eq!(host.command(59, 1), Some(IDLE));
        assert_eq!(host.command(8, 0x1AA), Some(IDLE));
        assert_eq!(host.take(4), [0, 0, 1, 0xAA]);
        let mut tries = 0;
        while host.command(55, 0) == Some(IDLE) && host.command(41, 1 << 30) != Some(0) {
            tries += 1;
        }
        assert!(tries > 50, "it takes a tenth of a second");
        assert_eq!(host.command(58, 0), Some(0));
        assert_eq!(host.take(4), [0xC0, 0xFF, 0x80, 0]);
        host.clock_hz = 8e6;
        host
    }

    fn write(&mut self, block: u32, bytes: &[u8; BLOCK], sum: u16) -> u8 {
        assert_eq!(self.command(24, block), Some(0));
        self.byte(START_BLOCK, true);
        self.send(bytes);
        self.send(&sum.to_be_bytes());
        self.byte(0xFF, true)
    }

    fn read(&mut self, block: u32) -> Vec<u8> {
        assert_eq!(self.command(17, block), Some(0));
        while self.byte(0xFF, true) != START_BLOCK {}
        let bytes = self.take(BLOCK);
        assert_eq!(self.take(2), crc16(&bytes).to_be_bytes());
        bytes
    }
}

/// The specification's own examples.
#[test]
fn checksums() {
    assert_eq!(crc7(&[0x40, 0, 0, 0, 0]), 0b100_1010);
    assert_eq!(crc7(&[0x51, 0, 0, 0, 0]), 0b010_1010);
    assert_eq!(crc16(&[0xFF; BLOCK]), 0x7FA1);
}

#[test]
fn it_sleeps_until_74_clocks_without_select() {
    let mut host = Host::new();
    assert_eq!(host.command(0, 0), None);
    host.wake(9);
    assert_eq!(host.command(0, 0), None);
    host.byte(0xFF, false);
    assert_eq!(host.command(0, 0), Some(IDLE));
    assert!(host.rules.said().is_empty());
}

#[test]
fn blocks_are_written_with_a_pause_and_read() {
    let mut host = Host::ready();
    let bytes = [0x5A; BLOCK];
    assert_eq!(host.write(7, &bytes, crc16(&bytes)), ACCEPTED);
    assert_eq!(host.byte(0xFF, true), 0, "busy");
    host.now_ns += 1_000_000;
    assert_eq!(host.byte(0xFF, true), 0xFF);
    assert_eq!(host.read(7), bytes);
    assert_eq!(host.write(7, &[1; BLOCK], 0), DATA_CRC_ERROR);
    assert_eq!(host.read(7), bytes);
    assert_eq!(host.command(17, 2048), Some(ADDRESS_ERROR));
    assert_eq!(host.command(9, 0), Some(0));
    while host.byte(0xFF, true) != START_BLOCK {}
    assert_eq!(host.take(10)[7..], [0, 0, 1], "1 MiB");
    host.take(8);
    assert_eq!(host.rules.said(), [""; 0]);
}

#[test]
fn a_block_is_torn_when_the_card_is_pulled() {
    let mut host = Host::ready();
    host.write(7, &[0x5A; BLOCK], crc16(&[0x5A; BLOCK]));
    host.card.pull(host.now_ns);
    assert_eq!(host.card.load(7), [[0x5A; 256], [0; 256]].concat());
    assert_eq!(host.command(17, 7), None, "it has to be woken again");
    assert!(host.rules.said()[0].contains("8000000 Hz"));
}

#[test]
fn what_the_specification_forbids() {
    let mut host = Host::ready();
    host.write(7, &[1; BLOCK], crc16(&[1; BLOCK]));
    host.command(13, 0);
    host.command(24, 9);
    host.byte(0x00, true);
    let mut at = At { now_ns: host.now_ns, clocks: RUNNING, rules: &mut host.rules };
    host.card.released(&mut at);
    let said = host.rules.said().join(";");
    for word in ["busy", "should begin", "within a transaction"] {
        assert!(said.contains(word), "{word}: {said}");
    }
}
