//! TI ADS122C04 and ADS122U04: one 24-bit bridge converter behind two buses.
//!
//! Each sampling period: read the conversion that the last period started (eight
//! bytes: a counter, the code, and all four again inverted), read back every
//! register, start the next conversion. A fault costs its own sample: the chip is
//! reset and set up again in the same call.
//!
//! A code that comes twice in a row is one in a hundred where the force stands
//! still, but it may also be a converter that has hung. Then, and only then, the
//! reference is converted too: if that gives the same code, it has. The next
//! conversion starts 2 ms late, which matters little: the force was standing still.
//!
//! Every half minute the chip's temperature or its supply is converted in the same way,
//! between two samples: none is lost, the next one starts 2 ms late.

mod bus;
pub mod registers;

use embedded_hal::delay::DelayNs;
use floe_core::Counts;

pub use self::bus::{Bus, I2cBus, SerialBus};
use crate::adc::{AdcFault, BridgeAdc, Climate, Input};
use registers::{
    DATA_READY, MONITOR, READ_DATA, READ_REGISTER, RESET, START, SUPPLY, THERMOMETER,
    WRITE_REGISTER, settings,
};

/// Longest time from a reset to the first command, data sheet section 6.6.
const RESET_US: u32 = 500;
/// Time for a conversion of the reference, nearly twice what it takes.
const MONITOR_US: u32 = 1_000;

/// The converter and what it has been told.
#[derive(Debug)]
pub struct Ads122<B, D> {
    bus: B,
    delay: D,
    input: Input,
    state: State,
    /// Counter of the last conversion that was read; none since a reset.
    counter: Option<u8>,
    /// The last code, and whether it is all that comes. A reset does not change what
    /// is known of it, only another code does.
    code: Option<i32>,
    frozen: bool,
    climate: Climate,
    /// What is to be converted beside the next sample.
    aside: Option<Aside>,
    /// The last one of the two.
    last_aside: Aside,
}

/// What is converted between two samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Aside {
    Temperature,
    Supply,
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

impl<B: Bus, D: DelayNs> Ads122<B, D> {
    /// Touches nothing: the first [`BridgeAdc::tick`] sets the chip up.
    pub fn new(bus: B, delay: D) -> Self {
        let (input, state) = (Input::Bridge, State::Unset);
        Self {
            bus,
            delay,
            input,
            state,
            counter: None,
            code: None,
            frozen: false,
            climate: Climate::default(),
            aside: None,
            last_aside: Aside::Supply,
        }
    }

    /// Resets, writes all registers, reads them back.
    fn set_up(&mut self) -> Result<(), AdcFault> {
        self.state = State::Unset;
        self.counter = None;
        self.bus.send(&[RESET])?;
        self.delay.delay_us(RESET_US);
        // The integrity check has to be on before anything is read back.
        let [zero, one, two, three] = settings(self.input);
        self.write_registers([(2, two), (0, zero), (1, one), (3, three)])?;
        self.check_registers()?;
        self.state = State::Ready;
        Ok(())
    }

    fn write_registers<const N: usize>(&mut self, values: [(u8, u8); N]) -> Result<(), AdcFault> {
        values.into_iter().try_for_each(|(register, value)| {
            self.bus.send(&[WRITE_REGISTER | register << B::ADDRESS_SHIFT, value])
        })
    }

    fn read_register(&mut self, register: u8) -> Result<u8, AdcFault> {
        let mut answer = [0; 2];
        self.bus.ask(READ_REGISTER | register << B::ADDRESS_SHIFT, &mut answer)?;
        if answer[0] == !answer[1] { Ok(answer[0]) } else { Err(AdcFault::Garbled) }
    }

    fn check_registers(&mut self) -> Result<(), AdcFault> {
        for (register, expected) in (0..).zip(settings(self.input)) {
            let read = self.read_register(register)?;
            let value = if register == 2 { read & !DATA_READY } else { read };
            if value != expected {
                return Err(AdcFault::Registers);
            }
        }
        Ok(())
    }

    /// The last conversion, which has to be a new one.
    fn read_data(&mut self) -> Result<i32, AdcFault> {
        let mut bytes = [0; 8];
        self.bus.ask(READ_DATA, &mut bytes)?;
        let [counter, a, b, c, inverse @ ..] = bytes;
        if inverse != [!counter, !a, !b, !c] {
            return Err(AdcFault::Garbled);
        }
        if self.counter.replace(counter) == Some(counter) {
            return Err(AdcFault::NotReady);
        }
        Ok(B::code([a, b, c]))
    }

    fn start(&mut self) -> Result<(), AdcFault> {
        self.bus.send(&[START])?;
        self.state = State::Converting;
        Ok(())
    }

    /// The finished conversion, if everything about it is as it should be.
    fn take(&mut self) -> Result<Counts, AdcFault> {
        // After a reset there is no counter to compare with.
        if self.counter.is_none() && self.read_register(2)? & DATA_READY == 0 {
            return Err(AdcFault::NotReady);
        }
        let code = self.read_data()?;
        self.check_registers()?;
        // Full scale is full scale, however often.
        let repeated = self.code.replace(code) == Some(code) && !saturated(code);
        self.frozen = repeated && (self.frozen || self.beside(MONITOR)? == code);
        if self.frozen {
            return Err(AdcFault::Stuck);
        }
        let scaled = self.scaled(code);
        if self.input == Input::Bridge {
            self.look_aside()?;
        }
        Ok(Counts(scaled))
    }

    /// Temperature or supply, if it is their turn.
    fn look_aside(&mut self) -> Result<(), AdcFault> {
        match self.aside.take() {
            None => {}
            Some(Aside::Temperature) => {
                self.climate.temperature_256 = Some((self.beside(THERMOMETER)? >> 10) * 8);
            }
            Some(Aside::Supply) => {
                // A quarter of it, as a part of 2048 mV, in 23 bits.
                self.climate.supply_mv = Some((self.beside(SUPPLY)? + (1 << 9)) >> 10);
            }
        }
        Ok(())
    }

    /// Converts something else, which waits a millisecond. That the registers are as
    /// before again is checked with the next sample.
    fn beside(&mut self, registers: [u8; 2]) -> Result<i32, AdcFault> {
        self.write_registers([(0, registers[0]), (1, registers[1])])?;
        self.bus.send(&[START])?;
        self.delay.delay_us(MONITOR_US);
        let code = self.read_data()?;
        let [zero, one, ..] = settings(self.input);
        self.write_registers([(0, zero), (1, one)])?;
        Ok(code)
    }

    /// The temperature comes as 14 bits at the top, in 1/32 °C.
    fn scaled(&self, code: i32) -> i32 {
        if self.input == Input::Temperature { (code >> 10) * 8 } else { code }
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

    fn climate(&self) -> Climate {
        self.climate
    }

    fn want_climate(&mut self) {
        self.last_aside = match self.last_aside {
            Aside::Temperature => Aside::Supply,
            Aside::Supply => Aside::Temperature,
        };
        self.aside = Some(self.last_aside);
    }

    fn select(&mut self, input: Input) -> bool {
        self.input = input;
        self.state = State::Unset;
        (self.counter, self.code, self.frozen) = (None, None, false);
        true
    }
}
