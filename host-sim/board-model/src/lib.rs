//! A NUCLEO-L476RG for QEMU: a plugin adds the peripherals that QEMU's machine `b-l475e-iot01a`
//! lacks, with a load cell on a converter, a display, a card and a console. The board's image runs
//! on it unchanged.
//!
//! Each peripheral is a file, written from the reference manual RM0351, the data sheets and the SD
//! specification instead of the firmware's drivers, and tested without QEMU. Behaviour that those
//! documents forbid is recorded as a breach, and a breach fails the run.
//!
//! ```text
//!  QEMU ◄─► qemu.rs ◄─► Board ─► tim2 lptim iwdg rtc usart rcc power gpio
//!                             ├► i2c ─► wires ─► converter (floe::chip), ssd1306
//!                             └► spi ─► slot ─► sd_card
//! ```

pub mod board;
pub mod gpio;
pub mod i2c;
pub mod iwdg;
pub mod lptim;
pub mod patience;
pub mod power;
#[cfg(unix)]
mod qemu;
pub mod rcc;
mod remote;
pub mod rtc;
pub mod rtt;
pub mod rules;
pub mod run;
pub mod sd_card;
pub mod slot;
pub mod spi;
pub mod ssd1306;
pub mod tim2;
pub mod usart;
pub mod wires;
