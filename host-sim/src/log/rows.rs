//! Rows of a text log: a time stamp and a reading each.

use floe_core::Reading;

use crate::error::InputError;

use super::HEAD_ROWS;
use super::cells::Cells;
use super::comment::comment;
use super::layout::{Layout, TimeCells, is_empty};
use super::lines::Lines;
use super::metadata::Metadata;
use super::number::Decimal;
use super::plain::Plain;
use super::stamp::{DAY_S, TimeUnit};
use super::timing::median;

/// One row of a log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Time stamp, s.
    pub time_s: f64,
    /// Reading of the force.
    pub reading: Reading,
    /// Records since the previous row, at least 1, if the log numbers them.
    pub records: u32,
    /// Line number.
    pub line: u64,
}

/// A last line without an end that was left out, with its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LastLine {
    /// The line is not a row.
    CutOff(u64),
    /// The line is a row, but shorter than the previous one: its last number may be incomplete.
    MayGoOn(u64),
}

impl LastLine {
    /// Warning about the line.
    #[must_use]
    pub fn warning(self) -> String {
        match self {
            Self::CutOff(line) => {
                format!("line {line}, the last, is cut off and was left out; all before it is used")
            }
            Self::MayGoOn(line) => format!(
                "line {line}, the last, has no end and is shorter than the row before: its last number \
                 may be cut short, and it was left out; if it is whole, end the line"
            ),
        }
    }
}

/// Reads rows in sequence.
#[derive(Debug)]
pub struct Rows {
    /// Metadata from the comments so far.
    pub metadata: Metadata,
    lines: Lines,
    layout: Layout,
    plain: Option<Plain>,
    cells: Cells,
    last_time_s: f64,
    /// Time of the row before the last one, and line of the last one.
    before_s: f64,
    last_line: u64,
    /// Length of the days passed since the first row, s, for times of day without a date.
    days_s: f64,
    last_record: Option<f64>,
    /// Usual step of the record numbers: above 1 in a log that was thinned.
    record_step: u32,
    truncated: Option<LastLine>,
    /// Number of bytes in the last row's line.
    bytes: usize,
    count: u64,
    /// Number of empty lines between rows without times, and of those since the last row.
    left_out: u64,
    empty: u64,
    /// Whether the first row's time is UTC; `None` before it.
    utc: Option<bool>,
    /// The first line whose time is an hour later than expected.
    hour_on: Option<u64>,
}

impl Rows {
    /// Continues after the header.
    #[must_use]
    pub fn new(lines: Lines, layout: Layout, metadata: Metadata) -> Self {
        Self {
            metadata,
            lines,
            plain: Plain::of(&layout),
            layout,
            cells: Cells::default(),
            last_time_s: f64::NEG_INFINITY,
            before_s: f64::NEG_INFINITY,
            last_line: 0,
            days_s: 0.0,
            last_record: None,
            record_step: 1,
            truncated: None,
            bytes: 0,
            count: 0,
            left_out: 0,
            empty: 0,
            utc: None,
            hour_on: None,
        }
    }

    /// The next row; `None` at the end, or if the last line is or may be cut off.
    ///
    /// # Errors
    /// A row that cannot be used, with its line number.
    #[inline]
    pub fn next_row(&mut self) -> Result<Option<Row>, InputError> {
        let Some(row) = self.plain_row() else { return self.next_odd_row() };
        let line = row.line;
        let placed = self.follow(row, None).map(Some);
        placed.map_err(|error| error.within(format_args!("line {line}")))
    }

    /// The next row by the general parser.
    #[inline(never)]
    fn next_odd_row(&mut self) -> Result<Option<Row>, InputError> {
        loop {
            let Some(line) = self.lines.next_line()? else { return Ok(None) };
            let (number, ended, bytes) = (line.number, line.ended, line.bytes.len());
            let result = match line.bytes.trim_ascii_start().first() {
                None => {
                    self.empty += 1;
                    Ok(None)
                }
                Some(b'#' | b'%' | b'"') if comment(line.bytes).is_some() => {
                    let late = self.count >= HEAD_ROWS as u64;
                    let take = if late { Metadata::take_late } else { Metadata::take };
                    take(&mut self.metadata, line.bytes, number).map(|()| None)
                }
                Some(_) => self.layout.row(line.bytes, ended, &mut self.cells),
            };
            if result.is_err() && is_empty(line.bytes, self.layout.separator) {
                // An empty row of a spreadsheet.
                continue;
            }
            if self.plain.is_none_or(|plain| !plain.has_mark())
                && self.layout.decimal != Decimal::Any
            {
                self.plain = Plain::of(&self.layout);
            }
            if let (Ok(Some(_)), None) = (&result, self.utc) {
                self.utc = Some(self.layout.says_zone(line.bytes, &self.cells));
            }
            let result = result.and_then(|found| {
                let numbered = |row| Row { line: number, ..row };
                found.map(|(row, record)| self.follow(numbered(row), record)).transpose()
            });
            match result {
                Ok(None) => {}
                Ok(Some(_)) if !ended && bytes < self.bytes => {
                    self.truncated = Some(LastLine::MayGoOn(number));
                    return Ok(None);
                }
                Ok(row) => {
                    self.bytes = bytes;
                    return Ok(row);
                }
                Err(_) if !ended => {
                    self.truncated = Some(LastLine::CutOff(number));
                    return Ok(None);
                }
                Err(error) => return Err(error.within(format_args!("line {number}"))),
            }
        }
    }

    /// The next row by the fast parser, if it is plain.
    fn plain_row(&mut self) -> Option<Row> {
        let plain = self.plain?.read(self.lines.ahead())?;
        let row = self.layout.plain_row(&plain)?;
        self.bytes = plain.bytes;
        Some(Row { line: self.lines.take(plain.length), ..row })
    }

    /// The last line, if it was left out.
    #[must_use]
    pub fn truncated(&self) -> Option<LastLine> {
        self.truncated
    }

    /// Number of empty lines that may have been readings, between rows without times.
    #[must_use]
    pub fn left_out(&self) -> u64 {
        self.left_out
    }

    /// Warning about a time of day without a zone that was set forward by an hour.
    #[must_use]
    pub fn summer_time(&self) -> Option<String> {
        let time = self.layout.time;
        let of_day = time.is_calendar() || matches!(time, TimeCells::DateAndClock { .. });
        let line = self.hour_on.filter(|_| of_day && !self.is_utc())?;
        Some(format!(
            "line {line}: the clock jumps forward by one hour: summer time? what it leaves out counts as \
             missing; if so, write its zone with each time"
        ))
    }

    /// Whether times are UTC: counted from 1970, or with a zone in the first row.
    #[must_use]
    pub fn is_utc(&self) -> bool {
        let since_1970 = TimeUnit::Epoch;
        matches!(self.layout.time, TimeCells::Number { unit, .. } if unit == since_1970)
            || self.utc.unwrap_or_default()
    }

    /// Layout of the rows.
    #[must_use]
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Checks a row against the previous one.
    #[inline]
    fn follow(&mut self, mut row: Row, record: Option<f64>) -> Result<Row, InputError> {
        if let TimeCells::Count { rate_hz } = self.layout.time {
            row.time_s = self.count as f64 / rate_hz;
            self.left_out += if self.count > 0 { self.empty } else { 0 };
            self.empty = 0;
        }
        self.count += 1;
        // A scan at the edge of a clock step may have the previous step's stamp.
        let jitter_s = self.layout.resolution_s.filter(|&step| step < 1.0).unwrap_or(0.0);
        row.time_s += self.days_s;
        if self.passes_midnight(row.time_s) {
            row.time_s += DAY_S;
            self.days_s += DAY_S;
        }
        if row.time_s < self.last_time_s - jitter_s {
            let seconds = self.last_time_s - row.time_s;
            let ahead = self.before_s.is_finite() && row.time_s >= self.before_s;
            let line = self.last_line;
            return Err(if ahead { runs_ahead(seconds, line) } else { goes_back(seconds) });
        }
        if self.layout.seconds_unsaid && leaves_out_40(self.last_time_s, row.time_s) {
            return Err(time_of_day(self.last_time_s, row.time_s));
        }
        if jumps_an_hour(row.time_s - self.last_time_s) {
            self.hour_on.get_or_insert(row.line);
        }
        self.before_s = self.last_time_s;
        (self.last_time_s, self.last_line) = (row.time_s, row.line);
        if let (Some(last), Some(record)) = (self.last_record, record) {
            row.records = self.in_steps((record - last) as u32);
        }
        self.last_record = record;
        Ok(row)
    }

    /// Finds the usual step of the record numbers in the first rows, and counts in such steps from
    /// here on, and in these rows: numbers that thinning has left out are no lost samples.
    pub fn find_record_step(&mut self, head: &mut [Row]) {
        let steps = head.iter().skip(1).map(|row| f64::from(row.records)).collect();
        self.record_step = median(steps).map_or(1, |step| step as u32);
        head.iter_mut().for_each(|row| row.records = self.in_steps(row.records));
    }

    /// A difference of record numbers in usual steps, at least 1.
    fn in_steps(&self, records: u32) -> u32 {
        (records.saturating_add(self.record_step / 2) / self.record_step).max(1)
    }

    /// Whether a time of day without a date has passed midnight.
    fn passes_midnight(&self, time_s: f64) -> bool {
        let undated = matches!(self.layout.time, TimeCells::DateAndClock { date: None, .. });
        undated && self.last_time_s - time_s > 0.5 * DAY_S
    }
}

/// Whether a step exceeds an interval between samples (1 s at most) by one hour.
fn jumps_an_hour(step_s: f64) -> bool {
    (3599.5..3601.5).contains(&step_s)
}

/// Whether a number continues like a time of day after 59 seconds and 59 minutes: 12:59:59.9 and
/// 13:00:00.0 written as 125959.9 and 130000.0.
fn leaves_out_40(before_s: f64, after_s: f64) -> bool {
    // Longest sampling period, s.
    const LONGEST_S: f64 = 1.0;
    let step_s = after_s - before_s;
    let left_out = |seconds: f64| (0.0..=LONGEST_S).contains(&(step_s - seconds));
    (left_out(40.0) || left_out(4040.0))
        && (60.0 - LONGEST_S..60.0).contains(&before_s.rem_euclid(100.0))
        && after_s.rem_euclid(100.0) < LONGEST_S
}

#[cold]
fn time_of_day(before_s: f64, after_s: f64) -> InputError {
    InputError::new(format!(
        "time goes from {before_s:.3} on to {after_s:.3}, as a time of day without colons does: write \
         12:59:59.9 for 125959.9, or give --time-unit s if it is in seconds"
    ))
}

/// Error for times that continue from the row before the last one, so that the last one may be
/// wrong.
#[cold]
fn runs_ahead(seconds: f64, line: u64) -> InputError {
    InputError::new(format!(
        "time goes back by {seconds:.6} s, and would not without line {line}: its time may be wrong; \
         correct it, or take that line out, or sort the log"
    ))
}

#[cold]
fn goes_back(seconds: f64) -> InputError {
    const NEAR_S: f64 = 10.0;
    const COUNTERS_S: [f64; 5] = [60.0, 65.536, 4_294.967_296, 4_294_967.296, 86_400.0];
    let by = |hours: f64| (seconds - 3600.0 * hours).abs() < NEAR_S;
    let began_anew = |span_s: &f64| (0.98 * span_s..=*span_s).contains(&seconds);
    let why = match (by(1.0), by(12.0)) {
        (true, _) => " (a clock set back by an hour? write its zone with each time)",
        (_, true) => " (twelve hours: are AM and PM missing?)",
        _ if COUNTERS_S.iter().any(began_anew) => {
            return InputError::new(format!(
                "time goes back by {seconds:.6} s: its counter, or the day, begins anew there; let the \
                 times run on, or cut the log there"
            ));
        }
        _ => "",
    };
    InputError::new(format!("time goes back by {seconds:.6} s{why}; cut the log there, or sort it"))
}
