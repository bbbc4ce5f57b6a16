//! Elementary functions made from the bits of a number: half the size and time of libm's.
//!
//! The coefficients are the minimax ones on the interval that is left when the exponent is taken
//! off. In double precision (the twin that the tests make of this crate) libm's stand in for them.

const ONE: u32 = 0x3F80_0000;
/// Bits of the mantissa.
const MANTISSA: u32 = 23;

/// Square root, correctly rounded, for normal numbers; else about right.
///
/// A guess from half the exponent, wrong by 3.5 % at most, three steps of Newton's, and the last
/// bit from an exact difference in integers: the result is that of a processor's own instruction.
#[cfg(any(test, target_arch = "arm"))]
pub(super) fn sqrt(x: f32) -> f32 {
    // Half the exponent's bias, less what makes the guess 3.5 % too large or too small at worst.
    const HALF: u32 = 0x1FBD_1DF5;
    const LEAST: u32 = 1 << MANTISSA;
    const ENDLESS: u32 = 0xFF << MANTISSA;
    // True also for NaN and below zero.
    if x.to_bits().wrapping_sub(LEAST) >= ENDLESS - LEAST {
        return unusual_root(x);
    }
    let mut y = f32::from_bits((x.to_bits() >> 1) + HALF);
    for _ in 0..3 {
        y = 0.5 * (y + x / y);
    }
    // With x = X·2^e and y = Y·2^f, X and Y of 24 bits, x/2^2f − Y² is small: its low bits suffice.
    let whole = |bits: u32| bits & ((1 << MANTISSA) - 1) | 1 << MANTISSA;
    let (square, root) = (x.to_bits(), y.to_bits());
    let shift = ((square >> MANTISSA) + 150).wrapping_sub(root >> MANTISSA << 1);
    let half = whole(root);
    let off = whole(square).wrapping_shl(shift).wrapping_sub(half.wrapping_mul(half));
    let (off, half) = (off.cast_signed(), half.cast_signed());
    // Below a power of two the next number is half as far.
    let below = if half == 1 << MANTISSA { half >> 1 } else { half };
    let more = u32::from(off > half).wrapping_sub(u32::from(off <= -below));
    f32::from_bits(root.wrapping_add(more))
}

/// Root of zero, negative numbers, infinity, NaN and subnormal numbers.
#[cfg(any(test, target_arch = "arm"))]
#[inline(always)]
fn unusual_root(x: f32) -> f32 {
    if x == 0.0 {
        x
    } else if x < 0.0 {
        f32::NAN
    } else if x < f32::INFINITY {
        small_root(x)
    } else {
        x
    }
}

/// Root of a subnormal number, by way of a normal one.
#[cfg(any(test, target_arch = "arm"))]
#[cold]
fn small_root(x: f32) -> f32 {
    const SCALE: f32 = 4096.0;
    sqrt(x * (SCALE * SCALE)) / SCALE
}

/// Exponential function: `2^k e^r` with `|r| ≤ ½ ln 2`; zero below the smallest normal number.
pub(super) fn exp(x: f32) -> f32 {
    // ln 2 in two parts, the first so short that its multiples up to some hundred are exact.
    const LN_2: (f32, f32) = (0.693_145_75, 1.428_606_8e-6);
    // Just inside ln of the smallest normal and of the largest number, −87.34 and 88.72.
    const LEAST: f32 = -87.3;
    const MOST: f32 = 88.0;
    // NaN stays NaN.
    if !(x > LEAST && x < MOST) {
        return if x <= LEAST { 0.0 } else { x * f32::MAX };
    }
    let twos = x * core::f32::consts::LOG2_E;
    let nearest = (twos + 0.5_f32.copysign(twos)) as i32;
    let whole = nearest as f32;
    let r = (x - whole * LN_2.0) - whole * LN_2.1;
    let tail = 0.166_665_18 + r * (0.041_666_2 + r * (0.008_368_97 + r * 0.001_395_063));
    let scale = f32::from_bits(ONE.wrapping_add((nearest << MANTISSA).cast_unsigned()));
    scale * (1.0 + (r + r * r * (0.5 + r * tail)))
}

/// Natural logarithm of a normal number above zero: with `x = m 2^k`, `m` from `√½` to `√2`, and
/// `s = (m − 1)/(m + 1)` it is `k ln 2 + 2 artanh s`.
pub(super) fn log(x: f32) -> f32 {
    // The bits of √½.
    const HALF_ROOT: u32 = 0x3F35_04F3;
    if x < f32::MIN_POSITIVE || x.is_nan() {
        return if x >= 0.0 { f32::NEG_INFINITY } else { f32::NAN };
    }
    let above = x.to_bits().wrapping_sub(HALF_ROOT);
    let twos = above.cast_signed() >> MANTISSA;
    let m = f32::from_bits((above & ((1 << MANTISSA) - 1)) + HALF_ROOT);
    let s = (m - 1.0) / (m + 1.0);
    let z = s * s;
    let artanh = 2.0 * s + s * z * (0.666_534_2 + z * 0.412_879);
    twos as f32 * core::f32::consts::LN_2 + artanh
}

#[cfg(test)]
mod tests {
    /// Every mantissa with an even and an odd exponent, and some of every exponent.
    #[test]
    fn the_root_is_the_processors_bit_for_bit() {
        let two_binades = 0x3F00_0000..=0x4000_0000;
        let all = (0..=u32::MAX).step_by(4099);
        for x in two_binades.chain(all).map(f32::from_bits) {
            let (root, exact) = (super::sqrt(x), crate::num::math::sqrt(x));
            let same = root.to_bits() == exact.to_bits() || root.is_nan() && exact.is_nan();
            assert!(same || x < f32::MIN_POSITIVE, "{x:e}: {root:e}, {exact:e}");
        }
    }

    #[test]
    fn where_there_is_no_number() {
        assert!(super::exp(f32::NAN).is_nan() && super::log(f32::NAN).is_nan());
        assert!(super::log(-1.0).is_nan() && super::exp(-1e9).to_bits() == 0);
        assert!(super::log(0.0).is_infinite() && super::exp(1e9).is_infinite());
        assert!(super::exp(0.0).to_bits() == super::ONE && super::log(1.0).to_bits() == 0);
    }
}
