//! TI ADS122C04 and ADS122U04: one 24-bit bridge converter behind two buses.
//!
//! In each sampling period the driver reads the conversion started in the previous period (eight
//! bytes: a counter, the code, and these four bytes inverted), reads back every register and starts
//! the next conversion. After a fault it resets the chip and sets it up again in the same call, so
//! a fault costs one sample.
//!
//! With a constant force one code in a hundred equals its predecessor, but a repeated code may also
//! come from a converter that hangs. After a repeated code the driver therefore converts the
//! reference too: if the result is the same code again, the converter hangs. The next conversion
//! then starts 2 ms late, which matters little because the force is constant.
//!
//! Every half minute the driver converts the chip's temperature or its supply voltage between two
//! samples. No sample is lost; the next conversion starts 2 ms late.

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
/// Waiting time for a conversion of the reference, nearly twice its duration (0.52 ms).
const MONITOR_US: u32 = 1_000;

/// Driver of the converter, with the state of the chip.
#[derive(Debug)]
pub struct Ads122<B, D> {
    bus: B,
    delay: D,
    input: Input,
    state: State,
    /// Counter of the last conversion that was read; none since a reset.
    counter: Option<u8>,
    /// The last code, and whether the converter is frozen at it. A reset keeps both; only a
    /// different code clears `frozen`.
    code: Option<i32>,
    frozen: bool,
    climate: Climate,
    /// Quantity to convert next to the coming sample.
    aside: Option<Aside>,
    /// The quantity that was requested last.
    last_aside: Aside,
}

/// Quantity converted between two samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Aside {
    Temperature,
    Supply,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// The contents of the registers are unknown.
    Unset,
    /// The registers are set up, no conversion is running.
    Ready,
    /// A conversion is running.
    Converting,
}

impl<B: Bus, D: DelayNs> Ads122<B, D> {
    /// Does not access the chip: the first [`BridgeAdc::tick`] sets it up.
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
        // Switch the integrity check on before reading anything back.
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

    /// Reads the finished conversion and checks counter, registers and repetition of the code.
    fn take(&mut self) -> Result<Counts, AdcFault> {
        // After a reset there is no counter to compare with.
        if self.counter.is_none() && self.read_register(2)? & DATA_READY == 0 {
            return Err(AdcFault::NotReady);
        }
        let code = self.read_data()?;
        self.check_registers()?;
        // A saturated reading may repeat full scale for any time.
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

    /// Converts temperature or supply if requested.
    fn look_aside(&mut self) -> Result<(), AdcFault> {
        match self.aside.take() {
            None => {}
            Some(Aside::Temperature) => {
                self.climate.temperature_256 = Some((self.beside(THERMOMETER)? >> 10) * 8);
            }
            Some(Aside::Supply) => {
                // The code is a quarter of the supply relative to 2048 mV, in 23 bits.
                self.climate.supply_mv = Some((self.beside(SUPPLY)? + (1 << 9)) >> 10);
            }
        }
        Ok(())
    }

    /// Converts with other values of registers 0 and 1, which takes a millisecond, and restores
    /// both. The next sample verifies the restored registers.
    fn beside(&mut self, registers: [u8; 2]) -> Result<i32, AdcFault> {
        self.write_registers([(0, registers[0]), (1, registers[1])])?;
        self.bus.send(&[START])?;
        self.delay.delay_us(MONITOR_US);
        let code = self.read_data()?;
        let [zero, one, ..] = settings(self.input);
        self.write_registers([(0, zero), (1, one)])?;
        Ok(code)
    }

    /// Scales the temperature, 14 bits at the top in 1/32 °C, to 1/256 °C; keeps other codes.
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
        // A start that fails costs the next sample: the counter stays, so the chip is not ready.
        let _ = self.start();
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
