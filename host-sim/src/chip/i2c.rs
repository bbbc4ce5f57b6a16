//! The I²C port of the ADS122C04 as an embedded-hal bus.

use std::cell::RefCell;
use std::rc::Rc;

use embedded_hal::delay::DelayNs;
use embedded_hal::i2c::{Error, ErrorKind, ErrorType, I2c, NoAcknowledgeSource, Operation};

use super::device::Device;
use super::line::Clock;
use super::trouble::Trouble;

/// Error: no acknowledge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NoAnswer;

impl Error for NoAnswer {
    fn kind(&self) -> ErrorKind {
        ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address)
    }
}

/// The chip on a bus of its own at address 0x40, with a clock shared with other parts of the test.
#[derive(Clone, Debug)]
pub struct I2cChip {
    device: Rc<RefCell<Device>>,
    clock: Clock,
}

const ADDRESS: u8 = 0x40;
/// Duration of a bit at 400 kHz.
const BIT_NS: u32 = 2_500;

impl I2cChip {
    /// Connects a chip to a clock.
    #[must_use]
    pub fn new(device: Rc<RefCell<Device>>, clock: Clock) -> Self {
        Self { device, clock }
    }

    /// Advances the clock by a start, the address, and bytes with acknowledges.
    fn pass(&mut self, bytes: usize) {
        self.clock.delay_ns((1 + 9 * (1 + bytes as u32)) * BIT_NS);
    }
}

impl ErrorType for I2cChip {
    type Error = NoAnswer;
}

impl I2c for I2cChip {
    fn transaction(
        &mut self,
        address: u8,
        operations: &mut [Operation<'_>],
    ) -> Result<(), NoAnswer> {
        let trouble = self.device.borrow().trouble(self.clock.now_ns());
        if address != ADDRESS || trouble == Some(Trouble::Silent) {
            self.pass(0);
            return Err(NoAnswer);
        }
        let mut answer = Vec::new();
        for operation in operations {
            match operation {
                Operation::Write(bytes) => {
                    self.pass(bytes.len());
                    let now_ns = self.clock.now_ns();
                    answer = self.device.borrow_mut().i2c_write(now_ns, bytes);
                }
                Operation::Read(buffer) => {
                    self.pass(buffer.len());
                    // A chip without more data leaves the line high.
                    let bytes = answer.drain(..answer.len().min(buffer.len()));
                    let bytes: Vec<u8> = bytes.collect();
                    buffer.fill(0xFF);
                    buffer[..bytes.len()].copy_from_slice(&bytes);
                }
            }
        }
        // Stop condition.
        self.clock.delay_ns(BIT_NS);
        Ok(())
    }
}
