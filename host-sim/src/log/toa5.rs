//! TOA5: Campbell's text table with four header lines.

use crate::error::{InputError, excerpt};

use super::LogOptions;
use super::cells::texts;
use super::csv::{agreed, column, find, there_are};
use super::label::Label;
use super::layout::{Layout, TimeCells};
use super::number::{Decimal, Unit};
use super::stamp::TimeUnit;

/// Name of the table for a test whose logger did not know the date.
pub const UNDATED: &str = "pull_undated";

/// Finds the columns in the second and third header line: names and units.
///
/// Without `--column` it is `force_n`, `force_kn` or the only column with a unit of force.
///
/// # Errors
/// A missing column, a unit that is not one of force, a units row that is too short, units that
/// contradict each other.
pub fn layout(names: &[u8], units: &[u8], options: &LogOptions) -> Result<Layout, InputError> {
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
    let time_column = options.time_column.as_deref().unwrap_or("TIMESTAMP");
    let time = column(&names, names.len(), time_column, "--time-column")?;
    let force = match &options.column {
        Some(wanted) => column(&names, names.len(), wanted, "--column")?,
        None => default_force(&names, &units)?,
    };
    let label = units.get(force).map_or("", String::as_str);
    let name = names.get(force).map_or("", String::as_str);
    let stated: Vec<Unit> =
        Label::new(name).force_unit().into_iter().chain(Unit::from_label(label)).collect();
    let unit = agreed(name, &stated, options.unit)?.or_else(|| unit(label)).ok_or_else(|| {
        let label = excerpt(label.as_bytes());
        InputError::new(format!("the column's unit is {label}: give --unit N|kN|lbf|kgf|counts"))
    })?;
    Ok(Layout {
        separator: b',',
        decimal: Decimal::Point,
        width: Some(names.len()),
        time: TimeCells::Number { cell: time, unit: TimeUnit::Iso },
        force,
        unit,
        record: find(&names, "RECORD", "--column")?,
        array_id: None,
        resolution_s: None,
        seconds_unsaid: false,
    })
}

/// The unit of a label; none means newtons, as for a named column of a CSV file.
fn unit(label: &str) -> Option<Unit> {
    if label.is_empty() { Some(Unit::Newton) } else { Unit::from_label(label) }
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
        let layout = layout(NAMES, units.as_bytes(), options).map_err(|e| e.to_string())?;
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
    fn a_short_units_row_is_refused() {
        let error = places("TS,RN,kN", &LogOptions::default()).unwrap_err();
        assert_eq!(error, "4 names, but 3 units in the row below");
    }
}
