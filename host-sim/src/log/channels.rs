//! Several channels below each other, each with the time again: `time_s,channel,force_n`.

use crate::error::InputError;

use super::columns::Columns;
use super::label::Label;
use super::layout::TimeCells;

/// Times that have to stand equally often.
const TIMES: usize = 4;
/// More numbers of the same time are rather those of its samples than of channels.
const MOST: usize = 8;

impl Columns<'_> {
    /// Refuses rows that say each time once for every channel that another column names.
    ///
    /// # Errors
    /// Names that column.
    pub fn refuse_channels(&self, time: TimeCells, force: usize) -> Result<(), InputError> {
        let (date, clock) = match time {
            TimeCells::Number { cell, .. } => (None, cell),
            TimeCells::DateAndClock { date, clock } => (date, clock),
            TimeCells::Count { .. } | TimeCells::Cr10 { .. } => return Ok(()),
        };
        let stamp =
            |row: &Vec<String>| (date.and_then(|at| row.get(at)).cloned(), row.get(clock).cloned());
        let mut groups: Vec<&[Vec<String>]> =
            self.header.rows.chunk_by(|a, b| stamp(a) == stamp(b)).collect();
        // The last one may go on.
        groups.pop();
        let times = groups.first().map_or(0, |group| group.len());
        if times < 2 || groups.len() < TIMES || groups.iter().any(|group| group.len() != times) {
            return Ok(());
        }
        let is_time = |at: usize| {
            at == clock || Some(at) == date || self.labels.get(at).is_some_and(Label::is_in_time)
        };
        let mut others = (0..self.header.width).filter(|&at| at != force && !is_time(at));
        let Some(channel) = others.find(|&at| names_channels(&groups, at)) else { return Ok(()) };
        Err(InputError::new(format!(
            "each time stands {times} times, and column {} differs within it: keep the rows of one \
             channel",
            self.said(channel)
        )))
    }

    pub(super) fn said(&self, column: usize) -> String {
        match self.name(column) {
            "" => (column + 1).to_string(),
            name => format!("'{name}'"),
        }
    }
}

/// Whether a column says the same of every time, and another thing in each of its rows.
fn names_channels(groups: &[&[Vec<String>]], column: usize) -> bool {
    let cells = |group: &[Vec<String>]| {
        let cells: Vec<Option<String>> = group.iter().map(|row| row.get(column).cloned()).collect();
        cells
    };
    let Some(first) = groups.first().map(|group| cells(group)) else { return false };
    let mut sorted = first.clone();
    sorted.sort();
    sorted.dedup();
    let are_numbers = first.iter().flatten().all(|cell| cell.parse::<f64>().is_ok());
    sorted.len() == first.len()
        && (first.len() <= MOST || !are_numbers)
        && groups.iter().all(|group| cells(group) == first)
}
