//! Recorded logs: text in, samples with index and time out, in constant memory.
//!
//! ```text
//!  bytes ─► lines ─► cells ─► rows ─────────► clock ─► Sample
//!           64 KiB   RFC 4180  stamp, reading  index
//! ```
//!
//! What differs between the formats is only where a row keeps its stamp and its
//! force ([`layout::Layout`]); each format's module finds that out.
//!
//! A reading that a logger marks as bad (-6999, 6999, -9999, -99999, NaN, infinite
//! or empty) is a sample without a force, counted as rejected. Anything else that
//! is not a number, and any time that is not one, is an error with its line.

use std::collections::VecDeque;
use std::io::Read;

use floe_core::RawSample;

use crate::card;
use crate::error::InputError;
use crate::rounding::counted;

pub mod above;
pub mod beat;
pub mod bursts;
pub mod cells;
pub mod channels;
pub mod clock;
pub mod columns;
pub mod comment;
pub mod cr10;
pub mod csv;
pub mod fine;
pub mod fraction;
pub mod groups;
pub mod header;
pub mod held;
pub mod inspection;
pub mod interval;
pub mod label;
pub mod layout;
pub mod lines;
pub mod meant;
pub mod metadata;
pub mod number;
pub mod open;
pub mod options;
pub mod other_forces;
pub mod other_times;
pub mod part;
pub mod plain;
pub mod rate;
pub mod remedy;
pub mod rows;
pub mod said_unit;
pub mod sense;
pub mod stamp;
pub mod start;
pub mod time_column;
pub mod time_unit;
pub mod timing;
pub mod toa5;
pub mod unit_cells;
pub mod winch_marks;

use clock::Clock;
use header::Header;
use held::Held;
use interval::Intervals;
use layout::Layout;
use lines::Lines;
use metadata::Metadata;
pub use number::{Decimal, STANDARD_GRAVITY, Unit};
use open::{begin, below, no_floe, peek, recognise, refuse_binary, utf8};
pub use options::LogOptions;
use rate::{keeps_up, left_out, of_stamps, refuse_rate};
use rows::{LastLine, Row, Rows};
use said_unit::refuse_other_unit;
use start::Start;

/// Number of rows read ahead to determine rate, phase and metadata.
const HEAD_ROWS: usize = 4096;

/// Kinds of text log.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Format {
    /// A header line, then rows.
    Csv,
    /// Campbell, four header lines.
    Toa5,
    /// Campbell mixed arrays, no header.
    Cr10,
    /// The logger's own sectors; the first test of them.
    Floe,
}

impl Format {
    /// As in options and results.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Toa5 => "toa5",
            Self::Cr10 => "cr10",
            Self::Floe => "floe",
        }
    }
}

/// A sample of a log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Sample for [`floe_core::Pipeline::step`].
    pub raw: RawSample,
    /// Time in the log's own time, s: the time column of a CSV; for calendar stamps seconds since
    /// the first sample.
    pub time_s: f64,
}

/// An open log.
#[derive(Debug)]
pub struct Log {
    format: Format,
    rows: Rows,
    /// Rows read and not returned: first the head, then those that the clock needs in advance.
    ahead: VecDeque<Row>,
    clock: Clock,
    origin_s: f64,
    held: Held,
    /// `None` if the rate is given (larger intervals are gaps then), or if stamps are shared.
    intervals: Option<Intervals>,
    head: Recognised,
    /// Remarks on other contents of a logger's own log.
    told: Vec<String>,
}

/// Information about a text log from before its first row.
#[derive(Clone, Debug, Default)]
pub struct Recognised {
    /// Header of the table; `None` for formats without one to search for.
    pub header: Option<Header>,
    /// Assumptions, one sentence each.
    pub notes: Vec<String>,
}

impl Log {
    /// Starts reading: recognizes the format, finds columns, rate and metadata.
    ///
    /// Never seeks, so any stream is suitable.
    ///
    /// # Errors
    /// A message of one line with the place in the stream and the remedy.
    pub fn from_reader(
        input: Box<dyn Read + Send>,
        options: &LogOptions,
    ) -> Result<Self, InputError> {
        let (input, start) = peek(input)?;
        let (input, is_floe) = (utf8(input, &start), card::is_log(&start));
        if is_floe && options.format.is_none_or(|format| format == Format::Floe) {
            return Self::from_floe(input, options);
        }
        if options.format == Some(Format::Floe) {
            return Err(no_floe());
        }
        let mut lines = Lines::new(input);
        let (head, end) = lines.head()?;
        refuse_binary(below(head, end, options.skip_lines))?;
        let format = options.format.unwrap_or_else(|| recognise(head, end));
        options.check(format)?;
        let (rows, head) = begin(format, lines, options)?;
        Self::timed(format, rows, head, options)
    }

    /// Opens a logger's own log through its text form.
    fn from_floe(input: Box<dyn Read + Send>, options: &LogOptions) -> Result<Self, InputError> {
        options.check(Format::Floe)?;
        let options = LogOptions {
            format: Some(Format::Floe),
            column: Some(card::COLUMN.to_string()),
            unit: Some(Unit::Counts),
            ..options.clone()
        };
        let (text, told) = card::Text::read(input)?;
        let (rows, head) = begin(Format::Floe, Lines::new(Box::new(text)), &options)?;
        Ok(Self { told, ..Self::timed(Format::Floe, rows, head, &options)? })
    }

    /// The next sample; `None` at the end.
    ///
    /// # Errors
    /// A line that cannot be used, with its number.
    pub fn next_sample(&mut self) -> Result<Option<Sample>, InputError> {
        let Some(row) = self.next_row()? else {
            return self.intervals.as_ref().map_or(Ok(()), Intervals::end).map(|()| None);
        };
        let stamps = self.ahead.iter().map(|row| row.time_s);
        let place = self.clock.place(row.time_s, row.records, stamps);
        let (index, time_s) = place.ok_or_else(|| too_long(row.line))?;
        self.intervals.as_mut().map_or(Ok(()), |intervals| intervals.push(&row))?;
        self.held.push(index, row.reading);
        let raw = RawSample { index, reading: row.reading };
        Ok(Some(Sample { raw, time_s: time_s - self.origin_s }))
    }

    /// The next row; `ahead` then contains the following rows that the clock needs.
    fn next_row(&mut self) -> Result<Option<Row>, InputError> {
        let lookahead = self.clock.lookahead();
        if lookahead == 0 && self.ahead.is_empty() {
            return self.rows.next_row();
        }
        while self.ahead.len() <= lookahead {
            let Some(row) = self.rows.next_row()? else { break };
            self.ahead.push_back(row);
        }
        Ok(self.ahead.pop_front())
    }

    /// The format, recognized or given.
    #[must_use]
    pub fn format(&self) -> Format {
        self.format
    }

    /// Samples per second.
    #[must_use]
    pub fn rate_hz(&self) -> f64 {
        self.clock.timing().rate_hz
    }

    /// Metadata of the test from the beginning of the log, up to its first 4096 samples.
    #[must_use]
    pub fn metadata(&self) -> &Metadata {
        &self.rows.metadata
    }

    /// Unit of the force column.
    #[must_use]
    pub fn unit(&self) -> Unit {
        self.rows.layout().unit
    }

    /// Layout of the rows.
    #[must_use]
    pub fn layout(&self) -> &Layout {
        self.rows.layout()
    }

    /// Information from above the first row.
    #[must_use]
    pub fn recognised(&self) -> &Recognised {
        &self.head
    }

    /// Time at which the log's own time begins, if the log contains the date.
    #[must_use]
    pub fn start(&self) -> Option<Start> {
        let metadata = self.metadata();
        if let Some(start_ms) = metadata.start_unix_ms {
            return Some(Start { unix_s: start_ms / 1000.0, is_utc: true });
        }
        let said = self.rows.layout().time.is_calendar() && !metadata.undated;
        said.then_some(Start { unix_s: self.origin_s, is_utc: self.rows.is_utc() })
    }

    /// Warnings for the result, complete at the end of the log.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let truncated = self.rows.truncated().map(LastLine::warning);
        let left_out = Some(self.rows.left_out()).filter(|&count| count > 0).map(|count| {
            format!(
                "{} between rows without a time left out: where a reading is missing, write NaN",
                counted(count, "empty line")
            )
        });
        let said = self.rows.metadata.notes.iter().map(|note| note.text.clone());
        let found = self.head.notes.iter().cloned().chain(said).chain(truncated).chain(left_out);
        found
            .chain(self.rows.summer_time())
            .chain(self.clock.warnings())
            .chain(self.held.warnings(self.rate_hz()))
            .chain(self.told.iter().cloned())
            .collect()
    }

    /// Reads the head and determines the timing.
    fn timed(
        format: Format,
        mut rows: Rows,
        mut recognised: Recognised,
        options: &LogOptions,
    ) -> Result<Self, InputError> {
        let mut head = Vec::new();
        while head.len() < HEAD_ROWS {
            let Some(row) = rows.next_row()? else { break };
            head.push(row);
        }
        if head.is_empty() {
            return Err(no_samples(&rows));
        }
        rows.find_record_step(&mut head);
        refuse_other_unit(&rows, options)?;
        let mut rate_hz = options.rate_hz.or(rows.metadata.rate_hz);
        refuse_rate(options.rate_hz, &rows.metadata)?;
        match options.rate_hz {
            Some(given) => recognised.notes.extend(keeps_up(given, &head, &rows)?),
            None => {
                if let Some((own_hz, note)) = of_stamps(&head, &rows)? {
                    rate_hz = Some(own_hz);
                    recognised.notes.push(note);
                }
            }
        }
        let timing = rows.layout().timing(&head, rate_hz)?;
        recognised.notes.extend(left_out(&timing).filter(|_| options.rate_hz.is_none()));
        let keeps_one = options.rate_hz.is_none() && timing.shared.is_none();
        let origin_s = if rows.layout().time.is_calendar() { timing.start_s } else { 0.0 };
        Ok(Self {
            format,
            rows,
            ahead: head.into(),
            clock: Clock::new(timing),
            origin_s,
            held: Held::default(),
            intervals: keeps_one.then(|| Intervals::new(timing.rate_hz.recip())),
            head: recognised,
            told: Vec::new(),
        })
    }
}

fn too_long(line: u64) -> InputError {
    InputError::new(format!(
        "line {line}: a test has {} sampling periods at most, gaps counted: cut the log before it",
        RawSample::LAST_INDEX
    ))
}

fn no_samples(rows: &Rows) -> InputError {
    InputError::new(match rows.truncated() {
        Some(LastLine::CutOff(line) | LastLine::MayGoOn(line)) => {
            format!("no samples: line {line} is cut off and nothing is before it")
        }
        None => "no samples: the log ends after its header".to_string(),
    })
}
