//! Helpers shared by the tests across the crates.

pub mod brute;
pub mod feed;
pub mod maths;
pub mod normal;
pub mod scenes;
