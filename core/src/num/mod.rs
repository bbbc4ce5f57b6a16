//! Arithmetic: elementary functions, pairs of `f32`, division without the library's.

mod bits;
pub mod double_single;
pub mod long_division;
pub mod math;
