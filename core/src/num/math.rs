//! The only module with elementary functions.
//!
//! One source must give the same bits on the board and on a PC, so every function names its
//! implementation. `docs/maths.md` compares the candidates: largest error over the range that Floe
//! uses, what its use tolerates, and the cost on a PC and on the board; `cargo xtask maths`
//! measures it, `tests/maths.rs` holds it.
//!
//! | function | implementation | largest error |
//! |---|---|---|
//! | [`sqrt`] | libm, on the board here | 0.5 ulp (correctly rounded) |
//! | [`sin_cos`] | here | 7.7e-8, up to one turn |
//! | [`atan2`] | here | 1.5 ulp |
//! | [`acos`] | from root and [`atan2`] | 2 ulp |
//! | [`exp`] | here | 2 ulp |
//! | [`ln`] | here | 2 ulp |
//! | [`rough_sqrt`] | micromath | 6.1 % relative: for detection limits only |
#![allow(
    clippy::disallowed_methods,
    clippy::disallowed_types,
    reason = "this is the one place that may call them"
)]

use micromath::F32Ext;

use crate::num::bits;

/// Square root, correctly rounded; NaN below zero.
///
/// libm takes a PC's instruction for it; stable Rust without std does not reach the board's, so
/// there it is computed from the bits. Both are correctly rounded and give the same bits.
#[must_use]
pub fn sqrt(x: f32) -> f32 {
    #[cfg(target_arch = "arm")]
    return bits::sqrt(x);
    #[cfg(not(target_arch = "arm"))]
    libm::sqrtf(x)
}

/// Root of the sum of two squares.
#[must_use]
pub fn hypotenuse(a: f32, b: f32) -> f32 {
    sqrt(a * a + b * b)
}

/// Sine and cosine of an angle of a few turns at most, rad.
///
/// Single precision throughout: libm's computes in double precision, which the board
/// does in software, at forty times the price. The polynomials are the minimax ones
/// on ±π/4, for `sin x / x` and `cos x`, in `x²`.
// Not inlined: it is small enough to be copied into other crates as well.
#[inline(never)]
#[must_use]
pub fn sin_cos(x_rad: f32) -> (f32, f32) {
    // π/2 in two parts, the first so short that its small multiples are exact.
    const HALF_PI: (f32, f32) = (1.570_312_5, 4.838_268e-4);
    let quarters = x_rad * core::f32::consts::FRAC_2_PI;
    let nearest = (quarters + 0.5_f32.copysign(quarters)) as i32;
    let whole = nearest as f32;
    let x = (x_rad - whole * HALF_PI.0) - whole * HALF_PI.1;
    let x2 = x * x;
    let sin = x - x * x2 * (0.166_666_55 - x2 * (0.008_332_178 - x2 * 1.951_723_5e-4));
    let tail = 0.041_666_646 - x2 * (0.001_388_736_7 - x2 * 2.443_838_1e-5);
    let cos = 1.0 - (0.5 * x2 - x2 * x2 * tail);
    match nearest & 3 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// Angle of the point (x, y), −π to π rad; 0 at the origin.
///
/// An odd polynomial up to an eighth of a turn, the minimax one; the rest by symmetry.
#[must_use]
pub fn atan2(y: f32, x: f32) -> f32 {
    use core::f32::consts::{FRAC_PI_2, PI};
    let (along, across) = (x.abs(), y.abs());
    let is_steep = across > along;
    let (small, large) = if is_steep { (along, across) } else { (across, along) };
    let z = if large > 0.0 { small / large } else { 0.0 };
    let z2 = z * z;
    // In independent pairs, which a processor can overlap.
    let z4 = z2 * z2;
    let pairs = [
        0.333_329_86 - 0.199_903_65 * z2,
        0.141_857_27 - 0.105_729_73 * z2,
        0.073_646_96 - 0.041_098_498 * z2,
        0.015_118_379 - 0.002_618_756_6 * z2,
    ];
    let tail = pairs[0] + z4 * (pairs[1] + z4 * (pairs[2] + z4 * pairs[3]));
    let mut angle = z - z * z2 * tail;
    if is_steep {
        angle = FRAC_PI_2 - angle;
    }
    if x < 0.0 {
        angle = PI - angle;
    }
    if y < 0.0 { -angle } else { angle }
}

/// Arc cosine, 0 to π rad; the argument is limited to ±1.
#[must_use]
pub fn acos(x: f32) -> f32 {
    let x = x.clamp(-1.0, 1.0);
    atan2(sqrt((1.0 - x) * (1.0 + x)), x)
}

/// Arc sine, −π/2 to π/2 rad; the argument is limited to ±1.
#[must_use]
pub fn asin(x: f32) -> f32 {
    core::f32::consts::FRAC_PI_2 - acos(x)
}

/// Exponential function.
#[must_use]
pub fn exp(x: f32) -> f32 {
    bits::exp(x)
}

/// Natural logarithm.
#[must_use]
pub fn ln(x: f32) -> f32 {
    bits::log(x)
}

/// The largest whole number that is not above a number within ±2³¹.
#[must_use]
#[inline(never)]
pub fn floor(x: f32) -> f32 {
    let whole = x as i32 as f32;
    if whole > x { whole - 1.0 } else { whole }
}

/// The larger one of two numbers.
///
/// One comparison, on the path of every sample, where `f32::max` also treats NaN.
#[must_use]
pub fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The smaller one of two numbers, see [`larger`].
#[must_use]
pub fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// Square root up to 6 % too large: a bit trick in a tenth of the time.
///
/// For limits that are themselves rough ('six sigma'), never for a result.
#[must_use]
pub fn rough_sqrt(x: f32) -> f32 {
    F32Ext::sqrt(x)
}
