//! Further columns of time: the same time in another unit.

use crate::error::InputError;

use super::columns::Columns;
use super::number::Decimal;
use super::other_forces::{ROUGH, last_digit, shown};
use super::stamp::TimeUnit;

/// A column and its unit.
type Place = (usize, TimeUnit);

impl Columns<'_> {
    /// Rejects a time if the same time in another unit does not advance equally in the first rows.
    ///
    /// # Errors
    /// Names both columns.
    pub fn refuse_other_times(&self, time: usize, decimal: Decimal) -> Result<(), InputError> {
        let labels = self.labels();
        let unit = |place| self.stated(place).find_map(TimeUnit::from_label);
        let (Some(own), Some(own_unit)) = (labels.get(time), unit(time)) else { return Ok(()) };
        let is_other = |place: &usize| {
            let same = labels.get(*place).is_some_and(|label| label.quantity == own.quantity);
            *place != time && same && own.is_time() && !own.quantity.is_empty()
        };
        let others = (0..labels.len()).filter(is_other);
        let mut others = others.filter_map(|place| Some((place, unit(place)?)));
        others.try_for_each(|other| self.compare_times((time, own_unit), other, decimal))
    }

    fn compare_times(
        &self,
        first: Place,
        second: Place,
        decimal: Decimal,
    ) -> Result<(), InputError> {
        let mut begin = None;
        for (row, (a, b)) in (1..).zip(self.cells(first.0).zip(self.cells(second.0))) {
            let (Some(a), Some(b)) = (moment(a, first.1, decimal), moment(b, second.1, decimal))
            else {
                continue;
            };
            let (a_began_s, b_began_s) = *begin.get_or_insert((a.seconds, b.seconds));
            let (one_s, other_s) = (a.seconds - a_began_s, b.seconds - b_began_s);
            let size_s = one_s.abs().max(other_s.abs());
            if (one_s - other_s).abs() > a.step_s + b.step_s + ROUGH * size_s {
                return Err(InputError::new(format!(
                    "'{}' and '{}' say {} s and {} s from the first row to row {row}: give \
                     --time-column NAME of the one that is right",
                    self.name(first.0),
                    self.name(second.0),
                    shown(one_s),
                    shown(other_s)
                )));
            }
        }
        Ok(())
    }
}

/// A time and the step of its last digit, s.
struct Moment {
    seconds: f64,
    step_s: f64,
}

fn moment(cell: &str, unit: TimeUnit, decimal: Decimal) -> Option<Moment> {
    let seconds = unit.seconds(cell.as_bytes(), decimal)?;
    let step_s = last_digit(cell) * unit.seconds(b"1", Decimal::Point)?;
    Some(Moment { seconds, step_s })
}
