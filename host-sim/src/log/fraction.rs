//! Fractions of a second without leading zeros: 0.62 for 62 ms.

use crate::error::InputError;

use super::columns::Columns;
use super::layout::TimeCells;

/// Consecutive stamps of one second that show the form.
const STAMPS: usize = 4;

impl Columns<'_> {
    /// Rejects times that are in order if the digits after the decimal mark count milliseconds, and
    /// not in order as decimal fractions: 0.0, 0.62, 0.125.
    ///
    /// # Errors
    /// Names the column.
    pub fn refuse_no_zeros(&self, time: TimeCells) -> Result<(), InputError> {
        let column = match time {
            TimeCells::Number { cell, .. } | TimeCells::DateAndClock { clock: cell, .. } => cell,
            TimeCells::Numbered { .. } | TimeCells::Count { .. } | TimeCells::Cr10 { .. } => {
                return Ok(());
            }
        };
        let cells: Vec<(&str, &str)> =
            self.cells(column).filter_map(|cell| cell.rsplit_once(['.', ','])).collect();
        match without_zeros(&cells) {
            Some((whole, part)) => Err(InputError::new(format!(
                "the times of column {} go back unless {whole}.{part} is {whole}.{part:0>3}: write zeros in \
                 front of the parts of a second",
                self.said(column)
            ))),
            None => Ok(()),
        }
    }
}

/// The first of such stamps, split at the mark.
fn without_zeros<'a>(cells: &[(&'a str, &'a str)]) -> Option<(&'a str, &'a str)> {
    let count = |part: &str| part.parse::<u32>().ok().filter(|_| part.len() < 4);
    let steps = || cells.windows(2).filter_map(|w| Some((*w.first()?, *w.last()?)));
    let same = || steps().filter(|((a, _), (b, _))| a == b);
    let counts_up =
        same().all(|((_, a), (_, b))| count(a).zip(count(b)).is_some_and(|(a, b)| a < b));
    let back = same().find(|((_, a), (_, b))| a > b).map(|(before, _)| before);
    back.filter(|_| counts_up && same().count() >= STAMPS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_that_are_missing() {
        let found = |parts: &[&str]| {
            let cells: Vec<(&str, &str)> = parts.iter().map(|part| ("12:00:00", *part)).collect();
            without_zeros(&cells).map(|(_, part)| part.to_string())
        };
        assert_eq!(found(&["0", "62", "125", "187", "250"]), Some("62".to_string()));
        assert_eq!(found(&["0", "0625", "125", "1875", "25"]), None);
        assert_eq!(found(&["000", "062", "125", "187", "250"]), None);
        assert_eq!(found(&["0", "1", "2", "3", "4"]), None);
        assert_eq!(found(&["9", "8", "7", "6", "5"]), None);
        assert_eq!(found(&["0", "62", "125"]), None);
    }
}
