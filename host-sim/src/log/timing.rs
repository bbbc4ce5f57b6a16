//! The sampling rate behind the time stamps at the beginning of a log.
//!
//! Stamps are *fine* when every sample has its own, *shared* when several
//! samples carry the same one because the clock is coarser than the sampling
//! (a CR10 at 16 Hz resolves 0.125 s: two scans a stamp).

use crate::error::InputError;

use super::rows::Row;
use super::stamp::no_rate;

/// Used when the stamps cannot tell.
pub const DEFAULT_RATE_HZ: f64 = 16.0;
/// Lowest and highest rate that is taken.
pub const RATES_HZ: std::ops::RangeInclusive<f64> = 1.0..=2000.0;

/// Rows with the stamp but not the reading of the row before, as a share of all,
/// from which on stamps are shared and not repeated by mistake.
const SHARED_FROM: f64 = 0.05;
/// Samples and passes for the straight line through the first stamps.
const PHASE_SAMPLES: usize = 256;
const PASSES: usize = 3;

/// How stamps and samples go together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// Samples per second.
    pub rate_hz: f64,
    /// Time of the first sample, s.
    pub start_s: f64,
    /// Set when samples share stamps.
    pub shared: Option<Shared>,
}

/// Samples that share a stamp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shared {
    /// Step of the stamps in sampling periods.
    pub step: f64,
    /// Mean of stamp minus time of the sample, in sampling periods.
    pub centre: f64,
}

/// Finds the timing; `rate_hz` if the user or the log states it, `resolution_s`
/// if the format is known to have coarse stamps.
///
/// # Errors
/// The time stands still, or the rate is out of [`RATES_HZ`].
pub fn find(
    rows: &[Row],
    rate_hz: Option<f64>,
    resolution_s: Option<f64>,
) -> Result<Timing, InputError> {
    let times: Vec<f64> = rows.iter().map(|row| row.time_s).collect();
    let start_s = times.first().copied().unwrap_or(0.0);
    let Some(step_s) = median(positive_differences(&times)) else {
        return standing(rows, start_s, rate_hz, resolution_s);
    };
    let timing = if shared_fraction(rows) > SHARED_FROM {
        shared(&times, step_s, rate_hz)
    } else {
        fine(&times, step_s, rate_hz)
    };
    if RATES_HZ.contains(&timing.rate_hz) {
        return Ok(timing);
    }
    Err(no_rate(timing.rate_hz))
}

/// Every stamp is the same: right for a single sample or for coarse stamps, and
/// no log otherwise.
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

fn median(mut values: Vec<f64>) -> Option<f64> {
    let middle = values.len() / 2;
    values.sort_by(f64::total_cmp);
    values.get(middle).copied()
}

#[allow(clippy::float_cmp)] // a stamp that is repeated is repeated exactly
fn shared_fraction(rows: &[Row]) -> f64 {
    let shares = |w: &[Row]| match w {
        [a, b] => a.time_s == b.time_s && a.reading != b.reading,
        _ => false,
    };
    rows.windows(2).filter(|w| shares(w)).count() as f64 / rows.len() as f64
}

/// One stamp per sample: a straight line through stamp against index.
///
/// Neighbours may be a poor first guess (jitter, rounded stamps) and so may
/// distant samples (gaps between them): the line with the fewest gaps and
/// duplicates and the smallest residuals is taken.
fn fine(times: &[f64], step_s: f64, rate_hz: Option<f64>) -> Timing {
    const SPANS: [usize; 6] = [1, 2, 4, 8, 16, 32];
    let start_s = times.first().copied().unwrap_or(0.0);
    let guess = Line { start_s, period_s: step_s };
    let line = match rate_hz {
        Some(rate_hz) => {
            let mut line = Line { start_s, period_s: rate_hz.recip() };
            line.fit_phase(times.get(..PHASE_SAMPLES).unwrap_or(times));
            line
        }
        None => SPANS
            .iter()
            .filter_map(|&span| Some(guess.refined(times, median(mean_steps(times, span))?)))
            .min_by(|a, b| a.cost(times).total_cmp(&b.cost(times)))
            .unwrap_or(guess),
    };
    Timing { rate_hz: line.period_s.recip(), start_s: line.start_s, shared: None }
}

/// Mean step over every `span` steps.
fn mean_steps(times: &[f64], span: usize) -> Vec<f64> {
    let later = times.iter().skip(span);
    later.zip(times).map(|(b, a)| (b - a) / span as f64).filter(|&step| step > 0.0).collect()
}

/// Stamp against index.
#[derive(Clone, Copy, Debug)]
struct Line {
    start_s: f64,
    period_s: f64,
}

impl Line {
    fn index(&self, time_s: f64) -> f64 {
        ((time_s - self.start_s) / self.period_s).round()
    }

    fn residual(&self, time_s: f64) -> f64 {
        (time_s - self.start_s) / self.period_s - self.index(time_s)
    }

    /// Share of steps that are not one, and the residuals: a grid on which every
    /// stamp is evenly off by up to half a period is as bad as one that leaves
    /// every fifth sample out.
    fn cost(&self, times: &[f64]) -> f64 {
        const RESIDUALS: f64 = 0.75;
        let n = times.len() as f64;
        let indices: Vec<f64> = times.iter().map(|&t| self.index(t)).collect();
        let is_break = |w: &&[f64]| matches!(w, [a, b] if (b - a - 1.0).abs() > 0.5);
        let breaks = indices.windows(2).filter(is_break).count() as f64;
        let square = times.iter().map(|&t| self.residual(t).powi(2)).sum::<f64>();
        breaks / n + RESIDUALS * (square / n).sqrt()
    }

    /// Fits over growing spans, so that no index is ambiguous.
    fn refined(mut self, times: &[f64], period_s: f64) -> Self {
        self.period_s = period_s;
        let mut count = 32;
        while count < times.len() {
            self.fit(times.get(..count).unwrap_or(times));
            count *= 2;
        }
        (0..PASSES).for_each(|_| self.fit(times));
        self.snap(times);
        self
    }

    /// Least squares with the indices that the line itself gives.
    fn fit(&mut self, times: &[f64]) {
        self.fit_phase(times);
        let n = times.len() as f64;
        let mean_index = times.iter().map(|&t| self.index(t)).sum::<f64>() / n;
        let mean_time = times.iter().map(|&t| t - self.start_s).sum::<f64>() / n;
        let (mut square, mut product) = (0.0, 0.0);
        for &time in times {
            let index = self.index(time) - mean_index;
            square += index * index;
            product += index * (time - self.start_s - mean_time);
        }
        if square > 0.0 && product > 0.0 {
            self.period_s = product / square;
        }
        self.start_s += mean_time - mean_index * self.period_s;
    }

    /// Moves the grid to the mean phase of the stamps, as an angle: half a
    /// period early and half a period late are the same.
    fn fit_phase(&mut self, times: &[f64]) {
        let (mut sine, mut cosine) = (0.0, 0.0);
        for &time in times {
            let (s, c) = (self.residual(time) * std::f64::consts::TAU).sin_cos();
            sine += s;
            cosine += c;
        }
        let angle = f64::atan2(sine, cosine);
        self.start_s += angle / std::f64::consts::TAU * self.period_s;
    }

    /// Takes the nearest whole rate if it leaves every stamp about where it is.
    fn snap(&mut self, times: &[f64]) {
        const ROUNDING: f64 = 1e-6;
        let nominal_s = self.period_s.recip().round().max(1.0).recip();
        let last = times.last().map_or(0.0, |&time| self.index(time));
        let moved = (self.period_s / nominal_s - 1.0).abs() * last;
        let widest = times.iter().map(|&t| self.residual(t).abs()).fold(ROUNDING, f64::max);
        if moved <= 2.0 * widest {
            self.start_s += (self.period_s - nominal_s) * last / 2.0;
            self.period_s = nominal_s;
        }
    }
}

/// Several samples per stamp: samples per group over the step of the stamps.
fn shared(times: &[f64], step_s: f64, rate_hz: Option<f64>) -> Timing {
    let rate_hz = rate_hz.unwrap_or_else(|| group_rate(times, step_s));
    let step = step_s * rate_hz;
    Timing {
        rate_hz,
        start_s: times.first().copied().unwrap_or(0.0),
        shared: Some(Shared { step, centre: centre(times, step, rate_hz) }),
    }
}

/// Mean size of the groups between neighbouring stamps, made whole when near.
fn group_rate(times: &[f64], step_s: f64) -> f64 {
    const NEAR: f64 = 0.03;
    let sizes = group_sizes(times, step_s);
    let mean = sizes.iter().sum::<f64>() / sizes.len() as f64;
    let Some(median) = median(sizes) else { return DEFAULT_RATE_HZ };
    let size = if (mean - median).abs() < NEAR * median { median } else { mean };
    let rate_hz = size / step_s;
    if (rate_hz - rate_hz.round()).abs() < NEAR * rate_hz { rate_hz.round() } else { rate_hz }
}

/// Rows per stamp, without the first and last stamp and those beside a gap.
fn group_sizes(times: &[f64], step_s: f64) -> Vec<f64> {
    let mut sizes = Vec::new();
    let mut begun: Option<usize> = None;
    for (at, w) in times.windows(2).enumerate() {
        let [a, b] = w else { continue };
        let step = b - a;
        if step > 0.0 {
            let whole = step < 1.5 * step_s;
            if let (Some(first), true) = (begun, whole) {
                sizes.push((at + 1 - first) as f64);
            }
            begun = whole.then_some(at + 1);
        }
    }
    sizes
}

/// Mean of stamp minus sample over a group, from where the first groups begin.
fn centre(times: &[f64], step: f64, rate_hz: f64) -> f64 {
    const GROUPS: usize = 9;
    let start = times.first().copied().unwrap_or(0.0);
    let begins = |(i, w): (usize, &[f64])| match w {
        [a, b] if b > a => Some((b - start) * rate_hz - (i + 1) as f64),
        _ => None,
    };
    let offsets = times.windows(2).enumerate().filter_map(begins).take(GROUPS).collect();
    median(offsets).unwrap_or(0.0) - (step - 1.0) / 2.0
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
        find(&rows(times), None, None).unwrap().rate_hz
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
    }

    #[test]
    fn shared_stamps_are_recognised() {
        let timing = find(&rows((0..200).map(|i| f64::from(i / 2) * 0.125)), None, None).unwrap();
        assert_eq!(timing.rate_hz, 16.0);
        assert_eq!(timing.shared, Some(Shared { step: 2.0, centre: -0.5 }));
        let minute = find(&rows([0.0; 900]), None, Some(60.0)).unwrap();
        assert_eq!(minute.shared, Some(Shared { step: 960.0, centre: -480.0 }));
        assert_eq!(rate((0..400).map(|i| (f64::from(i) / 16.0).floor())), 16.0);
        assert_eq!(rate((0..400).map(|i| (f64::from(i) / 1.6).floor() / 10.0)), 16.0);
    }

    #[test]
    fn times_that_tell_nothing_are_refused() {
        assert!(
            find(&rows([2.0; 9]), None, None).unwrap_err().to_string().contains("stands still")
        );
        let slow = find(&rows((0..9).map(|i| f64::from(i) * 600.0)), None, None).unwrap_err();
        assert!(slow.to_string().contains("0.001667 samples per second"), "{slow}");
    }
}
