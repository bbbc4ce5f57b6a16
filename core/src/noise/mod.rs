//! How far the force strays from the stick line: how much, how long, and in which shape.

pub(crate) mod flop;
mod oscillation;
pub(crate) mod ripple;
pub(crate) mod scale;
pub(crate) mod sinusoid;
mod time_asymmetry;
