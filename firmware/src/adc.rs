//! The interface between the logger and an analog-to-digital converter: the trait [`BridgeAdc`].

use core::fmt;

use floe_core::{Counts, Fault, Reading};

/// What a conversion measures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Input {
    /// The load cell.
    #[default]
    Bridge,
    /// The converter's inputs tied together: its own offset and noise.
    Shorted,
    /// The converter's temperature; code in 1/256 °C.
    Temperature,
    /// The load cell with burn-out currents on: full scale if a wire is broken.
    BurnOut,
}

/// Why a conversion gave no code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum AdcFault {
    /// No answer within the bus's time limit.
    Silent,
    /// The converter answers, but has no new conversion: it is stuck or too slow.
    NotReady,
    /// The answer contradicts itself, or the bus reports an error.
    Garbled,
    /// The converter returns the same code repeatedly, whatever it converts.
    Stuck,
    /// A register does not hold the value that was written to it: most likely a brown-out.
    Registers,
}

impl AdcFault {
    /// The fault as a phrase for the console and the log.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Silent => "silent",
            Self::NotReady => "not ready",
            Self::Garbled => "garbled",
            Self::Stuck => "stuck",
            Self::Registers => "registers changed",
        }
    }
}

impl fmt::Display for AdcFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.words())
    }
}

impl From<AdcFault> for Reading {
    fn from(fault: AdcFault) -> Self {
        Self::Bad(match fault {
            AdcFault::Silent | AdcFault::NotReady => Fault::Timeout,
            AdcFault::Garbled | AdcFault::Stuck | AdcFault::Registers => Fault::Corrupt,
        })
    }
}

/// Temperature and supply voltage of the converter. A value is `None` if the converter cannot
/// measure it or has not been asked yet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Climate {
    /// Temperature, 1/256 °C.
    pub temperature_256: Option<i32>,
    /// Supply, mV.
    pub supply_mv: Option<i32>,
}

/// A converter with one signed code per sampling period.
///
/// Called from the sampling interrupt: bounded in time, a few milliseconds at worst,
/// and never waits for the conversion of a sample.
pub trait BridgeAdc {
    /// Takes the code of the conversion that the previous call started, then
    /// starts the next one. `None`: nothing had been started.
    ///
    /// # Errors
    /// Why there is no code. The converter has been set up again as far as
    /// possible and the next conversion started: only this sample is lost.
    fn tick(&mut self) -> Result<Option<Counts>, AdcFault>;

    /// Requests one measurement of temperature or supply voltage (alternately), made next to the
    /// coming conversion without losing its sample. A converter without this ability does nothing.
    fn want_climate(&mut self) {}

    /// The newest temperature and supply voltage.
    fn climate(&self) -> Climate {
        Climate::default()
    }

    /// Selects the input of all following conversions. A converter that cannot switch inputs stays
    /// on the bridge and returns `false`.
    fn select(&mut self, input: Input) -> bool {
        input == Input::Bridge
    }
}
