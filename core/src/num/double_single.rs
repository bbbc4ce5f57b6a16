//! Sums without loss of precision, in pairs of single-precision numbers.
//!
//! The board computes `f64` in software, with 4 kB of code. A pair of `f32`, the second of which is
//! the rounding error of the first, holds 48 bits (Dekker, *A floating-point technique for
//! extending the available precision*, Numer. Math. 18 (1971) 224-242): enough for the mean of a
//! million events. The range is that of `f32`.

use core::ops::{Add, AddAssign, Mul, Neg, Sub};

/// The unevaluated sum of two numbers, the second at most half a unit in the last place
/// of the first.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub(crate) struct DoubleSingle {
    high: f32,
    low: f32,
}

impl DoubleSingle {
    /// `high + low`, where `low` is not the larger of them.
    fn renormed(high: f32, low: f32) -> Self {
        let sum = high + low;
        Self { high: sum, low: low - (sum - high) }
    }

    /// The sum with a number. Inlined: for loops.
    #[inline(always)]
    pub(crate) fn plus(self, number: f32) -> Self {
        let sum = self.high + number;
        let part = sum - self.high;
        let lost = (self.high - (sum - part)) + (number - part);
        Self::renormed(sum, lost + self.low)
    }

    /// The sum with a number that is no larger than `self`, in four operations (Kahan); with a
    /// larger one the last bit may be lost. Inlined: for loops.
    #[inline(always)]
    pub(crate) fn plus_smaller(self, number: f32) -> Self {
        let step = number + self.low;
        let high = self.high + step;
        Self { high, low: step - (high - self.high) }
    }

    /// The nearest number of single precision.
    pub(crate) fn rounded(self) -> f32 {
        self.high
    }
}

impl From<f32> for DoubleSingle {
    fn from(high: f32) -> Self {
        Self { high, low: 0.0 }
    }
}

impl Neg for DoubleSingle {
    type Output = Self;

    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Add for DoubleSingle {
    type Output = Self;

    #[inline(never)]
    fn add(self, other: Self) -> Self {
        let sum = self.high + other.high;
        let part = sum - self.high;
        let lost = (self.high - (sum - part)) + (other.high - part);
        Self::renormed(sum, lost + (self.low + other.low))
    }
}

impl AddAssign<f32> for DoubleSingle {
    #[inline(never)]
    fn add_assign(&mut self, number: f32) {
        *self = self.plus(number);
    }
}

impl Sub for DoubleSingle {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

/// A number in two halves of 12 bits each, whose products are exact: Dekker's way, by `2^12 + 1`.
fn halves(number: f32) -> (f32, f32) {
    let shifted = 4097.0 * number;
    let leading = shifted - (shifted - number);
    (leading, number - leading)
}

impl Mul for DoubleSingle {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let product = self.high * other.high;
        let ((a, b), (c, d)) = (halves(self.high), halves(other.high));
        let lost = (((a * c - product) + a * d) + b * c) + b * d;
        Self::renormed(product, lost + (self.high * other.low + self.low * other.high))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    impl From<f64> for DoubleSingle {
        fn from(number: f64) -> Self {
            let high = number as f32;
            Self { high, low: (number - f64::from(high)) as f32 }
        }
    }

    impl From<DoubleSingle> for f64 {
        fn from(number: DoubleSingle) -> Self {
            Self::from(number.high) + Self::from(number.low)
        }
    }

    /// Numbers of all sizes between 1e-9 and 1e9, of either sign.
    fn numbers() -> impl Iterator<Item = f64> {
        let mut bits = 1_u64;
        core::iter::from_fn(move || {
            bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let size = 10_f64.powi((bits >> 33) as i32 % 19 - 9);
            Some((2.0 * (bits >> 11) as f64 / 2_f64.powi(53) - 1.0) * size)
        })
    }

    #[test]
    fn agrees_with_double_precision_to_45_bits() {
        let least = 2_f64.powi(-45);
        for (a, b) in numbers().zip(numbers().skip(7)).take(200_000) {
            let (x, y) = (DoubleSingle::from(a), DoubleSingle::from(b));
            let (a, b) = (f64::from(x), f64::from(y));
            let size = a.abs() + b.abs();
            assert!((f64::from(x + y) - (a + b)).abs() <= least * size, "{a} + {b}");
            assert!((f64::from(x - y) - (a - b)).abs() <= least * size, "{a} - {b}");
            assert!((f64::from(x * y) - a * b).abs() <= least * (a * b).abs(), "{a} * {b}");
            assert_eq!(x > y, a > b);
        }
    }
}
