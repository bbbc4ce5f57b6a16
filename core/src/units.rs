//! The two quantities that must never be mixed up: codes and forces.
//!
//! Every other quantity is an `f32` whose name ends in its unit (`_n`, `_s`,
//! `_n_per_s`, `_rad`).

/// A code of the analogue-to-digital converter, signed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Counts(pub i32);

/// A force in the cable, in newtons; tension is positive.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Newtons(pub f32);

/// Standard gravity, m/s²: what turns a weight into a mass, here and in all tools.
pub const STANDARD_GRAVITY_M_PER_S2: f64 = 9.806_65;
