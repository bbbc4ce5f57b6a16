//! Positions and meaning of the cells in a row of a text log.

use crate::error::{InputError, excerpt};
use crate::rounding::counted;

use super::cells::{Cells, text};
use super::label::is_foreign;
use super::number::{Decimal, Unit, finite, is_thousand, reading, reading_of, thousand};
use super::part::Part;
use super::plain::PlainRow;
use super::remedy;
use super::rows::Row;
use super::stamp::{TimeUnit, clock_seconds, cr10_seconds, date_and_clock, date_seconds, has_zone};
use super::timing::{self, Timing};

/// Largest accepted time, s: 31 000 years.
const LATEST_S: f64 = 1e12;

/// Positions of all parts of a row, from the header or given.
///
/// Cells are counted from 0.
#[derive(Clone, Debug)]
pub struct Layout {
    /// Separator of the cells; a blank means any number of blanks.
    pub separator: u8,
    /// Decimal mark of the numbers.
    pub decimal: Decimal,
    /// Number of cells in a row; `None`: that of the first row.
    pub width: Option<usize>,
    /// Cells of the time stamp.
    pub time: TimeCells,
    /// Cell of the force.
    pub force: usize,
    /// Unit of the force.
    pub unit: Unit,
    /// Cell of the record number, if there is one.
    pub record: Option<usize>,
    /// First number of the rows that belong to the log.
    pub array_id: Option<u32>,
    /// Step of the stamps, s, if the format has coarse ones.
    pub resolution_s: Option<f64>,
    /// Whether the unit of the time is unstated and assumed to be seconds.
    pub seconds_unsaid: bool,
    /// Parts of a second beside a time in whole seconds.
    pub part: Option<Part>,
    /// Cell in which every row says the unit of its force.
    pub unit_cell: Option<usize>,
}

/// Form of a row's time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TimeCells {
    /// One cell.
    Number {
        /// Index of the cell.
        cell: usize,
        /// Unit or form of the time.
        unit: TimeUnit,
    },
    /// A time of day in one cell, with a date in another if there is one.
    DateAndClock {
        /// Cell of the date.
        date: Option<usize>,
        /// Cell of the time of day.
        clock: usize,
    },
    /// The number of the row, in one cell.
    Numbered {
        /// Index of the cell.
        cell: usize,
        /// Rows per second.
        rate_hz: f64,
    },
    /// No time: rows are consecutive.
    Count {
        /// Rows per second.
        rate_hz: f64,
    },
    /// Year, day and hhmm in cells 1 to 3, and seconds in cell 4 if there are any.
    Cr10 {
        /// Whether cell 4 contains seconds.
        seconds: bool,
    },
}

impl TimeCells {
    /// Whether stamps contain the date; the log's own time then begins with its first sample.
    #[must_use]
    pub fn is_calendar(self) -> bool {
        match self {
            Self::Number { unit, .. } => unit.is_calendar(),
            Self::DateAndClock { date, .. } => date.is_some(),
            Self::Numbered { .. } | Self::Count { .. } => false,
            Self::Cr10 { .. } => true,
        }
    }
}

impl Layout {
    /// The timing of the first rows; `rate_hz` if the user or the log states it.
    ///
    /// # Errors
    /// The rows do not determine it.
    pub fn timing(&self, rows: &[Row], rate_hz: Option<f64>) -> Result<Timing, InputError> {
        let unit = match self.time {
            TimeCells::Number { unit, .. } => unit,
            TimeCells::DateAndClock { .. }
            | TimeCells::Numbered { .. }
            | TimeCells::Count { .. }
            | TimeCells::Cr10 { .. } => TimeUnit::Second,
        };
        timing::find(rows, rate_hz, self.resolution_s, unit)
    }

    /// A row from two numbers; `None` if they cannot be a time and a force.
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
        self.refuse_other_unit(line, cells)?;
        let row = Row { time_s: self.time_s(line, cells)?, reading, records: 1, line: 0 };
        let record = self.record.and_then(|cell| finite(cells.get(line, cell)?));
        Ok(Some((row, record)))
    }

    /// Rejects a row that says another unit than the first ones.
    fn refuse_other_unit(&self, line: &[u8], cells: &Cells) -> Result<(), InputError> {
        let Some(cell) = self.unit_cell else { return Ok(()) };
        let said = cells.get(line, cell).map_or("", text);
        let other = Unit::from_label(said).is_some_and(|unit| unit != self.unit);
        match other || is_foreign(said) {
            true => Err(InputError::new(format!(
                "cell {} says '{said}', and the rows before {}: write all forces in one unit",
                cell + 1,
                self.unit.name()
            ))),
            false => Ok(()),
        }
    }

    /// Determines the decimal mark from the first force with a mark.
    fn settle(&mut self, force: &[u8], line: &[u8], cells: &Cells) -> Result<(), InputError> {
        let Some(mark) = force.iter().find(|byte| b".,".contains(byte)) else { return Ok(()) };
        if is_thousand(text(force)) {
            // If the time cannot be read, that is the reason why no rows were found to determine
            // the mark.
            self.time_s(line, cells)?;
            return Err(thousand(text(force)));
        }
        if finite(force).is_some() {
            self.decimal = if *mark == b',' { Decimal::Comma } else { Decimal::Point };
        }
        Ok(())
    }

    /// Whether a row's time contains its zone.
    pub(super) fn says_zone(&self, line: &[u8], cells: &Cells) -> bool {
        let cell = |index| text(cells.get(line, index).unwrap_or_default());
        match self.time {
            TimeCells::Number { cell: index, unit: TimeUnit::Iso } => {
                date_and_clock(cell(index)).is_some_and(|(_, clock)| has_zone(clock))
            }
            TimeCells::DateAndClock { clock, .. } => has_zone(cell(clock)),
            TimeCells::Number { .. }
            | TimeCells::Numbered { .. }
            | TimeCells::Count { .. }
            | TimeCells::Cr10 { .. } => false,
        }
    }

    /// Whether the force is the only cell, so that a line below the rows is not a short row.
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
            TimeCells::Numbered { cell: index, rate_hz } => {
                (cell(index), finite(cell(index)).map(|number| number / rate_hz))
            }
            // The previous rows determine it.
            TimeCells::Count { .. } => return Ok(0.0),
            TimeCells::Cr10 { seconds } => (line, cr10_time(line, cells, seconds)),
        };
        // Larger times leave no room for a fraction of a second.
        let time = time.filter(|time_s| time_s.abs() <= LATEST_S);
        Ok(time.ok_or_else(|| remedy::no_time(text))? + self.part_s(line, cells)?)
    }

    fn part_s(&self, line: &[u8], cells: &Cells) -> Result<f64, InputError> {
        let Some(Part { cell, unit }) = self.part else { return Ok(0.0) };
        let text = cells.get(line, cell).unwrap_or_default();
        let part_s = unit.seconds(text, self.decimal).filter(|part_s| (0.0..1.0).contains(part_s));
        part_s.ok_or_else(|| {
            InputError::new(format!(
                "cell {} holds {}, no part of a second; correct the line",
                cell + 1,
                excerpt(text)
            ))
        })
    }
}

/// Whether a line consists of separators between empty cells.
#[must_use]
pub fn is_empty(line: &[u8], separator: u8) -> bool {
    line.iter().all(|&byte| byte == separator || byte == b'"' || byte.is_ascii_whitespace())
}

fn begins_with(cell: Option<&[u8]>, id: u32) -> bool {
    cell.and_then(finite).is_some_and(|value| (value - f64::from(id)).abs() < 0.5)
}

/// Time of a mixed-array row, from cells 1 to 3 or 1 to 4.
#[must_use]
pub fn cr10_time(line: &[u8], cells: &Cells, seconds: bool) -> Option<f64> {
    let cell = |index| cells.get(line, index).and_then(finite);
    let second = if seconds { cell(4)? } else { 0.0 };
    cr10_seconds(cell(1)?, cell(2)?, cell(3)?, second)
}
