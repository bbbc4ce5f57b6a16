//! What goes into the pipeline, and what a calibrated sample looks like.

use crate::num::math;
use crate::units::{Counts, Newtons};

/// One sample as it comes from a converter or a log.
///
/// The index counts sampling periods from any start. A missing index is a gap:
/// it is never interpolated.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RawSample {
    /// Number of the sampling period, increasing.
    pub index: u32,
    /// What was read in it.
    pub reading: Reading,
}

impl RawSample {
    /// Largest index; samples beyond it count as duplicates. 31 bits: four years at 16 Hz, twelve
    /// days at 2000 Hz.
    pub const LAST_INDEX: u32 = u32::MAX / 2;
}

/// The content of a [`RawSample`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Reading {
    /// A converter code, to be calibrated.
    Counts(Counts),
    /// A force from a log that is already in newtons.
    Force(Newtons),
    /// Nothing usable, and why.
    Bad(Fault),
}

/// Why a reading could not be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Fault {
    /// The log holds a marker for a bad sample (-6999 and its kin, NaN, empty).
    Sentinel,
    /// The converter did not answer in time.
    Timeout,
    /// The converter's code or answer cannot be right.
    Corrupt,
    /// The bridge is not connected.
    Disconnected,
}

/// What the pipeline made of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum SampleFlag {
    /// Used.
    #[default]
    Good,
    /// At the end of the converter's or the cell's range: not a force.
    Saturated,
    /// The reading was [`Reading::Bad`] or not finite.
    Rejected,
    /// A spike: one sample far from both neighbours, faster than a cable can change. The pipeline
    /// never sets this flag, for a spike is known only with the next sample: it is named in
    /// [`crate::Step::spike`], and a caller may flag it then.
    Spike,
    /// The index was there already; the first reading stands.
    Duplicate,
}

/// A sample after calibration.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ForceSample {
    /// Index of the [`RawSample`].
    pub index: u32,
    /// Force, N. `None` unless the flag is [`SampleFlag::Good`].
    pub force_n: Option<f32>,
    /// Whether the sample is used, and if not, why.
    pub flag: SampleFlag,
    /// How many indices are missing right before this one.
    pub gap: u32,
}

/// What the block is doing, according to the samples so far.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Phase {
    /// Not enough samples yet.
    #[default]
    Unknown,
    /// The block rests, the cable is being stretched.
    Stick,
    /// The block moves.
    Slip,
}

/// A moment between samples: an index and a fraction of a period, 0 to below 1.
///
/// Index and fraction are kept apart: after a month of samples the resolution is the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SampleTime {
    /// The sample at or before the moment.
    pub index: u32,
    /// Fraction of a sampling period after it.
    pub fraction: f32,
}

impl SampleTime {
    /// The moment that lies `periods` after an index; before it, if they are negative.
    pub(crate) fn after(origin: u32, periods: f32) -> Self {
        let whole = math::floor(periods);
        Self { index: origin.saturating_add_signed(whole as i32), fraction: periods - whole }
    }

    /// Is this moment before another one? Not inlined: asked a dozen times.
    #[inline(never)]
    pub(crate) fn precedes(self, other: Self) -> bool {
        self < other
    }

    /// Periods from an earlier moment to this one.
    pub(crate) fn periods_since(self, earlier: Self) -> f32 {
        since(earlier.index, self.index) + self.fraction - earlier.fraction
    }
}

/// The force of a sample and its index.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ForcePoint {
    /// Index of the sample.
    pub index: u32,
    /// Its force, N.
    pub force_n: f32,
}

/// Periods from `origin` to `index`, negative if that lies before: indices are below 2^31.
#[inline(always)]
pub(crate) fn periods_between(origin: u32, index: u32) -> i32 {
    index.wrapping_sub(origin).cast_signed()
}

/// Periods from `origin` to `index` as a number, negative if `index` lies before.
#[inline(always)]
pub(crate) fn since(origin: u32, index: u32) -> f32 {
    periods_between(origin, index) as f32
}
