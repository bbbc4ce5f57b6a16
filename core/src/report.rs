//! The result so far, for a display, a log or a host tool.

use crate::coefficient::Estimate;
use crate::effect::Effects;
use crate::effects::level_shift::Change;
use crate::stats::quantity::Quantity;

/// What happened to the samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Counters {
    /// Samples seen, good or bad, without duplicates.
    pub samples: u32,
    /// Indices that never came.
    pub missing: u32,
    /// Indices that came again.
    pub duplicates: u32,
    /// Bad readings and spikes.
    pub rejected: u32,
    /// Readings at the end of the range.
    pub saturated: u32,
}

/// The result so far.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
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
    /// Natural frequency while sliding, rad/s; unknown while its standard deviation is a third of
    /// it or more.
    pub omega_rad_per_s: Option<Quantity>,
    /// Stiffness of the cable, N/m: from the winch speed if given, else from
    /// omega and the mass.
    pub stiffness_n_per_m: Option<f32>,
    /// Mean time from onset to onset, s, where no gap and no stretch without an event lies between
    /// them.
    pub recurrence_s: Option<f32>,
    /// Standard deviation of the drift of the load cell's zero, N; it is in the budget. `None`
    /// where that is no more than the noise.
    pub zero_n: Option<f32>,
    /// The budget's standard deviation of the zero as it was taken, N.
    pub zero_std_n: f32,
    /// Standard deviation of the means due to the drift of the zero, N.
    pub zero_drift_n: f32,
    /// Standard deviation of the damping ratio: the stated one, widened by what the events show.
    pub damping_std: f32,
    /// Weight in use over the given one; 1 where the block did not change.
    pub weight_ratio: f32,
    /// Relative standard deviation of that ratio, averaged over the events as the means are; 0
    /// where the block did not change.
    pub weight_ratio_std: f32,
    /// The newest change, with the ratio of the weights as it is known now.
    pub change: Option<Change>,
    /// The effects that the data show.
    pub found: Effects,
}
