//! Where a row of a text log has its cells, and what they say.

use crate::error::{InputError, excerpt};
use crate::rounding::counted;

use super::cells::{Cells, text};
use super::number::{Decimal, Unit, finite, is_thousand, reading, reading_of, thousand};
use super::plain::PlainRow;
use super::remedy;
use super::rows::Row;
use super::stamp::{
    DAY_S, TimeUnit, clock_seconds, cr10_seconds, date_and_clock, date_seconds, has_zone,
};
use super::timing::{self, Timing};

/// Largest time that is taken, s: 31 000 years.
const LATEST_S: f64 = 1e12;

/// Where in a row everything is; found from the header, or given.
///
/// Cells are counted from 0.
#[derive(Clone, Debug)]
pub struct Layout {
    /// Separator of the cells; a blank stands for any number of blanks.
    pub separator: u8,
    /// Decimal mark of the numbers.
    pub decimal: Decimal,
    /// Cells in a row; `None`: as many as the first row has.
    pub width: Option<usize>,
    /// The time stamp.
    pub time: TimeCells,
    /// The force.
    pub force: usize,
    /// Its unit.
    pub unit: Unit,
    /// The record number, if there is one.
    pub record: Option<usize>,
    /// Only rows that begin with this number belong to the log.
    pub array_id: Option<u32>,
    /// Step of the stamps if the format has coarse ones, s.
    pub resolution_s: Option<f64>,
    /// Nothing says the unit of the time, which is taken as seconds.
    pub seconds_unsaid: bool,
}

/// How a row tells its time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TimeCells {
    /// One cell.
    Number {
        /// Which.
        cell: usize,
        /// Its unit or form.
        unit: TimeUnit,
    },
    /// A time of day in one cell, perhaps a date in another.
    DateAndClock {
        /// The date.
        date: Option<usize>,
        /// The time of day.
        clock: usize,
    },
    /// Not at all: rows follow each other.
    Count {
        /// Rows a second.
        rate_hz: f64,
    },
    /// Year, day and hhmm in cells 1 to 3, perhaps seconds in cell 4.
    Cr10 {
        /// Cell 4 holds seconds.
        seconds: bool,
    },
}

impl TimeCells {
    /// Whether stamps say the date, so that the log's own time begins with its first
    /// sample.
    #[must_use]
    pub fn is_calendar(self) -> bool {
        match self {
            Self::Number { unit, .. } => unit.is_calendar(),
            Self::DateAndClock { date, .. } => date.is_some(),
            Self::Count { .. } => false,
            Self::Cr10 { .. } => true,
        }
    }
}

impl Layout {
    /// The timing of the first rows; `rate_hz` if the user or the log states it.
    ///
    /// # Errors
    /// They do not tell it.
    pub fn timing(&self, rows: &[Row], rate_hz: Option<f64>) -> Result<Timing, InputError> {
        let unit_s = match self.time {
            TimeCells::Number { unit: TimeUnit::Minute, .. } => 60.0,
            TimeCells::Number { unit: TimeUnit::Excel, .. } => DAY_S,
            // Of the others, the digits are those of seconds.
            TimeCells::Number { .. }
            | TimeCells::DateAndClock { .. }
            | TimeCells::Count { .. }
            | TimeCells::Cr10 { .. } => 1.0,
        };
        timing::find(rows, rate_hz, self.resolution_s, unit_s)
    }

    /// A row of two numbers; `None` if they cannot be a time and a force.
    pub(super) fn plain_row(&self, &PlainRow { time_s, force, .. }: &PlainRow) -> Option<Row> {
        let reading = reading_of(force, self.unit)?;
        (time_s.abs() <= LATEST_S).then_some(Row { time_s, reading, records: 1, line: 0 })
    }

    /// A row with its record number; `None` for a row of another array.
    pub(super) fn row(
        &mut self,
        line: &[u8],
        ended: bool,
        cells: &mut Cells,
    ) -> Result<Option<(Row, Option<f64>)>, InputError> {
        if !cells.cut(line, self.separator) {
            return Err(InputError::new(
                "a quote is not closed; correct the line, and write a cell that goes on over several \
                 lines into one",
            ));
        }
        if self.array_id.is_some_and(|id| !begins_with(cells.get(line, 0), id)) {
            return Ok(None);
        }
        let width = *self.width.get_or_insert(cells.len());
        if cells.len() != width {
            let (remedy, cells) =
                (remedy::of_width(line, cells.len()), counted(cells.len() as u64, "cell"));
            return Err(InputError::new(format!("{cells} instead of {width}; {remedy}")));
        }
        let force = cells.get(line, self.force).unwrap_or_default();
        if !ended && force.is_empty() {
            return Err(InputError::new("the force is cut off"));
        }
        let reading =
            reading(force, self.unit, self.decimal).ok_or_else(|| self.no_force(force))?;
        if self.decimal == Decimal::Any {
            self.settle(force, line, cells)?;
        }
        let row = Row { time_s: self.time_s(line, cells)?, reading, records: 1, line: 0 };
        let record = self.record.and_then(|cell| finite(cells.get(line, cell)?));
        Ok(Some((row, record)))
    }

    /// Takes the decimal mark from the first force that has one.
    fn settle(&mut self, force: &[u8], line: &[u8], cells: &Cells) -> Result<(), InputError> {
        let Some(mark) = force.iter().find(|byte| b".,".contains(byte)) else { return Ok(()) };
        if is_thousand(text(force)) {
            // A time that cannot be read is why no rows were found that tell the mark.
            self.time_s(line, cells)?;
            return Err(thousand(text(force)));
        }
        if finite(force).is_some() {
            self.decimal = if *mark == b',' { Decimal::Comma } else { Decimal::Point };
        }
        Ok(())
    }

    /// Whether a row's time is in a zone that it says.
    pub(super) fn says_zone(&self, line: &[u8], cells: &Cells) -> bool {
        let cell = |index| text(cells.get(line, index).unwrap_or_default());
        match self.time {
            TimeCells::Number { cell: index, unit: TimeUnit::Iso } => {
                date_and_clock(cell(index)).is_some_and(|(_, clock)| has_zone(clock))
            }
            TimeCells::DateAndClock { clock, .. } => has_zone(cell(clock)),
            TimeCells::Number { .. } | TimeCells::Count { .. } | TimeCells::Cr10 { .. } => false,
        }
    }

    /// Whether the force is all there is: a line below the rows is no row that is too short.
    fn is_alone(&self) -> bool {
        self.width == Some(1)
    }

    #[cold]
    fn no_force(&self, cell: &[u8]) -> InputError {
        let kind = if self.unit == Unit::Counts { "whole number of counts" } else { "number" };
        let (place, held) = (self.force + 1, excerpt(cell));
        let remedy = remedy::of_force(cell, self.unit, self.is_alone());
        InputError::new(format!("force cell {place} holds {held}, not a {kind}; {remedy}"))
    }

    fn time_s(&self, line: &[u8], cells: &Cells) -> Result<f64, InputError> {
        let cell = |index| cells.get(line, index).unwrap_or_default();
        let (text, time) = match self.time {
            TimeCells::Number { cell: index, unit } => {
                (cell(index), unit.seconds(cell(index), self.decimal))
            }
            TimeCells::DateAndClock { date, clock } => {
                let date = date.map_or(Some(0.0), |date| date_seconds(text(cell(date))));
                let clock_s = clock_seconds(text(cell(clock)));
                (cell(clock), date.zip(clock_s).map(|(date, clock)| date + clock))
            }
            // Told by the rows before.
            TimeCells::Count { .. } => return Ok(0.0),
            TimeCells::Cr10 { seconds } => (line, cr10_time(line, cells, seconds)),
        };
        // Times further out leave no room for a fraction of a second.
        let time = time.filter(|time_s| time_s.abs() <= LATEST_S);
        time.ok_or_else(|| remedy::no_time(text))
    }
}

/// Whether a line is nothing but separators between empty cells.
#[must_use]
pub fn is_empty(line: &[u8], separator: u8) -> bool {
    line.iter().all(|&byte| byte == separator || byte == b'"' || byte.is_ascii_whitespace())
}

fn begins_with(cell: Option<&[u8]>, id: u32) -> bool {
    cell.and_then(finite).is_some_and(|value| (value - f64::from(id)).abs() < 0.5)
}

/// The time of a mixed-array row, its stamp in cells 1 to 3 or 1 to 4.
#[must_use]
pub fn cr10_time(line: &[u8], cells: &Cells, seconds: bool) -> Option<f64> {
    let cell = |index| cells.get(line, index).and_then(finite);
    let second = if seconds { cell(4)? } else { 0.0 };
    cr10_seconds(cell(1)?, cell(2)?, cell(3)?, second)
}
