//! The picture.
use super::result::BenchResult;
/// SVG.
#[must_use]
pub fn svg(_result: &BenchResult) -> String {
    String::new()
}
