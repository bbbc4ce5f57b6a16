//! The chips on the I2C bus: converter and display.

use floe::chip::{Device, Trouble};

use crate::i2c::Target;
use crate::ssd1306::Ssd1306;

const CONVERTER: u8 = 0x40;
const DISPLAY: u8 = 0x3C;

/// A fault that holds the data line low for a time or for a number of clocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hold {
    /// Until this time, ns.
    Until(u64),
    /// Until a chip interrupted during a transfer has received this number of clocks.
    Clocks(u32),
}

/// Both chips and the state of the wires.
#[derive(Debug)]
pub struct Wires {
    /// The converter.
    pub converter: Device,
    /// The display.
    pub display: Ssd1306,
    /// Whether a display is connected.
    pub has_display: bool,
    /// The fault that holds the data line low.
    pub hold: Option<Hold>,
    /// Address of the current transfer.
    address: u8,
    sent: Vec<u8>,
    answer: Vec<u8>,
    last_ns: u64,
}

impl Wires {
    /// An idle bus.
    #[must_use]
    pub fn new(converter: Device, has_display: bool) -> Self {
        Self {
            converter,
            display: Ssd1306::default(),
            has_display,
            hold: None,
            address: 0,
            sent: Vec::new(),
            answer: Vec::new(),
            last_ns: 0,
        }
    }

    /// Whether the data line is held low.
    #[must_use]
    pub fn is_held(&mut self, now_ns: u64) -> bool {
        if matches!(self.hold, Some(Hold::Until(end)) if end <= now_ns) {
            self.hold = None;
        }
        self.hold.is_some()
    }

    /// Handles a clock that the program makes with its pins.
    pub fn clock(&mut self) {
        match &mut self.hold {
            Some(Hold::Clocks(0 | 1)) => self.hold = None,
            Some(Hold::Clocks(left)) => *left -= 1,
            _ => {}
        }
    }

    /// Passes the bytes sent so far to the converter, as one command.
    fn flush(&mut self, now_ns: u64) {
        // The converter's time never goes back.
        self.last_ns = self.last_ns.max(now_ns);
        if self.address == CONVERTER && !self.sent.is_empty() {
            self.answer = self.converter.i2c_write(self.last_ns, &self.sent);
        }
        self.sent.clear();
    }
}

impl Target for Wires {
    fn start(&mut self, now_ns: u64, address: u8, read: bool) -> bool {
        self.flush(now_ns);
        self.address = address;
        if !read && address == CONVERTER {
            self.answer.clear();
        }
        match address {
            CONVERTER => self.converter.trouble(now_ns) != Some(Trouble::Silent),
            DISPLAY if self.has_display => {
                self.display.start();
                true
            }
            _ => false,
        }
    }

    fn write(&mut self, _: u64, byte: u8) -> bool {
        match self.address {
            DISPLAY => self.display.write(byte),
            _ => self.sent.push(byte),
        }
        true
    }

    fn read(&mut self, _: u64) -> u8 {
        // A chip without more data leaves the line high.
        if self.answer.is_empty() { 0xFF } else { self.answer.remove(0) }
    }

    fn stop(&mut self, now_ns: u64) {
        self.flush(now_ns);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floe::chip::{LoadCell, Schedule, Variant};

    fn wires(trouble: Schedule) -> Wires {
        let cell = LoadCell::from_codes(&[0x12_3456], 16.0);
        Wires::new(Device::new(Variant::C04, cell, trouble), false)
    }

    #[test]
    fn the_converters_registers_answer() {
        let mut wires = wires(Schedule::default());
        assert!(wires.start(0, CONVERTER, false));
        assert!(wires.write(0, 0x44) && wires.write(0, 0xA2));
        wires.stop(10);
        assert!(wires.start(20, CONVERTER, false) && wires.write(20, 0x24));
        assert!(wires.start(30, CONVERTER, true));
        assert_eq!((wires.read(30), wires.read(30)), (0xA2, 0xFF));
        wires.stop(40);
    }

    #[test]
    fn who_is_not_there_does_not_acknowledge() {
        let mut wires = wires(Schedule::default().with(0, 9, Trouble::Silent));
        assert!(!wires.start(0, CONVERTER, false));
        assert!(!wires.start(0, DISPLAY, false));
        wires.has_display = true;
        assert!(wires.start(0, DISPLAY, false));
    }

    #[test]
    fn a_line_is_let_go_after_a_time_or_after_clocks() {
        let mut wires = wires(Schedule::default());
        wires.hold = Some(Hold::Until(100));
        assert!(wires.is_held(99) && !wires.is_held(100));
        wires.hold = Some(Hold::Clocks(2));
        wires.clock();
        assert!(wires.is_held(0));
        wires.clock();
        assert!(!wires.is_held(0));
    }
}
