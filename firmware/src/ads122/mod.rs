//! TI ADS122C04 and ADS122U04: one 24-bit bridge converter behind two buses.
//!
//! Each sampling period: read the conversion that the last period started (eight
//! bytes: a counter, the code, and all four again inverted), read back one
//! register, start the next conversion. A fault costs its own sample: the chip is
//! reset and set up again in the same call.

mod bus;
pub mod registers;

use embedded_hal::delay::DelayNs;
use floe_core::Counts;

pub use self::bus::{Bus, I2cBus, SerialBus};
use crate::adc::{AdcFault, BridgeAdc, Input};
use registers::{DATA_READY, READ_DATA, READ_REGISTER, RESET, START, WRITE_REGISTER, settings};

/// How often a code may come in a row. The chip's own noise is 12 codes or more,
/// so that five equal ones come by chance once in about 3 million samples.
pub const EQUAL_CODES: u8 = 4;

/// Longest time from a reset to the first command, data sheet section 6.6.
const RESET_US: u32 = 500;

/// The converter and what it has been told.
#[derive(Debug)]
pub struct Ads122<B, D> {
    bus: B,
    delay: D,
    input: Input,
    state: State,
    last: Last,
    next_register: u8,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// Registers unknown.
    Unset,
    /// Set up, nothing started.
    Ready,
    /// A conversion was started.
    Converting,
}

/// The last conversion, to tell a new one from an old one.
#[derive(Clone, Copy, Debug, Default)]
struct Last {
    counter: Option<u8>,
    code: Option<i32>,
    equal: u8,
}

impl<B: Bus, D: DelayNs> Ads122<B, D> {
    /// Touches nothing: the first [`BridgeAdc::tick`] sets the chip up.
    pub fn new(bus: B, delay: D) -> Self {
        let last = Last::default();
        Self { bus, delay, input: Input::Bridge, state: State::Unset, last, next_register: 0 }
    }

    /// Resets, writes all registers, reads them back.
    fn set_up(&mut self) -> Result<(), AdcFault> {
        self.state = State::Unset;
        self.last.counter = None;
        self.bus.send(&[RESET])?;
        self.delay.delay_us(RESET_US);
        // The integrity check has to be on before anything is read back.
        for register in [2, 0, 1, 3] {
            let value = settings(self.input)[usize::from(register)];
            self.bus.send(&[WRITE_REGISTER | register << B::ADDRESS_SHIFT, value])?;
        }
        for register in 0..4 {
            self.check_register(register)?;
        }
        self.state = State::Ready;
        Ok(())
    }

    fn read_register(&mut self, register: u8) -> Result<u8, AdcFault> {
        let mut answer = [0; 2];
        self.bus.ask(READ_REGISTER | register << B::ADDRESS_SHIFT, &mut answer)?;
        if answer[0] == !answer[1] { Ok(answer[0]) } else { Err(AdcFault::Garbled) }
    }

    fn check_register(&mut self, register: u8) -> Result<(), AdcFault> {
        let read = self.read_register(register)?;
        let value = if register == 2 { read & !DATA_READY } else { read };
        let expected = settings(self.input).get(usize::from(register)).copied();
        if expected == Some(value) { Ok(()) } else { Err(AdcFault::Registers) }
    }

    fn start(&mut self) -> Result<(), AdcFault> {
        self.bus.send(&[START])?;
        self.state = State::Converting;
        Ok(())
    }

    /// The finished conversion, with one register checked.
    fn take(&mut self) -> Result<Counts, AdcFault> {
        // After a reset there is no counter to compare with.
        if self.last.counter.is_none() && self.read_register(2)? & DATA_READY == 0 {
            return Err(AdcFault::NotReady);
        }
        let mut bytes = [0; 8];
        self.bus.ask(READ_DATA, &mut bytes)?;
        if (0..4).any(|i| bytes[i] != !bytes[i + 4]) {
            return Err(AdcFault::Garbled);
        }
        let code = B::code([bytes[1], bytes[2], bytes[3]]);
        self.last.check(bytes[0], code, self.input)?;
        self.check_register(self.next_register)?;
        self.next_register = (self.next_register + 1) % 4;
        Ok(Counts(self.scaled(code)))
    }

    /// The temperature comes as 14 bits at the top, in 1/32 °C.
    fn scaled(&self, code: i32) -> i32 {
        if self.input == Input::Temperature { (code >> 10) * 8 } else { code }
    }
}

impl Last {
    /// The suspicion of a stuck code outlives a reset of the chip.
    fn check(&mut self, counter: u8, code: i32, input: Input) -> Result<(), AdcFault> {
        if self.counter == Some(counter) {
            return Err(AdcFault::NotReady);
        }
        let noisy = matches!(input, Input::Bridge | Input::Shorted) && !saturated(code);
        let equal = noisy && self.code == Some(code);
        self.equal = if equal { self.equal.saturating_add(1) } else { 0 };
        (self.counter, self.code) = (Some(counter), Some(code));
        if self.equal >= EQUAL_CODES { Err(AdcFault::Stuck) } else { Ok(()) }
    }
}

fn saturated(code: i32) -> bool {
    code <= -(1 << 23) || code >= (1 << 23) - 1
}

impl<B: Bus, D: DelayNs> BridgeAdc for Ads122<B, D> {
    fn tick(&mut self) -> Result<Option<Counts>, AdcFault> {
        let taken = match self.state {
            State::Converting => self.take().map(Some),
            State::Ready | State::Unset => Ok(None),
        };
        if taken.is_err() || self.state == State::Unset {
            self.set_up().or_else(|fault| taken.and(Err(fault)))?;
        }
        self.start()?;
        taken
    }

    fn select(&mut self, input: Input) -> bool {
        self.input = input;
        self.state = State::Unset;
        self.last = Last::default();
        true
    }
}
