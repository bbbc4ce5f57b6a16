//! Rows of a text log: a time stamp and a reading each.

use floe_core::Reading;

use crate::error::{InputError, excerpt};

use super::cells::Cells;
use super::lines::Lines;
use super::metadata::Metadata;
use super::number::{Decimal, Unit, finite, is_grouped, number, reading, reading_of};
use super::plain::{Plain, PlainRow};
use super::stamp::{DAY_S, TimeUnit, clock_seconds, cr10_seconds, date_seconds, has_zone};

/// What to do about a line that cannot be read.
const CORRECT: &str = "correct the line or take it out";
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

/// One row of a log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// The stamp, s.
    pub time_s: f64,
    /// What was measured.
    pub reading: Reading,
    /// Records since the row before, at least 1, where the log numbers them.
    pub records: u32,
    /// Its line.
    pub line: u64,
}

/// Reads row by row.
#[derive(Debug)]
pub struct Rows {
    /// What comments have said so far.
    pub metadata: Metadata,
    lines: Lines,
    layout: Layout,
    plain: Option<Plain>,
    cells: Cells,
    last_time_s: f64,
    /// Midnights so far, for times of day that nothing dates.
    days_s: f64,
    last_record: Option<f64>,
    truncated: Option<u64>,
    count: u64,
    /// Whether the first row's time is in UTC; `None` before that.
    utc: Option<bool>,
}

impl Rows {
    /// Continues behind the header.
    #[must_use]
    pub fn new(lines: Lines, layout: Layout, metadata: Metadata) -> Self {
        Self {
            metadata,
            lines,
            plain: Plain::of(&layout),
            layout,
            cells: Cells::default(),
            last_time_s: f64::NEG_INFINITY,
            days_s: 0.0,
            last_record: None,
            truncated: None,
            count: 0,
            utc: None,
        }
    }

    /// The next row, `None` at the end or where the last line is cut off.
    ///
    /// # Errors
    /// A row that cannot be used, with its line number.
    pub fn next_row(&mut self) -> Result<Option<Row>, InputError> {
        loop {
            if let Some(row) = self.plain_row() {
                let line = row.line;
                let placed = self.follow(row, None).map(Some);
                return placed.map_err(|error| error.within(format_args!("line {line}")));
            }
            let Some(line) = self.lines.next_line()? else { return Ok(None) };
            let (number, ended) = (line.number, line.ended);
            let result = match line.bytes.trim_ascii_start().first() {
                None => Ok(None),
                Some(b'#') => self.metadata.take(line.bytes, number).map(|()| None),
                Some(_) => self.layout.row(line.bytes, ended, &mut self.cells),
            };
            if let (Ok(Some(_)), None) = (&result, self.utc) {
                self.utc = Some(self.layout.says_zone(line.bytes, &self.cells));
            }
            let result = result.and_then(|found| {
                let numbered = |row| Row { line: number, ..row };
                found.map(|(row, record)| self.follow(numbered(row), record)).transpose()
            });
            match result {
                Ok(None) => {}
                Ok(row) => return Ok(row),
                Err(_) if !ended => {
                    self.truncated = Some(number);
                    return Ok(None);
                }
                Err(error) => return Err(error.within(format_args!("line {number}"))),
            }
        }
    }

    /// The next line, if it is a row of the usual kind.
    fn plain_row(&mut self) -> Option<Row> {
        let plain = self.plain?.read(self.lines.ahead())?;
        let row = self.layout.plain_row(&plain)?;
        Some(Row { line: self.lines.take(plain.length), ..row })
    }

    /// Line number of a last line that was cut off and left out.
    #[must_use]
    pub fn truncated(&self) -> Option<u64> {
        self.truncated
    }

    /// Whether times are UTC: counted from 1970, or in a zone that the first row says.
    #[must_use]
    pub fn is_utc(&self) -> bool {
        let since_1970 = TimeUnit::Epoch;
        matches!(self.layout.time, TimeCells::Number { unit, .. } if unit == since_1970)
            || self.utc.unwrap_or_default()
    }

    /// Where the rows' cells are.
    #[must_use]
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Checks a row against the one before.
    fn follow(&mut self, mut row: Row, record: Option<f64>) -> Result<Row, InputError> {
        if let TimeCells::Count { rate_hz } = self.layout.time {
            row.time_s = self.count as f64 / rate_hz;
        }
        self.count += 1;
        // A scan at the edge of a clock step may carry the step before.
        let jitter_s = self.layout.resolution_s.filter(|&step| step < 1.0).unwrap_or(0.0);
        row.time_s += self.days_s;
        if self.passes_midnight(row.time_s) {
            row.time_s += DAY_S;
            self.days_s += DAY_S;
        }
        if row.time_s < self.last_time_s - jitter_s {
            return Err(InputError::new(format!(
                "time goes back by {:.6} s; cut the log there, or sort it",
                self.last_time_s - row.time_s
            )));
        }
        self.last_time_s = row.time_s;
        if let (Some(last), Some(record)) = (self.last_record, record) {
            row.records = (record - last).max(1.0) as u32;
        }
        self.last_record = record;
        Ok(row)
    }

    /// Whether a time of day that nothing dates has begun anew.
    fn passes_midnight(&self, time_s: f64) -> bool {
        let undated = matches!(self.layout.time, TimeCells::DateAndClock { date: None, .. });
        undated && self.last_time_s - time_s > 0.5 * DAY_S
    }
}

impl Layout {
    /// A row of two numbers; `None` if they cannot be a time and a force.
    fn plain_row(&self, &PlainRow { time_s, force, .. }: &PlainRow) -> Option<Row> {
        let reading = reading_of(force, self.unit)?;
        (time_s.abs() <= LATEST_S).then_some(Row { time_s, reading, records: 1, line: 0 })
    }

    /// A row with its record number; `None` for a row of another array.
    fn row(
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
            let cells = cells.len();
            return Err(InputError::new(format!("{cells} cells instead of {width}; {CORRECT}")));
        }
        let force = cells.get(line, self.force).unwrap_or_default();
        if !ended && force.is_empty() {
            return Err(InputError::new("the force is cut off"));
        }
        let reading =
            reading(force, self.unit, self.decimal).ok_or_else(|| self.no_force(force))?;
        let row = Row { time_s: self.time_s(line, cells)?, reading, records: 1, line: 0 };
        let record = self.record.and_then(|cell| finite(cells.get(line, cell)?));
        Ok(Some((row, record)))
    }

    /// Whether a row's time is in a zone that it says.
    fn says_zone(&self, line: &[u8], cells: &Cells) -> bool {
        let cell = |index| text(cells.get(line, index).unwrap_or_default());
        match self.time {
            TimeCells::Number { cell: index, unit: TimeUnit::Iso } => {
                cell(index).split_once([' ', 'T']).is_some_and(|(_, clock)| has_zone(clock))
            }
            TimeCells::DateAndClock { clock, .. } => has_zone(cell(clock)),
            TimeCells::Number { .. } | TimeCells::Count { .. } | TimeCells::Cr10 { .. } => false,
        }
    }

    #[cold]
    fn no_force(&self, cell: &[u8]) -> InputError {
        let kind = if self.unit == Unit::Counts { "whole number of counts" } else { "number" };
        let (place, held) = (self.force + 1, excerpt(cell));
        let remedy = if number(cell, Decimal::Any).is_some() && self.unit != Unit::Counts {
            "the rows before have another decimal mark: write all with the same".to_string()
        } else if is_grouped(cell) {
            "write it without marks between the thousands".to_string()
        } else {
            format!("{CORRECT}; NaN marks a bad reading")
        };
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
        time.ok_or_else(|| no_time(text))
    }
}

#[cold]
fn no_time(cell: &[u8]) -> InputError {
    let remedy = if cell.contains(&b':') {
        "write 2012-02-29 12:00:00 or 29.02.2012 12:00:00"
    } else {
        CORRECT
    };
    InputError::new(format!("no time can be read from {}; {remedy}", excerpt(cell)))
}

fn text(cell: &[u8]) -> &str {
    std::str::from_utf8(cell).unwrap_or_default()
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
