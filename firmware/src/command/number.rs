//! Parsing of typed numbers.

const MISSING: &str = "a number like 12.5 is missing";
pub(crate) const NEGATIVE: &str = "not below zero";

/// A number that is not negative.
pub(super) fn size(text: &str) -> Result<f32, &'static str> {
    number(text).and_then(|size| if size >= 0.0 { Ok(size) } else { Err(NEGATIVE) })
}

/// A decimal number without an exponent, of at most 15 digits. The standard library's parser would
/// take a tenth of the program.
pub(super) fn number(text: &str) -> Result<f32, &'static str> {
    const MOST_DIGITS: usize = 15;
    let (sign, digits) = match text.as_bytes() {
        [b'-', digits @ ..] => (-1.0, digits),
        digits => (1.0, digits),
    };
    let (mut number, mut scale, mut count, mut behind_point) = (0, 1, 0, false);
    for letter in digits {
        match letter {
            b'0'..=b'9' if count < MOST_DIGITS => {
                number = number * 10 + u64::from(letter - b'0');
                scale *= if behind_point { 10 } else { 1 };
                count += 1;
            }
            b'.' if !behind_point => behind_point = true,
            _ => return Err(MISSING),
        }
    }
    if count == 0 { Err(MISSING) } else { Ok(sign * ratio(number, scale)) }
}

/// A whole number of codes. A converter has 24 bits, and so has the mantissa of an `f32`.
pub(super) fn code(text: &str) -> Result<i32, &'static str> {
    let number = number(text)?;
    let code = number as i32;
    let is_whole = (code as f32).to_bits() == number.to_bits();
    if is_whole { Ok(code) } else { Err("a whole number of codes") }
}

/// The `f32` nearest to a ratio of two numbers below 2⁵³, the second above zero; ties go to the
/// even one.
fn ratio(mut number: u64, mut scale: u64) -> f32 {
    if number == 0 {
        return 0.0;
    }
    let mut exponent = 0;
    while number < scale {
        (number, exponent) = (2 * number, exponent - 1);
    }
    while number >= 2 * scale {
        (scale, exponent) = (2 * scale, exponent + 1);
    }
    // 24 binary digits, of which the first is 1.
    let mut digits = 0;
    for _ in 0..24 {
        let digit = u32::from(number >= scale);
        digits = 2 * digits + digit;
        number = 2 * (number - u64::from(digit) * scale);
    }
    let up = number > scale || (number == scale && digits % 2 == 1);
    (digits + u32::from(up)) as f32 * power_of_two(exponent - 23)
}

fn power_of_two(exponent: i32) -> f32 {
    f32::from_bits(((127 + exponent) as u32) << 23)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_the_standard_librarys() {
        for text in [
            "0",
            "1",
            "-1",
            "630",
            "0.1",
            "429.5",
            "0.01565217391304",
            "16777217",
            ".5",
            "5.",
            "3.4028235",
            "123456789012345",
            "0.00000000000001",
            "-2.86",
            "1.24",
        ] {
            assert_eq!(number(text), Ok(text.parse().unwrap()), "{text}");
        }
    }
}
