//! CR10 mixed arrays: no header, rows of different arrays in sequence.
//!
//! A row is `id, year, day, hhmm[, seconds], values...`. The rows of one array are the log; all
//! others are skipped.

use std::collections::BTreeMap;

use crate::error::InputError;

use super::LogOptions;
use super::cells::Cells;
use super::comment::comment;
use super::header::IN_A_ROW;
use super::layout::{Layout, TimeCells, cr10_time};
use super::number::{Decimal, Unit, finite};

/// Resolution of the logger's clock: an eighth of a second.
const RESOLUTION_S: f64 = 0.125;
const SECONDS: usize = 4;

/// Properties of an array's rows at the beginning of the log.
#[derive(Clone, Copy, Debug)]
struct Array {
    /// Number of cells in the first row.
    width: usize,
    /// Whether cell 4 contains seconds in every row.
    seconds: Seconds,
    /// Number of rows.
    rows: usize,
}

/// Whether the values of a cell are seconds: all on the clock's steps, or all running on within
/// their minute and beginning anew with the next, as those of a finer clock do and a force does not.
#[derive(Clone, Copy, Debug)]
struct Seconds {
    on_steps: bool,
    run_on: bool,
    /// Number of times they went up within a minute.
    rises: usize,
    /// Minute and seconds of the last row.
    last: (f64, f64),
}

impl Seconds {
    const UNKNOWN: Self = Self { on_steps: true, run_on: true, rises: 0, last: (f64::NAN, 0.0) };

    fn add(&mut self, minute: Option<f64>, cell: Option<&[u8]>) {
        let seconds = cell.and_then(finite).filter(|value| (0.0..60.0).contains(value));
        let (Some(minute), Some(seconds)) = (minute, seconds) else {
            *self = Self { on_steps: false, run_on: false, ..*self };
            return;
        };
        self.on_steps &= (seconds / RESOLUTION_S).fract().abs() < f64::EPSILON;
        let (later_s, last) = (minute - self.last.0, self.last.1);
        if later_s.abs() < 1.0 {
            self.run_on &= seconds >= last;
            self.rises += usize::from(seconds > last);
        } else if later_s < 61.0 {
            self.run_on &= seconds < last;
        }
        self.last = (minute, seconds);
    }

    fn are(&self) -> bool {
        self.on_steps || (self.run_on && self.rises >= IN_A_ROW)
    }
}

/// Whether a line looks like a row: numbers that begin with an array number and a time stamp.
#[must_use]
pub fn is_row(line: &[u8]) -> bool {
    let mut cells = Cells::default();
    cells.cut(line, b',')
        && array_id(line, &cells).is_some()
        && cr10_time(line, &cells, false).is_some()
}

/// Chooses array and column from the beginning of the log, whose lines end with `end`, and the
/// options.
///
/// Without `--array-id`: the only array, or the only one with seconds. Without `--column`: the cell
/// after the time stamp, with a note if it is not the only one.
///
/// # Errors
/// A choice that the log does not offer, or one that only the user can make.
pub fn layout(
    head: &[u8],
    end: u8,
    options: &LogOptions,
) -> Result<(Layout, Vec<String>), InputError> {
    let arrays = arrays(head, end);
    let id = choose(&arrays, options.array_id)?;
    let array =
        arrays.get(&id).copied().unwrap_or(Array { width: 0, seconds: Seconds::UNKNOWN, rows: 0 });
    let force = match &options.column {
        Some(text) => column(text, array.width)?,
        None => SECONDS + usize::from(array.seconds.are()),
    };
    if force >= array.width {
        return Err(InputError::new(format!("array {id} has no cell behind its time stamp")));
    }
    let seconds = array.seconds.are() && force != SECONDS;
    let unit = options.unit.unwrap_or(Unit::Newton);
    let note = options.column.is_none().then(|| first_of(force, array.width, unit)).flatten();
    let layout = Layout {
        separator: b',',
        decimal: Decimal::Point,
        width: None,
        time: TimeCells::Cr10 { seconds },
        force,
        unit,
        record: None,
        array_id: Some(id),
        resolution_s: Some(if seconds { RESOLUTION_S } else { 60.0 }),
        seconds_unsaid: false,
        part: None,
        unit_cell: None,
    };
    Ok((layout, note.into_iter().collect()))
}

/// Note on a force that is the first of several values.
fn first_of(force: usize, width: usize, unit: Unit) -> Option<String> {
    (force + 1 < width).then(|| {
        format!(
            "column {} of {width}, the first behind the time stamp, is read, as {}: --column takes \
             another, --unit another unit",
            force + 1,
            unit.name()
        )
    })
}

/// The arrays in `head`; the last line may be cut off, and counts only if its array is unknown
/// otherwise.
fn arrays(head: &[u8], end: u8) -> BTreeMap<u32, Array> {
    let mut arrays = BTreeMap::new();
    let mut cells = Cells::default();
    for line in head.split_inclusive(|&byte| byte == end) {
        let ended = line.last() == Some(&end);
        let line = line.trim_ascii();
        if comment(line).is_some() || !cells.cut(line, b',') {
            continue;
        }
        let Some(id) = array_id(line, &cells) else { continue };
        if !ended && (arrays.contains_key(&id) || !is_row(line)) {
            continue;
        }
        let width = cells.len();
        let array = arrays.entry(id).or_insert(Array { width, seconds: Seconds::UNKNOWN, rows: 0 });
        array.rows += 1;
        if width == array.width {
            let cell = cells.get(line, SECONDS).filter(|_| width > SECONDS + 1);
            array.seconds.add(cr10_time(line, &cells, false), cell);
        }
    }
    arrays
}

fn array_id(line: &[u8], cells: &Cells) -> Option<u32> {
    let id = finite(cells.get(line, 0)?)?;
    let valid = (1.0..=9999.0).contains(&id) && id.fract().abs() < f64::EPSILON;
    valid.then_some(id as u32)
}

fn choose(arrays: &BTreeMap<u32, Array>, wanted: Option<u32>) -> Result<u32, InputError> {
    if arrays.values().all(|array| array.width <= SECONDS) {
        let none = "no line is one of a cr10 log (number of the array, year, day, hhmm, values): leave \
                    --format out";
        return Err(InputError::new(none));
    }
    let list = || arrays.keys().map(u32::to_string).collect::<Vec<_>>().join(", ");
    if let Some(id) = wanted {
        let missing = || InputError::new(format!("no array {id}; there are: {}", list()));
        return arrays.contains_key(&id).then_some(id).ok_or_else(missing);
    }
    let only = |mut ids: Vec<u32>| if ids.len() == 1 { ids.pop() } else { None };
    // A single row may look like it by chance.
    let timed = |array: &Array| array.seconds.are() && array.rows > 1;
    let with_seconds = arrays.iter().filter(|(_, array)| timed(array)).map(|(&id, _)| id);
    only(arrays.keys().copied().collect()).or_else(|| only(with_seconds.collect())).ok_or_else(
        || InputError::new(format!("which array is it? give --array-id ID; there are: {}", list())),
    )
}

fn column(text: &str, width: usize) -> Result<usize, InputError> {
    let wrong = || {
        InputError::new(format!(
            "no column '{text}': in a cr10 log --column is a number from 5 (1 is the array, \
             2 to 4 its time) to {width}"
        ))
    };
    let number: usize = text.parse().map_err(|_| wrong())?;
    if (SECONDS + 1..=width).contains(&number) { Ok(number - 1) } else { Err(wrong()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MIXED: &[u8] = b"203,12,330,2100,2.258,66.19\n204,12,330,2102,-6999,6999\n";

    fn places(
        head: &[u8],
        id: Option<u32>,
        column: Option<&str>,
    ) -> Result<(u32, usize, bool), String> {
        let column = column.map(str::to_string);
        let options = LogOptions { array_id: id, column, ..LogOptions::default() };
        let end = if head.contains(&b'\n') { b'\n' } else { b'\r' };
        let (layout, _) = layout(head, end, &options).map_err(|e| e.to_string())?;
        let TimeCells::Cr10 { seconds } = layout.time else { panic!("not cr10") };
        Ok((layout.array_id.unwrap(), layout.force, seconds))
    }

    #[test]
    fn the_only_array_needs_no_options() {
        let head = b"# label\n101,94,100,1200,0,5.5\n101,94,100,1200,.125,5.6\n";
        assert_eq!(places(head, None, None), Ok((101, 5, true)));
        assert_eq!(places(head, None, Some("6")), Ok((101, 5, true)));
        assert_eq!(places(head, None, Some("5")), Ok((101, 4, false)));
    }

    #[test]
    fn the_only_array_with_seconds_is_taken_from_several() {
        let head = b"203,12,330,2100,2.258,66.19\n201,12,330,2200,0,1.3\n\
            7,12,330,2100,1.125,40\n7,12,330,2100,1.125,40\n";
        assert_eq!(places(head, None, None), Ok((7, 5, true)));
    }

    #[test]
    fn a_last_line_without_end_shows_a_new_array_but_spoils_no_known_one() {
        let head = b"7,94,100,1200,0,5.5\n7,94,100,1200,.125,5.6\n9,94,100,1200,3,4.5";
        assert_eq!(places(head, Some(9), None), Ok((9, 5, true)));
        let head = b"7,94,100,1200,0,5.5\n7,94,100,1200,.125,5.6\n7,94,100,1200,.1";
        assert_eq!(places(head, None, None), Ok((7, 5, true)));
        let head = b"77,94,100,1200,0,5.5\n77,94,100,1200,.125,5.6\n7";
        assert_eq!(places(head, None, None), Ok((77, 5, true)));
    }

    #[test]
    fn arrays_between_lines_that_end_with_cr_are_seen() {
        let lines: Vec<u8> =
            MIXED.iter().map(|&byte| if byte == b'\n' { b'\r' } else { byte }).collect();
        let error = places(&lines, None, None).unwrap_err();
        assert_eq!(error, "which array is it? give --array-id ID; there are: 203, 204");
        assert_eq!(places(&lines, Some(204), None), Ok((204, 4, false)));
    }

    #[test]
    fn several_arrays_need_a_choice() {
        let error = places(MIXED, None, None).unwrap_err();
        assert_eq!(error, "which array is it? give --array-id ID; there are: 203, 204");
        assert_eq!(places(MIXED, Some(203), Some("6")), Ok((203, 5, false)));
        assert!(places(MIXED, Some(9), None).unwrap_err().starts_with("no array 9"));
        for column in ["0", "4", "7", "force"] {
            assert!(places(MIXED, Some(203), Some(column)).unwrap_err().starts_with("no column"));
        }
    }

    /// A battery may stand in front of the force.
    #[test]
    fn the_first_of_several_values_is_said() {
        let head = b"7,94,100,1200,0,12.6,5.5\n7,94,100,1200,.125,12.6,5.6\n";
        let notes = |options: &LogOptions| layout(head, b'\n', options).unwrap().1;
        let [note] = &notes(&LogOptions::default())[..] else { panic!("one note") };
        assert!(
            note.starts_with("column 6 of 7, the first") && note.contains("as N: --column"),
            "{note}"
        );
        let given = LogOptions { column: Some("7".to_string()), ..LogOptions::default() };
        assert!(notes(&given).is_empty());
    }

    #[test]
    fn rows_are_told_from_other_lines() {
        assert!(is_row(b"203,12,330,2100,2.258"));
        assert!(!is_row(b"0.0,1.5"));
        assert!(!is_row(b"203,12,400,2100,2.258"));
        assert!(!is_row(b"t,force_n"));
    }
}
