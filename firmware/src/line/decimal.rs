//! Shortest decimal text of an `f32` that reads back as the same value. The standard library's
//! formatting would take a tenth of the program.

use core::fmt;

use crate::long_division::divide;
use heapless::String;

use crate::text::{Out, Show, whole};

/// Text with at least 6 significant digits, more if needed, without trailing zeros; with an
/// exponent outside 0.0001 to 1e9. Reading the text as `f32` gives the same bits (except for NaN).
///
/// ```
/// use floe_firmware::line::Decimal;
/// assert_eq!(Decimal(0.1).to_string(), "0.1");
/// assert_eq!(Decimal(1.0 / 3.0).to_string(), "0.33333334");
/// assert_eq!(Decimal(-2.5e-7).to_string(), "-2.5e-7");
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Decimal(pub f32);

impl Show for Decimal {
    fn show(&self, out: &mut Out<'_>) {
        if self.0.is_nan() {
            return "NaN".show(out);
        }
        if self.0.is_sign_negative() {
            "-".show(out);
        }
        if self.0.is_infinite() {
            return "inf".show(out);
        }
        let (digits, exponent) = shortest(self.0.abs());
        match exponent {
            -4..9 => plain(out, digits, exponent),
            _ => {
                plain(out, digits, 0);
                ("e", exponent).show(out);
            }
        }
    }
}

impl fmt::Display for Decimal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut text = String::<16>::new();
        self.show(&mut Out::new(&mut text));
        f.write_str(&text)
    }
}

/// Significant digits as an integer without trailing zeros, and the power of ten of the first
/// digit. From 6 to 9 digits: with 9 a decimal is nearer to its `f32` than to any other.
fn shortest(number: f32) -> (u32, i32) {
    if number == 0.0 {
        return (0, 0);
    }
    let (mut scaled, mut exponent) = six_digits(number);
    let mut limit = 1_000_000;
    while limit < 1_000_000_000 && !is_near(scaled, number) {
        (scaled, limit) = (10 * scaled, 10 * limit);
    }
    let mut digits = rounded(scaled);
    // Rounding up can add a digit, for example for 999 999.96.
    if digits >= limit {
        exponent += 1;
    }
    while digits.is_multiple_of(10) {
        digits /= 10;
    }
    (digits, exponent)
}

/// Number of binary digits after the point of a scaled number.
const POINT: u32 = 30;

/// A positive number with 6 decimal digits before the point, and the power of ten of the first
/// digit.
fn six_digits(number: f32) -> (u64, i32) {
    let (mantissa, power) = parts(number);
    // The number is `scaled * 2^binary * 10^decimal`, with `scaled` as large as possible.
    let normal = |scaled: u64, binary: i32| {
        let room = scaled.leading_zeros();
        (scaled << room, binary - room as i32)
    };
    let (mut scaled, mut binary) = normal(mantissa.into(), power);
    let mut decimal = 0;
    // Scaled below 2^20.
    while binary > -44 {
        (scaled, binary) = normal(tenth(scaled), binary);
        decimal += 1;
    }
    // Scaled to 2^16 at least.
    while binary < -47 {
        (scaled, binary) = normal((scaled >> 4) * 10, binary + 4);
        decimal -= 1;
    }
    scaled >>= -(binary + POINT as i32);
    if scaled >= 1_000_000 << POINT {
        (scaled, decimal) = (tenth(scaled), decimal + 1);
    }
    if scaled < 100_000 << POINT {
        (scaled, decimal) = (10 * scaled, decimal - 1);
    }
    (scaled, decimal + 5)
}

/// A positive number as mantissa and power of two.
fn parts(number: f32) -> (u32, i32) {
    let bits = number.to_bits();
    match bits >> 23 {
        0 => (bits, -149),
        power => (bits & 0x7F_FFFF | 0x80_0000, power as i32 - 150),
    }
}

fn tenth(scaled: u64) -> u64 {
    divide(scaled, 10).0
}

/// The nearest integer. Ties go up, even when scaling has truncated tenths.
fn rounded(scaled: u64) -> u32 {
    const CUT: u64 = 1 << 13;
    ((scaled + (1 << (POINT - 1)) + CUT) >> POINT) as u32
}

/// Whether rounding to an integer changes the number by less than nearly half the distance to the
/// next `f32`.
fn is_near(scaled: u64, number: f32) -> bool {
    let off = (u64::from(rounded(scaled)) << POINT).abs_diff(scaled);
    let (mantissa, _) = parts(number);
    // The next number below a power of two is half as far away as the next one above.
    let distances = if mantissa == 0x80_0000 { 4 } else { 2 };
    off * distances * u64::from(mantissa) < scaled - (scaled >> 12)
}

/// Writes `digits`, with the first digit at a power of ten.
fn plain(out: &mut Out<'_>, digits: u32, exponent: i32) {
    let count = digits.checked_ilog10().unwrap_or(0) as i32 + 1;
    let decimals = count - 1 - exponent;
    if decimals <= 0 {
        return (digits * 10_u32.pow(decimals.unsigned_abs())).show(out);
    }
    // With ten decimals or more the scale exceeds all digits.
    let scale = 10_u32.checked_pow(decimals.unsigned_abs()).unwrap_or(u32::MAX);
    (digits / scale, ".").show(out);
    whole(out, (digits % scale).into(), decimals as usize);
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
            // Powers of two and their neighbours, where the distance between numbers changes.
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
