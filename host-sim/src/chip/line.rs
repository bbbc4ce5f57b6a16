//! The chip's serial line as a port for a program on the same PC, in simulated time.

use std::cell::{Cell, RefCell};
use std::convert::Infallible;
use std::rc::Rc;

use embedded_hal::delay::DelayNs;
use embedded_io::{ErrorType, Read, ReadReady, Write};

use super::serial::SerialChip;

/// A clock that advances on request only.
#[derive(Clone, Debug, Default)]
pub struct Clock(Rc<Cell<u64>>);

impl Clock {
    /// Time since the start.
    #[must_use]
    pub fn now_ns(&self) -> u64 {
        self.0.get()
    }

    /// Advances to a time, unless it has passed.
    pub fn wait_until(&self, ns: u64) {
        self.0.set(self.0.get().max(ns));
    }
}

impl DelayNs for Clock {
    fn delay_ns(&mut self, ns: u32) {
        self.0.set(self.0.get() + u64::from(ns));
    }
}

/// The host's end of the line.
#[derive(Clone, Debug)]
pub struct SerialLine {
    chip: Rc<RefCell<SerialChip>>,
    clock: Clock,
    arrived: Rc<RefCell<Vec<u8>>>,
}

impl SerialLine {
    /// Connects a chip to a clock.
    #[must_use]
    pub fn new(chip: Rc<RefCell<SerialChip>>, clock: Clock) -> Self {
        Self { chip, clock, arrived: Rc::default() }
    }
}

impl ErrorType for SerialLine {
    type Error = Infallible;
}

impl ReadReady for SerialLine {
    fn read_ready(&mut self) -> Result<bool, Infallible> {
        let bytes = self.chip.borrow_mut().transmit(self.clock.now_ns());
        self.arrived.borrow_mut().extend(bytes);
        Ok(!self.arrived.borrow().is_empty())
    }
}

impl Read for SerialLine {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Infallible> {
        let mut arrived = self.arrived.borrow_mut();
        let count = arrived.len().min(buffer.len());
        for (slot, byte) in buffer.iter_mut().zip(arrived.drain(..count)) {
            *slot = byte;
        }
        Ok(count)
    }
}

impl Write for SerialLine {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        for &byte in bytes {
            self.chip.borrow_mut().receive(self.clock.now_ns(), byte);
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}
