//! Host tools of Floe: replay recorded logs, simulate tests, compare methods.
#![forbid(unsafe_code)]

pub mod chip;
pub mod replay;
