//! Configuration of the pipeline, in SI units, and the values that are refused.

use core::fmt;

use crate::effect::Effects;
use crate::units::STANDARD_GRAVITY_M_PER_S2;

/// Converter codes to newtons.
///
/// `force = (counts − tare_counts) / counts_per_n`, whose sign is that of the polarity. The
/// difference is taken in integers, so a large tare costs no precision.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Calibration {
    /// Code at zero force.
    pub tare_counts: i32,
    /// Codes per newton; negative when the cell is wired the other way round.
    pub counts_per_n: f32,
    /// Lowest and highest code of the converter: at or beyond them the reading
    /// is saturated.
    pub range_counts: (i32, i32),
}

impl Default for Calibration {
    /// One code per newton on a 24-bit converter.
    fn default() -> Self {
        Self { tare_counts: 0, counts_per_n: 1.0, range_counts: (-(1 << 23), (1 << 23) - 1) }
    }
}

/// Standard deviations of the configured inputs; 0 means exactly known.
///
/// They are in every combined uncertainty, never in the random one ([`crate::budget()`]).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct InputStd {
    /// Of the weight, relative. Default 0.3 %.
    pub weight: f32,
    /// Of the slope, rad. Default 0.2°.
    pub slope_rad: f32,
    /// Of the zero, N; `None`: 0.1 % of the largest force.
    pub zero_n: Option<f32>,
    /// Of the span of the load cell, relative. Default 0.1 %. 0 where the block was weighed with
    /// the same cell: a wrong span then changes force and weight by the same factor.
    pub span: f32,
    /// Of the damping ratio of the cable (critical damping is 1): half-normal, from 0 up. No
    /// coefficient is corrected for it. Default 0.5 %.
    pub damping: f32,
    /// Of the winch speed, relative. Default 1 %.
    pub winch: f32,
}

impl Default for InputStd {
    /// For weight, slope and load cell determined with ordinary care.
    fn default() -> Self {
        Self {
            weight: 0.003,
            slope_rad: 0.003_490_659,
            zero_n: None,
            span: 0.001,
            damping: 0.005,
            winch: 0.01,
        }
    }
}

impl InputStd {
    /// Everything is exactly known.
    pub const EXACT: Self = Self {
        weight: 0.0,
        slope_rad: 0.0,
        zero_n: Some(0.0),
        span: 0.0,
        damping: 0.0,
        winch: 0.0,
    };

    /// Largest damping ratio that counts: beyond it no cable swings, and nothing is known.
    pub const MOST_DAMPING: f32 = 0.3;

    /// Standard deviation of the zero, N: as stated, else 0.1 % of the largest force.
    pub(crate) fn zero_n(&self, largest_n: f32) -> f32 {
        const PART: f32 = 1e-3;
        self.zero_n.unwrap_or(PART * largest_n)
    }

    /// Is every one a finite number at or above zero?
    fn are_valid(&self) -> bool {
        let Self { weight, slope_rad, zero_n, span, damping, winch } = *self;
        let all = [weight, slope_rad, zero_n.unwrap_or(0.0), span, damping, winch];
        all.into_iter().all(is_at_least_zero)
    }
}

/// Configuration of the pipeline.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Config {
    /// Samples per second, 1 to 2000. Default 16.
    pub rate_hz: f32,
    /// Weight of the block, N, above zero.
    pub weight_n: f32,
    /// Mass of the block, kg, above zero, where it is not the weight over gravity: a block pulled
    /// along the underside of the ice is pressed on by its buoyancy.
    pub mass_kg: Option<f32>,
    /// Slope of the ice along the pull, rad, uphill positive, within ±1.2.
    pub slope_rad: f32,
    /// Take-up speed of the winch, m/s, if known: gives the stiffness.
    pub winch_m_per_s: Option<f32>,
    /// Largest force of the load cell, N: beyond it a sample is saturated.
    pub range_n: Option<f32>,
    /// For readings in counts.
    pub calibration: Calibration,
    /// What to look for beyond the linear model.
    pub effects: Effects,
    /// Standard deviations of these inputs.
    pub std: InputStd,
}

impl Default for Config {
    /// 16 Hz on level ice; the weight is left at zero and must be set.
    fn default() -> Self {
        Self {
            rate_hz: 16.0,
            weight_n: 0.0,
            mass_kg: None,
            slope_rad: 0.0,
            winch_m_per_s: None,
            range_n: None,
            calibration: Calibration::default(),
            effects: Effects::default(),
            std: InputStd::default(),
        }
    }
}

/// Which configuration value was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ConfigError {
    /// `rate_hz` is not within 1 to 2000.
    Rate,
    /// `weight_n`, or `mass_kg`, is not a finite number above zero.
    Weight,
    /// `slope_rad` is not within ±1.2.
    Slope,
    /// `winch_m_per_s` is not a finite number above zero.
    Winch,
    /// `range_n` is not a finite number above zero.
    Range,
    /// `calibration` has a span of zero, or an empty range.
    Calibration,
    /// A standard deviation in `std` is not a finite number at or above zero.
    Std,
}

impl fmt::Display for ConfigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Rate => "the sample rate must be 1 to 2000 Hz",
            Self::Weight => "the weight must be a number above zero",
            Self::Slope => "the slope must be within ±1.2 rad (±68°)",
            Self::Winch => "the winch speed must be a number above zero",
            Self::Range => "the load cell's range must be a number above zero",
            Self::Calibration => "the calibration needs a span that is not zero and a range",
            Self::Std => "a standard deviation must be a number at or above zero",
        })
    }
}

impl core::error::Error for ConfigError {}

/// Is a number finite and not below zero? Not inlined: asked a dozen times.
#[inline(never)]
fn is_at_least_zero(x: f32) -> bool {
    (0.0..f32::INFINITY).contains(&x)
}

impl Config {
    /// Steepest slope of the ice, rad: 68.7°, where a third of the weight (`cos α` = .36) still
    /// presses on it.
    pub const STEEPEST_RAD: f32 = 1.2;

    /// Checks every value.
    ///
    /// # Errors
    /// The first value that is out of its range.
    pub fn validate(&self) -> Result<(), ConfigError> {
        let positive = |x: f32| x > 0.0 && is_at_least_zero(x);
        let check = |ok: bool, error| if ok { Ok(()) } else { Err(error) };
        check((1.0..=2000.0).contains(&self.rate_hz), ConfigError::Rate)?;
        check(positive(self.weight_n), ConfigError::Weight)?;
        check(self.mass_kg.is_none_or(positive), ConfigError::Weight)?;
        check(self.slope_rad.abs() <= Self::STEEPEST_RAD, ConfigError::Slope)?;
        check(self.winch_m_per_s.is_none_or(positive), ConfigError::Winch)?;
        check(self.range_n.is_none_or(positive), ConfigError::Range)?;
        let calibration = &self.calibration;
        let span = calibration.counts_per_n;
        let range = calibration.range_counts;
        check(span.is_finite() && span != 0.0 && range.0 < range.1, ConfigError::Calibration)?;
        self.validate_std()
    }

    /// Mass of the block, kg.
    pub(crate) fn mass_kg(&self) -> f32 {
        self.mass_kg.unwrap_or(self.weight_n / STANDARD_GRAVITY_M_PER_S2 as f32)
    }

    /// Checks the standard deviations alone.
    ///
    /// # Errors
    /// One is not a finite number at or above zero.
    pub fn validate_std(&self) -> Result<(), ConfigError> {
        if self.std.are_valid() { Ok(()) } else { Err(ConfigError::Std) }
    }
}
