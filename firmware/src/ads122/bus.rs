//! The two buses of the chip: I²C and asynchronous serial.

use embedded_hal::delay::DelayNs;
use embedded_hal::i2c::{ErrorKind, I2c, SevenBitAddress};
use embedded_io::{Read, ReadReady, Write};

use crate::adc::AdcFault;

/// Transport of commands to the chip and of its answers.
pub trait Bus {
    /// Bit position of the register address in the command byte.
    const ADDRESS_SHIFT: u8;

    /// Sends a command and its arguments.
    ///
    /// # Errors
    /// [`AdcFault::Silent`] if the chip does not acknowledge, [`AdcFault::Garbled`] on any other
    /// bus error.
    fn send(&mut self, bytes: &[u8]) -> Result<(), AdcFault>;

    /// Sends a command and fills `answer` with the chip's answer.
    ///
    /// # Errors
    /// [`AdcFault::Silent`] without an acknowledge or an answer in time, else
    /// [`AdcFault::Garbled`].
    fn ask(&mut self, command: u8, answer: &mut [u8]) -> Result<(), AdcFault>;

    /// Code of a conversion from its three data bytes, in the order of the bus.
    fn code(bytes: [u8; 3]) -> i32;
}

/// ADS122C04: I²C.
#[derive(Debug)]
pub struct I2cBus<I> {
    i2c: I,
    address: SevenBitAddress,
}

impl<I> I2cBus<I> {
    /// With both address pins at ground the chip's address is 0x40.
    pub fn new(i2c: I, address: SevenBitAddress) -> Self {
        Self { i2c, address }
    }
}

impl<I: I2c> Bus for I2cBus<I> {
    const ADDRESS_SHIFT: u8 = 2;

    fn send(&mut self, bytes: &[u8]) -> Result<(), AdcFault> {
        self.i2c.write(self.address, bytes).map_err(i2c_fault)
    }

    fn ask(&mut self, command: u8, answer: &mut [u8]) -> Result<(), AdcFault> {
        self.i2c.write_read(self.address, &[command], answer).map_err(i2c_fault)
    }

    fn code(bytes: [u8; 3]) -> i32 {
        sign_extend(u32::from_be_bytes([0, bytes[0], bytes[1], bytes[2]]))
    }
}

fn i2c_fault(error: impl embedded_hal::i2c::Error) -> AdcFault {
    if matches!(error.kind(), ErrorKind::NoAcknowledge(_)) {
        AdcFault::Silent
    } else {
        AdcFault::Garbled
    }
}

/// ADS122U04: asynchronous serial, 115 200 baud.
#[derive(Debug)]
pub struct SerialBus<P, D> {
    port: P,
    delay: D,
}

/// Synchronization word sent before every command; the chip measures the baud rate from it.
const SYNC: u8 = 0x55;
/// A byte takes 87 µs; the longest answer is eight of them.
const POLL_US: u32 = 20;
const LIMIT_US: u32 = 2_000;
/// Bytes discarded before a command at most. A line that delivers more is faulty.
const STALE_BYTES: usize = 64;

impl<P: Read + Write + ReadReady, D: DelayNs> SerialBus<P, D> {
    /// A port of 115 200 baud, 8 data bits, no parity, one stop bit.
    pub fn new(port: P, delay: D) -> Self {
        Self { port, delay }
    }

    /// Discards received bytes that belong to no request.
    fn drain(&mut self) -> Result<(), AdcFault> {
        for _ in 0..STALE_BYTES {
            if !self.port.read_ready().map_err(garbled)? {
                return Ok(());
            }
            self.port.read(&mut [0]).map_err(garbled)?;
        }
        Err(AdcFault::Garbled)
    }

    fn wait_for_byte(&mut self, left_us: &mut u32) -> Result<(), AdcFault> {
        while !self.port.read_ready().map_err(garbled)? {
            *left_us = left_us.checked_sub(POLL_US).ok_or(AdcFault::Silent)?;
            self.delay.delay_us(POLL_US);
        }
        Ok(())
    }
}

impl<P: Read + Write + ReadReady, D: DelayNs> Bus for SerialBus<P, D> {
    const ADDRESS_SHIFT: u8 = 1;

    fn send(&mut self, bytes: &[u8]) -> Result<(), AdcFault> {
        self.port.write_all(&[SYNC]).map_err(garbled)?;
        self.port.write_all(bytes).map_err(garbled)?;
        self.port.flush().map_err(garbled)
    }

    fn ask(&mut self, command: u8, answer: &mut [u8]) -> Result<(), AdcFault> {
        self.drain()?;
        self.send(&[command])?;
        let mut left_us = LIMIT_US;
        for byte in answer.chunks_mut(1) {
            self.wait_for_byte(&mut left_us)?;
            self.port.read(byte).map_err(garbled)?;
        }
        Ok(())
    }

    fn code(bytes: [u8; 3]) -> i32 {
        sign_extend(u32::from_le_bytes([bytes[0], bytes[1], bytes[2], 0]))
    }
}

fn garbled<E>(_: E) -> AdcFault {
    AdcFault::Garbled
}

/// 24 bits in two's complement.
fn sign_extend(raw: u32) -> i32 {
    ((raw << 8).cast_signed()) >> 8
}
