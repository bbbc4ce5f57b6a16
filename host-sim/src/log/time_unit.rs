//! The unit of a time column: what its name, its numbers and the given rate say.

use crate::error::InputError;

use super::LogOptions;
use super::columns::Columns;
use super::label::Label;
use super::number::Decimal;
use super::stamp::{TimeUnit, is_since_1970};

impl Columns<'_> {
    /// Rejects a time that nobody chose and whose name contains a factor: `Time x 10 (ms)`.
    pub(super) fn refuse_factor(
        &self,
        column: usize,
        options: &LogOptions,
    ) -> Result<(), InputError> {
        let has_factor = self.labels.get(column).is_some_and(Label::holds_factor);
        if !has_factor || options.time_column.is_some() {
            return Ok(());
        }
        Err(InputError::new(format!(
            "the name of column {} holds a factor: write the times themselves, or give --time-column \
             NAME to read them as they stand",
            self.said(column)
        )))
    }

    /// A unit of time other than seconds within a name: `Time-min`, `ms since start`.
    pub(super) fn unit_within(&self, column: usize) -> Option<&str> {
        let is_other =
            |word: &&str| TimeUnit::from_label(word).is_some_and(|unit| unit != TimeUnit::Second);
        self.name(column).split(|letter: char| !letter.is_alphanumeric()).find(is_other)
    }

    /// Whether a column without a unit numbers the rows, so that a rate makes a time of it.
    #[must_use]
    pub fn is_counter(&self, column: usize, options: &LogOptions, decimal: Decimal) -> bool {
        // Larger ones count seconds since 1970.
        let is_small = self.values(column, decimal).first().is_some_and(|&first| first < 8e8);
        let is_said = options.time_unit.is_some() || self.stated(column).next().is_some();
        is_small && !is_said && self.numbers_rows(column, decimal)
    }

    /// Rejects counts from another year than 1970 or in another unit, and days other than a
    /// spreadsheet's.
    pub(super) fn dated(
        &self,
        column: usize,
        unit: TimeUnit,
        decimal: Decimal,
    ) -> Result<TimeUnit, InputError> {
        const YEAR_S: f64 = 31_556_952.0;
        let first = self.cells(column).find_map(|c| unit.seconds(c.as_bytes(), decimal));
        let Some(seconds) = first.filter(|&seconds| !is_since_1970(seconds)) else {
            return Ok(unit);
        };
        let why = if unit == TimeUnit::Excel {
            "are a spreadsheet's days: give --time-unit excel if they are"
        } else {
            "count from 1970: give --time-unit s|ms|us|ns if they count from elsewhere"
        };
        Err(InputError::new(format!(
            "the times of column {} begin in {:.0} if they {why}, or turn them into seconds",
            self.said(column),
            (1970.0 + seconds / YEAR_S).floor()
        )))
    }
}
