//! The elementary functions of each library and the arguments at which they are compared.
//!
//! This file is also compiled for the PC (`tests/support/maths.rs`), so that PC and board measure
//! identical source.
#![allow(clippy::disallowed_types, clippy::disallowed_methods, reason = "measured, not used")]

use core::fmt;

use floe_core::num::math;
use micromath::F32Ext;

use super::hardware;

/// One library's version of an elementary function.
#[derive(Clone, Copy, Debug)]
pub struct Function {
    /// Name in mathematics; `rough_sqrt` is a square root for limits.
    pub name: &'static str,
    /// Name of the library.
    pub library: &'static str,
    /// Smallest and largest argument in Floe.
    pub range: (f32, f32),
    /// The function.
    pub call: fn(f32) -> f32,
}

/// Range of variances of forces, N², and of their ratios.
const SQUARES: (f32, f32) = (1e-12, 1e12);
/// Range of `ω` times a time within a slip, and of slopes, rad: one turn in both directions.
const ANGLES: (f32, f32) = (-6.3, 6.3);
/// Range of `k w / (ω d)`: from nearly no winch speed to nearly no drop.
const RATIOS: (f32, f32) = (1e-6, 1e9);
/// Range of logarithms of likelihood ratios: the smallest normal number, and the cut-off.
const LOG_RATIOS: (f32, f32) = (-87.0, 7.0);

/// All functions compared; those of the core are listed under the library that implements them.
pub const FUNCTIONS: [Function; 23] = [
    new("sqrt", "floe", SQUARES, math::sqrt),
    new("sqrt", "libm", SQUARES, libm::sqrtf),
    new("sqrt", "micromath", SQUARES, F32Ext::sqrt),
    new("sqrt", "hardware", SQUARES, hardware::sqrt),
    new("rough_sqrt", "micromath", SQUARES, math::rough_sqrt),
    new("sin", "floe", ANGLES, |x| math::sin_cos(x).0),
    new("sin", "libm", ANGLES, |x| libm::sincosf(x).0),
    new("sin", "micromath", ANGLES, F32Ext::sin),
    new("cos", "floe", ANGLES, |x| math::sin_cos(x).1),
    new("cos", "libm", ANGLES, |x| libm::sincosf(x).1),
    new("cos", "micromath", ANGLES, F32Ext::cos),
    new("atan2", "floe", RATIOS, |x| math::atan2(x, 1.0)),
    new("atan2", "libm", RATIOS, |x| libm::atan2f(x, 1.0)),
    new("atan2", "micromath", RATIOS, |x| F32Ext::atan2(x, 1.0)),
    new("acos", "floe", (-1.0, 1.0), math::acos),
    new("acos", "libm", (-1.0, 1.0), libm::acosf),
    new("acos", "micromath", (-1.0, 1.0), F32Ext::acos),
    new("exp", "floe", LOG_RATIOS, math::exp),
    new("exp", "libm", LOG_RATIOS, libm::expf),
    new("exp", "micromath", LOG_RATIOS, F32Ext::exp),
    new("ln", "floe", SQUARES, math::ln),
    new("ln", "libm", SQUARES, libm::logf),
    new("ln", "micromath", SQUARES, F32Ext::ln),
];

/// Function without effect; its count is the overhead of a call.
pub const EMPTY: Function = new("empty", "none", (0.0, 1.0), |x| x);

const fn new(
    name: &'static str,
    library: &'static str,
    range: (f32, f32),
    call: fn(f32) -> f32,
) -> Function {
    Function { name, library, range, call }
}

impl Function {
    /// Argument number `i` of `0..=last`: equally spaced or, over decades, in equal steps of the
    /// number's bits. Single precision only, so that PC and board compute the same values.
    #[must_use]
    pub fn argument(&self, i: u32, last: u32) -> f32 {
        let (from, to) = self.range;
        if from <= 0.0 {
            return (from + (to - from) * (i as f32 / last as f32)).clamp(from, to);
        }
        let steps = u64::from(to.to_bits() - from.to_bits());
        f32::from_bits(from.to_bits() + (steps * u64::from(i) / u64::from(last)) as u32)
    }

    /// FNV-1a hash over the bits of 4096 results.
    #[must_use]
    pub fn hash(&self) -> u32 {
        let bytes = (0..4096).flat_map(|i| (self.call)(self.argument(i, 4095)).to_le_bytes());
        bytes.fold(0x811C_9DC5, |hash, byte| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193))
    }
}

impl fmt::Display for Function {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.name, self.library)
    }
}
