//! The result so far, for a display, a log or a host tool.

use crate::budget::t95;
use crate::change::Change;
use crate::math;

/// Mean of a coefficient over the events of a test.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Estimate {
    /// Mean.
    pub mean: f32,
    /// Standard error of the mean, the random part alone, including the variation between
    /// events. One event tells nothing of that variation: `None`.
    pub std_error: Option<f32>,
    /// Degrees of freedom of `std_error`.
    pub freedom: f32,
    /// Standard deviation of what is the same in all events, which no number of them
    /// averages out ([`crate::budget`]).
    pub systematic_std: f32,
    /// Part of it that the events share beyond the inputs: what the model learns from them.
    pub common_std: f32,
    /// Standard deviation between events, noise removed; needs two events.
    pub spread: Option<f32>,
    /// How many events count.
    pub events: u32,
}

impl Estimate {
    /// One standard deviation of all; `None` with one event.
    #[must_use]
    pub fn combined_std(&self) -> Option<f32> {
        self.std_error.map(|random| math::hypotenuse(random, self.systematic_std))
    }

    /// The 95 % interval by Student's t, the degrees of freedom by Welch and Satterthwaite:
    /// those of the inputs are endless. `None` with one event.
    #[must_use]
    pub fn ci95(&self) -> Option<(f32, f32)> {
        let (random, combined) = self.std_error.zip(self.combined_std())?;
        let ratio = combined / math::larger(random, 1e-3 * combined);
        let half = t95(self.freedom * ratio * ratio * ratio * ratio) * combined;
        Some((self.mean - half, self.mean + half))
    }
}

/// A number with its standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Quantity {
    /// The number.
    pub value: f32,
    /// One standard deviation.
    pub std: f32,
}

impl Quantity {
    /// In another unit.
    #[must_use]
    pub fn times(self, factor: f32) -> Self {
        Self { value: factor * self.value, std: factor.abs() * self.std }
    }
}

/// What happened to the samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Counters {
    /// Samples seen, good or bad, without duplicates.
    pub samples: u64,
    /// Indices that never came.
    pub missing: u64,
    /// Indices that came again.
    pub duplicates: u64,
    /// Bad readings and spikes.
    pub rejected: u64,
    /// Readings at the end of the range.
    pub saturated: u64,
}

/// The result so far.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Report {
    /// What happened to the samples.
    pub counters: Counters,
    /// Events found, with or without coefficients.
    pub events: u32,
    /// Static coefficient; `None` before the first event.
    pub mu_s: Option<Estimate>,
    /// Dynamic coefficient; `None` before the first event.
    pub mu: Option<Estimate>,
    /// Standard deviation of the noise on the force, N.
    pub noise_n: Option<f32>,
    /// Mean rate of the force at rest, N/s.
    pub loading_rate_n_per_s: Option<Quantity>,
    /// Natural frequency while sliding, rad/s; unknown where it is not known to a third.
    pub omega_rad_per_s: Option<Quantity>,
    /// Stiffness of the cable, N/m: from the winch speed if given, else from
    /// omega and the mass.
    pub stiffness_n_per_m: Option<f32>,
    /// Mean time from onset to onset, s.
    pub recurrence_s: Option<f32>,
    /// How far the zero of the load cell may have moved, one standard deviation, N: it is
    /// in the budget. Where it may have moved beyond the noise only.
    pub zero_n: Option<f32>,
    /// The budget's standard deviation of the zero as it was taken, N.
    pub zero_std_n: f32,
    /// What the drift of the zero leaves in the means, one standard deviation, N.
    pub zero_drift_n: f32,
    /// Weight in use over the given one, and what its relative standard deviation leaves in
    /// the means: 1 and 0 where the block did not change.
    pub weight_ratio: f32,
    /// See [`Report::weight_ratio`].
    pub weight_ratio_std: f32,
    /// The newest change, with the ratio of the weights as it is known now.
    pub change: Option<Change>,
}
