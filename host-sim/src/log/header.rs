//! Finds the first row of a text table, and the header above.
//!
//! ```text
//!  Channel 1, pull          preamble: read for '# key: value' only
//!  Time;Force               names
//!  [s];[kN]                 units
//!  0,0625;1,25              rows: values, equally many in each
//! ```
//!
//! The rows are found first: a line with values, followed by lines with values in the same places.
//! The lines directly above are their header.

use crate::error::InputError;

use super::above;
use super::cells::texts;
use super::comment::{comment, is_empty, is_ruler};
use super::label::{Label, bare_unit, is_unit_cell};
use super::lines::MAX_LINE;
use super::number::{Unit, finite, is_missing};
use super::said_unit::unit_above;
use super::stamp::{clock_seconds, date_seconds, date_time_seconds};

/// Number of rows whose cells are examined.
const LOOKED_AT: usize = 64;
/// Number of lines searched at once for the first row.
const LOOKED_THROUGH: usize = 268;
/// Number of consecutive rows that make a table.
pub(super) const IN_A_ROW: usize = 4;
/// Separators in the order of trial: the first ones never occur in a number or stamp, the last ones
/// may.
pub(super) const SEPARATORS: [u8; 5] = *b";\t|, ";

/// The head of a text table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Header {
    /// Separator of the cells; a blank means any number of blanks.
    pub separator: u8,
    /// Line number and names; `None` if the rows have no header.
    pub names: Option<(u64, Vec<String>)>,
    /// Line number and units below the names, one per column.
    pub units: Option<(u64, Vec<String>)>,
    /// Line of the first row.
    pub first_row: u64,
    /// Number of cells in a row.
    pub width: usize,
    /// Cells of the first rows.
    pub rows: Vec<Vec<String>>,
    /// Line above names and rows that contains a unit of force other than N, and that unit.
    pub unit_above: Option<(u64, String)>,
}

/// Kind of a cell's text.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Value,
    Empty,
    Text,
}

pub(super) fn kind(cell: &str) -> Kind {
    let is_stamp = || {
        date_time_seconds(cell.as_bytes()).or(date_seconds(cell)).or(clock_seconds(cell)).is_some()
    };
    match cell {
        "" => Kind::Empty,
        cell if is_number(cell) || is_stamp() || holds_clock(cell) => Kind::Value,
        _ => Kind::Text,
    }
}

/// Whether a cell contains a time of day, also in unsupported forms: `2/29/2012 9:12:30 AM`.
fn holds_clock(cell: &str) -> bool {
    let clock = |w: &[u8]| matches!(w, [a, b':', b] if a.is_ascii_digit() && b.is_ascii_digit());
    // Other cells behind it: `12:00:00.5,ok,1.25` is what a blank leaves of a row.
    let is_one = cell.matches([',', ';', '\t', '|']).count() < 2;
    is_one
        && cell.starts_with(|first: char| first.is_ascii_digit())
        && cell.as_bytes().windows(3).any(clock)
}

/// Whether a cell is a number; NaN and infinity count, since they are readings.
fn is_number(cell: &str) -> bool {
    finite(cell.as_bytes()).is_some() || cell.parse::<f64>().is_ok()
}

/// Line number and content.
pub(super) type Content<'a> = (u64, &'a [u8]);

/// Finds the rows and their header in the beginning of a log, whose lines end with `end`. The first
/// `skip` lines are ignored.
///
/// # Errors
/// A header that does not fit its rows.
pub fn find(head: &[u8], end: u8, skip: u64, separator: Option<u8>) -> Result<Header, InputError> {
    let head = without_cut_line(head, end);
    let lines: Vec<Content<'_>> = (1..)
        .zip(head.split(|&byte| byte == end).map(|line| line.strip_suffix(b"\r").unwrap_or(line)))
        .filter(|(number, line)| *number > skip && !line.trim_ascii().is_empty())
        .collect();
    let is_content =
        |(_, line): &Content<'_>| comment(line).is_none() && !is_ruler(line) && !is_empty(line);
    let content: Vec<Content<'_>> = lines.iter().copied().filter(is_content).collect();
    if lines.is_empty() && skip > 0 {
        return Err(InputError::new(format!(
            "no line is left of the first {} KiB after --skip-lines {skip}",
            MAX_LINE / 1024
        )));
    }
    if end == b'\n' {
        above::refuse_mixed_ends(&lines)?;
    }
    let tried = separator.map_or(SEPARATORS.to_vec(), |one| vec![one]);
    let Some((separator, first)) = begin_of_rows(&content, &tried) else {
        above::refuse_no_table(head, end, &lines, content.is_empty())?;
        let header = without_rows(&content, separator);
        above::refuse_no_rows(&header, content.len())?;
        return Ok(header);
    };
    above::refuse_broken_names(&content, first)?;
    let header = header_above(&lines, &content, separator, first).or_else(|error| {
        // With blanks inside stamps, names separated in another way describe the rows better.
        let others: Vec<u8> = tried.iter().copied().filter(|&other| other != separator).collect();
        named_otherwise(&content, first, &others).ok_or(error)
    })?;
    above::refuse_later_names(&header, &content)?;
    let other = (header.names.is_none() && header.width > 2)
        .then(|| named_otherwise(&content, first, &tried))
        .flatten();
    Ok(other.unwrap_or(header))
}

/// The head without its last line if it may be cut off.
fn without_cut_line(head: &[u8], end: u8) -> &[u8] {
    let last = head.iter().rposition(|&byte| byte == end).filter(|_| head.len() >= MAX_LINE);
    last.and_then(|last| head.get(..last)).unwrap_or(head)
}

/// Handles rows split by the wrong separator, such as a decimal comma, if another separator gives
/// the names of a time and a force above them.
fn named_otherwise(content: &[Content<'_>], first: usize, separators: &[u8]) -> Option<Header> {
    let is_named = |separator: u8, line: &[u8]| above::are_named(&texts(line, separator));
    let mut separators = separators.iter().filter(|separator| **separator != b' ');
    let (from, separator) = separators.find_map(|&separator| {
        let above = content.get(..first)?;
        Some((above.iter().rposition(|(_, line)| is_named(separator, line))?, separator))
    })?;
    Some(without_rows(content.get(from..)?, Some(separator)))
}

/// Separator and index of the first row, if there are rows.
fn begin_of_rows(content: &[Content<'_>], separators: &[u8]) -> Option<(u8, usize)> {
    let all: fn(&[Kind]) -> bool = |kinds| kinds.len() > 1 && !kinds.contains(&Kind::Text);
    let two: fn(&[Kind]) -> bool = |kinds| kinds.iter().filter(|k| **k == Kind::Value).count() > 1;
    let one: fn(&[Kind]) -> bool = |kinds| kinds == [Kind::Value];
    let begin = |lines: &[Content<'_>]| {
        [all, two, one].into_iter().find_map(|is_row| {
            separators.iter().find_map(|&s| Some((s, first_run(lines, s, is_row)?)))
        })
    };
    // The text above the rows may be long.
    let mut starts = (0..content.len()).step_by(LOOKED_THROUGH - IN_A_ROW);
    let (separator, first) = starts.find_map(|from| {
        let (separator, first) = begin(content.get(from..)?)?;
        Some((separator, from + first))
    })?;
    Some((separator, with_broken_rows(content, separator, first)))
}

/// The first of several lines that have values, or words for missing values, in the same places.
fn first_run(content: &[Content<'_>], separator: u8, is_row: fn(&[Kind]) -> bool) -> Option<usize> {
    let kinds: Vec<Vec<Kind>> = content
        .iter()
        .take(LOOKED_THROUGH)
        .map(|(_, line)| texts(line, separator).iter().map(|cell| kind_in_row(cell)).collect())
        .collect();
    let alike = |first: &[Kind], other: &[Kind]| {
        let fits = |(a, b): (&Kind, &Kind)| *a != Kind::Value || *b != Kind::Text;
        first.len() == other.len() && first.iter().zip(other).all(fits)
    };
    (0..kinds.len()).find(|&at| {
        let first = kinds.get(at).map_or(&[][..], Vec::as_slice);
        let mut run = kinds.iter().skip(at).take(IN_A_ROW);
        has_value(first) && is_row(first) && run.all(|row| alike(first, row))
    })
}

/// Kind of a cell in a row; above the rows `NA` may be a name.
fn kind_in_row(cell: &str) -> Kind {
    if is_missing(cell.as_bytes()) { Kind::Value } else { kind(cell) }
}

fn has_value(kinds: &[Kind]) -> bool {
    kinds.contains(&Kind::Value)
}

/// Includes lines with a value directly above the rows and of the same width, as broken rows.
fn with_broken_rows(content: &[Content<'_>], separator: u8, mut first: usize) -> usize {
    let cells = |at: usize| content.get(at).map(|(_, line)| texts(line, separator));
    let width = cells(first).map_or(0, |cells| cells.len());
    while let Some(above) = first.checked_sub(1).and_then(cells) {
        let values = above.iter().any(|cell| kind(cell) == Kind::Value);
        if above.len() != width || !values {
            break;
        }
        first -= 1;
    }
    first
}

/// Header for a log without recognizable rows: the first line is taken for the names, and reading
/// the rows will report the problem.
fn without_rows(content: &[Content<'_>], separator: Option<u8>) -> Header {
    let (number, line) = content.first().copied().unwrap_or((1, b""));
    let found = || SEPARATORS.into_iter().find(|s| *s != b' ' && line.contains(s));
    let blanks = || Some(b' ').filter(|blank| are_known(&texts(line, *blank)));
    let separator = separator.or_else(found).or_else(blanks).unwrap_or(b',');
    let names = texts(line, separator);
    Header {
        separator,
        width: names.len(),
        names: Some((number, names)),
        units: None,
        first_row: number + 1,
        rows: Vec::new(),
        unit_above: None,
    }
}

fn header_above(
    lines: &[Content<'_>],
    content: &[Content<'_>],
    separator: u8,
    first: usize,
) -> Result<Header, InputError> {
    let rows: Vec<Vec<String>> =
        content.iter().skip(first).take(LOOKED_AT).map(|(_, l)| texts(l, separator)).collect();
    let (first_row, width) =
        (content.get(first).map_or(1, |(n, _)| *n), rows.first().map_or(0, Vec::len));
    let above = |back: usize| {
        let (number, line) = content.get(first.checked_sub(back)?)?;
        let cells = texts(line, separator);
        let are_cut = separator == b' ' && cells.len() > width;
        Some((*number, if are_cut { above::with_units(cells) } else { cells }))
    };
    above::refuse_unknown_row(above, width)?;
    let (names, units) = match (above(2), above(1)) {
        (Some(names), Some(units))
            if (units.1.len() > 1 || width == 1) && is_units(&units.1) && is_header(&names.1) =>
        {
            (Some(names), Some(units))
        }
        (units, Some(names)) if is_names(&names.1, width) => {
            let are_above = |(_, cells): &(u64, Vec<String>)| {
                cells.len() == width
                    && is_units(cells)
                    && cells.iter().any(|cell| is_force_unit(cell))
            };
            (Some(names), units.filter(are_above))
        }
        _ => (above::commented_names(lines, first_row, separator, width), None),
    };
    let used = [&names, &units].map(|line| line.as_ref().map(|(number, _)| *number));
    let is_other =
        |(number, _): &&Content<'_>| *number < first_row && !used.contains(&Some(*number));
    let others: Vec<Content<'_>> = lines.iter().filter(is_other).copied().collect();
    let unit_above = unit_above(&others);
    let mut header = Header { separator, names, units, first_row, width, rows, unit_above };
    header.check()?;
    Ok(header)
}

fn is_units(cells: &[String]) -> bool {
    cells.iter().all(|cell| is_unit_cell(cell)) && cells.iter().any(|cell| !cell.is_empty())
}

fn is_force_unit(cell: &str) -> bool {
    Unit::from_label(bare_unit(cell)).is_some()
}

/// Whether cells are texts without any value.
fn is_header(cells: &[String]) -> bool {
    cells.len() > 1 && cells.iter().all(|cell| kind(cell) != Kind::Value)
}

/// Whether texts above the rows are their header: same width, or a name of time or force.
fn is_names(cells: &[String], width: usize) -> bool {
    let text = cells.iter().all(|cell| kind(cell) != Kind::Value);
    text && (cells.len() == width || (cells.len() > 1 && are_known(cells)))
}

pub(super) fn are_known(cells: &[String]) -> bool {
    let mut labels = cells.iter().map(|name| Label::new(name));
    labels.any(|label| label.is_time() || label.is_force())
}

impl Header {
    /// Makes names and units as wide as the rows, if only empty cells are added or removed.
    fn check(&mut self) -> Result<(), InputError> {
        let (width, rows) = (self.width, &self.rows);
        let unused = |at: usize| rows.iter().all(|row| row.get(at).is_none_or(String::is_empty));
        for (what, line) in [("header", &mut self.names), ("units row", &mut self.units)] {
            let Some((number, cells)) = line else { continue };
            // LabVIEW names a column for comments that its rows omit.
            let idle = |cell: &&String| cell.is_empty() || cell.eq_ignore_ascii_case("comment");
            if cells.iter().skip(width).all(|cell| idle(&cell)) {
                cells.truncate(width);
            }
            if what == "header" && above::are_behind_numbers(cells, rows) {
                cells.insert(0, String::new());
            }
            if what == "header" && cells.len() < width && (cells.len()..width).all(unused) {
                cells.resize(width, String::new());
            }
            if cells.len() != width {
                return Err(InputError::new(format!(
                    "the {what} has {} cells, and line {} has {width}; is the separator right? \
                     (--delimiter, --decimal)",
                    cells.len(),
                    self.first_row
                ))
                .within(format_args!("line {number}")));
            }
        }
        Ok(())
    }

    /// Name of a column; empty if there is none.
    #[must_use]
    pub fn name(&self, column: usize) -> &str {
        self.column_names().get(column).map_or("", String::as_str)
    }

    /// Names of the columns; empty without a header.
    #[must_use]
    pub fn column_names(&self) -> &[String] {
        self.names.as_ref().map_or(&[], |(_, names)| names)
    }

    /// The cells of a column in the first rows.
    pub fn cells(&self, column: usize) -> impl Iterator<Item = &str> {
        self.rows.iter().filter_map(move |row| row.get(column)).map(String::as_str)
    }
}
