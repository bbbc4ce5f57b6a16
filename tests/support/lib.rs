//! Helpers shared by the tests across the crates.

pub mod aims;
pub mod both;
pub mod brute;
pub mod feed;
pub mod honesty;
pub mod maths;
pub mod normal;
pub mod records;
pub mod scenes;
pub mod score;
pub mod wide;
