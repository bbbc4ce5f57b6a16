//! The boards: pins, clocks, peripherals. All `unsafe` code is here.
#![allow(unsafe_code)]

mod bytes;

#[cfg(any(feature = "mps2-an386", feature = "nucleo-l476"))]
pub mod stack;

#[cfg(feature = "mps2-an386")]
pub mod mps2;
#[cfg(feature = "nucleo-l476")]
pub mod nucleo;
