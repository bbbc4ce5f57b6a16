//! The sampling rate, from the time stamps at the beginning of a log.
//!
//! Stamps are *fine* if every sample has its own, *shared* if several samples have the same one
//! because the clock is coarser than the sampling (a CR10 at 16 Hz resolves 0.125 s: two scans per
//! stamp).

use crate::error::InputError;

use super::beat::beating;
use super::bursts::Bursts;
use super::fine::fine;
use super::groups::shared;
use super::rate::no_rate;
use super::rows::Row;
use super::stamp::{DAY_S, TimeUnit};

/// Rate used if the stamps do not determine it.
pub const DEFAULT_RATE_HZ: f64 = 16.0;
/// Lowest and highest accepted rate.
pub const RATES_HZ: std::ops::RangeInclusive<f64> = 1.0..=2000.0;

/// Fraction of rows with the stamp of the previous row from which stamps count as shared instead of
/// repeated by mistake.
const SHARED_FROM: f64 = 0.05;

/// Relation of stamps and samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// Samples per second.
    pub rate_hz: f64,
    /// Time of the first sample, s.
    pub start_s: f64,
    /// Properties of shared stamps, if samples share stamps.
    pub shared: Option<Shared>,
}

impl Timing {
    /// Whether a stamp is repeated occasionally because samples come slightly faster than its last
    /// digit advances.
    #[must_use]
    pub fn is_hardly_shared(&self) -> bool {
        self.shared.is_some_and(|it| it.step > 1.0 && it.step * (1.0 - SHARED_FROM) < 1.0)
    }
}

/// Stamps shared by samples, or rounded by half a period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shared {
    /// Step of the stamps, in sampling periods.
    pub step: f64,
    /// Mean of stamp minus sample time, in sampling periods.
    pub centre: f64,
}

/// Determines the timing; `rate_hz` if the user or the log states it, `resolution_s` if the format
/// has coarse stamps, `unit` that of the stamps.
///
/// # Errors
/// The time stands still, the stamps do not determine the rate, or the rate is out of [`RATES_HZ`].
pub fn find(
    rows: &[Row],
    rate_hz: Option<f64>,
    resolution_s: Option<f64>,
    unit: TimeUnit,
) -> Result<Timing, InputError> {
    // In the other forms the last digit is one of seconds.
    let unit_s = match unit {
        TimeUnit::Minute => 60.0,
        TimeUnit::Excel => DAY_S,
        TimeUnit::Second
        | TimeUnit::Millisecond
        | TimeUnit::Microsecond
        | TimeUnit::Nanosecond
        | TimeUnit::Iso
        | TimeUnit::Epoch => 1.0,
    };
    let times: Vec<f64> = rows.iter().map(|row| row.time_s).collect();
    let start_s = times.first().copied().unwrap_or(0.0);
    let Some(step_s) = median(positive_differences(&times)) else {
        return standing(rows, start_s, rate_hz, resolution_s);
    };
    let bursts = Bursts::of(&times).and_then(|bursts| bursts.timing(&times, rate_hz));
    let timing = if let Some(arrived) = bursts {
        arrived?
    } else if are_shared(rows, resolution_s.is_some()) {
        shared(&times, step_s, rate_hz, resolution_s)?
    } else {
        beating(rows, rate_hz, step_s, unit_s)
            .unwrap_or_else(|| fine(&times, step_s, rate_hz, unit_s))
    };
    if RATES_HZ.contains(&timing.rate_hz) {
        return Ok(timing);
    }
    Err(no_rate(timing.rate_hz, unit))
}

/// Timing if every stamp is equal: valid for a single sample or for coarse stamps only.
fn standing(
    rows: &[Row],
    start_s: f64,
    rate_hz: Option<f64>,
    resolution_s: Option<f64>,
) -> Result<Timing, InputError> {
    let rate_hz = rate_hz.unwrap_or(DEFAULT_RATE_HZ);
    let step = resolution_s.map_or(1.0, |resolution_s| resolution_s * rate_hz);
    if rows.len() > 1 && rows.len() as f64 > step {
        return Err(InputError::new(format!(
            "the time stands still: all of the first {} samples have the same time",
            rows.len()
        )));
    }
    Ok(Timing { rate_hz, start_s, shared: Some(Shared { step, centre: -step / 2.0 }) })
}

fn positive_differences(times: &[f64]) -> Vec<f64> {
    times.windows(2).filter_map(|w| Some(w.last()? - w.first()?)).filter(|&d| d > 0.0).collect()
}

pub(crate) fn median(mut values: Vec<f64>) -> Option<f64> {
    let middle = values.len() / 2;
    values.sort_by(f64::total_cmp);
    values.get(middle).copied()
}

/// Whether several samples share a stamp. In repeated rows the reading never changes within a
/// stamp; a constant force does not decide.
#[allow(clippy::float_cmp)] // a stamp that is repeated is repeated exactly
fn are_shared(rows: &[Row], are_coarse: bool) -> bool {
    let [mut repeated, mut changes, mut both] = [0.0; 3];
    for w in rows.windows(2) {
        let [a, b] = w else { continue };
        let (same_stamp, other_reading) = (a.time_s == b.time_s, a.reading != b.reading);
        repeated += f64::from(same_stamp);
        changes += f64::from(other_reading);
        both += f64::from(same_stamp && other_reading);
    }
    let are_twice = !are_coarse && changes > 0.0 && both <= SHARED_FROM * changes;
    repeated > SHARED_FROM * rows.len() as f64 && !are_twice
}

#[cfg(test)]
#[allow(clippy::float_cmp)] // exact by construction
mod tests {
    use super::*;
    use floe_core::{Newtons, Reading};

    fn rows(times: impl IntoIterator<Item = f64>) -> Vec<Row> {
        let reading = |i: usize| Reading::Force(Newtons(i as f32));
        let row = |(i, time_s)| Row { time_s, reading: reading(i), records: 1, line: 0 };
        times.into_iter().enumerate().map(row).collect()
    }

    fn rate(times: impl IntoIterator<Item = f64>) -> f64 {
        find(&rows(times), None, None, TimeUnit::Second).unwrap().rate_hz
    }

    /// Deterministic jitter within ±`most`.
    fn jitter(i: u32, most: f64) -> f64 {
        (f64::from(i.wrapping_mul(2_654_435_761)) / f64::from(u32::MAX) * 2.0 - 1.0) * most
    }

    #[test]
    fn exact_and_rounded_stamps_give_the_nominal_rate() {
        assert_eq!(rate((0..50).map(|i| f64::from(i) / 16.0)), 16.0);
        assert_eq!(rate((0..4096).map(|i| (f64::from(i) / 16.0 * 1e3).round() / 1e3)), 16.0);
        assert_eq!(rate((0..30).map(|i| (f64::from(i) / 30.0 * 1e3).round() / 1e3)), 30.0);
        assert_eq!(rate((0..4096).map(|i| (f64::from(i) / 2000.0 * 1e6).round() / 1e6)), 2000.0);
        assert_eq!(rate((0..400).map(|i| (f64::from(i) / 16.0 * 20.0).floor() / 20.0)), 16.0);
        assert_eq!(rate((0..400).map(|i| (f64::from(i) / 30.0 * 100.0).round() / 100.0)), 30.0);
        assert_eq!(rate([0.0, 0.0625]), 16.0);
        assert_eq!(rate([0.0]), DEFAULT_RATE_HZ);
    }

    #[test]
    fn a_rate_that_the_last_digit_hides_is_found() {
        let decimals = |rate: f64, digit: f64, count| {
            (0..count).map(move |i| (f64::from(i) / rate / digit).floor() * digit)
        };
        assert_eq!(rate(decimals(92.0, 0.01, 4096)), 92.0);
        assert_eq!(rate(decimals(9.0, 0.1, 1920)), 9.0);
        assert_eq!(rate(decimals(33.0, 0.1, 1920)), 33.0);
        assert!((rate(decimals(9.4, 0.1, 1920)) - 9.4).abs() < 0.002);
        for own in [98.0, 99.0, 99.5, 100.3, 100.5, 102.0, 103.0, 104.0, 105.0] {
            assert!((rate(decimals(own, 0.01, 4096)) / own - 1.0).abs() < 2e-5, "{own}");
        }
        let ticks = decimals(100.0, 0.015_625, 4096).map(|t| (t * 1e3).floor() / 1e3);
        assert_eq!(rate(ticks), 100.0);
        let minutes = rows(decimals(16.0, 0.06, 1920));
        assert_eq!(find(&minutes, None, None, TimeUnit::Minute).unwrap().rate_hz, 16.0);
    }

    #[test]
    fn stamps_without_a_whole_group_tell_no_rate() {
        let minutes =
            |rate: f64| (0..800).map(move |i| ((f64::from(i) / rate + 30.0) / 60.0).floor() * 60.0);
        let error =
            find(&rows(minutes(10.0)), None, None, TimeUnit::Second).unwrap_err().to_string();
        assert!(error.contains("do not tell the rate: give --rate-hz"), "{error}");
        let cr10 = find(&rows(minutes(16.0)), None, Some(60.0), TimeUnit::Second).unwrap();
        assert_eq!(cr10.rate_hz, DEFAULT_RATE_HZ);
    }

    #[test]
    fn a_rate_that_is_not_nominal_is_kept() {
        let found = rate((0..4096).map(|i| f64::from(i) / 16.0008));
        assert!((found - 16.0008).abs() < 1e-9);
        assert!((rate((0..100).map(|i| f64::from(i) / 12.5)) - 12.5).abs() < 1e-9);
    }

    #[test]
    fn jitter_gaps_and_repeats_do_not_matter() {
        let jittered = (0..4096).map(|i| (f64::from(i) + jitter(i, 0.4)) / 16.0);
        assert!((rate(jittered) - 16.0).abs() < 1e-3);
        assert_eq!(rate((0..4096).filter(|i| i % 7 > 0).map(|i| f64::from(i) / 16.0)), 16.0);
        assert_eq!(rate((0..4096).map(|i| f64::from(i - i % 50 / 49) / 16.0)), 16.0);
        assert_eq!(rate((0..4096).map(|i| f64::from(i - i % 50 / 49) / 100.0)), 100.0);
        let twice = |i: u32| (i * i % 1009 < 30).then_some(i);
        let now_and_then = (0..4096).flat_map(|i| std::iter::once(i).chain(twice(i)));
        assert_eq!(rate(now_and_then.map(|i| f64::from(i) / 100.0)), 100.0);
    }

    #[test]
    fn shared_stamps_are_recognised() {
        let timing =
            find(&rows((0..200).map(|i| f64::from(i / 2) * 0.125)), None, None, TimeUnit::Second)
                .unwrap();
        assert_eq!(timing.rate_hz, 16.0);
        assert_eq!(timing.shared, Some(Shared { step: 2.0, centre: -0.5 }));
        let minute = find(&rows([0.0; 900]), None, Some(60.0), TimeUnit::Second).unwrap();
        assert_eq!(minute.shared, Some(Shared { step: 960.0, centre: -480.0 }));
        assert_eq!(rate((0..400).map(|i| (f64::from(i) / 16.0).floor())), 16.0);
        assert_eq!(rate((0..400).map(|i| (f64::from(i) / 1.6).floor() / 10.0)), 16.0);
    }

    #[test]
    fn stamps_are_shared_also_while_the_force_rests() {
        let halves = |changes_from: usize| {
            let mut rows = rows((0..4096).map(|i| f64::from(i / 2) * 0.125));
            rows.iter_mut().take(changes_from).for_each(|row| {
                row.reading = Reading::Force(Newtons(0.0));
            });
            rows
        };
        for changes_from in [4000, 4096] {
            let found = find(&halves(changes_from), None, None, TimeUnit::Second).unwrap();
            assert_eq!((found.rate_hz, found.shared.is_some()), (16.0, true), "{changes_from}");
        }
        let mut twice = halves(0);
        twice.iter_mut().zip(0_u16..).for_each(|(row, i)| {
            row.reading = Reading::Force(Newtons(f32::from(i / 2)));
        });
        assert_eq!(find(&twice, None, None, TimeUnit::Second).unwrap().rate_hz, 8.0);
        assert_eq!(find(&twice, None, Some(0.125), TimeUnit::Second).unwrap().rate_hz, 16.0);
    }

    #[test]
    fn times_that_tell_nothing_are_refused() {
        assert!(
            find(&rows([2.0; 9]), None, None, TimeUnit::Second)
                .unwrap_err()
                .to_string()
                .contains("stands still")
        );
        let slow = find(&rows((0..9).map(|i| f64::from(i) * 600.0)), None, None, TimeUnit::Second)
            .unwrap_err();
        assert!(slow.to_string().contains("0.001667 samples per second"), "{slow}");
    }
}
