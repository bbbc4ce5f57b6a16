//! The watchdog, which resets the board unless it is fed in time.

use embassy_stm32::pac::IWDG;
use embassy_stm32::pac::iwdg::vals::{Key, Pr};

/// Counts in the watchdog's period, of its own 32 kHz oscillator divided by 128: 10 s, longer than
/// the longest pause of a card, shorter than a user's patience.
const COUNTS: u16 = 2500;

/// The watchdog.
#[derive(Debug)]
pub struct Watchdog(());

impl Watchdog {
    /// Sets the period.
    pub(super) fn new() -> Self {
        write_key(Key::ENABLE);
        IWDG.pr().write(|w| w.set_pr(Pr::DIVIDE_BY128));
        IWDG.rlr().write(|w| w.set_rl(COUNTS - 1));
        Self(())
    }

    /// Starts it; only a reset stops it.
    pub fn unleash(&mut self) {
        write_key(Key::START);
    }

    /// Begins a new period.
    pub fn pet(&mut self) {
        write_key(Key::RESET);
    }
}

fn write_key(key: Key) {
    IWDG.kr().write(|w| w.set_key(key));
}
