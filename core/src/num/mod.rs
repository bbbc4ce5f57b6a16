//! Arithmetic: elementary functions, pairs of `f32`.

mod bits;
pub(crate) mod double_single;
pub mod math;
