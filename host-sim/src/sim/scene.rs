//! Description of a simulated test: the block, the pull and the measurement.

use serde::{Deserialize, Serialize};

mod fault;
mod terms_on;
mod validate;

use super::along_slip::AlongSlip;
use super::check::SceneError;
use super::damping::CableDamping;
use super::measurement::Measurement;
use super::rate_and_state::RateAndState;
use super::rocking::Rocking;
use super::stribeck::Stribeck;
use super::terms::{
    Breaking, Creep, Drag, HoldTime, PartialSlips, RateDependence, Sag, Snow, Tilt, Variation,
    Weighing,
};
use super::wander::Wander;
use super::winch::WinchProfile;

/// One simulated test. SI units; every term beyond the linear block on a cable
/// is off unless given.
///
/// The default is test DFF8-13 of the paper without noise.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// Name of the test.
    #[serde(default)]
    pub test_id: Option<String>,
    /// Length of the record, s, above zero.
    #[serde(default = "default_duration_s")]
    pub duration_s: f64,
    /// Samples per second, 1 to 2000.
    #[serde(default = "default_rate_hz")]
    pub rate_hz: f64,
    /// Weight of the block `Mg`, N, above zero.
    pub weight_n: f64,
    /// Static coefficient, at least `mu`.
    pub mu_s: f64,
    /// Dynamic coefficient, above zero.
    pub mu: f64,
    /// Stiffness of the cable `k`, N/m, above zero.
    pub stiffness_n_per_m: f64,
    /// Take-up speed of the winch `w`, m/s, above zero.
    pub winch_m_per_s: f64,
    /// Free length of the cable at the start, m, above zero.
    #[serde(default = "default_cable_length_m")]
    pub cable_length_m: f64,
    /// Slope of the ice along the pull, degrees, uphill positive.
    #[serde(default)]
    pub slope_deg: f64,
    /// Force in the cable at the start, the block at rest, N.
    #[serde(default)]
    pub start_force_n: f64,
    /// Start with the block sliding evenly at the winch's speed instead of at
    /// rest: with constant friction it never sticks.
    #[serde(default)]
    pub start_sliding: bool,
    /// The cable is tied to a post: it is stretched and nothing slips.
    #[serde(default)]
    pub post: bool,
    /// The block hangs and swings instead of being pulled.
    pub weighing: Option<Weighing>,
    /// See [`Snow`].
    pub snow: Option<Snow>,
    /// See [`Variation`].
    pub variation: Option<Variation>,
    /// See [`Wander`].
    pub wander: Option<Wander>,
    /// See [`PartialSlips`].
    pub partial_slips: Option<PartialSlips>,
    /// See [`HoldTime`].
    pub hold_time: Option<HoldTime>,
    /// See [`RateDependence`].
    pub rate_dependence: Option<RateDependence>,
    /// See [`Stribeck`].
    pub stribeck: Option<Stribeck>,
    /// See [`RateAndState`].
    pub rate_and_state: Option<RateAndState>,
    /// See [`AlongSlip`].
    pub along_slip: Option<AlongSlip>,
    /// See [`Rocking`].
    pub rocking: Option<Rocking>,
    /// See [`Creep`].
    pub creep: Option<Creep>,
    /// The cable gets shorter and stiffer as the block comes near:
    /// `k = AE / (L0 - x)`.
    #[serde(default)]
    pub shortening: bool,
    /// See [`Sag`].
    pub sag: Option<Sag>,
    /// See [`CableDamping`].
    pub cable_damping: Option<CableDamping>,
    /// See [`WinchProfile`].
    pub winch_profile: Option<WinchProfile>,
    /// See [`Breaking`].
    pub breaking: Option<Breaking>,
    /// See [`Tilt`].
    pub tilt: Option<Tilt>,
    /// See [`Drag`].
    pub drag: Option<Drag>,
    /// When the record starts, for logs with a calendar.
    #[serde(default)]
    pub start: Start,
    /// What lies between the force in the cable and the log.
    #[serde(default)]
    pub measurement: Measurement,
}

/// Calendar time of the first sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Start {
    /// Year.
    pub year: i32,
    /// Day of the year, 1 to 366.
    pub day: u32,
    /// Hour, 0 to 23.
    pub hour: u32,
    /// Minute, 0 to 59.
    pub minute: u32,
}

impl Default for Start {
    /// One minute before midnight of 9 April 1994, so that a log rolls over.
    fn default() -> Self {
        Self { year: 1994, day: 99, hour: 23, minute: 59 }
    }
}

fn default_duration_s() -> f64 {
    120.0
}

fn default_rate_hz() -> f64 {
    16.0
}

fn default_cable_length_m() -> f64 {
    15.0
}

impl Default for Scene {
    fn default() -> Self {
        Self {
            test_id: None,
            duration_s: default_duration_s(),
            rate_hz: default_rate_hz(),
            weight_n: 630.0,
            mu_s: 1.24,
            mu: 0.78,
            stiffness_n_per_m: 23_000.0,
            winch_m_per_s: 360.0 / 23_000.0,
            cable_length_m: default_cable_length_m(),
            slope_deg: 0.0,
            start_force_n: 0.0,
            start_sliding: false,
            post: false,
            weighing: None,
            snow: None,
            variation: None,
            wander: None,
            partial_slips: None,
            hold_time: None,
            rate_dependence: None,
            stribeck: None,
            rate_and_state: None,
            along_slip: None,
            rocking: None,
            creep: None,
            shortening: false,
            sag: None,
            cable_damping: None,
            winch_profile: None,
            breaking: None,
            tilt: None,
            drag: None,
            start: Start::default(),
            measurement: Measurement::default(),
        }
    }
}

impl Scene {
    /// Slope of the ice, rad.
    #[must_use]
    pub fn slope_rad(&self) -> f64 {
        self.slope_deg.to_radians()
    }

    /// `mu_s` and `mu`, including the effect of snow on the ice.
    #[must_use]
    pub fn coefficients(&self) -> (f64, f64) {
        let (mu_s, mu) = self.snow.map_or((0.0, 0.0), |s| (s.mu_s_offset, s.mu_offset));
        (self.mu_s + mu_s, self.mu + mu)
    }

    /// Number of samples in the record.
    #[must_use]
    pub fn sample_count(&self) -> u32 {
        (self.duration_s * self.rate_hz + 1e-9).floor() as u32
    }

    /// Parses a scene from TOML and checks it.
    ///
    /// # Errors
    /// One line with the fault and its position.
    pub fn from_toml(text: &str) -> Result<Self, SceneError> {
        let scene: Self =
            toml::from_str(text).map_err(|e| SceneError(fault::in_words(&e, text)))?;
        scene.validate()?;
        Ok(scene)
    }
}
