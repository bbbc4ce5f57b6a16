//! Departures of the force from the stick line: their scale, their correlation and their course.

pub(crate) mod flop;
mod oscillation;
pub(crate) mod ripple;
pub(crate) mod scale;
pub(crate) mod sinusoid;
mod time_asymmetry;
