//! The only home of elementary functions.
//!
//! The same source must give the same bits on the board and on a PC, so every
//! function names its implementation. `docs/maths.md` compares the candidates: largest
//! error over the range that Floe uses, what its use can bear, and the cost on a PC
//! and on the board; `cargo xtask maths` measures it, `tests/maths.rs` holds it.
//!
//! | function | implementation | largest error |
//! |---|---|---|
//! | [`sqrt`] | libm | 0.5 ulp (correctly rounded) |
//! | [`sin_cos`] | libm | 1 ulp |
//! | [`atan2`] | libm | 1.5 ulp |
//! | [`acos`] | libm | 2 ulp |
//! | [`exp`] | libm | 1 ulp |
//! | [`rough_sqrt`] | micromath | 6.1 % relative: for detection limits only |
#![allow(
    clippy::disallowed_methods,
    clippy::disallowed_types,
    reason = "this is the one place that may call them"
)]

use micromath::F32Ext;

/// Square root, correctly rounded; NaN below zero.
#[must_use]
pub fn sqrt(x: f32) -> f32 {
    libm::sqrtf(x)
}

/// Sine and cosine of an angle in radians.
#[must_use]
pub fn sin_cos(x_rad: f32) -> (f32, f32) {
    libm::sincosf(x_rad)
}

/// Angle of the point (x, y), −π to π rad.
#[must_use]
pub fn atan2(y: f32, x: f32) -> f32 {
    libm::atan2f(y, x)
}

/// Arc cosine, 0 to π rad; the argument is limited to ±1.
#[must_use]
pub fn acos(x: f32) -> f32 {
    libm::acosf(x.clamp(-1.0, 1.0))
}

/// Exponential function.
#[must_use]
pub fn exp(x: f32) -> f32 {
    libm::expf(x)
}

/// Square root up to 6 % too large: a bit trick in a tenth of the time.
///
/// For limits that are themselves rough ('six sigma'), never for a result.
#[must_use]
pub fn rough_sqrt(x: f32) -> f32 {
    F32Ext::sqrt(x)
}
