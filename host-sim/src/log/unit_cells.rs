//! Units in a column of the rows: `Force,Unit,Time (s)` and `7.94,N,0.0`.

use crate::error::{InputError, excerpt};

use super::columns::Columns;
use super::header::{Kind, kind};
use super::label::{Label, is_foreign};
use super::number::{Unit, finite};

/// Names of such a column.
const NAMES: [&str; 4] = ["unit", "units", "einheit", "force unit"];

impl Columns<'_> {
    /// The unit of force in the column directly after one.
    #[must_use]
    pub fn force_unit_behind(&self, column: usize) -> Option<Unit> {
        self.cells(self.behind(column)?).find_map(Unit::from_label)
    }

    /// The column in which every row says the force's unit, if that is one that is read.
    ///
    /// # Errors
    /// The first rows contain several units.
    pub fn unit_cell(&self, force: usize) -> Result<Option<usize>, InputError> {
        let is_read = self.unit_in_rows(force)?.and_then(Unit::from_label).is_some();
        Ok(self.unit_column(force).filter(|_| is_read))
    }

    /// The column of units: the one behind the force, or the only one. Behind other columns `N` may
    /// be the north if the force's unit is known and no name says more.
    fn unit_column(&self, force: usize) -> Option<usize> {
        let is_known = self.stated_force(force).is_some();
        let mut all = (0..self.header.width)
            .filter(|&at| self.is_called_units(at) || !is_known && self.holds_units(at));
        let only = all.next().filter(|_| all.next().is_none());
        self.behind(force).or(only)
    }

    /// The unit of the force in the first rows.
    ///
    /// # Errors
    /// The rows contain several units.
    pub fn unit_in_rows(&self, force: usize) -> Result<Option<&str>, InputError> {
        let Some(column) = self.unit_column(force) else { return Ok(None) };
        let said = |cell: &&str| !cell.is_empty() && finite(cell.as_bytes()).is_none();
        let mut cells = self.cells(column).filter(said);
        let Some(first) = cells.next() else { return Ok(None) };
        match cells.find(|cell| !cell.eq_ignore_ascii_case(first)) {
            None => Ok(Some(first)),
            Some(other) => Err(InputError::new(format!(
                "column {} says {} and {}: write all forces in one unit",
                self.said(column),
                excerpt(first.as_bytes()),
                excerpt(other.as_bytes())
            ))),
        }
    }

    /// The columns whose unit may be the one after the last of them.
    #[must_use]
    pub fn with_unit_behind(&self, last: usize) -> Vec<usize> {
        let mut columns: Vec<usize> =
            (0..=last).rev().take_while(|&at| at == last || self.is_bare(at)).collect();
        columns.reverse();
        columns
    }

    /// Whether a column may be the force by its name and first rows: numbers without a unit that do
    /// not count the rows.
    #[must_use]
    pub fn is_bare(&self, column: usize) -> bool {
        let is_time = self.labels.get(column).is_some_and(Label::is_time);
        let mut cells = self.cells(column).filter(|cell| !cell.is_empty()).peekable();
        let holds_numbers = cells.peek().is_some()
            && cells.all(|cell| kind(cell) == Kind::Value && finite(cell.as_bytes()).is_some());
        holds_numbers
            && !is_time
            && self.stated(column).next().is_none()
            && !self.numbers_rows(column, super::Decimal::Any)
    }

    fn behind(&self, column: usize) -> Option<usize> {
        Some(column + 1).filter(|&next| self.holds_units(next))
    }

    fn is_called_units(&self, column: usize) -> bool {
        self.labels.get(column).is_some_and(|label| NAMES.contains(&label.quantity.as_str()))
    }

    /// Whether a column contains units, by its name or its cells.
    fn holds_units(&self, column: usize) -> bool {
        let mut cells = self.cells(column).peekable();
        self.is_called_units(column)
            || cells.peek().is_some()
                && cells.all(|cell| Unit::from_label(cell).is_some() || is_foreign(cell))
    }
}
