//! Further columns of force: the same force in another unit, or another force.

use crate::error::InputError;

use super::columns::Columns;
use super::label::Label;
use super::number::{Decimal, Unit, number};

/// Largest relative error of a conversion written with few digits.
const ROUGH: f64 = 1e-3;

impl Columns<'_> {
    /// Notes on other columns of force: the same one in another unit, as far as the first rows
    /// show, or another force.
    ///
    /// # Errors
    /// The forces should be equal and are not.
    pub fn other_forces(
        &self,
        force: usize,
        unit: Unit,
        decimal: Decimal,
    ) -> Result<Vec<String>, InputError> {
        let labels = &self.labels;
        let Some(own) = labels.get(force) else { return Ok(Vec::new()) };
        let is_other = |(place, label): &(usize, &Label)| {
            let unit = self.stated_force(*place);
            let is_stated = unit.is_some_and(|it| it.newtons().is_some() || label.holds_force());
            *place != force && (label.is_force() || is_stated)
        };
        let others = labels.iter().enumerate().filter(is_other);
        let note = |(place, label): (usize, &Label)| {
            let (name, other) = (self.name(force), self.name(place));
            let newtons = |unit: &Unit| unit.newtons().is_some();
            let has_rows = !self.header.rows.is_empty();
            let is_same = has_rows && own.quantity == label.quantity && newtons(&unit);
            let its_unit = self.stated_force(place).filter(newtons).filter(|_| is_same);
            let Some(its_unit) = its_unit else {
                return Ok(format!("'{name}' is read, not '{other}': --column takes another"));
            };
            let rows = self.compare((force, unit), (place, its_unit), decimal)?;
            Ok(format!(
                "'{name}' and '{other}' are the same in the first {rows} rows: '{name}' is read"
            ))
        };
        others.map(note).collect()
    }

    /// Notes that the only column of force is used although its name has further words
    /// (`force_std_n`), or is only a unit while other columns exist.
    ///
    /// # Errors
    /// The name contains a factor: `Force x 10 N`.
    pub fn only_force(
        &self,
        force: usize,
        time: Option<usize>,
    ) -> Result<Option<String>, InputError> {
        let Some(label) = self.labels.get(force) else { return Ok(None) };
        let name = self.name(force);
        if label.holds_factor() {
            return Err(InputError::new(format!(
                "the name of column '{name}' holds a factor: write the forces themselves, or give \
                 --column NAME to read them as they stand"
            )));
        }
        let is_other = |at: usize| at != force && Some(at) != time && self.is_bare(at);
        let by_unit = !label.holds_force() && (0..self.labels.len()).any(is_other);
        Ok((by_unit || label.says_more_than_force()).then(|| {
            format!("'{name}' is the only column of force, and is read: --column takes another")
        }))
    }

    /// Number of rows with equal forces in both columns.
    fn compare(
        &self,
        (first, unit): (usize, Unit),
        (second, its_unit): (usize, Unit),
        decimal: Decimal,
    ) -> Result<usize, InputError> {
        let rows = self.cells(first).zip(self.cells(second));
        let mut count = 0;
        for (a, b) in rows {
            count += 1;
            let (Some(a), Some(b)) = (force(a, unit, decimal), force(b, its_unit, decimal)) else {
                continue;
            };
            if a.contradicts(&b) {
                return Err(InputError::new(format!(
                    "'{}' and '{}' say {} N and {} N in row {count}: give --column NAME of the one \
                     that is right",
                    self.name(first),
                    self.name(second),
                    shown(a.value),
                    shown(b.value)
                )));
            }
        }
        Ok(count)
    }
}

/// A force, N, or a time, s, as it is written: with the step of its last digit.
pub(super) struct Written {
    pub(super) value: f64,
    pub(super) step: f64,
}

impl Written {
    /// Whether two numbers differ by more than their digits and a rough conversion.
    pub(super) fn contradicts(&self, other: &Self) -> bool {
        let size = self.value.abs().max(other.value.abs());
        (self.value - other.value).abs() > self.step + other.step + ROUGH * size
    }
}

fn force(cell: &str, unit: Unit, decimal: Decimal) -> Option<Written> {
    let value = number(cell.as_bytes(), decimal).filter(|value| value.is_finite())?;
    let scale = unit.newtons()?;
    Some(Written { value: value * scale, step: last_digit(cell) * scale })
}

/// The step of a number's last digit.
pub(super) fn last_digit(cell: &str) -> f64 {
    let digits = |(_, behind): (&str, &str)| behind.bytes().take_while(u8::is_ascii_digit).count();
    let decimals = cell.split_once(['.', ',']).map_or(0, digits);
    let exponent = cell.split_once(['e', 'E']).and_then(|(_, text)| text.parse().ok());
    10_f64.powi(exponent.unwrap_or(0) - decimals as i32)
}

pub(super) fn shown(value: f64) -> String {
    format!("{value:.*}", crate::rounding::decimals(value))
}

#[cfg(test)]
mod tests {
    use super::super::{LogOptions, Metadata, csv, header};

    fn notes(text: &str) -> Result<Vec<String>, String> {
        let header = header::find(text.as_bytes(), b'\n', 0, None).map_err(|e| e.to_string())?;
        let found = csv::layout(&header, &LogOptions::default(), &Metadata::default());
        found.map(|(_, notes)| notes).map_err(|e| e.to_string())
    }

    #[test]
    fn the_same_force_in_another_unit_is_said() {
        let row = |i: u32| format!("{i},{},{:.2}\n", 100 * i, f64::from(i) * 0.1);
        let rows: String = (0..9).map(row).collect();
        let said = notes(&format!("time_s,force_n,force_kn\n{rows}")).unwrap();
        assert_eq!(
            said,
            ["'force_n' and 'force_kn' are the same in the first 9 rows: 'force_n' is read"]
        );
    }

    #[test]
    fn a_force_that_contradicts_the_other_is_refused() {
        let rows: String = (1..9).map(|i| format!("{i},{},{}\n", 100 * i, i)).collect();
        let error = notes(&format!("time_s,force_n,force_kn\n{rows}")).unwrap_err();
        assert!(
            error.starts_with("'force_n' and 'force_kn' say 200.0 N and 2000 N in row 2"),
            "{error}"
        );
    }

    #[test]
    fn another_force_is_said() {
        let said = notes("time_s,load_n,force_n\n0,1,2\n1,1,3\n2,1,4\n3,1,5\n").unwrap();
        assert_eq!(said, ["'force_n' is read, not 'load_n': --column takes another"]);
        let said = notes("time_s,force_raw_n,force_n\n0,1,2\n1,1,3\n2,1,4\n3,1,5\n").unwrap();
        assert_eq!(said, ["'force_n' is read, not 'force_raw_n': --column takes another"]);
    }
}
