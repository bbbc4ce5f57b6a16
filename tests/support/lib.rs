//! Helpers shared by the tests across the crates.

pub mod brute;
pub mod normal;
