#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

pub mod bench;
pub mod campaign;
pub mod card;
pub mod chip;
pub mod cli;
mod columnar;
pub mod error;
pub mod live;
pub mod log;
pub mod replay;
pub mod report;
pub mod sim;
pub mod stiffness;
pub mod weigh;
