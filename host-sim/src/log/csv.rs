//! CSV: a header line, a time column and a force column.

use crate::error::InputError;

use super::LogOptions;
use super::cells::texts;
use super::number::{Unit, finite};
use super::rows::{Layout, TimeCells};

const TIME_COLUMNS: [&str; 4] = ["time_s", "t_s", "t", "time"];
const FORCE_COLUMNS: [(&str, Unit); 2] =
    [("force_n", Unit::Newton), ("force_kn", Unit::Kilonewton)];

/// Finds the columns in a header line.
///
/// # Errors
/// No header, or a column that is not there.
pub fn layout(header: &[u8], options: &LogOptions) -> Result<Layout, InputError> {
    let separator = separator(header);
    let names = texts(header, separator);
    if names.iter().all(|name| name.is_empty() || finite(name.as_bytes()).is_some()) {
        return Err(InputError::new("no header line; name the columns, e.g. 'time_s,force_n'"));
    }
    let (force, unit) = match &options.column {
        Some(name) => {
            let force = find(&names, name).ok_or_else(|| no_column(name, &names))?;
            (force, options.unit.unwrap_or(Unit::Newton))
        }
        None => default_force(&names, options.unit)?,
    };
    let time = TIME_COLUMNS.iter().find_map(|name| find(&names, name)).ok_or_else(|| {
        InputError::new(format!("no time column (time_s, t_s, t or time); {}", there_are(&names)))
    })?;
    Ok(Layout {
        separator,
        width: Some(names.len()),
        time: TimeCells::Seconds(time),
        force,
        unit,
        record: None,
        array_id: None,
        resolution_s: None,
    })
}

fn default_force(names: &[String], unit: Option<Unit>) -> Result<(usize, Unit), InputError> {
    let mut columns = FORCE_COLUMNS.iter();
    let found = columns.find_map(|&(name, its)| Some((find(names, name)?, unit.unwrap_or(its))));
    found.ok_or_else(|| {
        let there_are = there_are(names);
        InputError::new(format!("no column force_n or force_kn: give --column NAME; {there_are}"))
    })
}

/// Place of a column: by its exact name, else whatever the case.
#[must_use]
pub fn find(names: &[String], name: &str) -> Option<usize> {
    let exact = names.iter().position(|n| n == name);
    exact.or_else(|| names.iter().position(|n| n.eq_ignore_ascii_case(name)))
}

/// The error for a column that is not there.
#[must_use]
pub fn no_column(name: &str, names: &[String]) -> InputError {
    InputError::new(format!("no column '{name}'; {}", there_are(names)))
}

/// The columns there are, for a message.
#[must_use]
pub fn there_are(names: &[String]) -> String {
    const MOST: usize = 60;
    let more = if names.len() > MOST { ", ..." } else { "" };
    let shown: Vec<String> = names
        .iter()
        .take(MOST)
        .map(|n| n.chars().take(40).flat_map(char::escape_debug).collect())
        .collect();
    format!("there are: {}{more}", shown.join(", "))
}

/// A semicolon or a tab in the header is never part of a name; a comma may be.
fn separator(header: &[u8]) -> u8 {
    *b";\t".iter().find(|separator| header.contains(separator)).unwrap_or(&b',')
}

#[cfg(test)]
mod tests {
    use super::*;

    fn places(header: &str, column: Option<&str>) -> Result<(usize, usize, Unit), String> {
        let options = LogOptions { column: column.map(str::to_string), ..LogOptions::default() };
        let layout = layout(header.as_bytes(), &options).map_err(|e| e.to_string())?;
        let TimeCells::Seconds(time) = layout.time else { panic!("not seconds") };
        Ok((time, layout.force, layout.unit))
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
        assert!(places("0.0,1.5", None).unwrap_err().starts_with("no header line"));
    }
}
