//! What the user sets, and what the log remembers for him.

use floe_core::{Config, ConfigError, Counts};
use heapless::String;

use crate::command::Setting;
use crate::sample::RATE_HZ;

/// Longest name of a test.
pub const NAME_LEN: usize = 16;

/// Everything that outlives a test.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// What the core is told.
    pub config: Config,
    /// Name of the test.
    pub name: String<NAME_LEN>,
}

impl Default for Settings {
    /// A 5 kN, 2 mV/V cell on a ratiometric 24-bit converter with gain 128.
    fn default() -> Self {
        let mut config = Config { rate_hz: RATE_HZ, ..Config::default() };
        config.calibration.counts_per_n = 429.5;
        Self { config, name: String::new() }
    }
}

impl Settings {
    /// Force of a code, N, for the display when no test is running.
    #[must_use]
    pub fn force_n(&self, code: Counts) -> f32 {
        let calibration = &self.config.calibration;
        let counts = code.0.saturating_sub(calibration.tare_counts);
        counts as f32 / calibration.counts_per_n
    }

    /// With one value changed. The weight may still be missing.
    ///
    /// # Errors
    /// The value is out of its range.
    pub fn with(&self, setting: Setting) -> Result<Self, ConfigError> {
        let mut changed = self.clone();
        let config = &mut changed.config;
        let known = |value: f32| (value != 0.0).then_some(value);
        match setting {
            Setting::Weight(weight_n) => config.weight_n = weight_n,
            Setting::Slope(slope_rad) => config.slope_rad = slope_rad,
            Setting::Winch(winch_m_per_s) => config.winch_m_per_s = known(winch_m_per_s),
            Setting::Range(range_n) => config.range_n = known(range_n),
            Setting::Span(counts_per_n) => config.calibration.counts_per_n = counts_per_n,
            Setting::Tare(tare_counts) => config.calibration.tare_counts = tare_counts,
            Setting::Name(name) => changed.name = name,
        }
        let mut complete = changed.config;
        if complete.weight_n == 0.0 {
            complete.weight_n = 1.0;
        }
        complete.validate()?;
        Ok(changed)
    }
}
