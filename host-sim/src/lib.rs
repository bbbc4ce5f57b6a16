//! Host tools of Floe: replay recorded logs, simulate tests, compare methods.
#![forbid(unsafe_code)]

pub mod cli;
pub mod replay;
pub mod report;
pub mod sim;
