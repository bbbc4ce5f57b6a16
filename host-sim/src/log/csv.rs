//! Text tables: columns of time and force, and their units.

use crate::error::{InputError, beginning, excerpt};

use super::LogOptions;
use super::columns::Columns;
use super::header::Header;
use super::layout::{Layout, TimeCells};
use super::metadata::Metadata;

/// A layout, and the assumptions made to find it.
pub type Found = (Layout, Vec<String>);

/// Finds the columns below a header.
///
/// `metadata` is from comments above the rows: without a rate, rows need a time.
///
/// # Errors
/// A column that is missing or ambiguous, units that contradict each other.
pub fn layout(
    header: &Header,
    options: &LogOptions,
    metadata: &Metadata,
) -> Result<Found, InputError> {
    let columns = Columns::new(header);
    let time = columns.time(options)?;
    let force = columns.force(options, time)?;
    if time == Some(force) {
        return Err(InputError::new(format!(
            "column {} cannot be the time and the force: give --time-column and --column",
            force + 1
        )));
    }
    let (unit, mut notes) = columns.force_unit(force, options, metadata.first("unit"))?;
    let decimal = columns.decimal(force, time, options)?;
    if options.column.is_none() {
        notes.extend(columns.only_force(force, time)?);
        notes.extend(columns.other_forces(force, unit, decimal)?);
    }
    if let (Some(time), None) = (time, &options.time_column) {
        columns.refuse_other_times(time, decimal)?;
    }
    let time = match (time, options.rate_hz.or(metadata.rate_hz)) {
        (Some(cell), Some(rate_hz)) if columns.is_counter(cell, options, decimal) => {
            TimeCells::Numbered { cell, rate_hz }
        }
        (Some(time), _) => columns.time_cells(time, options, decimal)?,
        (None, Some(rate_hz)) => TimeCells::Count { rate_hz },
        (None, None) => return Err(columns.no_time(force)),
    };
    columns.refuse_channels(time, force, options)?;
    columns.refuse_no_zeros(time)?;
    notes.extend(columns.assumed_seconds(time, options));
    if header.names.is_none() {
        let time = if header.width > 1 { "the first column is the time, " } else { "" };
        notes.insert(0, format!("no header: {time}column {} is the force", force + 1));
    }
    let (part, note) = columns.part_of_second(time, force, decimal).unzip();
    notes.extend(note);
    let layout = Layout {
        separator: header.separator,
        decimal,
        width: Some(header.width),
        time,
        force,
        unit,
        record: None,
        array_id: None,
        resolution_s: None,
        seconds_unsaid: columns.seconds_unsaid(time, options),
        part,
        unit_cell: columns.unit_cell(force)?,
    };
    Ok((layout, notes))
}

/// The unit from those that a column states and the given one, of which `option` is the name.
///
/// # Errors
/// The units contradict each other.
pub fn agreed<T: Copy + PartialEq>(
    name: &str,
    stated: &[T],
    given: Option<T>,
    text: fn(T) -> &'static str,
    option: &str,
) -> Result<Option<T>, InputError> {
    let Some(first) = stated.first().copied() else { return Ok(given) };
    if let Some(other) = stated.iter().find(|&&other| other != first) {
        return Err(InputError::new(format!(
            "column '{name}' is in {} by its name and in {} below it; correct the log",
            text(first),
            text(*other)
        )));
    }
    match given.filter(|&given| given != first) {
        Some(given) => Err(InputError::new(format!(
            "column '{name}' is in {}, and {option} says {}; leave {option} out, or correct the \
             column's name",
            text(first),
            text(given)
        ))),
        None => Ok(Some(first)),
    }
}

/// Index of a column by its exact name, or else ignoring case.
///
/// # Errors
/// Two columns have the name.
pub fn find(names: &[String], name: &str, option: &str) -> Result<Option<usize>, InputError> {
    let exact = |n: &String| n == name;
    let alike = |n: &String| n.eq_ignore_ascii_case(name);
    let places = |is: &dyn Fn(&String) -> bool| {
        names.iter().enumerate().filter(|(_, n)| is(n)).map(|(i, _)| i).collect::<Vec<usize>>()
    };
    let found = Some(places(&exact)).filter(|found| !found.is_empty());
    match found.unwrap_or_else(|| places(&alike)).as_slice() {
        [] => Ok(None),
        [only] => Ok(Some(*only)),
        [first, second, ..] => Err(InputError::new(format!(
            "columns {} and {} are both called '{name}': name the one by its number, e.g. \
             {option} {}",
            first + 1,
            second + 1,
            second + 1
        ))),
    }
}

impl Header {
    /// Index of a column by its name, or by its number from 1.
    ///
    /// # Errors
    /// No column or several columns have the name.
    pub fn column(&self, wanted: &str, option: &str) -> Result<usize, InputError> {
        let (names, width) = (self.column_names(), self.width);
        if let Some(place) = find(names, wanted, option)? {
            return Ok(place);
        }
        match wanted.parse::<usize>() {
            Ok(number) if (1..=width).contains(&number) => Ok(number - 1),
            _ if names.is_empty() => Err(InputError::new(format!(
                "no column {}: without a header a column is a number from 1 to {width}",
                excerpt(wanted.as_bytes())
            ))),
            _ => Err(InputError::new(format!("no column '{wanted}'; {}", there_are(names)))),
        }
    }
}

/// The existing columns, for a message.
#[must_use]
pub fn there_are(names: &[String]) -> String {
    const MOST: usize = 60;
    let more = if names.len() > MOST { ", ..." } else { "" };
    let shown: Vec<String> = names.iter().take(MOST).map(|name| beginning(name)).collect();
    format!("there are: {}{more}", shown.join(", "))
}

#[cfg(test)]
mod tests {
    use super::super::header;
    use super::*;
    use crate::log::number::Unit;
    use crate::log::stamp::TimeUnit;

    fn places(text: &str, column: Option<&str>) -> Result<(usize, usize, Unit), String> {
        let options = LogOptions { column: column.map(str::to_string), ..LogOptions::default() };
        let header = header::find(text.as_bytes(), b'\n', 0, None).map_err(|e| e.to_string())?;
        let (layout, _) =
            layout(&header, &options, &Metadata::default()).map_err(|e| e.to_string())?;
        let TimeCells::Number { cell, unit: TimeUnit::Second } = layout.time else {
            panic!("not seconds")
        };
        Ok((cell, layout.force, layout.unit))
    }

    #[test]
    fn columns_by_name() {
        assert_eq!(places("time_s,force_n", None), Ok((0, 1, Unit::Newton)));
        assert_eq!(places("a;Force_kN;T", None), Ok((2, 1, Unit::Kilonewton)));
        assert_eq!(places("t\tx\ty", Some("y")), Ok((0, 2, Unit::Newton)));
        assert_eq!(places("\"time\",\"force_n\"", None), Ok((0, 1, Unit::Newton)));
    }

    #[test]
    fn what_is_missing_is_named() {
        let error = places("t,a,b", Some("c")).unwrap_err();
        assert_eq!(error, "no column 'c'; there are: t, a, b");
        assert!(places("a,force_n", None).unwrap_err().starts_with("no time column"));
        assert!(places("t,a", None).unwrap_err().contains("give --column NAME; there are: t, a"));
        assert!(places("0,1,2\n1,2,3\n", None).unwrap_err().starts_with("no header line"));
    }
}
