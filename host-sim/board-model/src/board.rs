//! The whole board: peripherals, chips on the buses, and the script of a run.

mod access;
#[cfg(test)]
mod clock;
mod events;

use std::fs::OpenOptions;

use floe::chip::{Device, Variant};

use crate::gpio::{Gpio, Name};
use crate::i2c::I2c;
use crate::iwdg::Iwdg;
use crate::lptim::Lptim;
use crate::patience::Patience;
use crate::power::{Flash, Pwr};
use crate::rcc::{Oscillators, Rcc};
use crate::remote::Remote;
use crate::rtc::Rtc;
use crate::rtt::Memory;
use crate::rules::{At, Clocks, Rules};
use crate::run::{CardSetup, Incident, Outcome, Setup, When};
use crate::sd_card::{Kind, SdCard};
use crate::slot::Slot;
use crate::spi::Spi;
use crate::tim2::Tim2;
use crate::usart::Usart;
use crate::wires::Wires;

pub use access::BASES;

/// The functions of the emulator that the board needs.
pub trait Emulator: Memory {
    /// Emulated time, ns.
    fn now_ns(&self) -> u64;
    /// Sets the level of an interrupt line.
    fn set_interrupt(&mut self, number: u32, up: bool);
    /// Advances the time while the program only polls: to `when_ns`, or to the next event due
    /// before.
    fn skip_to(&mut self, when_ns: u64);
    /// Requests a call of [`Board::wake`] at a time, ns.
    fn wake_at(&mut self, when_ns: u64);
    /// Sets the processor's stack pointer.
    fn move_stack(&mut self, to: u32);
    /// Requests a restart of the processor, after which [`Board::restarted`] is called.
    fn restart(&mut self);
    /// Ends the run.
    fn finish(&mut self);
}

/// The board.
#[derive(Debug)]
pub struct Board {
    setup: Setup,
    rules: Rules,
    rcc: Rcc,
    pwr: Pwr,
    flash: Flash,
    port_a: Gpio,
    port_b: Gpio,
    tim2: Tim2,
    lptim: Lptim,
    i2c: I2c,
    wires: Wires,
    spi: Spi,
    slot: Slot,
    usart: Usart,
    iwdg: Iwdg,
    rtc: Rtc,
    remote: Option<Remote>,
    clocks: Clocks,
    patience: Patience,
    /// The script's remaining events; the next one is last.
    script: Vec<(When, Incident)>,
    /// A peripheral whose accesses fail.
    failing: Option<u32>,
    /// Cause of the requested restart: reset flags and name.
    cause: Option<(u32, &'static str)>,
    lines_up: (bool, bool),
    waiting_for_tick: bool,
    heard: usize,
    logged: Vec<u8>,
    outcome: Outcome,
}

impl Board {
    /// The board at power-up.
    ///
    /// # Errors
    /// The card's image or the port cannot be opened.
    pub fn new(setup: Setup) -> std::io::Result<Self> {
        let start_ns = setup.crystal_start_s.map(|s| (s * 1e9) as u64);
        let oscillators =
            Oscillators { crystal_start_ns: start_ns, msi_error: 0.004, hsi_error: -0.003 };
        let rcc = Rcc::new(oscillators);
        let card = setup.card.as_ref().map(open_card).transpose()?;
        let present = setup.card.as_ref().is_some_and(|card| card.present);
        let device = Device::new(Variant::C04, setup.load_cell(), setup.troubles.clone());
        let mut script = setup.script.clone();
        // The order of simultaneous events is kept.
        script.reverse();
        Ok(Self {
            rules: Rules::default(),
            clocks: rcc.clocks(0),
            rcc,
            pwr: Pwr::default(),
            flash: Flash::default(),
            port_a: Gpio::new(Name::A),
            port_b: Gpio::new(Name::B),
            tim2: Tim2::new(),
            lptim: Lptim::default(),
            i2c: I2c::default(),
            wires: Wires::new(device, setup.display),
            spi: Spi::default(),
            slot: Slot::new(card, present),
            usart: Usart::default(),
            iwdg: Iwdg::default(),
            rtc: Rtc::default(),
            patience: Patience::default(),
            remote: setup.port.map(Remote::new).transpose()?,
            script,
            failing: None,
            cause: None,
            lines_up: (false, false),
            waiting_for_tick: true,
            heard: 0,
            logged: Vec::new(),
            outcome: Outcome::default(),
            setup,
        })
    }

    /// Passes a change of the clocks to the peripherals that count.
    fn follow_clocks(&mut self, now_ns: u64) {
        let clocks = self.rcc.clocks(now_ns);
        if clocks != self.clocks {
            let at = &mut At { now_ns, clocks: self.clocks, rules: &mut self.rules };
            self.tim2.rebase(at);
            // The calendar counts with the old clock until now, with the new one from now on.
            let at = &mut At { now_ns, clocks, rules: &mut self.rules };
            self.rtc.rebase(at);
            self.clocks = clocks;
        }
    }
}

fn open_card(setup: &CardSetup) -> std::io::Result<SdCard> {
    let disk = OpenOptions::new().read(true).write(true).open(&setup.image)?;
    let write_ns = (setup.write_s * 1e9) as u64;
    let kind = Kind { write_ns, unreadable: setup.unreadable, ..Kind::default() };
    SdCard::new(kind, Box::new(disk))
}
