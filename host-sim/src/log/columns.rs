//! Columns of a text table, described by names, units and first cells.

use crate::error::{InputError, excerpt};

use super::LogOptions;
use super::csv::{agreed, find, there_are};
use super::header::Header;
use super::label::{Label, bare_unit, is_foreign};
use super::metadata::Said;
use super::number::{Decimal, Unit, finite, is_thousand, number, thousand};
use super::said_unit::{assumed, commented, refuse_second};

/// Names that take precedence, in this order.
const FORCE_COLUMNS: [&str; 2] = ["force_n", "force_kn"];

/// The columns of a table with their labels.
#[derive(Debug)]
pub struct Columns<'a> {
    pub(super) header: &'a Header,
    pub(super) names: &'a [String],
    pub(super) labels: Vec<Label>,
}

impl<'a> Columns<'a> {
    /// Parses the names in a header.
    #[must_use]
    pub fn new(header: &'a Header) -> Self {
        let names = header.column_names();
        let labels = names.iter().map(|name| Label::new(name)).collect();
        Self { header, names, labels }
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

    /// The units stated by name and units row.
    pub(super) fn stated(&self, column: usize) -> impl Iterator<Item = &str> {
        let in_name = self.labels.get(column).and_then(|label| label.unit.as_deref());
        in_name.into_iter().chain(self.unit_below(column))
    }

    /// The force column.
    ///
    /// # Errors
    /// There is none, or there are several.
    pub fn force(&self, options: &LogOptions, time: Option<usize>) -> Result<usize, InputError> {
        if let Some(name) = &options.column {
            return self.header.column(name, "--column");
        }
        if self.names.is_empty() {
            return Ok(self.header.width - 1);
        }
        for name in FORCE_COLUMNS {
            if let Some(place) = find(self.names, name, "--column")? {
                return Ok(place);
            }
        }
        let others: Vec<usize> =
            (0..self.names.len()).filter(|&place| Some(place) != time).collect();
        let is_named = |&i: &usize| self.labels.get(i).is_some_and(Label::is_force);
        let named: Vec<usize> = others.iter().copied().filter(is_named).collect();
        let found = if named.is_empty() { self.in_units(&others) } else { named };
        match found.as_slice() {
            [only] => Ok(*only),
            [] => Err(InputError::new(format!(
                "no column force_n or force_kn: give --column NAME; {}",
                there_are(self.names)
            ))),
            several => Err(self.which(several)),
        }
    }

    /// The columns among `columns` that have a unit of force.
    fn in_units(&self, columns: &[usize]) -> Vec<usize> {
        let unit = |i| self.stated_force(i).or_else(|| self.force_unit_behind(i));
        let found: Vec<usize> = columns.iter().copied().filter(|&i| unit(i).is_some()).collect();
        match found.as_slice() {
            [only] if self.stated_force(*only).is_none() => self.with_unit_behind(*only),
            _ => found,
        }
    }

    /// The error for several possible force columns.
    fn which(&self, places: &[usize]) -> InputError {
        let name = |place: &usize| self.names.get(*place);
        let twice = places.iter().any(|a| places.iter().any(|b| a != b && name(a) == name(b)));
        let numbers = places.iter().map(|place| format!("--column {}", place + 1));
        let numbers = numbers.collect::<Vec<_>>().join(" or ");
        let by = if twice { numbers } else { "--column NAME".to_string() };
        InputError::new(format!("which column is the force? give {by}; {}", there_are(self.names)))
    }

    /// The unit of the force, and a note if it is assumed. `said`: the unit in a comment.
    ///
    /// # Errors
    /// Units that contradict each other, or one that is not of force.
    pub fn force_unit(
        &self,
        column: usize,
        options: &LogOptions,
        said: Option<&Said>,
    ) -> Result<(Unit, Vec<String>), InputError> {
        let name = self.name(column);
        let in_rows = self.unit_in_rows(column)?;
        let stated = || self.stated(column).chain(in_rows);
        let units: Vec<Unit> = stated().filter_map(Unit::from_label).collect();
        let unknown = stated().find(|unit| Unit::from_label(unit).is_none());
        agreed(name, &units, options.unit, Unit::name, "--unit").map(|unit| match (unit, unknown) {
            (Some(unit), Some(label)) if options.unit.is_none() && is_foreign(label) => {
                Err(InputError::new(format!(
                    "column '{name}' is in {} and in {label}: correct the log, or give --unit",
                    unit.name()
                )))
            }
            (Some(unit), _) => {
                let label = self.labels.get(column).filter(|_| options.unit.is_none());
                label.map_or(Ok(()), |it| refuse_second(name, &it.quantity, unit))?;
                Ok((unit, Vec::new()))
            }
            (None, Some(label)) => Err(InputError::new(format!(
                "the unit of column '{name}' is '{label}', which is not read: turn it into N, or give \
                 --unit N|kN|lbf|kgf|counts if it is one of these"
            ))),
            (None, None) => said.map_or_else(|| assumed(self.header, column), commented),
        })?
    }

    /// Rejects numbers with a mark exactly where thousands are separated, unless one of the `numbers`
    /// of the log has that mark elsewhere.
    fn refuse_thousands(&self, column: usize, numbers: &[&str]) -> Result<(), InputError> {
        let marked = |cell: &&str| cell.contains(['.', ',']);
        let cells = || self.cells(column).filter(|cell| finite(cell.as_bytes()).is_some());
        let is_short = |cell: &str| cell.trim_start_matches('-').len() < 4;
        let mut others = cells().filter(|cell| !marked(cell)).peekable();
        let mut grouped = cells().filter(marked).peekable();
        let Some(first) = grouped.peek().copied() else { return Ok(()) };
        if others.peek().is_none() || !others.all(is_short) || !grouped.all(is_thousand) {
            return Ok(());
        }
        let is_decimal =
            |mark| numbers.iter().any(|cell| cell.contains(mark) && !is_thousand(cell));
        let mark = if first.contains(',') { ',' } else { '.' };
        if is_decimal(mark) { Ok(()) } else { Err(thousand(first)) }
    }

    /// The decimal mark: as given, or the only one in the first rows.
    ///
    /// # Errors
    /// The rows contain both.
    pub fn decimal(
        &self,
        force: usize,
        time: Option<usize>,
        options: &LogOptions,
    ) -> Result<Decimal, InputError> {
        if let Some(decimal) = options.decimal {
            self.refuse_other_mark(decimal, [Some(force), time])?;
            return Ok(decimal);
        }
        let numbers: Vec<&str> = [Some(force), time]
            .into_iter()
            .flatten()
            .flat_map(|column| self.cells(column))
            .filter(|cell| number(cell.as_bytes(), Decimal::Any).is_some())
            .collect();
        for column in [Some(force), time].into_iter().flatten() {
            self.refuse_thousands(column, &numbers)?;
        }
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

    /// Rejects a decimal mark that the first number with a mark contradicts.
    fn refuse_other_mark(
        &self,
        given: Decimal,
        columns: [Option<usize>; 2],
    ) -> Result<(), InputError> {
        for column in columns.into_iter().flatten() {
            let first = self.cells(column).find(|cell| cell.contains(['.', ',']));
            let is = |decimal| first.is_some_and(|cell| number(cell.as_bytes(), decimal).is_some());
            if is(Decimal::Any) && !is(given) {
                let cell = excerpt(first.unwrap_or_default().as_bytes());
                return Err(InputError::new(format!(
                    "{} holds {cell}, which has another decimal mark than --decimal says: leave it out, or write all with one",
                    said(self.name(column))
                )));
            }
        }
        Ok(())
    }
}

pub(super) fn said(name: &str) -> String {
    if name.is_empty() { "the force".to_string() } else { format!("column '{name}'") }
}
