//! How far the force strays from the stick line: how much, how long, and in which shape.

pub mod flop;
pub mod ripple;
pub mod scale;
mod swing;
mod time_asymmetry;
