//! Helpers shared by the tests across the crates.

pub mod aims;
pub mod board;
pub mod both;
pub mod brute;
pub mod classes;
pub mod day;
pub mod fat;
pub mod feed;
pub mod fuzz;
pub mod honesty;
pub mod maths;
pub mod normal;
pub mod parallel;
pub mod random;
pub mod records;
pub mod saw;
pub mod scenes;
pub mod score;
pub mod scripted;
pub mod shown;
pub mod sweep;
pub mod terminal;
pub mod wide;

/// Whether this runs in CI, where a missing tool is an error.
#[must_use]
pub fn in_ci() -> bool {
    std::env::var("CI").is_ok_and(|ci| ci == "true")
}
