//! The logger application, without pins, clocks and peripherals.
//!
//! ```text
//!  tick interrupt                      main loop
//!  converter ─► sampler ─► queue ─► core pipeline ─► live lines, log, display
//! ```
//!
//! It runs on a board (`src/board/`), and on a PC in tests.
#![cfg_attr(not(test), no_std)]

pub mod adc;
pub mod ads122;
pub mod app;
pub mod average;
#[cfg(target_os = "none")]
pub mod board;
#[cfg(feature = "card")]
pub mod card;
pub mod command;
pub mod console;
#[cfg(feature = "display")]
pub mod display;
pub mod journal;
pub mod line;
mod log;
pub mod long_division;
pub mod measuring;
#[cfg(feature = "card")]
pub mod media;
pub mod notebook;
pub mod period;
pub mod record;
pub mod sample;
pub mod sampler;
pub mod self_test;
pub mod settings;
pub mod store;
pub mod text;
pub mod wall_clock;
pub mod weighing;
