//! What the user sets, and what the log remembers for him.

use floe_core::{Config, ConfigError, Counts, InputStd};
use heapless::String;

use crate::command::{Quantity, Setting};
use crate::notebook::{Notes, WeightFrom};
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
    /// Which effects the core looks for.
    pub effects: Effects,
    /// How well the inputs are known.
    pub stds: Stds,
    /// What weighed the block.
    pub weight_from: Option<WeightFrom>,
    /// The zero of the load cell, measured around the test.
    pub zero: Zero,
    /// The notebook.
    pub notes: Notes,
}

/// Sets of effects, one bit each; `None` in a log that does not say.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Effects {
    /// Looked for in this test.
    pub enabled: Option<u32>,
    /// Compiled into the program that measured it.
    pub compiled: Option<u32>,
}

impl Effects {
    /// As a computation has them.
    #[must_use]
    pub fn of(enabled: floe_core::Effects) -> Self {
        let compiled = Some(floe_core::Effects::COMPILED.mask());
        Self { enabled: Some(enabled.mask()), compiled }
    }

    /// For a computation that is to give the same again: those that were looked for and were
    /// there; all, if nobody said.
    #[must_use]
    pub fn in_use(&self) -> floe_core::Effects {
        let all = floe_core::Effects::COMPILED.mask();
        let (enabled, compiled) = (self.enabled.unwrap_or(all), self.compiled.unwrap_or(all));
        floe_core::Effects::from_mask(enabled & compiled)
    }
}

/// One standard deviation of each input; `None` where nobody said.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stds {
    /// Of the weight, N.
    pub weight_n: Option<f32>,
    /// Of the slope, rad.
    pub slope_rad: Option<f32>,
    /// Of the zero of the load cell, N.
    pub zero_n: Option<f32>,
    /// Of the span, as a part of it.
    pub span: Option<f32>,
    /// Of the damping ratio of the swing.
    pub damping: Option<f32>,
    /// Of the winch's speed, m/s.
    pub winch_m_per_s: Option<f32>,
}

impl Stds {
    /// The winch's came with a later version of lines and sectors, and stands at their end.
    pub(crate) fn first(&self) -> [Option<f32>; 5] {
        [self.weight_n, self.slope_rad, self.zero_n, self.span, self.damping]
    }
}

/// Force without a load, N, by the calibration of the test.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Zero {
    /// Before the test.
    pub before_n: Option<f32>,
    /// After it.
    pub after_n: Option<f32>,
}

impl Default for Settings {
    /// A 5 kN, 2 mV/V cell on a ratiometric 24-bit converter with gain 128.
    // Made in three places, and much of it.
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

    /// Largest force of the cell, or of the converter if the cell's is not known, N.
    #[must_use]
    pub fn range_n(&self) -> f32 {
        let calibration = &self.config.calibration;
        let full_n = calibration.range_counts.1 as f32 / calibration.counts_per_n.abs();
        self.config.range_n.unwrap_or(full_n)
    }

    /// What the core is told: the configuration, and how well it is known. A span that is
    /// wrong cancels where the block was weighed with the same cell.
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

    /// With one value changed. The weight may still be missing.
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
        // Also what the core is not told of these settings: the card keeps it.
        if changed.is_sound() { Ok(changed) } else { Err(ConfigError::Std) }
    }

    fn set_number(&mut self, quantity: Quantity, value: f32) {
        let Self { config, stds, notes, weight_from, .. } = self;
        match quantity {
            // Said by somebody who has another balance, and no std with it.
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

    /// What the cell has weighed, it has weighed by another span: that does not cancel any more.
    pub(crate) fn set_span(&mut self, counts_per_n: f32) {
        self.config.calibration.counts_per_n = counts_per_n;
        self.weight_from = Some(WeightFrom::Other);
    }

    /// What the core will refuse; the weight may still be missing.
    pub(crate) fn check(&self) -> Result<(), ConfigError> {
        let mut complete = self.config;
        if complete.weight_n == 0.0 {
            complete.weight_n = 1.0;
        }
        complete.validate()
    }

    /// Whether a logger could have written this: what comes from a card is held to
    /// the same as what comes from the console.
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

/// What is typed as 0 when it is unknown.
fn known(value: f32) -> Option<f32> {
    (value != 0.0).then_some(value)
}

/// Whether all that are known are numbers not below zero.
#[inline(never)]
fn are_sizes(values: &[Option<f32>]) -> bool {
    values.iter().flatten().all(|value| (0.0..f32::INFINITY).contains(value))
}

/// Whether a letter can stand in a name: in a line's field and, a space as `_`, in a
/// file's name.
#[must_use]
pub fn fits_name(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || matches!(byte, b'-' | b'_' | b'.' | b' ')
}
