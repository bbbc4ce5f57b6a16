//! How far the force strays from the stick line: how much, how long, and in which shape.

pub mod flop;
mod oscillation;
pub mod ripple;
pub mod scale;
mod time_asymmetry;
