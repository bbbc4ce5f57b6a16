//! Checks that the interval of the stamps stays constant, since a logger may have been
//! reconfigured.

use crate::error::InputError;

use super::rows::Row;

/// Number of equally spaced stamps that establish an interval; lost samples are not so regular. A
/// change by less than [`SAME`] is noticed that late.
const STAMPS: u32 = 40;
/// Largest relative difference of equal intervals.
const SAME: f64 = 0.2;
/// Ratio from which two intervals differ. Stamps rounded to steps of nearly a period vary by less
/// over this number of stamps.
const OTHER: f64 = 1.1;

/// A series of equally spaced stamps.
#[derive(Clone, Copy, Debug)]
struct Even {
    interval_s: f64,
    /// Stamp and line of the first.
    since_s: f64,
    line: u64,
}

impl Even {
    fn is_other(&self, interval_s: f64) -> bool {
        !(OTHER.recip()..OTHER).contains(&(self.interval_s / interval_s))
    }

    /// Error with the start of the series, and the remedy.
    fn refused(&self, beside: &str, cut: &str) -> InputError {
        let Self { interval_s, line, .. } = self;
        InputError::new(format!(
            "line {line}: from here on the samples come every {interval_s:.6} s, {beside} s; cut the \
             log {cut}, or give --rate-hz R to take what is slower for gaps"
        ))
    }
}

/// Compares the intervals of the stamps with each other, and with the period found for all stamps.
#[derive(Clone, Debug)]
pub struct Intervals {
    period_s: f64,
    /// Stamp and line of the last row.
    last: (f64, u64),
    /// The current series, and its number of intervals.
    now: Even,
    alike: u32,
    /// The first series of [`STAMPS`] stamps.
    first: Option<Even>,
}

impl Intervals {
    /// Starts for a log with this period.
    #[must_use]
    pub fn new(period_s: f64) -> Self {
        let now = Even { interval_s: 0.0, since_s: f64::NAN, line: 0 };
        Self { period_s, last: (f64::NAN, 0), now, alike: 0, first: None }
    }

    /// Takes the next row.
    ///
    /// # Errors
    /// The interval changes at the named line.
    pub fn push(&mut self, row: &Row) -> Result<(), InputError> {
        let (since_s, line) = std::mem::replace(&mut self.last, (row.time_s, row.line));
        let interval_s = row.time_s - since_s;
        if (interval_s - self.now.interval_s).abs() <= SAME * self.now.interval_s {
            self.alike = self.alike.saturating_add(1);
        } else {
            self.now = Even { interval_s: interval_s.max(0.0), since_s, line };
            self.alike = 1;
        }
        if self.alike != STAMPS {
            return Ok(());
        }
        let mean_s = (row.time_s - self.now.since_s) / f64::from(STAMPS);
        let even = Even { interval_s: mean_s, ..self.now };
        // A series that goes on is compared again: its interval may change by less than `SAME`.
        (self.now.since_s, self.now.line) = self.last;
        self.alike = 0;
        let first = *self.first.get_or_insert(even);
        // If the first series does not have the period, the period is a mean of it and the
        // following series.
        let before_s = if first.is_other(self.period_s) { first.interval_s } else { self.period_s };
        if even.is_other(before_s) {
            return Err(even.refused(&format!("before every {before_s:.6}"), "there"));
        }
        Ok(())
    }

    /// Final check at the end.
    ///
    /// # Errors
    /// A series of stamps did not have the period, and no other followed.
    pub fn end(&self) -> Result<(), InputError> {
        let Some(first) = self.first.filter(|first| first.is_other(self.period_s)) else {
            return Ok(());
        };
        Err(first
            .refused(&format!("on the whole every {:.6}", self.period_s), "where that changes"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floe_core::{Newtons, Reading};

    /// Error message for these intervals, the first of them between lines 2 and 3.
    fn said(period_s: f64, between: impl IntoIterator<Item = f64>) -> Option<String> {
        let mut intervals = Intervals::new(period_s);
        let (mut time_s, mut line) = (0.0, 2);
        let mut row = |interval_s: f64| {
            (time_s, line) = (time_s + interval_s, line + 1);
            let reading = Reading::Force(Newtons(0.0));
            intervals.push(&Row { time_s, reading, records: 1, line })
        };
        let between = std::iter::once(0.0).chain(between);
        let all = between.into_iter().try_for_each(&mut row).and_then(|()| intervals.end());
        all.err().map(|error| error.to_string())
    }

    #[test]
    fn the_line_from_which_on_the_interval_is_another_is_named() {
        let change =
            |first: f64, then: f64| (0..600).map(move |i| if i < 300 { first } else { then });
        let changed =
            "line 303: from here on the samples come every 0.100000 s, before every 0.062500";
        // The period of the first series, and the mean of both, which neither has.
        for period_s in [0.0625, 0.0811] {
            let said = said(period_s, change(0.0625, 0.1)).unwrap();
            assert!(said.starts_with(changed), "{said}");
        }
        assert_eq!(said(0.0625, change(0.0625, 0.065)), None);
        let slightly = said(0.0625, change(0.0625, 0.0545)).unwrap();
        let late = "line 323: from here on the samples come every 0.054500 s, before";
        assert!(slightly.starts_with(late), "{slightly}");
    }

    #[test]
    fn an_interval_that_nothing_even_follows_is_none_either() {
        let uneven = |i: u32| if i < 60 { 0.0625 } else { 0.05 + 0.1 * f64::from(i % 2) };
        let said = said(0.1, (0..600).map(uneven)).unwrap();
        assert!(said.contains("line 3: ") && said.contains("on the whole every 0.1"), "{said}");
    }
}
