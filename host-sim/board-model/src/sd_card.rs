//! An SDHC card in SPI mode (SD Physical Layer Simplified Specification, chapter 7), as strict as
//! the specification allows.

use std::collections::VecDeque;
use std::fmt::Debug;
use std::io::{Read, Seek, SeekFrom, Write};

use crate::rules::At;
use wire::{crc7, crc16, framed};

mod wire;

#[cfg(test)]
mod tests;

/// Bytes of a block.
pub const BLOCK: usize = 512;

/// Clocks required before the first command while the card is not selected.
const WAKING_CLOCKS: u32 = 74;
/// Clock limit until the card is ready, Hz, with a margin for rounding.
const SLOW_HZ: f64 = 400_500.0;
/// Clock limit of a ready card, Hz.
const FAST_HZ: f64 = 25e6;
/// Bytes before a response.
const NCR: usize = 2;

const IDLE: u8 = 1 << 0;
const ILLEGAL: u8 = 1 << 2;
const CRC_ERROR: u8 = 1 << 3;
const ADDRESS_ERROR: u8 = 1 << 5;
const START_BLOCK: u8 = 0xFE;
const ACCEPTED: u8 = 0x05;
const DATA_CRC_ERROR: u8 = 0x0B;
/// Error token: the card's own error correction failed.
const ECC_FAILED: u8 = 0x04;

/// Storage of the blocks.
pub trait Disk: Read + Write + Seek + Debug + Send {}
impl<T: Read + Write + Seek + Debug + Send> Disk for T {}

/// Timing and faults of a card.
#[derive(Clone, Debug)]
pub struct Kind {
    /// Time from the first ACMD41 until the card is ready, ns.
    pub ready_ns: u64,
    /// Time from a command to a block of data, ns.
    pub read_ns: u64,
    /// Busy time after a block, ns.
    pub write_ns: u64,
    /// Busy time after every 64th block, ns: the card's housekeeping.
    pub tidy_ns: u64,
    /// Whether reading any block fails.
    pub unreadable: bool,
}

impl Default for Kind {
    fn default() -> Self {
        let (ready_ns, read_ns) = (100_000_000, 200_000);
        Self { ready_ns, read_ns, write_ns: 800_000, tidy_ns: 20_000_000, unreadable: false }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Power {
    /// Before the first command, after this number of clocks.
    Waking(u32),
    /// In SPI mode and idle; time of the first ACMD41, ns.
    Idle(Option<u64>),
    Ready,
}

#[derive(Debug)]
enum Input {
    Command(Vec<u8>),
    /// Waiting for the start of the block with this number.
    Token(u32),
    Block(u32, Vec<u8>),
}

/// The card.
#[derive(Debug)]
pub struct SdCard {
    kind: Kind,
    disk: Box<dyn Disk>,
    blocks: u32,
    power: Power,
    checks_crc: bool,
    application: bool,
    input: Input,
    output: VecDeque<u8>,
    /// A block being sent by the card.
    data: Option<(u64, Vec<u8>)>,
    /// A block being programmed.
    programming: Option<(u64, u32, Vec<u8>)>,
    written: u32,
}

impl SdCard {
    /// A card just inserted.
    ///
    /// # Errors
    /// The size of the disk cannot be determined.
    pub fn new(kind: Kind, mut disk: Box<dyn Disk>) -> std::io::Result<Self> {
        let blocks = (disk.seek(SeekFrom::End(0))? / BLOCK as u64) as u32;
        Ok(Self {
            kind,
            disk,
            blocks,
            power: Power::Waking(0),
            checks_crc: false,
            application: false,
            input: Input::Command(Vec::new()),
            output: VecDeque::new(),
            data: None,
            programming: None,
            written: 0,
        })
    }

    /// Removes the supply: a block being programmed is torn.
    pub fn pull(&mut self, now_ns: u64) {
        self.finish_programming(now_ns);
        if let Some((_, block, bytes)) = self.programming.take() {
            self.store(block, &bytes[..BLOCK / 2]);
        }
        self.power = Power::Waking(0);
        (self.checks_crc, self.application) = (false, false);
        self.abort();
    }

    /// Aborts the transaction after chip select has risen for any reason. The specification does
    /// not define the card's behaviour in this case.
    pub fn abort(&mut self) {
        self.output.clear();
        (self.data, self.input) = (None, Input::Command(Vec::new()));
    }

    /// Number of blocks written.
    #[must_use]
    pub fn written(&self) -> u32 {
        self.written
    }

    /// Handles a rise of chip select, which is forbidden within a transaction.
    pub fn released(&mut self, at: &mut At<'_>) {
        let command = matches!(&self.input, Input::Command(bytes) if bytes.is_empty());
        if !command || !self.output.is_empty() || self.data.is_some() {
            at.breach("SD: chip select released within a transaction");
        }
        self.abort();
    }

    /// Exchanges one byte in eight clocks.
    pub fn exchange(&mut self, byte: u8, selected: bool, clock_hz: f64, at: &mut At<'_>) -> u8 {
        let limit_hz = if self.power == Power::Ready { FAST_HZ } else { SLOW_HZ };
        if clock_hz > limit_hz {
            at.breach(format!("SD: clocked at {clock_hz:.0} Hz, {limit_hz:.0} are allowed now"));
        }
        self.finish_programming(at.now_ns);
        if !selected {
            if let Power::Waking(clocks) = &mut self.power {
                *clocks = if byte == 0xFF { *clocks + 8 } else { 0 };
            }
            return 0xFF;
        }
        if matches!(self.power, Power::Waking(clocks) if clocks < WAKING_CLOCKS) {
            return 0xFF;
        }
        let answer = self.answer(at.now_ns);
        self.take(byte, at);
        answer
    }

    fn answer(&mut self, now_ns: u64) -> u8 {
        if let Some(byte) = self.output.pop_front() {
            return byte;
        }
        if let Some((_, block)) = self.data.take_if(|(ready, _)| *ready <= now_ns) {
            self.output.extend(block);
            return self.output.pop_front().unwrap_or(0xFF);
        }
        if self.programming.is_some() { 0x00 } else { 0xFF }
    }

    fn take(&mut self, byte: u8, at: &mut At<'_>) {
        match &mut self.input {
            Input::Command(bytes) => {
                if bytes.is_empty() && byte >> 6 != 0b01 {
                    return;
                }
                if bytes.is_empty() && self.programming.is_some() {
                    at.breach("SD: a command while the card is busy");
                }
                bytes.push(byte);
                if let Ok(command) = <[u8; 6]>::try_from(&bytes[..]) {
                    bytes.clear();
                    self.obey(command, at);
                }
            }
            Input::Token(block) => match byte {
                START_BLOCK => self.input = Input::Block(*block, Vec::new()),
                0xFF => {}
                _ => at.breach(format!("SD: 0x{byte:02x} where a block should begin")),
            },
            Input::Block(block, bytes) => {
                bytes.push(byte);
                if bytes.len() == BLOCK + 2 {
                    let (block, bytes) = (*block, std::mem::take(bytes));
                    self.input = Input::Command(Vec::new());
                    self.program(block, bytes, at.now_ns);
                }
            }
        }
    }

    fn program(&mut self, block: u32, mut bytes: Vec<u8>, now_ns: u64) {
        let sum = bytes.split_off(BLOCK);
        if self.checks_crc && sum != crc16(&bytes).to_be_bytes() {
            return self.output.push_back(DATA_CRC_ERROR);
        }
        self.output.push_back(ACCEPTED);
        self.written += 1;
        let tidies = self.written.is_multiple_of(64);
        let busy_ns = if tidies { self.kind.tidy_ns } else { self.kind.write_ns };
        self.programming = Some((now_ns + busy_ns, block, bytes));
    }

    fn finish_programming(&mut self, now_ns: u64) {
        if let Some((_, block, bytes)) = self.programming.take_if(|(end, ..)| *end <= now_ns) {
            self.store(block, &bytes);
        }
    }

    fn store(&mut self, block: u32, bytes: &[u8]) {
        let place = SeekFrom::Start(u64::from(block) * BLOCK as u64);
        let done = self.disk.seek(place).and_then(|_| self.disk.write_all(bytes));
        done.expect("the card's image can be written");
    }

    fn load(&mut self, block: u32) -> Vec<u8> {
        let mut bytes = vec![0; BLOCK];
        let place = SeekFrom::Start(u64::from(block) * BLOCK as u64);
        let done = self.disk.seek(place).and_then(|_| self.disk.read_exact(&mut bytes));
        done.expect("the card's image can be read");
        bytes
    }

    fn obey(&mut self, command: [u8; 6], at: &At<'_>) {
        let [index, argument @ .., sum] = command;
        let (index, argument) = (index & 0x3F, u32::from_be_bytes(argument));
        self.output.clear();
        self.output.extend([0xFF; NCR]);
        let application = std::mem::take(&mut self.application);
        // CMD0 and CMD8 are checked always.
        let checked = self.checks_crc || index == 0 || index == 8;
        if checked && sum != crc7(&command[..5]) << 1 | 1 {
            return self.respond(CRC_ERROR);
        }
        if let Power::Waking(_) = self.power {
            if index == 0 {
                self.power = Power::Idle(None);
                self.respond(0);
            }
            return;
        }
        match (index, application) {
            (41, true) => self.get_ready(argument, at.now_ns),
            (_, true) => self.respond(ILLEGAL),
            (0, _) => {
                (self.power, self.checks_crc) = (Power::Idle(None), false);
                self.respond(0);
            }
            (8, _) => {
                self.respond(0);
                self.output.extend([0, 0, argument as u8 >> 4 & 1 | 1, argument as u8]);
            }
            (55, _) => {
                self.application = true;
                self.respond(0);
            }
            (58, _) => {
                self.respond(0);
                let ready = if self.power == Power::Ready { 0xC0 } else { 0 };
                self.output.extend([ready, 0xFF, 0x80, 0]);
            }
            (59, _) => {
                self.checks_crc = argument & 1 != 0;
                self.respond(0);
            }
            _ if self.power != Power::Ready => self.respond(ILLEGAL),
            (9, _) => {
                self.respond(0);
                self.data = Some((at.now_ns + self.kind.read_ns, framed(&self.csd())));
            }
            (13, _) => {
                self.respond(0);
                self.output.push_back(0);
            }
            (16, _) => self.respond(0),
            (17 | 24, _) if argument >= self.blocks => self.respond(ADDRESS_ERROR),
            (17, _) => {
                self.respond(0);
                let bytes = self.load(argument);
                let sent = if self.kind.unreadable { vec![ECC_FAILED] } else { framed(&bytes) };
                self.data = Some((at.now_ns + self.kind.read_ns, sent));
            }
            (24, _) => {
                self.respond(0);
                self.input = Input::Token(argument);
            }
            _ => self.respond(ILLEGAL),
        }
    }

    fn respond(&mut self, flags: u8) {
        let idle = if self.power == Power::Ready { 0 } else { IDLE };
        self.output.push_back(flags | idle);
    }

    /// Handles ACMD41; a host without support for high capacity never gets the card ready.
    fn get_ready(&mut self, argument: u32, now_ns: u64) {
        if let Power::Idle(since) = &mut self.power {
            let since_ns = *since.get_or_insert(now_ns);
            if argument & 1 << 30 != 0 && now_ns >= since_ns + self.kind.ready_ns {
                self.power = Power::Ready;
            }
        }
        self.respond(0);
    }

    /// CSD register version 2, with the size in units of 512 KiB.
    fn csd(&self) -> [u8; 16] {
        let [_, high, middle, low] = (self.blocks / 1024).saturating_sub(1).to_be_bytes();
        let mut csd = [0x40, 0x0E, 0, 0x32, 0x5B, 0x59, 0, 0, 0, 0, 0x7F, 0x80, 0x0A, 0x40, 0, 0];
        (csd[7], csd[8], csd[9]) = (high & 0x3F, middle, low);
        csd[15] = crc7(&csd[..15]) << 1 | 1;
        csd
    }
}
