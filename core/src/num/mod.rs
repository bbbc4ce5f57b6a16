//! Arithmetic: elementary functions, pairs of `f32`, division without the library's.

pub mod double_single;
pub mod long_division;
pub mod math;
