//! What a scene must satisfy before it is computed.

use super::scene::{Scene, SceneError};

/// Refuses with `message` unless `ok`.
pub(super) fn require(ok: bool, message: impl FnOnce() -> String) -> Result<(), SceneError> {
    if ok { Ok(()) } else { Err(SceneError(message())) }
}

/// Refuses unless `value` is finite and above zero.
pub(super) fn positive(name: &str, value: f64) -> Result<(), SceneError> {
    require(value.is_finite() && value > 0.0, || {
        format!("{name} = {value}: must be a number above zero")
    })
}

/// Refuses unless `value` is finite and not negative.
pub(super) fn not_negative(name: &str, value: f64) -> Result<(), SceneError> {
    require(value.is_finite() && value >= 0.0, || {
        format!("{name} = {value}: must be a number not below zero")
    })
}

impl Scene {
    /// Checks every value.
    ///
    /// # Errors
    /// The first value out of its range, by its name.
    pub fn validate(&self) -> Result<(), SceneError> {
        positive("duration_s", self.duration_s)?;
        require((1.0..=2000.0).contains(&self.rate_hz), || {
            format!("rate_hz = {}: must be 1 to 2000", self.rate_hz)
        })?;
        positive("weight_n", self.weight_n)?;
        positive("stiffness_n_per_m", self.stiffness_n_per_m)?;
        positive("winch_m_per_s", self.winch_m_per_s)?;
        positive("cable_length_m", self.cable_length_m)?;
        self.validate_friction()?;
        not_negative("start_force_n", self.start_force_n)?;
        self.validate_start()?;
        self.measurement.validate()
    }

    /// The block must rest on the slope by itself: the state machine knows no
    /// sliding back.
    fn validate_friction(&self) -> Result<(), SceneError> {
        positive("mu", self.mu)?;
        require(self.mu_s.is_finite() && self.mu_s >= self.mu, || {
            format!("mu_s = {}: must be a number not below mu = {}", self.mu_s, self.mu)
        })?;
        let tangent = self.slope_rad().tan().abs();
        require(self.slope_deg.abs() < 60.0 && tangent < self.mu, || {
            format!(
                "slope_deg = {}: a block with mu = {} slides down by itself",
                self.slope_deg, self.mu
            )
        })
    }

    fn validate_start(&self) -> Result<(), SceneError> {
        let s = &self.start;
        let ok = (1..=366).contains(&s.day) && s.hour < 24 && s.minute < 60;
        require(ok, || "start: day must be 1 to 366, hour 0 to 23, minute 0 to 59".to_owned())
    }
}
