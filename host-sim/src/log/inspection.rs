//! Contents of a log before any computation: `floe inspect`.

use floe_core::{Counts, Newtons, Reading};
use serde::Serialize;

use crate::error::InputError;

use super::layout::TimeCells;
use super::metadata::Said;
use super::number::Decimal;
use super::{Format, Log};

/// Name and version of the format; changes if a meaning changes.
pub const SCHEMA: &str = "floe-inspect/1";

/// The recognized form of a log, and statistics from reading it to the end.
#[derive(Clone, Debug, Serialize)]
pub struct Inspection {
    /// [`SCHEMA`].
    pub schema: &'static str,
    /// Path from the command line.
    pub path: String,
    /// `csv`, `toa5`, `cr10` or `floe`.
    pub format: &'static str,
    /// Separator of the cells; `None` in a logger's own log, which has no cells.
    pub delimiter: Option<char>,
    /// `.` or `,`; `None` if the log contains neither.
    pub decimal: Option<char>,
    /// Line of the column names.
    pub header_line: Option<u64>,
    /// Line of the units below them.
    pub units_line: Option<u64>,
    /// Line of the first row, if it was searched for.
    pub first_row_line: Option<u64>,
    /// The columns' names.
    pub columns: Vec<String>,
    /// Columns of the time, from 1.
    pub time_columns: Vec<usize>,
    /// Unit or form of the time in the form of `--time-unit`; `None` without a time.
    pub time_unit: Option<&'static str>,
    /// Time of the first sample, ISO 8601, if the log contains the date.
    pub start: Option<String>,
    /// Column of the force, from 1.
    pub force_column: usize,
    /// Unit of the force in the form of `--unit`.
    pub force_unit: &'static str,
    /// Samples per second.
    pub rate_hz: f64,
    /// Whether several samples share a time stamp.
    pub shared_stamps: bool,
    /// Metadata of the test in the log.
    pub metadata: Vec<Known>,
    /// Samples read, without duplicates.
    pub samples: u64,
    /// From the first to the last sample.
    pub duration_s: f64,
    /// Sampling periods without a sample.
    pub missing: u64,
    /// Samples whose sampling period was already taken.
    pub duplicates: u64,
    /// Readings that a logger marks as bad.
    pub bad: u64,
    /// Smallest force in N, or reading in counts.
    pub lowest: Option<f64>,
    /// Largest force in N, or reading in counts.
    pub highest: Option<f64>,
    /// Assumptions and warnings.
    pub warnings: Vec<String>,
}

/// An entry of the metadata.
#[derive(Clone, Debug, Serialize)]
pub struct Known {
    /// Its key.
    pub key: String,
    /// Value as written in the log.
    pub value: String,
    /// Line number, if the log has lines.
    pub line: Option<u64>,
}

/// Reads a log to its end.
///
/// # Errors
/// A line that cannot be used.
pub fn inspect(path: &str, log: &mut Log) -> Result<Inspection, InputError> {
    let mut seen = Seen::default();
    while let Some(sample) = log.next_sample()? {
        seen.push(sample.raw.index, sample.time_s, sample.raw.reading);
    }
    let (layout, header) = (log.layout(), log.recognised().header.as_ref());
    let is_text = log.format() != Format::Floe;
    let in_text = header.filter(|_| is_text);
    let known =
        |Said { key, value, line }| Known { key, value, line: Some(line).filter(|_| is_text) };
    let (mut time_columns, time_unit) = time(layout.time);
    time_columns.extend(layout.part.map(|part| part.cell + 1));
    Ok(Inspection {
        schema: SCHEMA,
        path: path.to_string(),
        format: log.format().name(),
        delimiter: Some(char::from(layout.separator)).filter(|_| is_text),
        decimal: match layout.decimal {
            Decimal::Point if is_text => Some('.'),
            Decimal::Comma if is_text => Some(','),
            Decimal::Point | Decimal::Comma | Decimal::Any => None,
        },
        header_line: in_text.and_then(|header| header.names.as_ref()).map(|(line, _)| *line),
        units_line: in_text.and_then(|header| header.units.as_ref()).map(|(line, _)| *line),
        first_row_line: in_text.map(|header| header.first_row),
        columns: header.map_or_else(Vec::new, |header| header.column_names().to_vec()),
        time_columns,
        time_unit,
        start: log.start().and_then(|start| start.after(0.0)),
        force_column: layout.force + 1,
        force_unit: layout.unit.name(),
        rate_hz: log.rate_hz(),
        shared_stamps: log.clock.timing().shared.is_some_and(|shared| shared.step > 1.0),
        metadata: log.metadata().said.iter().cloned().map(known).collect(),
        samples: seen.samples,
        duration_s: seen.last_s - seen.first_s.unwrap_or_default(),
        missing: seen.missing,
        duplicates: seen.duplicates,
        bad: seen.bad,
        lowest: seen.range.map(|(lowest, _)| lowest),
        highest: seen.range.map(|(_, highest)| highest),
        warnings: log.warnings(),
    })
}

/// Columns from 1, and the unit.
fn time(cells: TimeCells) -> (Vec<usize>, Option<&'static str>) {
    match cells {
        TimeCells::Number { cell, unit } => (vec![cell + 1], Some(unit.name())),
        TimeCells::DateAndClock { date, clock } => {
            let columns = date.into_iter().chain([clock]).map(|cell| cell + 1);
            (columns.collect(), Some("iso"))
        }
        TimeCells::Numbered { cell, .. } => (vec![cell + 1], None),
        TimeCells::Count { .. } => (Vec::new(), None),
        TimeCells::Cr10 { seconds } => ((2..=4 + usize::from(seconds)).collect(), Some("iso")),
    }
}

/// Statistics of the samples read.
#[derive(Debug, Default)]
struct Seen {
    samples: u64,
    missing: u64,
    duplicates: u64,
    bad: u64,
    next: u32,
    first_s: Option<f64>,
    last_s: f64,
    range: Option<(f64, f64)>,
}

impl Seen {
    fn push(&mut self, index: u32, time_s: f64, reading: Reading) {
        if index < self.next {
            self.duplicates += 1;
            return;
        }
        self.missing += if self.samples == 0 { 0 } else { u64::from(index - self.next) };
        (self.next, self.samples, self.last_s) = (index + 1, self.samples + 1, time_s);
        self.first_s.get_or_insert(time_s);
        let value = match reading {
            Reading::Force(Newtons(force)) => f64::from(force),
            Reading::Counts(Counts(counts)) => f64::from(counts),
            Reading::Bad(_) => {
                self.bad += 1;
                return;
            }
        };
        let (lowest, highest) = self.range.unwrap_or((value, value));
        self.range = Some((lowest.min(value), highest.max(value)));
    }
}
