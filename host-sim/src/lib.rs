//! Host tools of Floe: replay recorded logs, simulate tests, compare methods.
#![forbid(unsafe_code)]

pub mod bench;
pub mod campaign;
pub mod card;
pub mod chip;
pub mod cli;
pub mod error;
pub mod live;
pub mod log;
pub mod replay;
pub mod report;
pub mod sim;
pub mod stiffness;
pub mod weigh;
