//! Recorded logs: text in, samples with index and time out, in constant memory.
//!
//! ```text
//!  bytes ─► lines ─► cells ─► rows ─────────► clock ─► Sample
//!           64 KiB   RFC 4180  stamp, reading  index
//! ```
//!
//! What differs between the formats is only where a row keeps its stamp and its
//! force ([`rows::Layout`]); each format's module finds that out.
//!
//! A reading that a logger marks as bad (-6999, 6999, -99999, NaN, infinite or
//! empty) is a sample without a force, counted as rejected. Anything else that
//! is not a number, and any time that is not one, is an error with its line.

use std::collections::VecDeque;
use std::io::{Cursor, Read};

use floe_core::RawSample;
use floe_firmware::record::MAGIC;

use crate::card;
use crate::error::{InputError, excerpt};

pub mod cells;
pub mod clock;
pub mod cr10;
pub mod csv;
pub mod lines;
pub mod metadata;
pub mod number;
pub mod rows;
pub mod stamp;
pub mod timing;
pub mod toa5;

use clock::Clock;
use lines::Lines;
use metadata::Metadata;
pub use number::{STANDARD_GRAVITY, Unit};
use rows::{Row, Rows, TimeCells};

/// Rows read ahead to find rate, phase and metadata.
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

/// What a caller may say about a log; everything else is found in it.
#[derive(Clone, Debug, Default)]
pub struct LogOptions {
    /// Recognised from the content if `None`.
    pub format: Option<Format>,
    /// From the log or its stamps if `None`.
    pub rate_hz: Option<f64>,
    /// Name of the force column; for cr10 its number in the row, from 1.
    pub column: Option<String>,
    /// Unit of the force column.
    pub unit: Option<Unit>,
    /// The array to read of a cr10 log.
    pub array_id: Option<u32>,
}

/// One sample of a log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// For [`floe_core::Pipeline::step`].
    pub raw: RawSample,
    /// In the log's own time, s: a CSV's time column; for calendar stamps
    /// seconds since the first sample.
    pub time_s: f64,
}

/// An open log.
#[derive(Debug)]
pub struct Log {
    format: Format,
    rows: Rows,
    /// Rows read but not given out: the head at first, then what the clock
    /// needs to see ahead.
    ahead: VecDeque<Row>,
    clock: Clock,
    origin_s: f64,
    /// What a logger's own log holds beside the test.
    told: card::Told,
}

impl Log {
    /// Begins to read: recognises the format, finds columns, rate and metadata.
    ///
    /// Never seeks, so any stream will do.
    ///
    /// # Errors
    /// One line that says where in the stream and what to do about it.
    pub fn from_reader(
        input: Box<dyn Read + Send>,
        options: &LogOptions,
    ) -> Result<Self, InputError> {
        let (input, is_floe) = peek_floe(input)?;
        if is_floe && options.format.is_none_or(|format| format == Format::Floe) {
            return Self::from_floe(input, options);
        }
        if options.format == Some(Format::Floe) {
            return Err(InputError::new("is not a log of a floe logger; leave --format out"));
        }
        let mut lines = Lines::new(input);
        let head = lines.head()?;
        refuse_binary(head)?;
        let format = options.format.unwrap_or_else(|| recognise(head));
        let rows = begin(format, lines, options)?;
        Self::start(format, rows, options)
    }

    /// The logger's own log, by way of its text.
    fn from_floe(input: Box<dyn Read + Send>, options: &LogOptions) -> Result<Self, InputError> {
        let options = LogOptions {
            format: Some(Format::Floe),
            column: Some(card::COLUMN.to_string()),
            unit: Some(Unit::Counts),
            ..options.clone()
        };
        let text = card::Text::new(input);
        let told = text.told();
        let rows = begin(Format::Floe, Lines::new(Box::new(text)), &options)?;
        Ok(Self { told, ..Self::start(Format::Floe, rows, &options)? })
    }

    /// The next sample, `None` at the end.
    ///
    /// # Errors
    /// A line that cannot be used, with its number.
    pub fn next_sample(&mut self) -> Result<Option<Sample>, InputError> {
        let Some(row) = self.next_row()? else { return Ok(None) };
        let stamps = self.ahead.iter().map(|row| row.time_s);
        let (index, time_s) = self.clock.place(row.time_s, row.records, stamps);
        let raw = RawSample { index, reading: row.reading };
        Ok(Some(Sample { raw, time_s: time_s - self.origin_s }))
    }

    /// The next row, with as many behind it in `ahead` as the clock looks at.
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

    /// What was recognised, or said by the caller.
    #[must_use]
    pub fn format(&self) -> Format {
        self.format
    }

    /// Samples per second.
    #[must_use]
    pub fn rate_hz(&self) -> f64 {
        self.clock.timing().rate_hz
    }

    /// What the log says about its test, up to its first 4096 samples.
    #[must_use]
    pub fn metadata(&self) -> &Metadata {
        &self.rows.metadata
    }

    /// Unit of the force column.
    #[must_use]
    pub fn unit(&self) -> Unit {
        self.rows.layout().unit
    }

    /// What a reader of the result should know, complete at the end of the log.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let truncated = self.rows.truncated().map(|line| {
            format!("line {line}, the last, is cut off and was left out; all before it is used")
        });
        let misfits = self.clock.misfits();
        let rate_hz = self.rate_hz();
        let misfits = (misfits > 0)
            .then(|| format!("{misfits} time stamps do not fit {rate_hz} samples per second"));
        truncated.into_iter().chain(misfits).chain(self.told.warnings()).collect()
    }

    /// Reads the head and finds the timing in it.
    fn start(format: Format, mut rows: Rows, options: &LogOptions) -> Result<Self, InputError> {
        let mut head = Vec::new();
        while head.len() < HEAD_ROWS {
            let Some(row) = rows.next_row()? else { break };
            head.push(row);
        }
        if head.is_empty() {
            return Err(no_samples(&rows));
        }
        let rate_hz = options.rate_hz.or(rows.metadata.rate_hz);
        if let Some(wrong) = rate_hz.filter(|rate| !timing::RATES_HZ.contains(rate)) {
            return Err(InputError::new(format!("a rate of {wrong} Hz is not within 1 to 2000")));
        }
        let timing = timing::find(&head, rate_hz, rows.layout().resolution_s)?;
        let calendar = !matches!(rows.layout().time, TimeCells::Seconds(_));
        let origin_s = if calendar { timing.start_s } else { 0.0 };
        Ok(Self {
            format,
            rows,
            ahead: head.into(),
            clock: Clock::new(timing),
            origin_s,
            told: card::Told::default(),
        })
    }
}

/// Whether the stream is a log of the logger itself; nothing of it is lost.
fn peek_floe(mut input: Box<dyn Read + Send>) -> Result<(Box<dyn Read + Send>, bool), InputError> {
    let mut mark = Vec::new();
    let read = input.by_ref().take(MAGIC.len() as u64).read_to_end(&mut mark);
    read.map_err(|error| InputError::new(format!("cannot be read: {error}")))?;
    let is_floe = mark == MAGIC;
    Ok((Box::new(Cursor::new(mark).chain(input)), is_floe))
}

fn no_samples(rows: &Rows) -> InputError {
    InputError::new(match rows.truncated() {
        Some(line) => format!("no samples: line {line} is cut off and nothing is before it"),
        None => "no samples: the log ends after its header".to_string(),
    })
}

/// Refuses what is certainly no text log of ours, with the way out.
fn refuse_binary(head: &[u8]) -> Result<(), InputError> {
    let refuse = |message: &str| Err(InputError::new(message));
    let text = head.trim_ascii_start();
    if text.is_empty() {
        return refuse("is empty");
    }
    if head.starts_with(b"\xFF\xFE") || head.starts_with(b"\xFE\xFF") {
        return refuse("is UTF-16 text; convert it to UTF-8, e.g. iconv -f UTF-16 -t UTF-8");
    }
    for kind in ["TOB1", "TOB2", "TOB3", "TOACI1"] {
        if text.strip_prefix(b"\"").unwrap_or(text).starts_with(kind.as_bytes()) {
            return Err(InputError::new(format!("is {kind}; convert it to TOA5 with CardConvert")));
        }
    }
    let first = text.split(|&byte| byte == b'\n').next().unwrap_or_default();
    if first.contains(&0) || control_share(head) > 0.02 {
        return refuse("is a binary file, not a csv, toa5 or cr10 log");
    }
    Ok(())
}

/// Share of bytes that no text holds, apart from the zeros that a logger leaves
/// at the end when its power is cut.
fn control_share(bytes: &[u8]) -> f64 {
    let end = bytes.iter().rposition(|&byte| byte != 0).map_or(0, |last| last + 1);
    let bytes = bytes.get(..end).unwrap_or_default();
    let control = |byte: &&u8| byte.is_ascii_control() && !byte.is_ascii_whitespace();
    bytes.iter().filter(control).count() as f64 / bytes.len().max(1) as f64
}

/// The format by its first line that is no comment.
fn recognise(head: &[u8]) -> Format {
    let lines = head.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii);
    let first = lines.into_iter().find(|line| !line.is_empty() && !line.starts_with(b"#"));
    match first.unwrap_or_default() {
        line if is_toa5(line) => Format::Toa5,
        line if cr10::is_row(line) => Format::Cr10,
        _ => Format::Csv,
    }
}

fn is_toa5(line: &[u8]) -> bool {
    line.strip_prefix(b"\"").unwrap_or(line).starts_with(b"TOA5")
}

/// Takes the header and finds the layout.
fn begin(format: Format, mut lines: Lines, options: &LogOptions) -> Result<Rows, InputError> {
    let mut metadata = Metadata::default();
    let layout = match format {
        Format::Csv | Format::Floe => {
            let (header, number) = header_line(&mut lines, &mut metadata)?;
            let place = format!("line {number}");
            csv::layout(&header, options).map_err(|error| error.within(place))?
        }
        Format::Toa5 => {
            let (first, number) = header_line(&mut lines, &mut metadata)?;
            if !is_toa5(&first) {
                let message = format!("a toa5 log begins with \"TOA5\", not {}", excerpt(&first));
                return Err(InputError::new(message).within(format_args!("line {number}")));
            }
            let (names, number) = header_line(&mut lines, &mut metadata)?;
            let (units, _) = header_line(&mut lines, &mut metadata)?;
            let (_processing, _) = header_line(&mut lines, &mut metadata)?;
            let place = format!("line {number}");
            toa5::layout(&names, &units, options).map_err(|error| error.within(place))?
        }
        Format::Cr10 => cr10::layout(lines.head()?, options)?,
    };
    Ok(Rows::new(lines, layout, metadata))
}

/// The next line that is neither empty nor a comment, and its number.
fn header_line(lines: &mut Lines, metadata: &mut Metadata) -> Result<(Vec<u8>, u64), InputError> {
    while let Some(line) = lines.next_line()? {
        let number = line.number;
        match line.bytes.trim_ascii_start().first() {
            None => {}
            Some(b'#') => {
                let taken = metadata.take(line.bytes);
                taken.map_err(|error| error.within(format_args!("line {number}")))?;
            }
            Some(_) => return Ok((line.bytes.to_vec(), number)),
        }
    }
    Err(InputError::new("ends before its header does"))
}
