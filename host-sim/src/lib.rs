#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

#[doc(hidden)]
pub mod bench;
pub mod campaign;
pub mod card;
pub mod chip;
#[doc(hidden)]
pub mod cli;
mod columnar;
pub mod error;
#[doc(hidden)]
pub mod live;
pub mod log;
pub mod replay;
mod report;
mod rounding;
mod short_file;
pub mod sim;
pub mod stiffness;
mod weigh;
