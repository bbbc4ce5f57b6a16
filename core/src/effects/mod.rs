//! What makes an event depart from line, ellipse, line, and what changes between events.

pub mod corner;
pub(crate) mod damping;
pub mod level_shift;
pub mod mass_change;
pub(crate) mod sag;
pub(crate) mod zero_drift;
