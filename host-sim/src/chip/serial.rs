//! The serial port of the ADS122U04, with the timing of the bytes.

use std::collections::VecDeque;

use super::device::{Device, Variant};
use super::load_cell::LoadCell;
use super::trouble::{Schedule, Trouble, noise};

/// Synchronization word before every command.
const SYNC: u8 = 0x55;

/// The chip on a serial line.
#[derive(Debug)]
pub struct SerialChip {
    device: Device,
    expects: Expects,
    out: VecDeque<(u64, u8)>,
    byte_ns: u64,
    babbled_ns: u64,
}

#[derive(Clone, Copy, Debug)]
enum Expects {
    Sync,
    Command,
    Value { register: usize },
}

impl SerialChip {
    /// A chip with `byte_ns` per byte on the line: 86 806 at 115 200 baud, or zero for a line
    /// without delay.
    #[must_use]
    pub fn new(load_cell: LoadCell, trouble: Schedule, byte_ns: u64) -> Self {
        let device = Device::new(Variant::U04, load_cell, trouble);
        Self { device, expects: Expects::Sync, out: VecDeque::new(), byte_ns, babbled_ns: 0 }
    }

    /// The chip behind the port.
    #[must_use]
    pub fn device(&self) -> &Device {
        &self.device
    }

    /// Receives a byte from the host.
    pub fn receive(&mut self, now_ns: u64, byte: u8) {
        self.expects = match self.expects {
            Expects::Sync if byte == SYNC => Expects::Command,
            Expects::Sync => Expects::Sync,
            Expects::Command => self.command(now_ns, byte),
            Expects::Value { register } => {
                self.device.write_register(now_ns, register, byte);
                Expects::Sync
            }
        };
    }

    fn command(&mut self, now_ns: u64, byte: u8) -> Expects {
        let register = usize::from(byte >> 1 & 0b111);
        match byte >> 4 {
            0b0001 => {
                let data = self.device.read_data(now_ns);
                self.answer(now_ns, &data);
            }
            0b0010 => {
                let value = self.device.read_register(now_ns, register);
                self.answer(now_ns, &value);
            }
            0b0100 => return Expects::Value { register },
            _ => self.device.command(now_ns, byte),
        }
        Expects::Sync
    }

    fn answer(&mut self, now_ns: u64, bytes: &[u8]) {
        let late_ns = match self.device.trouble(now_ns) {
            Some(Trouble::Silent) => return,
            Some(Trouble::Late { ns }) => ns,
            _ => 0,
        };
        let times = (1..).map(|n: u64| now_ns + late_ns + n * self.byte_ns);
        self.out.extend(times.zip(bytes.iter().copied()));
    }

    /// The bytes that have arrived at the host.
    pub fn transmit(&mut self, now_ns: u64) -> Vec<u8> {
        if self.device.trouble(now_ns) == Some(Trouble::Babbling) {
            self.babble(now_ns);
        }
        let arrived = self.out.partition_point(|&(time, _)| time <= now_ns);
        self.out.drain(..arrived).map(|(_, byte)| byte).collect()
    }

    /// Sends a random byte every 87 µs.
    fn babble(&mut self, now_ns: u64) {
        const BYTE_NS: u64 = 86_806;
        self.babbled_ns = self.babbled_ns.max(now_ns.saturating_sub(64 * BYTE_NS));
        while self.babbled_ns + BYTE_NS <= now_ns {
            self.babbled_ns += BYTE_NS;
            self.out.push_front((0, noise(self.babbled_ns / BYTE_NS)));
        }
    }
}
