//! Further columns of time: the same time in another unit.

use crate::error::InputError;

use super::columns::Columns;
use super::number::Decimal;
use super::other_forces::{Written, last_digit, shown};
use super::stamp::TimeUnit;

/// A column and its unit.
type Place = (usize, TimeUnit);

impl Columns<'_> {
    /// Rejects a time if the same time in another unit does not advance equally in the first rows.
    ///
    /// # Errors
    /// Names both columns.
    pub fn refuse_other_times(&self, time: usize, decimal: Decimal) -> Result<(), InputError> {
        let labels = &self.labels;
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
            let (a_began_s, b_began_s) = *begin.get_or_insert((a.value, b.value));
            let one = Written { value: a.value - a_began_s, ..a };
            let other = Written { value: b.value - b_began_s, ..b };
            if one.contradicts(&other) {
                return Err(InputError::new(format!(
                    "'{}' and '{}' say {} s and {} s from the first row to row {row}: give \
                     --time-column NAME of the one that is right",
                    self.name(first.0),
                    self.name(second.0),
                    shown(one.value),
                    shown(other.value)
                )));
            }
        }
        Ok(())
    }
}

fn moment(cell: &str, unit: TimeUnit, decimal: Decimal) -> Option<Written> {
    let value = unit.seconds(cell.as_bytes(), decimal)?;
    let step = last_digit(cell) * unit.seconds(b"1", Decimal::Point)?;
    Some(Written { value, step })
}
