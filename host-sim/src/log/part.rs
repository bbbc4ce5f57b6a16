//! Parts of a second in a column of their own: `secs,nsecs`, or a time in whole seconds beside `ms`.

use super::columns::Columns;
use super::layout::TimeCells;
use super::number::Decimal;
use super::stamp::{TimeUnit, clock_seconds};
use super::timing::median;

/// Units of such a column, and how many are a second.
const UNITS: [(TimeUnit, f64); 3] =
    [(TimeUnit::Millisecond, 1e3), (TimeUnit::Microsecond, 1e6), (TimeUnit::Nanosecond, 1e9)];
/// Fewest rows that show it.
const FEWEST: usize = 16;
/// Longest step into the next second, in usual steps: a count of the rows in a second falls short of
/// the second's end.
const LONGEST: f64 = 3.0;

/// A column that runs on within the seconds of the time and begins anew with each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    /// Index of the cell.
    pub cell: usize,
    /// Its unit: ms, us or ns.
    pub unit: TimeUnit,
}

impl Columns<'_> {
    /// The column beside `time` that holds the parts of its seconds, by the first rows, and a note.
    #[must_use]
    pub fn part_of_second(
        &self,
        time: TimeCells,
        force: usize,
        decimal: Decimal,
    ) -> Option<(Part, String)> {
        let (used, seconds_s) = self.whole_seconds(time, decimal)?;
        let mut others = (0..self.header.width).filter(|cell| *cell != used && *cell != force);
        others.find_map(|cell| {
            let unit = unit_of(&seconds_s, &self.whole_numbers(cell)?)?;
            let note = format!(
                "column {} is read as the {} within the seconds of column {}",
                self.said(cell),
                unit.name(),
                self.said(used)
            );
            Some((Part { cell, unit }, note))
        })
    }

    /// The cell of a time in whole seconds, and those of the first rows.
    fn whole_seconds(&self, time: TimeCells, decimal: Decimal) -> Option<(usize, Vec<f64>)> {
        use TimeUnit::{Epoch, Iso, Second};
        let (cell, unit) = match time {
            TimeCells::Number { cell, unit: unit @ (Second | Iso | Epoch) } => (cell, Some(unit)),
            TimeCells::DateAndClock { clock, .. } => (clock, None),
            TimeCells::Number { .. }
            | TimeCells::Numbered { .. }
            | TimeCells::Count { .. }
            | TimeCells::Cr10 { .. } => return None,
        };
        let seconds = |text: &str| match unit {
            Some(unit) => unit.seconds(text.as_bytes(), decimal),
            None => clock_seconds(text),
        };
        let all = self.cells(cell).map(|text| seconds(text).filter(|s| s.fract().abs() < 1e-9));
        Some((cell, all.collect::<Option<Vec<f64>>>()?))
    }

    /// The cells of a column, if all are whole numbers from zero on.
    fn whole_numbers(&self, cell: usize) -> Option<Vec<f64>> {
        self.cells(cell).map(|text| Some(f64::from(text.parse::<u32>().ok()?))).collect()
    }
}

/// The unit in which the parts make the seconds run on evenly, at least once into a next second.
fn unit_of(seconds_s: &[f64], parts: &[f64]) -> Option<TimeUnit> {
    let largest = parts.iter().copied().fold(0.0, f64::max);
    let (unit, in_second) = UNITS.into_iter().find(|(_, in_second)| largest < *in_second)?;
    let whole_steps = || seconds_s.windows(2).map(|w| matches!(w, [a, b] if a < b));
    let times = seconds_s.iter().zip(parts).map(|(second, part)| second + part / in_second);
    let times: Vec<f64> = times.collect();
    let steps: Vec<f64> = times.windows(2).map(|w| w[1] - w[0]).collect();
    let usual_s = median(steps.clone()).filter(|usual_s| *usual_s > 0.0)?;
    let runs_on = steps.iter().all(|&step| step > -1e-9);
    let mut over = steps.iter().zip(whole_steps()).filter(|(_, is_over)| *is_over);
    let shared = whole_steps().filter(|is_over| !is_over).count();
    let evenly = over.any(|(&step, _)| step < LONGEST * usual_s);
    (runs_on && evenly && shared >= FEWEST).then_some(unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 48 rows, 16 in a second.
    fn found(part: impl Fn(u32) -> f64) -> Option<TimeUnit> {
        let rows = 0..48_u32;
        let seconds: Vec<f64> = rows.clone().map(|row| f64::from(row / 16)).collect();
        unit_of(&seconds, &rows.map(|row| part(row % 16)).collect::<Vec<f64>>())
    }

    #[test]
    fn parts_of_a_second_are_told_from_other_numbers() {
        let sixteenth = |in_second: f64| move |row| (f64::from(row) * in_second / 16.0).floor();
        assert_eq!(found(sixteenth(1e3)), Some(TimeUnit::Millisecond));
        assert_eq!(found(sixteenth(1e6)), Some(TimeUnit::Microsecond));
        assert_eq!(found(sixteenth(1e9)), Some(TimeUnit::Nanosecond));
        assert_eq!(found(sixteenth(100.0)), None, "hundredths");
        assert_eq!(found(f64::from), None, "a count of the rows in a second");
        assert_eq!(found(|_| 12.0), None, "a temperature");
        assert_eq!(found(|row| 900.0 - f64::from(row)), None, "falls");
    }
}
