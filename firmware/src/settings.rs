//! The user's settings, and how the log stores them.

use floe_core::{Config, ConfigError, Counts, InputStd};
use heapless::String;

use crate::command::{Quantity, Setting};
use crate::notebook::{Notes, WeightFrom};
use crate::sample::RATE_HZ;

/// Longest name of a test.
pub const NAME_LEN: usize = 16;

/// All settings that are kept from one test to the next.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Configuration of the core.
    pub config: Config,
    /// Name of the test.
    pub name: String<NAME_LEN>,
    /// Which effects the core looks for.
    pub effects: Effects,
    /// Uncertainties of the inputs.
    pub stds: Stds,
    /// Scale that weighed the block.
    pub weight_from: Option<WeightFrom>,
    /// Zero of the load cell before and after the test.
    pub zero: Zero,
    /// Notes on the test.
    pub notes: Notes,
}

/// Sets of effects, one bit each; `None` in a log without them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Effects {
    /// Looked for in this test.
    pub enabled: Option<u32>,
    /// Compiled into the program that measured the test.
    pub compiled: Option<u32>,
}

impl Effects {
    /// From a set of the core, with all effects of this program as `compiled`.
    #[must_use]
    pub fn of(enabled: floe_core::Effects) -> Self {
        let compiled = Some(floe_core::Effects::COMPILED.mask());
        Self { enabled: Some(enabled.mask()), compiled }
    }

    /// Effects for a repetition of the computation: those both enabled and compiled in; an unknown
    /// set counts as all.
    #[must_use]
    pub fn in_use(&self) -> floe_core::Effects {
        let all = floe_core::Effects::COMPILED.mask();
        let (enabled, compiled) = (self.enabled.unwrap_or(all), self.compiled.unwrap_or(all));
        floe_core::Effects::from_mask(enabled & compiled)
    }
}

/// Standard deviation of each input; `None` if not given.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stds {
    /// Of the weight, N.
    pub weight_n: Option<f32>,
    /// Of the slope, rad.
    pub slope_rad: Option<f32>,
    /// Of the zero of the load cell, N.
    pub zero_n: Option<f32>,
    /// Of the span, relative.
    pub span: Option<f32>,
    /// Of the damping ratio of the swing.
    pub damping: Option<f32>,
    /// Of the winch's speed, m/s.
    pub winch_m_per_s: Option<f32>,
}

impl Stds {
    /// All except that of the winch's speed, which a later version of lines and sectors appended.
    pub(crate) fn first(&self) -> [Option<f32>; 5] {
        [self.weight_n, self.slope_rad, self.zero_n, self.span, self.damping]
    }
}

/// Force without a load, N, with the calibration of the test.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Zero {
    /// Before the test.
    pub before_n: Option<f32>,
    /// After the test.
    pub after_n: Option<f32>,
}

impl Default for Settings {
    /// Default for a 5 kN, 2 mV/V cell on a ratiometric 24-bit converter with gain 128.
    // Not inlined: it is large and called in three places.
    #[inline(never)]
    fn default() -> Self {
        let mut config = Config { rate_hz: RATE_HZ, ..Config::default() };
        config.calibration.counts_per_n = 429.5;
        Self {
            config,
            name: String::new(),
            effects: Effects::default(),
            stds: Stds::default(),
            weight_from: None,
            zero: Zero::default(),
            notes: Notes::default(),
        }
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

    /// Largest force of the cell, N, or of the converter if the cell's is unknown.
    #[must_use]
    pub fn range_n(&self) -> f32 {
        let calibration = &self.config.calibration;
        let full_n = calibration.range_counts.1 as f32 / calibration.counts_per_n.abs();
        self.config.range_n.unwrap_or(full_n)
    }

    /// Configuration of the core, including the uncertainties. An error of the span cancels if the
    /// block was weighed with the same cell.
    #[must_use]
    pub fn core_config(&self) -> Config {
        let Stds { weight_n, slope_rad, zero_n, span, damping, winch_m_per_s } = self.stds;
        let usual = InputStd::default();
        let cancels = self.weight_from == Some(WeightFrom::SameCell);
        let winch = winch_m_per_s.zip(self.config.winch_m_per_s).map(|(std, speed)| std / speed);
        let weight = weight_n.map_or(usual.weight, |std| std / self.config.weight_n);
        let std = InputStd {
            weight: if weight.is_finite() { weight } else { usual.weight },
            slope_rad: slope_rad.unwrap_or(usual.slope_rad),
            zero_n: zero_n.or(usual.zero_n),
            span: if cancels { 0.0 } else { span.unwrap_or(usual.span) },
            damping: damping.unwrap_or(usual.damping),
            winch: winch.unwrap_or(usual.winch),
        };
        Config { std, effects: self.effects.in_use(), ..self.config }
    }

    /// A copy with one value changed. The weight may still be missing.
    ///
    /// # Errors
    /// The value is out of its range.
    pub fn with(&self, setting: Setting) -> Result<Self, ConfigError> {
        let mut changed = self.clone();
        match setting {
            Setting::Number(quantity, value) => changed.set_number(quantity, value),
            Setting::Tare(tare_counts) => changed.config.calibration.tare_counts = tare_counts,
            Setting::Name(name) => changed.name = name,
            Setting::Kind(kind) => changed.notes.kind = Some(kind),
            Setting::Track(track) => changed.notes.track = Some(track),
            Setting::Size([length_m, width_m, height_m]) => {
                changed.notes.length_m = known(length_m);
                changed.notes.width_m = known(width_m);
                changed.notes.height_m = known(height_m);
            }
            Setting::Cable(length_m, ae_n) => {
                changed.notes.cable_length_m = known(length_m);
                changed.notes.cable_ae_n = ae_n.and_then(known);
            }
            Setting::WeightFrom(from) => changed.weight_from = Some(from),
            Setting::Effects(effects) => changed.effects = Effects::of(effects),
        }
        changed.check()?;
        changed.core_config().validate_std()?;
        // Settings that the core does not use are checked too, because the card stores them.
        if changed.is_sound() { Ok(changed) } else { Err(ConfigError::Std) }
    }

    fn set_number(&mut self, quantity: Quantity, value: f32) {
        let Self { config, stds, notes, weight_from, .. } = self;
        match quantity {
            // A typed weight comes from another balance, and its uncertainty is not known.
            Quantity::Weight => {
                config.weight_n = value;
                *weight_from = Some(WeightFrom::Other);
                stds.weight_n = None;
            }
            Quantity::Slope => config.slope_rad = value,
            Quantity::Winch => config.winch_m_per_s = known(value),
            Quantity::Range => config.range_n = known(value),
            Quantity::Span => self.set_span(value),
            Quantity::Snow => notes.snow_mm = Some(value),
            Quantity::WeightStd => stds.weight_n = Some(value),
            Quantity::SlopeStd => stds.slope_rad = Some(value),
            Quantity::ZeroStd => stds.zero_n = Some(value),
            Quantity::SpanStd => stds.span = Some(value),
            Quantity::DampingStd => stds.damping = Some(value),
            Quantity::WinchStd => stds.winch_m_per_s = Some(value),
        }
    }

    /// Sets the span. A weight measured with the previous span no longer cancels its error.
    pub(crate) fn set_span(&mut self, counts_per_n: f32) {
        self.config.calibration.counts_per_n = counts_per_n;
        self.weight_from = Some(WeightFrom::Other);
    }

    /// Checks the configuration by the core's rules; the weight may still be missing.
    pub(crate) fn check(&self) -> Result<(), ConfigError> {
        let mut complete = self.config;
        if complete.weight_n == 0.0 {
            complete.weight_n = 1.0;
        }
        complete.validate()
    }

    /// Whether a logger could have written these settings: data from a card must satisfy the same
    /// rules as data from the console.
    #[must_use]
    #[inline(never)]
    pub fn is_sound(&self) -> bool {
        let zeros = [self.zero.before_n, self.zero.after_n];
        self.check().is_ok()
            && self.name.bytes().all(fits_name)
            && are_sizes(&self.stds.first())
            && are_sizes(&[self.stds.winch_m_per_s])
            && are_sizes(&self.notes.lengths())
            && are_sizes(&zeros.map(|zero| zero.map(f32::abs)))
    }
}

/// `None` for 0, which is typed for an unknown value.
fn known(value: f32) -> Option<f32> {
    (value != 0.0).then_some(value)
}

/// Whether all known values are finite and not negative.
#[inline(never)]
fn are_sizes(values: &[Option<f32>]) -> bool {
    values.iter().flatten().all(|value| (0.0..f32::INFINITY).contains(value))
}

/// Whether a byte may occur in a name, which is written to a field of a line and, with `_` for a
/// space, to a file name.
#[must_use]
pub fn fits_name(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || matches!(byte, b'-' | b'_' | b'.' | b' ')
}
