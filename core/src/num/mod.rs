//! Arithmetic: elementary functions, pairs of `f32`.

mod bits;
pub mod double_single;
pub mod math;
