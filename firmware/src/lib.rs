//! The logger application: everything but pins, clocks and peripherals.
//!
//! ```text
//!  tick interrupt                      main loop
//!  converter ─► sampler ─► queue ─► core pipeline ─► live lines, log, display
//! ```
//!
//! It runs on a board (`src/board/`), and on a PC under test.
#![cfg_attr(not(test), no_std)]

pub mod adc;
pub mod ads122;
