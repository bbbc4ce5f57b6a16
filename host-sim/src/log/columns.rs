//! The columns of a text table: what their names, units and first cells say.

use crate::error::InputError;

use super::LogOptions;
use super::csv::{agreed, agreed_time, find, there_are};
use super::header::Header;
use super::label::{Label, bare_unit};
use super::layout::TimeCells;
use super::number::{Decimal, Unit, number};
use super::stamp::{TimeUnit, clock_seconds, date_seconds, date_time_seconds, is_since_1970};
use super::timing::RATES_HZ;

/// Names that are taken before any other, in this order.
const TIME_COLUMNS: [&str; 4] = ["time_s", "t_s", "t", "time"];
const FORCE_COLUMNS: [&str; 2] = ["force_n", "force_kn"];

/// The columns of a table by their labels.
#[derive(Debug)]
pub struct Columns<'a> {
    header: &'a Header,
    names: Vec<String>,
    labels: Vec<Label>,
}

impl<'a> Columns<'a> {
    /// Labels the names of a header.
    #[must_use]
    pub fn new(header: &'a Header) -> Self {
        let names = header.names.as_ref().map_or_else(Vec::new, |(_, names)| names.clone());
        let labels = names.iter().map(|name| Label::new(name)).collect();
        Self { header, names, labels }
    }

    /// What the names say.
    #[must_use]
    pub fn labels(&self) -> &[Label] {
        &self.labels
    }

    /// Name of a column.
    #[must_use]
    pub fn name(&self, column: usize) -> &str {
        self.header.name(column)
    }

    /// The cells of a column in the first rows.
    pub fn cells(&self, column: usize) -> impl Iterator<Item = &str> {
        self.header.cells(column)
    }

    /// The unit of force that a column states.
    #[must_use]
    pub fn stated_force(&self, column: usize) -> Option<Unit> {
        self.stated(column).find_map(Unit::from_label)
    }

    /// The unit in the row below the names.
    fn unit_below(&self, column: usize) -> Option<&str> {
        let (_, units) = self.header.units.as_ref()?;
        Some(bare_unit(units.get(column)?)).filter(|unit| !unit.is_empty() && *unit != "-")
    }

    /// The units that name and units row state.
    fn stated(&self, column: usize) -> impl Iterator<Item = &str> {
        let in_name = self.labels.get(column).and_then(|label| label.unit.as_deref());
        in_name.into_iter().chain(self.unit_below(column))
    }

    /// The time column, if there is one.
    ///
    /// # Errors
    /// Of the column that is named, or two of the name.
    pub fn time(&self, options: &LogOptions) -> Result<Option<usize>, InputError> {
        if let Some(name) = &options.time_column {
            return self.header.column(name, "--time-column").map(Some);
        }
        if self.names.is_empty() {
            return self.time_without_header(options);
        }
        for name in TIME_COLUMNS {
            if let Some(place) = find(&self.names, name, "--time-column")? {
                return Ok(Some(place));
            }
        }
        self.refuse_parts()?;
        let Some(place) = self.labels.iter().position(Label::is_time) else {
            return Ok(self.dated().or_else(|| self.only_in_time_units()));
        };
        find(&self.names, &self.names[place], "--time-column").map(|_| Some(place))
    }

    /// The only column in a unit of time, whatever it is called.
    fn only_in_time_units(&self) -> Option<usize> {
        let in_time = |&i: &usize| self.stated(i).any(|unit| TimeUnit::from_label(unit).is_some());
        let is_force = |&i: &usize| self.labels.get(i).is_some_and(Label::is_force);
        let mut places = (0..self.names.len()).filter(in_time).filter(|i| !is_force(i));
        places.next().filter(|_| places.next().is_none())
    }

    /// Refuses a time that is spread over columns: hours, minutes and seconds apart.
    fn refuse_parts(&self) -> Result<(), InputError> {
        const HOURS: [&str; 6] = ["h", "hh", "hhmm", "hour", "hours", "stunde"];
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

    /// The only column of dates with times of day: the time, whatever it is called.
    fn dated(&self) -> Option<usize> {
        let is_dated = |&place: &usize| {
            let mut cells = self.header.cells(place).filter(|cell| !cell.is_empty()).peekable();
            cells.peek().is_some() && cells.all(|cell| date_time_seconds(cell.as_bytes()).is_some())
        };
        let mut dated = (0..self.names.len()).filter(is_dated);
        dated.next().filter(|_| dated.next().is_none())
    }

    /// Two columns are time and force, one is the force.
    fn time_without_header(&self, options: &LogOptions) -> Result<Option<usize>, InputError> {
        match self.header.width {
            1 => Ok(None),
            2 => Ok(Some(0)),
            _ if options.column.is_some() => Ok(Some(0)),
            width => Err(InputError::new(format!(
                "no header line over {width} columns: name the columns, e.g. 'time_s,force_n', \
                 or give --time-column 1 --column 2"
            ))),
        }
    }

    /// The force column.
    ///
    /// # Errors
    /// It is not there, or one of several.
    pub fn force(&self, options: &LogOptions, time: Option<usize>) -> Result<usize, InputError> {
        if let Some(name) = &options.column {
            return self.header.column(name, "--column");
        }
        if self.names.is_empty() {
            return Ok(self.header.width - 1);
        }
        for name in FORCE_COLUMNS {
            if let Some(place) = find(&self.names, name, "--column")? {
                return Ok(place);
            }
        }
        let others = || (0..self.names.len()).filter(|&place| Some(place) != time);
        let named = others().filter(|&i| self.labels.get(i).is_some_and(Label::is_force));
        let in_newtons = others().filter(|&i| self.stated_force(i).is_some());
        let named: Vec<usize> = named.collect();
        let found = if named.is_empty() { in_newtons.collect() } else { named };
        match found.as_slice() {
            [only] => Ok(*only),
            [] => Err(InputError::new(format!(
                "no column force_n or force_kn: give --column NAME; {}",
                there_are(&self.names)
            ))),
            several => Err(self.which(several)),
        }
    }

    /// The error for several columns that may be the force.
    fn which(&self, places: &[usize]) -> InputError {
        let name = |place: &usize| self.names.get(*place);
        let twice = places.iter().any(|a| places.iter().any(|b| a != b && name(a) == name(b)));
        let numbers = places.iter().map(|place| format!("--column {}", place + 1));
        let numbers = numbers.collect::<Vec<_>>().join(" or ");
        let by = if twice { numbers } else { "--column NAME".to_string() };
        InputError::new(format!("which column is the force? give {by}; {}", there_are(&self.names)))
    }

    /// The unit of the force, and a note if it is assumed.
    ///
    /// # Errors
    /// Units that contradict each other, or one that is not of force.
    pub fn force_unit(
        &self,
        column: usize,
        options: &LogOptions,
    ) -> Result<(Unit, Vec<String>), InputError> {
        let name = self.header.name(column);
        let mut stated = self.stated(column);
        let units: Vec<Unit> = stated.by_ref().filter_map(Unit::from_label).collect();
        let unknown = self.stated(column).find(|unit| Unit::from_label(unit).is_none());
        agreed(name, &units, options.unit).map(|unit| match (unit, unknown) {
            (Some(unit), _) => Ok((unit, Vec::new())),
            (None, Some(label)) => Err(InputError::new(format!(
                "the unit of column '{name}' is '{label}', which is not read: turn it into N, or give \
                 --unit N|kN|lbf|kgf|counts if it is one of these"
            ))),
            (None, None) => {
                Ok((Unit::Newton, vec![format!("{} has no unit: taken as N", said(name))]))
            }
        })?
    }

    /// The decimal mark: as given, or the only one that the first rows show.
    ///
    /// # Errors
    /// They show both.
    pub fn decimal(
        &self,
        force: usize,
        time: Option<usize>,
        options: &LogOptions,
    ) -> Result<Decimal, InputError> {
        if let Some(decimal) = options.decimal {
            return Ok(decimal);
        }
        let numbers: Vec<&str> = [Some(force), time]
            .into_iter()
            .flatten()
            .flat_map(|column| self.header.cells(column))
            .filter(|cell| number(cell.as_bytes(), Decimal::Any).is_some())
            .collect();
        let with = |mark: char| numbers.iter().find(|cell| cell.contains(mark));
        match (with('.'), with(',')) {
            (Some(_), None) => Ok(Decimal::Point),
            (None, Some(_)) => Ok(Decimal::Comma),
            (None, None) => Ok(Decimal::Any),
            (Some(point), Some(comma)) => Err(InputError::new(format!(
                "both '{point}' and '{comma}' are in it: which is the decimal mark? \
                 give --decimal . or --decimal ,"
            ))),
        }
    }

    /// How the time column tells the time.
    ///
    /// # Errors
    /// Units that contradict each other, or one that is not known.
    pub fn time_cells(
        &self,
        column: usize,
        options: &LogOptions,
        decimal: Decimal,
    ) -> Result<TimeCells, InputError> {
        let cell = self.header.cells(column).find(|cell| !cell.is_empty()).unwrap_or_default();
        if options.time_unit.is_none() && date_time_seconds(cell.as_bytes()).is_some() {
            return Ok(TimeCells::Number { cell: column, unit: TimeUnit::Iso });
        }
        if let Some(clock) = self.clock(column, cell) {
            return clock;
        }
        let name = self.header.name(column);
        let stated: Vec<&str> = self.stated(column).collect();
        let units: Vec<TimeUnit> =
            stated.iter().filter_map(|unit| TimeUnit::from_label(unit)).collect();
        let unit = match (options.time_unit, units.as_slice()) {
            (Some(given), _) if given.is_calendar() => given,
            (given, units) => match (agreed_time(name, units, given)?, stated.first()) {
                (Some(unit), _) => self.since_1970(column, unit, decimal).unwrap_or(unit),
                (None, Some(label)) => {
                    return Err(InputError::new(format!(
                        "the unit of column '{name}' is '{label}': \
                         give --time-unit s|ms|us|ns|min|iso|epoch|excel"
                    )));
                }
                (None, None) => self.unit_by_size(column, decimal),
            },
        };
        Ok(TimeCells::Number { cell: column, unit })
    }

    /// A column in a unit of time may count from 1970.
    fn since_1970(&self, column: usize, unit: TimeUnit, decimal: Decimal) -> Option<TimeUnit> {
        let first = self.header.cells(column).next()?;
        let counts = unit != TimeUnit::Minute
            && unit.seconds(first.as_bytes(), decimal).is_some_and(is_since_1970);
        counts.then_some(TimeUnit::Epoch)
    }

    /// A time of day without a date, or with one in a column of its own.
    fn clock(&self, column: usize, cell: &str) -> Option<Result<TimeCells, InputError>> {
        let first = |place: usize| self.header.cells(place).next().unwrap_or_default();
        let is_date = |place: &usize| date_seconds(first(*place)).is_some();
        let is_clock = |place: &usize| {
            *place != column
                && first(*place).contains(':')
                && clock_seconds(first(*place)).is_some()
        };
        let mut others = 0..self.header.width;
        if date_seconds(cell).is_some() {
            return others
                .find(is_clock)
                .map(|clock| Ok(TimeCells::DateAndClock { date: Some(column), clock }));
        }
        let clock = cell.contains(':') && clock_seconds(cell).is_some();
        clock.then(|| Ok(TimeCells::DateAndClock { date: others.find(is_date), clock: column }))
    }

    /// Seconds, unless the numbers can only be a date: counted since 1970, or in days
    /// with steps that would be far too short for seconds.
    fn unit_by_size(&self, column: usize, decimal: Decimal) -> TimeUnit {
        let values: Vec<f64> =
            self.header.cells(column).filter_map(|c| number(c.as_bytes(), decimal)).collect();
        let Some(first) = values.first().copied() else { return TimeUnit::Second };
        let steps = values.windows(2).filter_map(|w| Some(w.last()? - w.first()?));
        let step = steps.filter(|&step| step > 0.0).fold(f64::INFINITY, f64::min);
        let rates = |unit_s: f64| RATES_HZ.contains(&(step * unit_s).recip());
        match first {
            8e8..1e20 => TimeUnit::Epoch,
            20_000.0..80_000.0 if !rates(1.0) && rates(86_400.0) => TimeUnit::Excel,
            _ => TimeUnit::Second,
        }
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
        let mut others = (0..self.names.len()).filter(|&place| place != force);
        let Some(other) = others.next().and_then(|place| self.names.get(place)) else {
            return InputError::new(format!("{known} {rate}; {}", there_are(&self.names)));
        };
        let such: String = other.chars().take(40).flat_map(char::escape_debug).collect();
        InputError::new(format!(
            "{known} --time-column NAME, such as '{such}', or {rate}; {}",
            there_are(&self.names)
        ))
    }
}

fn said(name: &str) -> String {
    if name.is_empty() { "the force".to_string() } else { format!("column '{name}'") }
}
