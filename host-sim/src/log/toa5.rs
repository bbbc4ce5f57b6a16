//! TOA5: Campbell's text table with four header lines.

use crate::error::InputError;

use super::LogOptions;
use super::cells::texts;
use super::columns::Columns;
use super::csv::{Found, find, there_are};
use super::header::Header;
use super::layout::{Layout, TimeCells};
use super::metadata::Said;
use super::number::{Decimal, Unit};
use super::stamp::TimeUnit;

/// Name of the table for a test whose logger did not know the date.
pub const UNDATED: &str = "pull_undated";

/// Finds the columns in the second and third header line: names and units.
///
/// Without `--column` it is `force_n`, `force_kn` or the only column with a unit of force. `said`:
/// the unit in a comment.
///
/// # Errors
/// A missing column, a unit that is not one of force, a units row that is too short, units that
/// contradict each other.
pub fn layout(
    names: &[u8],
    units: &[u8],
    options: &LogOptions,
    said: Option<&Said>,
) -> Result<Found, InputError> {
    let names = texts(names, b',');
    let units = texts(units, b',');
    if names.len() == 1 {
        return Err(InputError::new("no comma is between its names: save it with commas"));
    }
    if units.len() != names.len() {
        let (names, units) = (names.len(), units.len());
        let message = format!("{names} names, but {units} units in the row below");
        return Err(InputError::new(message));
    }
    let header = header(names, units.clone());
    let columns = Columns::new(&header);
    let time_column = options.time_column.as_deref().unwrap_or("TIMESTAMP");
    let time = header.column(time_column, "--time-column")?;
    let force = match &options.column {
        Some(wanted) => header.column(wanted, "--column")?,
        None => default_force(columns.names, &units)?,
    };
    let record = find(columns.names, "RECORD", "--column")?;
    let (unit, mut notes) = columns.force_unit(force, options, said)?;
    if options.column.is_none() {
        notes.extend(columns.other_forces(force, unit, Decimal::Point)?);
    }
    let layout = Layout {
        separator: b',',
        decimal: Decimal::Point,
        width: Some(header.width),
        time: TimeCells::Number { cell: time, unit: TimeUnit::Iso },
        force,
        unit,
        record,
        array_id: None,
        resolution_s: None,
        seconds_unsaid: false,
        part: None,
        unit_cell: None,
    };
    Ok((layout, notes))
}

/// The header of a log without comments, before its rows are read.
fn header(names: Vec<String>, units: Vec<String>) -> Header {
    Header {
        separator: b',',
        width: names.len(),
        names: Some((2, names)),
        units: Some((3, units)),
        first_row: 5,
        rows: Vec::new(),
        unit_above: None,
    }
}

fn default_force(names: &[String], units: &[String]) -> Result<usize, InputError> {
    let both = ["force_n", "force_kn"].map(|name| find(names, name, "--column"));
    match both {
        [Ok(Some(place)), Ok(None)] | [Ok(None), Ok(Some(place))] => return Ok(place),
        [Ok(Some(_)), Ok(Some(_))] => {
            return Err(InputError::new(
                "force_n and force_kn are both there: give --column NAME of the one to read",
            ));
        }
        [Ok(None), Ok(None)] => {}
        [Err(error), _] | [_, Err(error)] => return Err(error),
    }
    let is_force = |&i: &usize| {
        units.get(i).and_then(|u| Unit::from_label(u)).is_some_and(|u| u.newtons().is_some())
    };
    let mut by_unit = (0..names.len()).filter(is_force);
    let only = by_unit.next().filter(|_| by_unit.next().is_none());
    only.ok_or_else(|| {
        let there_are = there_are(names);
        InputError::new(format!("which column is the force? give --column NAME; {there_are}"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const NAMES: &[u8] = b"\"TIMESTAMP\",\"RECORD\",\"Pull\",\"Batt\"";

    fn places(units: &str, options: &LogOptions) -> Result<(usize, Unit), String> {
        let found = layout(NAMES, units.as_bytes(), options, None).map_err(|e| e.to_string())?;
        let layout = found.0;
        let stamp = TimeCells::Number { cell: 0, unit: TimeUnit::Iso };
        assert_eq!((layout.time, layout.record), (stamp, Some(1)));
        Ok((layout.force, layout.unit))
    }

    #[test]
    fn a_force_in_both_units_is_asked_for() {
        let names = ["TIMESTAMP", "force_n", "force_kn"].map(str::to_string);
        let error = default_force(&names, &[]).unwrap_err().to_string();
        assert!(error.contains("--column NAME"), "{error}");
        assert_eq!(default_force(&names[..2], &[]).unwrap(), 1);
    }

    #[test]
    fn the_units_row_tells_column_and_unit() {
        let options = LogOptions::default();
        assert_eq!(places("TS,RN,kN,Volts", &options), Ok((2, Unit::Kilonewton)));
        assert!(places("TS,RN,kN,N", &options).unwrap_err().contains("--column NAME"));
        assert!(places("TS,RN,,", &options).unwrap_err().contains("--column NAME"));
    }

    #[test]
    fn a_named_column_needs_a_unit_of_force() {
        let mut options = LogOptions { column: Some("Batt".to_string()), ..LogOptions::default() };
        assert_eq!(places("TS,RN,kN,", &options), Ok((3, Unit::Newton)));
        assert!(places("TS,RN,kN,Volts", &options).unwrap_err().contains("is 'Volts'"));
        options.unit = Some(Unit::PoundForce);
        assert_eq!(places("TS,RN,kN,Volts", &options), Ok((3, Unit::PoundForce)));
        options.column = Some("4".to_string());
        assert_eq!(places("TS,RN,kN,Volts", &options), Ok((3, Unit::PoundForce)));
        options.column = Some("Pull".to_string());
        let error = places("TS,RN,kN,Volts", &options).unwrap_err();
        assert!(error.starts_with("column 'Pull' is in kN, and --unit says lbf"), "{error}");
    }

    #[test]
    fn a_unit_that_is_not_in_its_row_is_said_or_asked_for() {
        let options = LogOptions { column: Some("3".to_string()), ..LogOptions::default() };
        let notes = |name: &str| {
            let names = format!("TIMESTAMP,RECORD,{name},force_n");
            let found = layout(names.as_bytes(), b"TS,RN,,N", &options, None);
            found.map(|(layout, notes)| (layout.unit, notes)).map_err(|e| e.to_string())
        };
        let assumed = "column 'Load' has no unit: taken as N".to_string();
        assert_eq!(notes("Load"), Ok((Unit::Newton, vec![assumed])));
        let error = notes("Load_kgf_Avg").unwrap_err();
        assert!(error.starts_with("the name of column 'Load_kgf_Avg' holds 'kgf'"), "{error}");
        let other = layout(b"TIMESTAMP,Pull,force_n", b"TS,kN,N", &LogOptions::default(), None);
        let other = other.map(|(_, notes)| notes).map_err(|e| e.to_string());
        let said = "'force_n' is read, not 'Pull': --column takes another".to_string();
        assert_eq!(other, Ok(vec![said]));
    }

    #[test]
    fn a_short_units_row_is_refused() {
        let error = places("TS,RN,kN", &LogOptions::default()).unwrap_err();
        assert_eq!(error, "4 names, but 3 units in the row below");
    }
}
