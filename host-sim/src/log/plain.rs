//! Fast parser for the usual row: decimal numbers between separators, without quotes, blanks,
//! exponents or more digits than an `f64` represents exactly. All other rows are left to the
//! general parser, which gives the same results.

use memchr::memchr3;

use super::layout::{Layout, TimeCells};
use super::number::{Decimal, Unit};
use super::stamp::TimeUnit;

/// Positions of time, in seconds, and force in a plain row.
#[derive(Clone, Copy, Debug)]
pub struct Plain {
    separator: u8,
    mark: u8,
    width: usize,
    time: usize,
    force: usize,
}

/// A plain row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlainRow {
    /// Time, s.
    pub time_s: f64,
    /// Force in the unit of the log.
    pub force: f64,
    /// Number of bytes without the end of the line.
    pub bytes: usize,
    /// Number of bytes with the end of the line.
    pub length: usize,
}

impl Plain {
    /// The parser for a layout whose rows can be plain.
    #[must_use]
    pub fn of(layout: &Layout) -> Option<Self> {
        let TimeCells::Number { cell: time, unit: TimeUnit::Second } = layout.time else {
            return None;
        };
        let mark = match layout.decimal {
            Decimal::Point => b'.',
            Decimal::Comma => b',',
            // The first number with a mark determines it; no text contains this byte.
            Decimal::Any => 0xFF,
        };
        let other = layout.record.is_some()
            || layout.part.is_some()
            || layout.unit_cell.is_some()
            || layout.array_id.is_some()
            || layout.unit == Unit::Counts
            || [b' ', b'-', mark].contains(&layout.separator);
        let Layout { separator, width, force, .. } = *layout;
        (!other && time != force).then_some(Self { separator, mark, width: width?, time, force })
    }

    /// Whether the decimal mark is known.
    #[must_use]
    pub fn has_mark(&self) -> bool {
        self.mark != 0xFF
    }

    /// Parses the row at the beginning of a text; `None` if it is not plain, or ends within eight
    /// bytes of the end of the text.
    #[must_use]
    pub fn read(&self, text: &[u8]) -> Option<PlainRow> {
        if text
            .first()
            .is_none_or(|&first| matches!(first, b'#' | b'%') || first.is_ascii_whitespace())
        {
            return None;
        }
        let (mut time_s, mut force, mut rest) = (f64::NAN, f64::NAN, text);
        let mut cell = 0;
        loop {
            if cell == self.time {
                (time_s, rest) = decimal(rest, self.mark)?;
            } else if cell == self.force {
                (force, rest) = decimal(rest, self.mark)?;
            } else {
                rest = rest.get(memchr3(self.separator, b'"', b'\n', rest)?..)?;
            }
            cell += 1;
            rest = match rest {
                [next, rest @ ..] if *next == self.separator && cell < self.width => rest,
                [b'\n', rest @ ..] | [b'\r', b'\n', rest @ ..] if cell == self.width => {
                    let length = text.len() - rest.len();
                    let line = text.get(..length - 1)?;
                    let bytes = line.strip_suffix(b"\r").unwrap_or(line).len();
                    return Some(PlainRow { time_s, force, bytes, length });
                }
                _ => return None,
            };
        }
    }
}

/// Number of digits that every `f64` represents exactly, as it does the powers of ten below: a
/// single division then rounds correctly (Clinger 1990).
const MOST_DIGITS: usize = 15;
const PLACES: [u64; 9] = [1, 10, 100, 1000, 10_000, 100_000, 1_000_000, 10_000_000, 100_000_000];
const POWERS: [f64; MOST_DIGITS + 1] =
    [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15];

/// The number at the beginning of a text, and the rest.
#[inline(always)]
fn decimal(text: &[u8], mark: u8) -> Option<(f64, &[u8])> {
    let (negative, text) = match text {
        [b'-', rest @ ..] => (true, rest),
        _ => (false, text),
    };
    let (mut mantissa, mut rest) = digits(text, 0)?;
    let whole = text.len() - rest.len();
    let mut fraction = 0;
    if let [byte, behind @ ..] = rest
        && *byte == mark
    {
        (mantissa, rest) = digits(behind, mantissa)?;
        fraction = behind.len() - rest.len();
    }
    if !(1..=MOST_DIGITS).contains(&(whole + fraction)) {
        return None;
    }
    let value = mantissa.cast_signed() as f64 / POWERS.get(fraction)?;
    Some((if negative { -value } else { value }, rest))
}

/// Appends digits to a mantissa, fifteen in total at most; returns the rest.
#[inline(always)]
fn digits(text: &[u8], mantissa: u64) -> Option<(u64, &[u8])> {
    let (mantissa, rest) = some_digits(text, mantissa)?;
    if text.len() - rest.len() < 8 {
        return Some((mantissa, rest));
    }
    let (mantissa, end) = some_digits(rest, mantissa)?;
    (rest.len() - end.len() < 8).then_some((mantissa, end))
}

/// Appends up to eight digits.
#[inline(always)]
fn some_digits(text: &[u8], mantissa: u64) -> Option<(u64, &[u8])> {
    let (value, count) = up_to_eight(*text.first_chunk()?);
    let mantissa = mantissa.wrapping_mul(*PLACES.get(count)?).wrapping_add(value);
    Some((mantissa, text.get(count..)?))
}

/// Value and number of the leading digits among eight letters, computed in parallel: each byte of a
/// word contains a letter, the first one in the lowest byte.
fn up_to_eight(letters: [u8; 8]) -> (u64, usize) {
    const EACH: u64 = 0x0101_0101_0101_0101;
    const TWO_OF_FOUR: u64 = 0x0000_00ff_0000_00ff;
    let word = u64::from_le_bytes(letters) ^ (EACH * 0x30);
    // Digits are 0 to 9 now. Adding 0x76 gives 0x80 or more for all other letters; carries affect
    // later letters only.
    let others = (word.wrapping_add(EACH * 0x76) | word) & (EACH * 0x80);
    let count = others.trailing_zeros() / 8;
    // Leading zeros are added; then neighbours are combined into two, four and eight digits.
    let word = word.checked_shl(64 - 8 * count).unwrap_or(0);
    let twos = word.wrapping_mul(10).wrapping_add(word >> 8);
    let (first_and_third, second_and_fourth) = (twos & TWO_OF_FOUR, (twos >> 16) & TWO_OF_FOUR);
    let value = first_and_third
        .wrapping_mul(100 + (1_000_000 << 32))
        .wrapping_add(second_and_fourth.wrapping_mul(1 + (10_000 << 32)));
    (value >> 32, count as usize)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const TWO: Plain = Plain { separator: b';', mark: b'.', width: 3, time: 2, force: 0 };

    /// Time and force of a row that is followed by others.
    fn read(row: &str) -> Option<(f64, f64)> {
        let text = format!("{row}\n0;;0.000000\n");
        let row = TWO.read(text.as_bytes()).inspect(|it| assert_eq!(it.length, row.len() + 1))?;
        Some((row.time_s, row.force))
    }

    #[test]
    fn cells_are_taken_where_they_are() {
        assert_eq!(read("-12.5;note;0.0625"), Some((0.0625, -12.5)));
        assert_eq!(read("3;;4\r"), Some((4.0, 3.0)));
        let commas = Plain { mark: b',', ..TWO };
        let row = commas.read(b"-12,5;1.5;0,0625\n0;0;0,0000");
        assert_eq!(row, Some(PlainRow { time_s: 0.0625, force: -12.5, bytes: 16, length: 17 }));
        assert_eq!(commas.read(b"-12.5;1.5;0,0625\n0;0;0,0000"), None);
        let last = Plain { separator: b',', mark: b'.', width: 3, time: 0, force: 1 };
        let row = last.read(b"0.5,2,#\r\n0,0,0\n");
        assert_eq!(row, Some(PlainRow { time_s: 0.5, force: 2.0, bytes: 7, length: 9 }));
    }

    #[test]
    fn everything_unusual_is_left_to_the_long_way() {
        let rows = [
            "1;2",
            "1;2;3;4",
            "1;\"2\";3",
            "+1;2;3",
            "1e3;2;3",
            " 1;2;3",
            "1;2;3 ",
            "1;2;3\r\r",
            "1,5;2;3",
            ";2;3",
            "1.2.3;2;3",
            "nan;2;3",
            "-;2;3",
            ".;2;3",
            "1;2;1234567890.123456",
            "",
        ];
        for row in rows {
            assert_eq!(read(row), None, "{row}");
        }
        assert_eq!(TWO.read(b"1;2;3"), None);
        let indexed = Plain { separator: b',', mark: b'.', width: 3, time: 1, force: 2 };
        for comment in ["# a,1,2\n0,0,0.0000\n", "% a,1,2\n0,0,0.0000\n", "  # a,1,2\n0,0,0.0000\n"]
        {
            assert_eq!(indexed.read(comment.as_bytes()), None);
        }
    }

    proptest! {
        #[test]
        fn a_number_is_the_one_that_the_standard_library_reads(
            text in r"-?[0-9]{0,9}\.?[0-9]{0,9}", behind in "[^0-9.]{8}"
        ) {
            if let Some((value, rest)) = decimal((text.clone() + &behind).as_bytes(), b'.') {
                prop_assert_eq!(rest, behind.as_bytes());
                let expected: f64 = text.parse().unwrap();
                prop_assert_eq!(value.to_bits(), expected.to_bits());
            }
        }

        #[test]
        fn digits_end_where_they_end(letters: [u8; 8], digits in "[0-9]{0,8}") {
            let mut text = letters;
            text[..digits.len()].copy_from_slice(digits.as_bytes());
            let count = text.iter().take_while(|letter| letter.is_ascii_digit()).count();
            let value = std::str::from_utf8(&text[..count]).unwrap().parse().unwrap_or(0);
            prop_assert_eq!(up_to_eight(text), (value, count));
        }
    }
}
