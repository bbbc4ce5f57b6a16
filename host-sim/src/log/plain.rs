//! The usual row, quickly: decimal numbers between separators, without quotes, blanks,
//! exponents or more digits than an `f64` holds exactly. Any other row is none of these
//! and is read the long way, with the same result.

use super::number::{Decimal, Unit};
use super::rows::{Layout, TimeCells};
use super::stamp::TimeUnit;

/// Where a plain row has its time, in seconds, and its force.
#[derive(Clone, Copy, Debug)]
pub struct Plain {
    separator: u8,
    width: usize,
    time: usize,
    force: usize,
}

impl Plain {
    /// For a layout whose rows can be plain.
    #[must_use]
    pub fn of(layout: &Layout) -> Option<Self> {
        let TimeCells::Number { cell: time, unit: TimeUnit::Second } = layout.time else {
            return None;
        };
        let other = layout.record.is_some()
            || layout.array_id.is_some()
            || layout.decimal == Decimal::Comma
            || layout.unit == Unit::Counts
            || matches!(layout.separator, b' ' | b'.' | b'-');
        let Layout { separator, width, force, .. } = *layout;
        (!other && time != force).then_some(Self { separator, width: width?, time, force })
    }

    /// Time and force of a row; `None` if it is not a plain one.
    #[must_use]
    pub fn read(&self, line: &[u8]) -> Option<(f64, f64)> {
        let (mut time, mut force) = (None, None);
        let mut rest = line;
        for cell in 1..=self.width {
            let end = if cell == self.time + 1 {
                let (value, end) = decimal(rest)?;
                time = Some(value);
                end
            } else if cell == self.force + 1 {
                let (value, end) = decimal(rest)?;
                force = Some(value);
                end
            } else {
                let ends = |&byte: &u8| byte == self.separator || byte == b'"';
                rest.iter().position(ends).unwrap_or(rest.len())
            };
            match rest.get(end) {
                None if cell == self.width => return time.zip(force),
                Some(&byte) if byte == self.separator => rest = rest.get(end + 1..)?,
                _ => return None,
            }
        }
        None
    }
}

/// Digits that any `f64` holds exactly, as it does the powers of ten below: one division
/// then rounds correctly (Clinger 1990).
const MOST_DIGITS: usize = 15;
const POWERS: [f64; MOST_DIGITS + 1] =
    [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15];

/// The number that a text begins with, and where it ends.
fn decimal(text: &[u8]) -> Option<(f64, usize)> {
    let sign = usize::from(text.first() == Some(&b'-'));
    let (mantissa, whole) = digits(text.get(sign..)?, 0);
    let mut end = sign + whole;
    let (mut mantissa, mut fraction) = (mantissa, 0);
    if text.get(end) == Some(&b'.') {
        (mantissa, fraction) = digits(text.get(end + 1..)?, mantissa);
        end += 1 + fraction;
    }
    if !(1..=MOST_DIGITS).contains(&(whole + fraction)) {
        return None;
    }
    let value = mantissa as f64 / POWERS.get(fraction)?;
    Some((if sign > 0 { -value } else { value }, end))
}

/// Digits behind those of a mantissa, and how many they are; of too many it is meaningless.
fn digits(text: &[u8], mut mantissa: u64) -> (u64, usize) {
    let mut count = 0;
    for byte in text {
        let digit = byte.wrapping_sub(b'0');
        if digit > 9 {
            break;
        }
        mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(digit));
        count += 1;
    }
    (mantissa, count)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const TWO: Plain = Plain { separator: b';', width: 3, time: 2, force: 0 };

    #[test]
    fn cells_are_taken_where_they_are() {
        assert_eq!(TWO.read(b"-12.5;note;0.0625"), Some((0.0625, -12.5)));
        assert_eq!(TWO.read(b"3;;4"), Some((4.0, 3.0)));
    }

    #[test]
    fn everything_unusual_is_left_to_the_long_way() {
        let lines = [
            "1;2",
            "1;2;3;4",
            "1;\"2\";3",
            "+1;2;3",
            "1e3;2;3",
            " 1;2;3",
            "1;2;3 ",
            "1,5;2;3",
            ";2;3",
            "1.2.3;2;3",
            "nan;2;3",
            "-;2;3",
            ".;2;3",
            "1;2;1234567890.123456",
            "",
        ];
        for line in lines {
            assert_eq!(TWO.read(line.as_bytes()), None, "{line}");
        }
    }

    proptest! {
        #[test]
        fn a_number_is_the_one_that_the_standard_library_reads(
            text in r"-?[0-9]{0,9}\.?[0-9]{0,9}"
        ) {
            if let Some((value, end)) = decimal(text.as_bytes()) {
                prop_assert!(end == text.len() || text.len() > MOST_DIGITS);
                if end == text.len() {
                    let expected: f64 = text.parse().unwrap();
                    prop_assert_eq!(value.to_bits(), expected.to_bits());
                }
            }
        }
    }
}
