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

/// The number in an environment variable, or `usual` without the variable.
///
/// # Panics
/// The variable is not a number above zero: the test would do nothing, or less than was asked.
#[must_use]
pub fn number(name: &str, usual: f64) -> f64 {
    let Ok(text) = std::env::var(name) else { return usual };
    let number = text.parse().ok().filter(|number: &f64| number.is_finite() && *number > 0.0);
    number.unwrap_or_else(|| panic!("{name} is '{text}', not a number above zero"))
}

/// Whether this runs in CI, where a missing tool is an error.
#[must_use]
pub fn in_ci() -> bool {
    std::env::var("CI").is_ok_and(|ci| ci == "true")
}
