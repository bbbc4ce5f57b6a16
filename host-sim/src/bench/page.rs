//! The page `speed-vs-error.md`.
use super::result::BenchResult;
/// The page.
#[must_use]
pub fn markdown(_result: &BenchResult, _picture: &str) -> String {
    String::new()
}
