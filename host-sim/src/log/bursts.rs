//! Rows that arrive together: a program that reads a buffered port stamps several samples within
//! milliseconds, then none for a while.

use crate::error::InputError;

use super::groups::shared;
use super::timing::{RATES_HZ, Timing, median};

/// Bursts of rows, alike in number and evenly spaced.
#[derive(Debug)]
pub(super) struct Bursts {
    size: f64,
    every_s: f64,
    /// Step of the stamps within a burst.
    within_s: f64,
    /// For every row the first stamp of its burst.
    starts_s: Vec<f64>,
}

impl Bursts {
    /// `None` if the rows do not come in bursts.
    pub fn of(times: &[f64]) -> Option<Self> {
        const FEWEST: usize = 8;
        /// Smallest size: pairs still show their rate.
        const SMALLEST: f64 = 3.0;
        /// Mean step over the step within a burst, at least.
        const DENSE: f64 = 3.0;
        let mean_s = (times.last()? - times.first()?) / times.len() as f64;
        let bursts: Vec<&[f64]> = times.chunk_by(|a, b| b - a < mean_s).collect();
        // The first and the last may be cut.
        let whole = bursts.get(1..bursts.len().saturating_sub(1))?;
        let sizes: Vec<f64> = whole.iter().map(|burst| burst.len() as f64).collect();
        let first_s = |burst: &&[f64]| burst.first().copied().unwrap_or_default();
        let steps_s: Vec<f64> = whole
            .windows(2)
            .filter_map(|w| Some(first_s(w.last()?) - first_s(w.first()?)))
            .collect();
        let lengths_s =
            whole.iter().map(|burst| burst.last().map_or(0.0, |last| last - first_s(burst)));
        let (size, every_s) = (median(sizes.clone())?, median(steps_s.clone())?);
        let within_s = median(lengths_s.collect())? / (size - 1.0);
        let is_dense = within_s > 0.0 && DENSE * within_s < every_s / size;
        let is_alike = mostly(&sizes, size) && mostly(&steps_s, every_s);
        let is_such = whole.len() >= FEWEST && size >= SMALLEST && is_dense && is_alike;
        let starts_s = bursts.iter().flat_map(|burst| burst.iter().map(move |_| first_s(burst)));
        is_such.then(|| Self { size, every_s, within_s, starts_s: starts_s.collect() })
    }

    /// The timing if the stamps are times of arrival, which a given rate confirms; `None` for
    /// another given rate.
    ///
    /// # Errors
    /// No rate is given: both are named.
    pub fn timing(
        &self,
        times: &[f64],
        given_hz: Option<f64>,
    ) -> Option<Result<Timing, InputError>> {
        const NEAR: f64 = 0.2;
        let rate_hz = self.size / self.every_s;
        let Some(given_hz) = given_hz else { return Some(Err(self.asked(rate_hz))) };
        if (given_hz / rate_hz - 1.0).abs() > NEAR {
            return None;
        }
        let found = shared(&self.starts_s, self.every_s, Some(given_hz), None);
        let late_s: f64 = times.iter().zip(&self.starts_s).map(|(time, start)| time - start).sum();
        Some(found.map(|mut timing| {
            if let Some(shared) = &mut timing.shared {
                shared.centre += late_s / times.len() as f64 * given_hz;
            }
            timing
        }))
    }

    fn asked(&self, rate_hz: f64) -> InputError {
        let own_hz = self.within_s.recip();
        let lost = if RATES_HZ.contains(&own_hz) {
            format!(", or --rate-hz {own_hz:.0} if what lies between them is missing")
        } else {
            String::new()
        };
        InputError::new(format!(
            "the samples come {} at a time, every {:.3} s: give --rate-hz {rate_hz:.3} if these are \
             the times at which they arrived{lost}",
            self.size, self.every_s
        ))
    }
}

/// Whether four of five values are within a quarter of the usual one.
fn mostly(values: &[f64], usual: f64) -> bool {
    let alike = values.iter().filter(|&value| (value / usual - 1.0).abs() < 0.25).count();
    5 * alike >= 4 * values.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 512 samples, 16 a second, that arrive in bursts of `size`.
    fn arrived(size: u32, within_s: f64) -> Vec<f64> {
        let time_s = |i: u32| f64::from(i / size * size) / 16.0 + f64::from(i % size) * within_s;
        (0..512).map(time_s).collect()
    }

    #[test]
    fn what_arrives_together_is_no_rate() {
        for (size, within_s) in [(3, 0.001), (8, 0.0001), (8, 0.001), (16, 0.015), (32, 0.002)] {
            let times = arrived(size, within_s);
            let bursts = Bursts::of(&times).unwrap();
            let asked = bursts.timing(&times, None).unwrap().unwrap_err().to_string();
            assert!(asked.contains("give --rate-hz 16.000 if these are the times"), "{asked}");
            let timing = bursts.timing(&times, Some(16.0)).unwrap().unwrap();
            assert!((timing.shared.unwrap().step - f64::from(size)).abs() < 1e-9);
            assert!(bursts.timing(&times, Some(1000.0)).is_none());
        }
    }

    #[test]
    fn pauses_losses_and_shared_stamps_are_no_bursts() {
        let every = |keep: fn(u32) -> bool| {
            (0..2000_u32).filter(move |&i| keep(i)).map(|i| f64::from(i) / 16.0).collect::<Vec<_>>()
        };
        assert!(Bursts::of(&every(|_| true)).is_none());
        assert!(Bursts::of(&every(|i| i % 7 > 0)).is_none());
        assert!(Bursts::of(&every(|i| i % 50 < 25)).is_none());
        assert!(Bursts::of(&every(|i| i % 400 < 390)).is_none());
        let seconds: Vec<f64> = (0..512).map(|i| f64::from(i / 16)).collect();
        assert!(Bursts::of(&seconds).is_none());
        assert!(Bursts::of(&[]).is_none() && Bursts::of(&[1.0]).is_none());
    }
}
