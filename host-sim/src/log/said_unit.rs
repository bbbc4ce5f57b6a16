//! The unit of forces whose column does not state it: from a comment, or a line above the rows.

use crate::error::InputError;

use super::cells::words;
use super::columns::said;
use super::header::{Content, Header};
use super::label::{Label, is_foreign, unit_within};
use super::metadata::Said;
use super::number::{Unit, finite};
use super::rows::Rows;
use super::{LogOptions, comment::comment};

/// A force without a unit is in N, unless its name or a line above contains another unit.
///
/// # Errors
/// Names that unit.
pub fn assumed(header: &Header, column: usize) -> Result<(Unit, Vec<String>), InputError> {
    const GIVE: &str = "--unit N|kN|lbf|kgf|counts";
    let name = header.name(column);
    match (unit_within(name), &header.unit_above) {
        (Some(unit), _) => Err(InputError::new(format!(
            "the name of column '{name}' holds '{unit}': give the unit, {GIVE}"
        ))),
        (None, Some((line, unit))) => Err(InputError::new(format!(
            "{} has no unit, and line {line} holds '{unit}': give the unit, {GIVE}",
            said(name)
        ))),
        (None, None) => Ok((Unit::Newton, vec![format!("{} has no unit: taken as N", said(name))])),
    }
}

/// The unit in a comment.
///
/// # Errors
/// The text is no unit.
pub fn commented(said: &Said) -> Result<(Unit, Vec<String>), InputError> {
    let Said { key, value, line } = said;
    let unit = Unit::from_label(value).ok_or_else(|| {
        InputError::new(format!(
            "'# {key}: {value}' in line {line} is no unit that is read: write N, kN, lbf, kgf or counts, \
             or give --unit"
        ))
    })?;
    Ok((unit, Vec::new()))
}

/// The first line that contains a unit of force other than N, and that unit.
#[must_use]
pub fn unit_above(lines: &[Content<'_>]) -> Option<(u64, String)> {
    lines.iter().find_map(|(number, line)| {
        let text = words(comment(line).unwrap_or(line));
        Some((*number, unit_held(&text)?.to_string()))
    })
}

/// A unit in a line, except that of a number (`Load cell: 5 kN`) or of a key (`mass_kg: 64`).
fn unit_held(line: &str) -> Option<&str> {
    let end = line.trim_end_matches(|mark: char| mark.is_whitespace() || ",;".contains(mark));
    let value = end.rsplit([':', '=', ',', ';', '\t']).next().unwrap_or_default();
    if finite(value.trim().as_bytes()).is_some() {
        return None;
    }
    let is_other = |word: &str| {
        Unit::from_label(word).is_some_and(|unit| unit != Unit::Newton && unit != Unit::Counts)
    };
    let foreign = |word: &str, before: &str| is_foreign(word) && tells_unit(line, before);
    let mut before = "";
    for piece in line.split_inclusive(|letter: char| !letter.is_alphanumeric()) {
        let word = piece.trim_end_matches(|letter: char| !letter.is_alphanumeric());
        let before_marks = before.trim_end_matches([' ', '\t', ',', ';', ':', '=']);
        let is_of_number = before_marks.ends_with(|last: char| last.is_ascii_digit());
        if (is_other(word) || foreign(word, before)) && !is_of_number && !piece.ends_with('/') {
            return Some(word);
        }
        before = if piece.trim().is_empty() { before } else { piece };
    }
    None
}

/// Whether a word behind `before` is a unit, even one that is not read: `Y_Unit_Label mV`, `Force in g`.
fn tells_unit(line: &str, before: &str) -> bool {
    const NAMES: [&str; 4] = ["unit", "units", "einheit", "einheiten"];
    let line = line.to_lowercase();
    let mut words = line.split(|letter: char| !letter.is_alphanumeric());
    let is_behind = before.trim() == "in" || before.ends_with(['(', '[']);
    words.any(|word| NAMES.contains(&word)) || is_behind && Label::new(&line).holds_force()
}

/// Rejects a name with another unit besides that which is read: `Force (N) kN`.
///
/// # Errors
/// Names both.
pub fn refuse_second(name: &str, quantity: &str, unit: Unit) -> Result<(), InputError> {
    match unit_held(quantity).filter(|held| Unit::from_label(held) != Some(unit)) {
        Some(held) => Err(InputError::new(format!(
            "column '{name}' is in {} and in {}: correct its name, or give --unit",
            unit.name(),
            Unit::from_label(held).map_or(held, |unit| unit.name())
        ))),
        None => Ok(()),
    }
}

/// Rejects a `# unit:` other than the unit in use.
///
/// # Errors
/// Names its line.
pub fn refuse_other_unit(rows: &Rows, options: &LogOptions) -> Result<(), InputError> {
    let Some(Said { value, line, .. }) = rows.metadata.first("unit") else { return Ok(()) };
    let read = rows.layout().unit;
    if Unit::from_label(value).is_none_or(|said| said == read) {
        return Ok(());
    }
    let why = match options.unit {
        Some(unit) => {
            format!("--unit says {}: leave --unit out, or correct the comment", unit.name())
        }
        None if rows.layout().array_id.is_some() => format!(
            "the forces of a cr10 log are read in {}: give --unit, or correct the comment",
            read.name()
        ),
        None => format!(
            "the forces are read in {}: correct it, or write it above the rows",
            read.name()
        ),
    };
    Err(InputError::new(format!("line {line}: '# unit: {value}', and {why}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_in_the_lines_above() {
        for line in
            ["Y_Unit_Label\tkN", "units: s, kN", "Force in kN", "F 1 (kN)", "time_s;force_kn"]
        {
            assert!(unit_held(line).is_some_and(|unit| unit.eq_ignore_ascii_case("kN")), "{line}");
        }
        for (line, unit) in [
            ("Y_Unit_Label\tVolts", "Volts"),
            ("Unit;g", "g"),
            ("Force in daN", "daN"),
            ("# load [mV]", "mV"),
        ] {
            assert_eq!(unit_held(line), Some(unit), "{line}");
        }
        for line in [
            "Load cell: 5 kN",
            "Version V, Serie G",
            "Force cell sensitivity (mV/V)",
            "Time (s), Supply (V)",
            "mass_kg: 64",
            "Mass\t64 kg",
            "600 kg/m3, in kg/m3",
            "Unit,N",
            "Mass,64,kg",
        ] {
            assert_eq!(unit_held(line), None, "{line}");
        }
    }
}
