//! Comments above the rows of a text table: comments with column names, and files of comments only.

use crate::error::InputError;

use super::cells::texts;
use super::comment::comment;
use super::header::{Content, Header, IN_A_ROW, Kind, SEPARATORS, are_known, kind};
use super::label::{Label, is_unit_cell};
use super::lines::{MAX_LINE, too_long};
use super::number::{count_up, finite};

/// Column names in the comment directly above the rows, as written by numpy and MATLAB users.
pub fn commented_names(
    lines: &[Content<'_>],
    first_row: u64,
    separator: u8,
    width: usize,
) -> Option<(u64, Vec<String>)> {
    let (number, line) = lines.iter().rev().find(|(number, _)| *number < first_row)?;
    let names = texts(comment(line)?, separator);
    let names = if names.len() > width { with_units(names) } else { names };
    (names.len() == width && are_known(&names)).then_some((*number, names))
}

/// Joins units in brackets with the preceding name if blanks have separated them.
#[must_use]
pub fn with_units(cells: Vec<String>) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for cell in cells {
        match names.last_mut() {
            Some(name) if cell.starts_with(['(', '[']) => *name = format!("{name} {cell}"),
            _ => names.push(cell),
        }
    }
    names
}

/// Rejects a beginning of a log without rows, if the reason is known.
///
/// # Errors
/// The rows are comments, or the text is all comments or a single line.
pub fn refuse_no_table(
    head: &[u8],
    end: u8,
    lines: &[Content<'_>],
    comments_only: bool,
) -> Result<(), InputError> {
    if let Some((number, mark)) = commented_rows(lines) {
        return Err(InputError::new(format!(
            "the rows from line {number} on begin with '{mark}', the mark of a comment: take it away"
        )));
    }
    if !comments_only {
        return refuse_quoted_lines(lines);
    }
    let whole = head.len() < MAX_LINE - LONGEST_END;
    Err(match (whole, head.contains(&end)) {
        (true, _) => InputError::new("ends before its header does"),
        (false, true) => InputError::new(format!(
            "the first {} KiB hold no table: shorten what is above it",
            MAX_LINE / 1024
        )),
        (false, false) => too_long(1),
    })
}

/// Rejects lines that are quoted as a whole.
fn refuse_quoted_lines(lines: &[Content<'_>]) -> Result<(), InputError> {
    let is_one_cell = |line: &[u8]| match line.trim_ascii() {
        [b'"', inside @ .., b'"'] => {
            !inside.contains(&b'"') && SEPARATORS.iter().any(|cut| inside.contains(cut))
        }
        _ => false,
    };
    let rows = lines.iter().filter(|(_, line)| comment(line).is_none());
    let quoted = rows.clone().count() > 1 && rows.clone().all(|(_, line)| is_one_cell(line));
    match rows.clone().next().filter(|_| quoted) {
        Some((number, _)) => Err(InputError::new(format!(
            "line {number}: the whole line is in quotes, like those after it: take them away"
        ))),
        None => Ok(()),
    }
}

/// Rejects lines that end with LF among many that end with CR.
///
/// # Errors
/// Names the first line that contains others.
pub fn refuse_mixed_ends(lines: &[Content<'_>]) -> Result<(), InputError> {
    let holds = |line: &[u8]| line.trim_ascii().iter().filter(|&&byte| byte == b'\r').count() > 1;
    match lines.iter().find(|(_, line)| holds(line)) {
        Some((number, _)) => Err(InputError::new(format!(
            "line {number}: some lines end with CR and some with LF: end all with LF"
        ))),
        None => Ok(()),
    }
}

/// Rejects an unreadable row directly above the values if names are above it.
///
/// # Errors
/// Names both lines. `above` returns the lines from the first row upward.
pub fn refuse_unknown_row(
    above: impl Fn(usize) -> Option<(u64, Vec<String>)>,
    width: usize,
) -> Result<(), InputError> {
    let Some((number, row)) = above(1) else { return Ok(()) };
    let is_text = row.iter().all(|cell| kind(cell) != Kind::Value);
    let are_units = row.len() > 1 && row.iter().all(|cell| is_unit_cell(cell));
    if width < 2 || is_text && (are_known(&row) || are_units) {
        return Ok(());
    }
    let are_names = |(_, cells): &(u64, Vec<String>)| cells.len() >= width && are_known(cells);
    match (2..4).filter_map(above).rfind(are_names) {
        Some((names, _)) => Err(InputError::new(format!(
            "line {number}: the names are in line {names}, and this row below them is not understood: \
             correct it, or take it out"
        ))),
        None => Ok(()),
    }
}

/// Whether names identify the columns of time and force.
#[must_use]
pub fn are_named(names: &[String]) -> bool {
    let labels: Vec<Label> = names.iter().map(|name| Label::new(name)).collect();
    labels.iter().any(Label::is_time) && labels.iter().any(Label::is_force)
}

/// Rejects rows below names without time or force if a later line names both, since the log may
/// begin there.
///
/// # Errors
/// Names that line.
pub fn refuse_later_names(header: &Header, content: &[Content<'_>]) -> Result<(), InputError> {
    if are_named(header.column_names()) {
        return Ok(());
    }
    let are_names = |line: &[u8]| {
        let cells = texts(line, header.separator);
        cells.first().is_some_and(|cell| kind(cell) == Kind::Text) && are_named(&cells)
    };
    let mut below = content.iter().filter(|(number, _)| *number > header.first_row);
    match below.find(|(_, line)| are_names(line)) {
        Some((number, _)) => Err(InputError::new(format!(
            "line {number}: time and force are named here, below rows of numbers: if the log begins \
             here, give --skip-lines {}, else take this line out",
            number - 1
        ))),
        None => Ok(()),
    }
}

/// Rejects lines without any row below unknown names.
///
/// # Errors
/// Names the first line.
pub fn refuse_no_rows(header: &Header, lines: usize) -> Result<(), InputError> {
    let is_number = |name: &String| {
        name.trim_start_matches(['+', '-']).starts_with(|first: char| first.is_ascii_digit())
    };
    let are_names = |names: &[String]| are_known(names) && !names.iter().any(is_number);
    match &header.names {
        // A single line may be too long for this message.
        Some((number, names)) if lines > 1 && !are_names(names) => Err(InputError::new(format!(
            "line {number}: no rows of numbers are found from here on: write time and force into each, \
             such as 0.0625,12.5; or is the separator another? (--delimiter)"
        ))),
        _ => Ok(()),
    }
}

/// Whether rows begin with a number without a name, as written by R and pandas: it counts the rows,
/// and the time follows it.
#[must_use]
pub fn are_behind_numbers(names: &[String], rows: &[Vec<String>]) -> bool {
    let column = |at: usize| -> Vec<f64> {
        rows.iter().filter_map(|row| finite(row.get(at)?.as_bytes())).collect()
    };
    let time = names.iter().position(|name| Label::new(name).is_time());
    let (numbers, Some(time)) = (column(0), time) else { return false };
    let is_wider = rows.iter().all(|row| row.len() == names.len() + 1);
    is_wider
        && numbers.len() == rows.len()
        && count_up(&numbers)
        && column(time + 1).windows(2).all(|w| w.first() < w.last())
}

/// Rejects quoted names that extend over several lines.
///
/// # Errors
/// The line above the first row ends a quote that it does not begin.
pub fn refuse_broken_names(content: &[Content<'_>], first: usize) -> Result<(), InputError> {
    let above = first.checked_sub(1).and_then(|above| content.get(above));
    let quotes = |line: &[u8]| line.iter().filter(|&&byte| byte == b'"').count();
    match above.filter(|(_, line)| !quotes(line).is_multiple_of(2)) {
        Some((number, _)) => Err(InputError::new(format!(
            "line {number}: a name in quotes goes on over several lines: write each name into one"
        ))),
        None => Ok(()),
    }
}

/// Length by which a head may be shorter than the longest line if its last line was cut off.
const LONGEST_END: usize = 4096;

/// Line number and mark of the first of several comments that are rows.
fn commented_rows(lines: &[Content<'_>]) -> Option<(u64, char)> {
    let is_row = |line: &[u8]| {
        comment(line).is_some_and(|text| SEPARATORS.iter().any(|&cut| are_values(text, cut)))
    };
    let mut run = lines.windows(IN_A_ROW).filter(|run| run.iter().all(|(_, line)| is_row(line)));
    let (number, line) = run.next()?.first()?;
    let mark = line.trim_ascii_start().first().copied().map_or('#', char::from);
    Some((*number, mark))
}

fn are_values(text: &[u8], separator: u8) -> bool {
    let cells = texts(text, separator);
    cells.len() > 1 && cells.iter().all(|cell| kind(cell) == Kind::Value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_that_blanks_cut_off_go_back_to_their_names() {
        let cells = ["time", "(s)", "F", "[kN]"].map(str::to_string).to_vec();
        assert_eq!(with_units(cells), ["time (s)", "F [kN]"]);
    }

    #[test]
    fn rows_behind_a_mark_are_seen() {
        let rows: Vec<String> = (0..5).map(|i| format!("#{i},0.{i},1.5")).collect();
        let lines: Vec<Content<'_>> = (7..).zip(rows.iter().map(|row| row.as_bytes())).collect();
        assert_eq!(commented_rows(&lines), Some((7, '#')));
        assert_eq!(commented_rows(&lines[..3]), None);
        let words: Vec<Content<'_>> = (1..9).map(|i| (i, &b"# weight_n: 630"[..])).collect();
        assert_eq!(commented_rows(&words), None);
    }
}
