//! An `f32` as the decimal that gives it back: the standard library's way would be
//! a tenth of the program.

use core::fmt;

/// Writes at least 6 significant digits, more if needed, without closing zeros;
/// with an exponent outside 0.0001 to 1e9. Reading the text as `f32` gives the same
/// bits (not for NaN).
///
/// ```
/// use floe_firmware::line::Decimal;
/// assert_eq!(Decimal(0.1).to_string(), "0.1");
/// assert_eq!(Decimal(1.0 / 3.0).to_string(), "0.33333334");
/// assert_eq!(Decimal(-2.5e-7).to_string(), "-2.5e-7");
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Decimal(pub f32);

/// The least number of 6 digits, and the one above all of 9: with 9 digits a decimal
/// is nearer to its `f32` than to any other.
const FIRST: f64 = 1e5;
const LAST: f64 = 1e9;

impl fmt::Display for Decimal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let value = f64::from(self.0);
        if value.is_nan() || value.is_infinite() {
            return f.write_str(if value.is_nan() {
                "NaN"
            } else if value > 0.0 {
                "inf"
            } else {
                "-inf"
            });
        }
        if self.0.is_sign_negative() {
            f.write_str("-")?;
        }
        let (digits, exponent) = shortest(self.0.abs());
        match exponent {
            -4..9 => plain(f, digits, exponent),
            _ => {
                plain(f, digits, 0)?;
                write!(f, "e{exponent}")
            }
        }
    }
}

/// Significant digits as a whole number without closing zeros, and the power of
/// ten of the first of them.
fn shortest(number: f32) -> (u32, i32) {
    if number == 0.0 {
        return (0, 0);
    }
    let value = f64::from(number);
    let (mut exponent, mut unit) = (0, 1.0);
    while value >= 10.0 * unit {
        (exponent, unit) = (exponent + 1, 10.0 * unit);
    }
    while value < unit {
        (exponent, unit) = (exponent - 1, 0.1 * unit);
    }
    let scale = FIRST / unit;
    let (mut scaled, mut near, mut limit) = (value * scale, half_gap(number) * scale, 10.0 * FIRST);
    let rounded = |scaled: f64| (scaled + 0.5) as u32;
    while limit < LAST && (f64::from(rounded(scaled)) - scaled).abs() >= near {
        (scaled, near, limit) = (10.0 * scaled, 10.0 * near, 10.0 * limit);
    }
    let mut digits = rounded(scaled);
    // Rounding up can carry into a new first digit: 999 999.96.
    if f64::from(digits) >= limit {
        exponent += 1;
    }
    while digits % 10 == 0 {
        digits /= 10;
    }
    (digits, exponent)
}

/// Nearly half the distance to the nearer neighbour of a number above zero.
fn half_gap(number: f32) -> f64 {
    let neighbour = |bits: u32| f64::from(f32::from_bits(bits));
    let below = f64::from(number) - neighbour(number.to_bits() - 1);
    let above = neighbour(number.to_bits() + 1) - f64::from(number);
    0.4999 * below.min(above)
}

/// Writes `digits` with the first of them at a power of ten.
fn plain(f: &mut fmt::Formatter<'_>, digits: u32, exponent: i32) -> fmt::Result {
    let count = digits.checked_ilog10().unwrap_or(0) as i32 + 1;
    let decimals = count - 1 - exponent;
    if decimals <= 0 {
        return write!(f, "{}", digits * 10_u32.pow(decimals.unsigned_abs()));
    }
    // Ten decimals or more are more than there are digits.
    let scale = 10_u32.checked_pow(decimals.unsigned_abs()).unwrap_or(u32::MAX);
    let (whole, rest) = (digits / scale, digits % scale);
    write!(f, "{whole}.{rest:0width$}", width = decimals as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(value: f32) {
        let text = Decimal(value).to_string();
        let back: f32 = text.parse().unwrap();
        assert_eq!(back.to_bits(), value.to_bits(), "{value:e} became {text}");
    }

    #[test]
    fn every_kind_of_number_comes_back() {
        for value in [
            0.0,
            -0.0,
            1.0,
            -1.0,
            0.1,
            0.3,
            630.0,
            0.0001,
            0.000_099_999,
            999_999.94,
            9_999_999.0,
            16_777_216.0,
            999_999_900.0,
            1e9,
            1e10,
            3.4e38,
            f32::MAX,
            f32::MIN_POSITIVE,
            1e-45,
            1.0 / 3.0,
            123_456.79,
            f32::EPSILON,
            f32::INFINITY,
            f32::NEG_INFINITY,
        ] {
            check(value);
        }
        for exponent in 1..255_u32 {
            // Powers of two and their neighbours, where the distance changes.
            for offset in [-1_i32, 0, 1] {
                check(f32::from_bits((exponent << 23).wrapping_add_signed(offset)));
            }
        }
    }

    #[test]
    fn two_million_random_numbers_come_back() {
        let mut bits = 1_u32;
        for _ in 0..2_000_000 {
            bits = bits.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let value = f32::from_bits(bits);
            if !value.is_nan() {
                check(value);
            }
        }
    }

    #[test]
    fn text_is_short() {
        for (value, text) in [
            (0.0, "0"),
            (630.0, "630"),
            (429.5, "429.5"),
            (0.78, "0.78"),
            (1.24, "1.24"),
            (-0.001, "-0.001"),
            (1e-5, "1e-5"),
            (0.015_652_174, "0.015652174"),
            (123_456.0, "123456"),
            (1_000_000.0, "1000000"),
            (2e9, "2e9"),
        ] {
            assert_eq!(Decimal(value).to_string(), text);
        }
    }
}
