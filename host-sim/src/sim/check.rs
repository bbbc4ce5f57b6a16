//! Checks of a scene's values, and their error.

use crate::rounding::short;

/// Why a scene cannot be simulated, in one line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneError(pub(super) String);

impl std::fmt::Display for SceneError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for SceneError {}

/// Returns the error `message` unless `ok`.
pub(super) fn require(ok: bool, message: impl FnOnce() -> String) -> Result<(), SceneError> {
    if ok { Ok(()) } else { Err(SceneError(message())) }
}

/// Returns an error unless `value` is finite and above zero.
pub(super) fn positive(name: &str, value: f64) -> Result<(), SceneError> {
    require(value.is_finite() && value > 0.0, || {
        format!("{name} = {}: must be a number above zero", short(value))
    })
}

/// Returns an error unless `value` is above zero and at most `most`.
pub(super) fn above_zero(name: &str, value: f64, most: f64) -> Result<(), SceneError> {
    positive(name, value)?;
    require(value <= most, || {
        format!("{name} = {}: must be above zero, at most {}", short(value), short(most))
    })
}

/// Returns an error unless `value` is at least `least`: what is finer makes the computation endless.
pub(super) fn not_below(name: &str, value: f64, least: f64) -> Result<(), SceneError> {
    require(value.is_finite() && value >= least, || {
        format!("{name} = {}: must be a number not below {}", short(value), short(least))
    })
}

/// Returns an error unless `value` is finite and not negative.
pub(super) fn not_negative(name: &str, value: f64) -> Result<(), SceneError> {
    not_below(name, value, 0.0)
}

/// Returns an error unless `value` is finite and within the limits.
pub(super) fn between(name: &str, value: f64, low: f64, high: f64) -> Result<(), SceneError> {
    require((low..=high).contains(&value), || {
        format!("{name} = {}: must be {} to {}", short(value), short(low), short(high))
    })
}
