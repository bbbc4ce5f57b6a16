//! Numbers in cells, and markers for missing ones.

use floe_core::{Counts, Fault, Newtons, Reading};

use crate::error::InputError;

use super::cells::words;

/// Markers of a failed measurement: those of Campbell loggers, and -9999 of weather and climate
/// archives.
pub const SENTINELS: [f64; 4] = [-6999.0, 6999.0, -99999.0, -9999.0];

/// Standard gravity, m/s²: turns a mass into a weight and kgf into N.
pub use floe_core::units::STANDARD_GRAVITY_M_PER_S2 as STANDARD_GRAVITY;

/// Unit of the force column.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Unit {
    /// Newtons.
    #[value(name = "N")]
    Newton,
    /// Kilonewtons.
    #[value(name = "kN")]
    Kilonewton,
    /// Pounds-force.
    #[value(name = "lbf")]
    PoundForce,
    /// Kilograms-force.
    #[value(name = "kgf")]
    KilogramForce,
    /// Codes of a converter, to be calibrated.
    #[value(name = "counts")]
    Counts,
}

impl Unit {
    /// Newtons in one unit; `None` for counts.
    #[must_use]
    pub fn newtons(self) -> Option<f64> {
        match self {
            Self::Newton => Some(1.0),
            Self::Kilonewton => Some(1e3),
            Self::PoundForce => Some(4.448_221_615_260_5),
            Self::KilogramForce => Some(STANDARD_GRAVITY),
            Self::Counts => None,
        }
    }

    /// The unit in a column's name or units row.
    #[must_use]
    pub fn from_label(label: &str) -> Option<Self> {
        match label.trim().trim_end_matches('.').to_lowercase().as_str() {
            "n" | "newton" | "newtons" | "н" => Some(Self::Newton),
            "kn" | "kilonewton" | "kilonewtons" | "кн" => Some(Self::Kilonewton),
            "lbf" | "lbs" | "lb" | "pound" | "pounds" => Some(Self::PoundForce),
            // A load cell that shows kg shows the force of that mass.
            "kgf" | "kg" | "kgs" | "kp" | "кгс" | "kilogram" | "kilograms" => {
                Some(Self::KilogramForce)
            }
            "counts" | "count" | "cts" | "adc" => Some(Self::Counts),
            _ => None,
        }
    }

    /// As in options.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Newton => "N",
            Self::Kilonewton => "kN",
            Self::PoundForce => "lbf",
            Self::KilogramForce => "kgf",
            Self::Counts => "counts",
        }
    }
}

/// The decimal mark of a log.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Decimal {
    /// A point.
    Point,
    /// A comma.
    Comma,
    /// Either, where the log shows neither.
    #[default]
    Any,
}

impl std::str::FromStr for Decimal {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "." | "point" => Ok(Self::Point),
            "," | "comma" => Ok(Self::Comma),
            _ => Err("must be . or ,".to_string()),
        }
    }
}

/// Parses a decimal number, or NaN and infinity by name.
///
/// `None` if the cell is empty or contains anything else.
#[must_use]
pub fn number(cell: &[u8], decimal: Decimal) -> Option<f64> {
    match fast_float2::parse(cell) {
        Ok(value) if decimal != Decimal::Comma || !cell.contains(&b'.') => Some(value),
        Ok(_) => None,
        Err(_) => unusual_number(cell, decimal),
    }
}

/// Parses a leading plus, a decimal comma, Fortran's exponent `D`, or the typographic minus written
/// by some spreadsheets.
#[cold]
fn unusual_number(cell: &[u8], decimal: Decimal) -> Option<f64> {
    // Surrounding blanks may be other than ASCII.
    let text = std::str::from_utf8(cell).ok()?.trim();
    if let Some(size) = text.strip_prefix('\u{2212}') {
        let size = size.starts_with(|first: char| first.is_ascii_digit()).then_some(size)?;
        return number(size.as_bytes(), decimal).map(|size| -size);
    }
    let text = text.replacen(['D', 'd'], "E", 1);
    if decimal == Decimal::Point { text.parse().ok() } else { comma_number(&text) }
}

fn comma_number(text: &str) -> Option<f64> {
    text.replacen(',', ".", 1).parse().ok()
}

/// A finite number with point or comma.
#[must_use]
pub fn finite(cell: &[u8]) -> Option<f64> {
    number(cell, Decimal::Any).filter(|value| value.is_finite())
}

/// The content of a force cell.
///
/// Empty cells, NaN, infinities and the [`SENTINELS`] (except for counts, where any code may be
/// real) are bad samples. `None` for other text, and for counts that are not 32-bit integers.
#[must_use]
pub fn reading(cell: &[u8], unit: Unit, decimal: Decimal) -> Option<Reading> {
    const BAD: Reading = Reading::Bad(Fault::Sentinel);
    if cell.is_empty() {
        return Some(BAD);
    }
    match number(cell, decimal) {
        Some(value) => reading_of(value, unit),
        None => is_missing(cell).then_some(BAD),
    }
}

/// Whether a cell is a marker for a missing number, as written by spreadsheets and statistics
/// programs.
#[cold]
#[must_use]
pub fn is_missing(cell: &[u8]) -> bool {
    const WORDS: [&str; 16] = [
        "NA", "<NA>", "N/A", "#N/A", "null", "None", "missing", "#DIV/0!", "#NUM!", "#VALUE!",
        "#REF!", "#NAME?", "#NV", "#ZAHL!", "#WERT!", "#BEZUG!",
    ];
    // Forms of C libraries with any digits: `-1.#IND00`, `-nan(ind)`.
    let number = cell.strip_prefix(b"-").unwrap_or(cell);
    let is_c = |start: &[u8]| {
        number.get(..start.len()).is_some_and(|begin| begin.eq_ignore_ascii_case(start))
    };
    WORDS.iter().any(|word| cell.eq_ignore_ascii_case(word.as_bytes()))
        || is_c(b"1.#")
        || is_c(b"nan(")
}

/// Whether a cell is a number with separated thousands: digits, a mark, three digits.
#[must_use]
pub fn is_grouped(cell: &[u8]) -> bool {
    const MARKS: [char; 9] =
        [',', '.', ' ', '_', '\'', '\u{2019}', '\u{a0}', '\u{2009}', '\u{202f}'];
    let text = words(cell);
    let mut groups = text.trim_start_matches(['+', '-']).split(MARKS);
    let digits = |group: &str| !group.is_empty() && group.bytes().all(|b| b.is_ascii_digit());
    let leads = |group: &str| digits(group) && group.len() < 4 && !group.starts_with('0');
    let first = groups.next().is_some_and(leads);
    first
        && groups.next().is_some_and(|group| digits(group) && group.len() == 3)
        && groups.all(digits)
}

/// Whether each number is one more than the previous.
#[must_use]
pub fn count_up(numbers: &[f64]) -> bool {
    let is_next = |w: &[f64]| matches!(w, [a, b] if (b - a - 1.0).abs() < 1e-9);
    numbers.windows(2).all(is_next)
}

/// Whether a number may have a separated thousand or decimals: `1.006`.
#[must_use]
pub fn is_thousand(cell: &str) -> bool {
    let is_long = cell.split(['.', ',']).skip(1).any(|group| group.len() != 3);
    !is_long && cell.contains(['.', ',']) && is_grouped(cell.as_bytes())
}

/// The error for a number that may have a separated thousand.
#[must_use]
pub fn thousand(cell: &str) -> InputError {
    InputError::new(format!(
        "'{cell}' is among numbers without a mark: are these thousands? write it without marks between \
         the thousands, or give --decimal . or --decimal ,"
    ))
}

/// A reading from a parsed number.
#[must_use]
pub fn reading_of(value: f64, unit: Unit) -> Option<Reading> {
    const BAD: Reading = Reading::Bad(Fault::Sentinel);
    let Some(newtons) = unit.newtons() else {
        return if value.is_finite() { counts(value) } else { Some(BAD) };
    };
    let force = (value * newtons) as f32;
    let good = force.is_finite() && !is_sentinel(value);
    Some(if good { Reading::Force(Newtons(force)) } else { BAD })
}

#[allow(clippy::float_cmp)] // a marker is written exactly
fn is_sentinel(value: f64) -> bool {
    value.abs() >= 6999.0 && SENTINELS.contains(&value)
}

fn counts(value: f64) -> Option<Reading> {
    let whole = value.fract().abs() < f64::EPSILON;
    let in_range = (f64::from(i32::MIN)..=f64::from(i32::MAX)).contains(&value);
    (whole && in_range).then_some(Reading::Counts(Counts(value as i32)))
}

#[cfg(test)]
#[allow(clippy::float_cmp)] // exact by construction
mod tests {
    use super::*;

    #[test]
    fn numbers_as_loggers_write_them() {
        let table: [(&str, Option<f64>); 18] = [
            ("1.25", Some(1.25)),
            ("-.22", Some(-0.22)),
            (".5", Some(0.5)),
            ("5.", Some(5.0)),
            ("+5", Some(5.0)),
            ("1e-3", Some(0.001)),
            ("1,25", Some(1.25)),
            ("-0,5", Some(-0.5)),
            ("\u{2212}0.5", Some(-0.5)),
            ("\u{2212}0,5", Some(-0.5)),
            ("\u{2212}-0.5", None),
            ("1.5D-02", Some(0.015)),
            ("1,5d2", Some(150.0)),
            ("1D", None),
            ("1,234,5", None),
            ("abc", None),
            ("1.2.3", None),
            ("", None),
        ];
        for (text, expected) in table {
            assert_eq!(number(text.as_bytes(), Decimal::Any), expected, "{text}");
        }
    }

    #[test]
    fn a_decimal_mark_that_is_known_is_held_to() {
        let both = |text: &str| {
            [Decimal::Point, Decimal::Comma].map(|decimal| number(text.as_bytes(), decimal))
        };
        assert_eq!(both("1.25"), [Some(1.25), None]);
        assert_eq!(both("1,25"), [None, Some(1.25)]);
        assert_eq!(both("+5"), [Some(5.0), Some(5.0)]);
        assert_eq!(both("1.234,5"), [None, None]);
    }

    #[test]
    fn markers_are_bad_samples_and_text_is_an_error() {
        let bad = [
            "-6999", "6999", "-99999", "-9999", "-6999.0", "NAN", "nan", "", "inf", "-INF",
            "1e999", "1e39",
        ]
        .into_iter()
        .chain(["N/A", "#n/a", "NULL", "#DIV/0!", "-1.#IND00", "-nan(ind)", "missing"]);
        for text in bad {
            let expected = Some(Reading::Bad(Fault::Sentinel));
            assert_eq!(reading(text.as_bytes(), Unit::Newton, Decimal::Any), expected, "{text}");
        }
        for text in ["abc", "-", "12 N", "0x10", "--5"] {
            assert_eq!(reading(text.as_bytes(), Unit::Newton, Decimal::Any), None, "{text}");
        }
    }

    #[test]
    fn units_become_newtons() {
        let newtons = |unit| match reading(b"2", unit, Decimal::Any) {
            Some(Reading::Force(Newtons(force))) => force,
            other => panic!("{other:?}"),
        };
        assert_eq!(newtons(Unit::Newton), 2.0);
        assert_eq!(newtons(Unit::Kilonewton), 2000.0);
        assert_eq!(newtons(Unit::PoundForce), 8.896_443);
        assert_eq!(newtons(Unit::KilogramForce), 19.6133);
    }

    #[test]
    fn counts_are_whole_and_have_no_markers() {
        assert_eq!(
            reading(b"6999", Unit::Counts, Decimal::Any),
            Some(Reading::Counts(Counts(6999)))
        );
        assert_eq!(reading(b"1.5", Unit::Counts, Decimal::Any), None);
        assert_eq!(reading(b"3e9", Unit::Counts, Decimal::Any), None);
        assert_eq!(
            reading(b"nan", Unit::Counts, Decimal::Any),
            Some(Reading::Bad(Fault::Sentinel))
        );
    }
}
