//! The unit of the forces where their column does not say it: a comment.

use crate::error::InputError;

use super::LogOptions;
use super::columns::said;
use super::label::unit_within;
use super::metadata::Said;
use super::number::Unit;
use super::rows::Rows;

/// The unit that a comment says.
///
/// # Errors
/// It is none.
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

/// A force without a unit is in N, unless its name holds another one.
///
/// # Errors
/// Names that unit.
pub fn assumed(name: &str) -> Result<(Unit, Vec<String>), InputError> {
    match unit_within(name) {
        Some(unit) => Err(InputError::new(format!(
            "the name of column '{name}' holds '{unit}': give the unit, --unit N|kN|lbf|kgf|counts"
        ))),
        None => Ok((Unit::Newton, vec![format!("{} has no unit: taken as N", said(name))])),
    }
}

/// Refuses a `# unit:` that the forces are not read in.
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
        None => format!(
            "the forces are read in {}: correct it, or write it above the rows",
            read.name()
        ),
    };
    Err(InputError::new(format!("line {line}: '# unit: {value}', and {why}")))
}
