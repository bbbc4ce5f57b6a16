//! Remedies for cells or lines that cannot be read.

use crate::error::{InputError, excerpt};

use super::cells::text;
use super::label::Label;
use super::number::{Decimal, Unit, is_grouped, is_missing, number};
use super::stamp::TimeUnit;

const CORRECT: &str = "correct the line or take it out";
const FOOTER: &str = "if a footer or another log begins there, cut the log there";

/// Remedy for a force. `is_alone`: the row has no other cell.
#[cold]
#[must_use]
pub fn of_force(cell: &[u8], unit: Unit, is_alone: bool) -> String {
    let said = text(cell);
    if Label::new(said).holds_force() {
        "names again: take it out if the same columns go on below, else cut the log there"
            .to_string()
    } else if is_alone && said.starts_with(char::is_alphabetic) {
        format!("{CORRECT}; NaN marks a bad reading; {FOOTER}")
    } else if number(cell, Decimal::Any).is_some() && unit != Unit::Counts {
        "the rows before have another decimal mark: write all with the same".to_string()
    } else if is_grouped(cell) {
        "write it without marks between the thousands".to_string()
    } else if cell.iter().any(|byte| b",;\t".contains(byte)) {
        format!("{CORRECT}, or is the separator another? (--delimiter)")
    } else if said.contains(char::is_numeric) && unit != Unit::Counts {
        "write the number alone, such as -12.5, and its unit into the name of the column; NaN marks a \
         bad reading"
            .to_string()
    } else {
        format!("{CORRECT}; NaN marks a bad reading")
    }
}

/// Remedy for a row with too few or too many cells.
#[cold]
#[must_use]
pub fn of_width(line: &[u8], cells: usize) -> String {
    match (cells, line.iter().find(|byte| !b" \t\"".contains(byte))) {
        (1, Some(first)) if first.is_ascii_digit() => {
            format!("{CORRECT}, or is the separator another? (--delimiter)")
        }
        (2.., Some(first)) if !first.is_ascii_alphabetic() => CORRECT.to_string(),
        (_, Some(_)) => format!("{CORRECT}; {FOOTER}"),
        (_, None) => CORRECT.to_string(),
    }
}

/// The error for a time, with its remedy.
#[cold]
#[must_use]
pub fn no_time(cell: &[u8]) -> InputError {
    InputError::new(format!("no time can be read from {}; {}", excerpt(cell), of_time(text(cell))))
}

fn of_time(cell: &str) -> &'static str {
    const DATE: &str = "write 2012-02-29 12:00:00 or 29.02.2012 12:00:00";
    let colons = cell.bytes().filter(|&byte| byte == b':').count();
    let before = cell.split(':').next().unwrap_or_default();
    let has_date = before.contains(['-', '/', '.', ',', 'T']) || before.trim().len() > 5;
    match colons {
        _ if is_words(cell) => FOOTER,
        _ if cell.contains(" day") => "write a time that runs on in seconds",
        _ if is_with_unit(cell) => {
            "write the number alone, and its unit into the name of the column"
        }
        1.. if names_zone(cell) => "write its zone as an offset, such as +01:00",
        _ if cell.to_lowercase().contains(".m.") => "write AM or PM without points",
        _ if cell.contains('\u{2212}') => "write the minus of its zone as -",
        4.. => DATE,
        3 if !has_date => "write parts of a second behind a point: 12:00:00.5",
        2 if !has_date && is_clock(cell) => {
            "a time of day ends with 24:00:00; write a time that runs on in seconds"
        }
        1 if !has_date && is_clock(cell) => "write hours, minutes and seconds: 00:12:34.5",
        1.. if !has_date => "write a time of day as 12:00:00.5, AM or PM may stand behind it",
        0 if cell.bytes().filter(u8::is_ascii_digit).count() < 6 => CORRECT,
        _ => DATE,
    }
}

/// Whether a cell is text without a digit, and no missing number: `Mean:`, `Channels`.
fn is_words(cell: &str) -> bool {
    let is_number = || number(cell.as_bytes(), Decimal::Any).is_some();
    cell.starts_with(char::is_alphabetic)
        && !cell.bytes().any(|byte| byte.is_ascii_digit())
        && !is_number()
        && !is_missing(cell.as_bytes())
}

/// Whether a cell contains digits and marks only.
fn is_clock(cell: &str) -> bool {
    cell.bytes().all(|byte| byte.is_ascii_digit() || b":.,".contains(&byte))
}

/// Whether a cell is a number with its unit: `62.5 ms`.
fn is_with_unit(cell: &str) -> bool {
    let unit = cell.trim_start_matches(|first: char| !first.is_alphabetic());
    unit.len() < cell.len() && !cell.contains(':') && TimeUnit::from_label(unit).is_some()
}

/// Whether a stamp contains the name of a zone: `CET` at the end, `UTC+1`, `[Europe/Oslo]`.
fn names_zone(stamp: &str) -> bool {
    let word = stamp.rsplit(' ').next().unwrap_or_default();
    let is_zone = (3..=4).contains(&word.len()) && word.bytes().all(|b| b.is_ascii_uppercase());
    is_zone && stamp.len() > word.len() || ["UTC", "GMT", "["].iter().any(|it| stamp.contains(it))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times() {
        let table = [
            ("0 days 00:00:01.0625", "in seconds"),
            ("0 sec", "the number alone"),
            ("2012-02-29 09:12:30 UTC+1", "as an offset"),
            ("2012-02-29T09:12:30+01:00[Europe/Oslo]", "as an offset"),
            ("AM 11:59:30.0", "AM or PM may stand behind it"),
            ("11:59:30.0A", "AM or PM may stand behind it"),
            ("09.12.30.0625", "2012-02-29 12:00:00"),
            ("20120229 091230.5", "2012-02-29 12:00:00"),
            ("Wed Feb 29 09:12:30 2012", "2012-02-29 12:00:00"),
            ("30:00:00", "24:00:00"),
            ("00:30.5", "hours, minutes and seconds"),
            ("12:00:00:0625", "behind a point"),
            ("", "correct the line"),
            ("NaN", "correct the line"),
            ("missing", "correct the line"),
            ("Mean:", "cut the log there"),
        ];
        for (cell, remedy) in table {
            assert!(of_time(cell).contains(remedy), "{cell}: {}", of_time(cell));
        }
    }

    #[test]
    fn rows_of_another_width() {
        for (line, cells, remedy) in [
            ("0.0625;12.5", 1, "(--delimiter)"),
            ("0.0625,12.5,3", 3, "take it out"),
            ("\"2012-02-29 12:00:00\",1", 2, "take it out"),
            ("\"TOA5\",\"CR1000\"", 2, "cut the log there"),
            ("Mean", 1, "cut the log there"),
            ("\u{7}", 1, "cut the log there"),
        ] {
            let said = of_width(line.as_bytes(), cells);
            assert!(said.ends_with(remedy), "{line}: {said}");
        }
    }

    #[test]
    fn forces() {
        let table = [
            ("114.035 # slip", "the number alone"),
            ("(0.47)", "the number alone"),
            ("1_006.06", "between the thousands"),
            ("OL", "NaN marks"),
        ];
        for (cell, remedy) in table {
            let said = of_force(cell.as_bytes(), Unit::Newton, false);
            assert!(said.contains(remedy), "{cell}: {said}");
        }
    }
}
