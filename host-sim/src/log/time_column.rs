//! Finds the time column of a text table and its form.

use crate::error::{InputError, beginning};
use crate::rounding::counted;

use super::LogOptions;
use super::columns::Columns;
use super::csv::{agreed, find, there_are};
use super::header::{IN_A_ROW, Kind, kind};
use super::label::Label;
use super::layout::TimeCells;
use super::number::{Decimal, count_up, number};
use super::stamp::{TimeUnit, clock_seconds, date_seconds, date_time_seconds, is_since_1970};
use super::timing::RATES_HZ;

/// Names that take precedence, in this order.
const TIME_COLUMNS: [&str; 4] = ["time_s", "t_s", "time", "t"];

/// Width up to which a few rows are normal; with wider rows each row may be a channel.
const MOST_COLUMNS: usize = 32;

impl Columns<'_> {
    /// The time column, if there is one.
    ///
    /// # Errors
    /// A problem of the given column, or two columns of the name.
    pub fn time(&self, options: &LogOptions) -> Result<Option<usize>, InputError> {
        if let Some(name) = &options.time_column {
            return self.header.column(name, "--time-column").map(Some);
        }
        if self.names.is_empty() {
            return self.time_without_header(options);
        }
        for name in TIME_COLUMNS {
            let found = find(self.names, name, "--time-column")?;
            if let Some(place) = found.filter(|&place| !self.is_empty(place)) {
                let other = (name == "t").then(|| self.rather_than_t(place)).flatten();
                return Ok(other.or(Some(place)));
            }
        }
        self.refuse_parts()?;
        let is_named = |&place: &usize| {
            let is = self.labels.get(place).is_some_and(|it| it.is_time() && !is_temperature(it));
            is && !self.is_empty(place)
        };
        let Some(place) = (0..self.names.len()).find(is_named) else {
            return Ok(self.of_dates().or_else(|| self.only_in_time_units()));
        };
        find(self.names, &self.names[place], "--time-column").map(|_| Some(place))
    }

    /// Whether a column is empty in the first rows, as LabVIEW leaves that of times.
    fn is_empty(&self, place: usize) -> bool {
        !self.header.rows.is_empty() && self.cells(place).all(str::is_empty)
    }

    /// A column that describes the time better than a bare `t` or `T`, which may be a temperature.
    fn rather_than_t(&self, t: usize) -> Option<usize> {
        let says_unit = |label: &Label| label.is_time() && label.is_in_time();
        self.labels
            .iter()
            .position(says_unit)
            .or_else(|| self.of_dates())
            .filter(|&place| place != t)
    }

    /// The only column with a unit of time, under any name.
    fn only_in_time_units(&self) -> Option<usize> {
        let in_time = |&i: &usize| self.stated(i).any(|unit| TimeUnit::from_label(unit).is_some());
        let is_force = |&i: &usize| self.labels.get(i).is_some_and(Label::is_force);
        let is_told = |i: &usize| !is_force(i) && !self.is_empty(*i);
        let mut places = (0..self.names.len()).filter(in_time).filter(is_told);
        places.next().filter(|_| places.next().is_none())
    }

    /// Rejects a time in several columns for hours, minutes and seconds.
    fn refuse_parts(&self) -> Result<(), InputError> {
        const HOURS: [&str; 10] =
            ["h", "hh", "hhmm", "hour", "hours", "stunde", "ss", "year", "yyyy", "doy"];
        let is_part = |i: &usize| {
            let Some(label) = self.labels.get(*i) else { return false };
            let alone = label.quantity.is_empty() && label.time_unit().is_some();
            alone || HOURS.contains(&label.quantity.as_str())
        };
        let parts: Vec<&str> =
            (0..self.names.len()).filter(is_part).map(|i| self.names[i].as_str()).collect();
        if parts.len() < 2 {
            return Ok(());
        }
        Err(InputError::new(format!(
            "the time is spread over the columns {}: put it into one, or give --time-column NAME \
             of one that runs on",
            parts.join(", ")
        )))
    }

    /// The only column of dates with times of day, under any name: it is the time.
    fn of_dates(&self) -> Option<usize> {
        let is_dated = |&place: &usize| {
            let mut cells = self.cells(place).filter(|cell| !cell.is_empty()).peekable();
            cells.peek().is_some() && cells.all(|cell| date_time_seconds(cell.as_bytes()).is_some())
        };
        let mut dated = (0..self.names.len()).filter(is_dated);
        dated.next().filter(|_| dated.next().is_none())
    }

    /// The time column without a header: of two columns the first, of one none.
    fn time_without_header(&self, options: &LogOptions) -> Result<Option<usize>, InputError> {
        match self.header.width {
            1 => Ok(None),
            2 => self.refuse_up_and_down().map(|()| Some(0)),
            _ if options.column.is_some() => Ok(Some(0)),
            width if self.header.rows.len() < IN_A_ROW && width > MOST_COLUMNS => {
                Err(InputError::new(format!(
                    "{} of {width} cells: write one row for each sample, with its time and its force",
                    counted(self.header.rows.len() as u64, "row")
                )))
            }
            width => Err(InputError::new(format!(
                "no header line over {width} columns: name the columns, e.g. 'time_s,force_n', \
                 or give --time-column 1 --column {}",
                (1..width).find(|&at| self.is_bare(at)).unwrap_or(1) + 1
            ))),
        }
    }

    /// Rejects a first column of two that rises and falls, as forces do and times do not.
    fn refuse_up_and_down(&self) -> Result<(), InputError> {
        const STEPS: usize = 3;
        let values = self.values(0, Decimal::Any);
        let count = |is: fn(&f64, &f64) -> bool| {
            values.windows(2).filter(|w| matches!(w, [a, b] if is(a, b))).count()
        };
        if count(|a, b| a < b) < STEPS || count(|a, b| a > b) < STEPS {
            return Ok(());
        }
        Err(InputError::new(
            "no header, and the first of two columns goes up and down as no time does: name the columns, \
             e.g. 'force_n,time_s'; if a decimal mark has cut the numbers apart, give --delimiter ';'",
        ))
    }

    /// Form of the time column.
    ///
    /// # Errors
    /// Units that contradict each other, or an unknown one.
    pub fn time_cells(
        &self,
        column: usize,
        options: &LogOptions,
        decimal: Decimal,
    ) -> Result<TimeCells, InputError> {
        let cell = self.cells(column).find(|cell| !cell.is_empty()).unwrap_or_default();
        let is_dated = date_time_seconds(cell.as_bytes()).is_some();
        let is_text = is_dated || cell.contains(':') && clock_seconds(cell).is_some();
        if let Some(given) = options.time_unit.filter(|unit| is_text && *unit != TimeUnit::Iso) {
            return Err(InputError::new(format!(
                "column {} holds times as text, and --time-unit says {}: leave --time-unit out",
                self.said(column),
                given.name()
            )));
        }
        if is_dated {
            return Ok(TimeCells::Number { cell: column, unit: TimeUnit::Iso });
        }
        if let Some(clock) = self.clock(column, cell) {
            return Ok(clock);
        }
        let name = self.name(column);
        self.refuse_factor(column, options)?;
        let stated: Vec<&str> = self.stated(column).collect();
        let units: Vec<TimeUnit> =
            stated.iter().filter_map(|unit| TimeUnit::from_label(unit)).collect();
        let unit = match (options.time_unit, units.as_slice()) {
            (Some(given), _) if given.is_calendar() => given,
            (given, units) => {
                match (agreed(name, units, given, TimeUnit::name, "--time-unit")?, stated.first()) {
                    (Some(unit), _) => self.since_1970(column, unit, decimal).unwrap_or(unit),
                    (None, Some(label)) => {
                        return Err(InputError::new(format!(
                            "the unit of column '{name}' is '{label}', which is not read: turn it into \
                         seconds, or give --time-unit s|ms|us|ns|min|iso|epoch|excel if it is one of these"
                        )));
                    }
                    (None, None) => self.unit_by_size(column, decimal)?,
                }
            }
        };
        Ok(TimeCells::Number { cell: column, unit })
    }

    /// Whether a column with a unit of time counts from 1970.
    fn since_1970(&self, column: usize, unit: TimeUnit, decimal: Decimal) -> Option<TimeUnit> {
        let first = self.cells(column).next()?;
        let counts = unit != TimeUnit::Minute
            && unit.seconds(first.as_bytes(), decimal).is_some_and(is_since_1970);
        counts.then_some(TimeUnit::Epoch)
    }

    /// A time of day without a date, or with the date in another column.
    fn clock(&self, column: usize, cell: &str) -> Option<TimeCells> {
        let first = |place: usize| self.cells(place).next().unwrap_or_default();
        let is_date = |place: &usize| date_seconds(first(*place)).is_some();
        let is_clock = |place: &usize| {
            *place != column
                && first(*place).contains(':')
                && clock_seconds(first(*place)).is_some()
        };
        let mut others = 0..self.header.width;
        if date_seconds(cell).is_some() {
            let clock = others.find(is_clock)?;
            return Some(TimeCells::DateAndClock { date: Some(column), clock });
        }
        let clock = cell.contains(':') && clock_seconds(cell).is_some();
        clock.then(|| TimeCells::DateAndClock { date: others.find(is_date), clock: column })
    }

    /// Seconds, unless the numbers can only be dates: counted since 1970, or days with steps far
    /// too short for seconds.
    fn unit_by_size(&self, column: usize, decimal: Decimal) -> Result<TimeUnit, InputError> {
        let values = self.values(column, decimal);
        let Some(first) = values.first().copied() else { return Ok(TimeUnit::Second) };
        let steps = values.windows(2).filter_map(|w| Some(w.last()? - w.first()?));
        let step = steps.filter(|&step| step > 0.0).fold(f64::INFINITY, f64::min);
        let rates = |unit_s: f64| RATES_HZ.contains(&(step * unit_s).recip());
        match first {
            8e8..1e20 => self.dated(column, TimeUnit::Epoch, decimal),
            20_000.0..80_000.0 | 713_960.0..773_960.0 if !rates(1.0) && rates(86_400.0) => {
                self.dated(column, TimeUnit::Excel, decimal)
            }
            _ if self.unit_within(column).is_some() => Err(InputError::new(format!(
                "the name of column {} holds '{}': give the unit, --time-unit s|ms|us|ns|min",
                self.said(column),
                self.unit_within(column).unwrap_or_default()
            ))),
            _ if self.numbers_rows(column, decimal) => Err(InputError::new(format!(
                "the times of column {} go up by 1 from row to row and have no unit: are they \
                 numbers of the rows? then give --rate-hz, else --time-unit s or ms, or another --time-column",
                self.said(column)
            ))),
            _ => Ok(TimeUnit::Second),
        }
    }

    pub(super) fn values(&self, column: usize, decimal: Decimal) -> Vec<f64> {
        self.cells(column).filter_map(|cell| number(cell.as_bytes(), decimal)).collect()
    }

    /// Whether a column may be the time by its first rows: no text, and no numbers that are
    /// constant, fall or count the rows.
    fn runs_on(&self, column: usize) -> bool {
        let values = self.values(column, Decimal::Any);
        let (first, last) = (values.first(), values.last());
        let goes_on = values.windows(2).all(|w| w.first() <= w.last()) && first < last;
        let mut cells = self.cells(column).filter(|cell| !cell.is_empty());
        let are_values = cells.all(|cell| kind(cell) == Kind::Value);
        // Of dates the first and the last differ, unless they say when the record began.
        let dates_go_on =
            values.is_empty() && self.cells(column).next() != self.cells(column).last();
        are_values && (dates_go_on || goes_on) && !self.numbers_rows(column, Decimal::Any)
    }

    /// Whether a column may number the rows, by the first ones.
    pub(super) fn numbers_rows(&self, column: usize, decimal: Decimal) -> bool {
        let values = self.values(column, decimal);
        let whole = values.first().is_some_and(|first| first.fract().abs() < 1e-9);
        whole && values.len() > 3 && count_up(&values)
    }

    /// Whether the unit of a time assumed to be in seconds is unstated.
    #[must_use]
    pub fn seconds_unsaid(&self, time: TimeCells, options: &LogOptions) -> bool {
        let TimeCells::Number { cell, unit: TimeUnit::Second } = time else { return false };
        options.time_unit.is_none() && self.stated(cell).next().is_none()
    }

    /// Note on a time without a unit, if it has integers only or may be in minutes, and on a time of
    /// day beside a date that is not read.
    #[must_use]
    pub fn assumed_seconds(&self, time: TimeCells, options: &LogOptions) -> Option<String> {
        if let TimeCells::Numbered { cell, .. } = time {
            let name = self.said(cell);
            return Some(format!("column {name} numbers the rows, and the rate is as given"));
        }
        let TimeCells::Number { cell, .. } = time else { return self.unread_date(time) };
        let is_whole = |value: &f64| value.fract().abs() < 1e-9;
        let values = self.values(cell, Decimal::Any);
        let span = values.first().zip(values.last()).map_or(0.0, |(first, last)| last - first);
        let in_minutes = 60.0 * span > 0.0 && 60.0 * span <= values.len() as f64 - 1.0;
        let doubtful = in_minutes || !values.is_empty() && values.iter().all(is_whole);
        (self.seconds_unsaid(time, options) && doubtful)
            .then(|| format!("the times of column {} have no unit: taken as s", self.said(cell)))
    }

    fn unread_date(&self, time: TimeCells) -> Option<String> {
        let TimeCells::DateAndClock { date: None, .. } = time else { return None };
        let is_date = |it: &Label| ["date", "datum"].contains(&it.quantity.as_str());
        let column = self.labels.iter().position(is_date).filter(|&place| !self.is_empty(place))?;
        Some(format!(
            "column {} is not read, and the log has no date: write 2012-02-29 or 29.02.2012",
            self.said(column)
        ))
    }

    /// The error for rows without a time.
    #[must_use]
    pub fn no_time(&self, force: usize) -> InputError {
        if self.names.is_empty() {
            return InputError::new(
                "no header and one column only: give --rate-hz R for forces without a time",
            );
        }
        let known = "no time column (time_s, t_s, t or time): give";
        let rate = "--rate-hz R for rows without a time";
        let may_be_time = |&place: &usize| {
            let is_named = self.names.get(place).is_some_and(|name| !name.is_empty());
            place != force && is_named && !self.is_empty(place) && self.runs_on(place)
        };
        let mut others = (0..self.names.len()).filter(may_be_time);
        let Some(other) = others.next().and_then(|place| self.names.get(place)) else {
            return InputError::new(format!("{known} {rate}; {}", there_are(self.names)));
        };
        let such = beginning(other);
        InputError::new(format!(
            "{known} --time-column NAME, such as '{such}', or {rate}; {}",
            there_are(self.names)
        ))
    }
}

/// Whether a label such as `T [°C]` has the name of a time with another unit.
fn is_temperature(label: &Label) -> bool {
    label.quantity == "t" && label.unit.is_some() && !label.is_in_time()
}
