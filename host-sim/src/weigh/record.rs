//! The readings used for a weighing: the last 64 s without outliers.

use floe_core::SampleFlag;
use floe_firmware::weighing::{MEANS, readings_a_mean};
use serde::Serialize;

use crate::log::timing::median;
use crate::rounding::counted;

/// An outlier deviates from the median by more than `DEVIATIONS` standard deviations of the
/// readings and by more than the share `PART` of the median: neither a swing nor a step goes so
/// far.
const DEVIATIONS: f64 = 10.0;
const PART: f64 = 0.05;
/// At most one reading in 50 is left out. If more are outliers, the load does not rest.
pub(super) const RARE: usize = 50;
/// Standard deviation of normal noise over its median absolute deviation.
const NORMAL: f64 = 1.4826;

/// A reading that was left out.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LeftOut {
    /// Time in the log, s.
    pub time_s: f64,
    /// Value of the reading, N.
    pub force_n: f64,
}

/// Time, s, and force, N, or why there is none; [`SampleFlag::Rejected`] where a reading is
/// missing.
type Reading = (f64, Result<f32, SampleFlag>);

/// The readings of the last 64 s.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Settled {
    /// Forces in newtons; `None` for a missing reading and for an outlier.
    pub(super) forces_n: Vec<Option<f32>>,
    /// The outliers.
    pub(super) left_out: Vec<LeftOut>,
    /// Number of readings at or beyond the end of the range.
    pub(super) saturated: usize,
    /// From the first reading of the log to its last, s.
    pub(super) log_s: f64,
}

/// The last readings, in whole groups of [`readings_a_mean`].
#[derive(Clone, Debug)]
pub(super) struct Record {
    group: usize,
    start_s: Option<f64>,
    readings: Vec<Reading>,
}

impl Record {
    pub(super) fn new(rate_hz: f64) -> Self {
        let group = readings_a_mean(rate_hz as f32) as usize;
        Self { group, start_s: None, readings: Vec::new() }
    }

    pub(super) fn push(&mut self, time_s: f64, force_n: Result<f32, SampleFlag>) {
        self.start_s.get_or_insert(time_s);
        let longest = MEANS * self.group;
        if self.readings.len() >= 2 * longest {
            self.readings.drain(..longest);
        }
        self.readings.push((time_s, force_n));
    }

    /// Splits the readings of the last 64 s into those used and the outliers.
    pub(super) fn settle(mut self) -> Settled {
        let count = self.readings.len();
        let begin = (count - count % self.group).saturating_sub(MEANS * self.group);
        let mut readings = self.readings.split_off(begin);
        let left_out = take_out(&mut readings);
        let is_saturated = |it: &&Reading| it.1 == Err(SampleFlag::Saturated);
        let log_s =
            readings.last().zip(self.start_s).map_or(0.0, |(last, start_s)| last.0 - start_s);
        Settled {
            saturated: readings.iter().filter(is_saturated).count(),
            forces_n: readings.into_iter().map(|(_, force_n)| force_n.ok()).collect(),
            left_out,
            log_s,
        }
    }
}

fn take_out(readings: &mut [Reading]) -> Vec<LeftOut> {
    let forces = || readings.iter().filter_map(|(_, force_n)| force_n.ok().map(f64::from));
    let Some(middle_n) = median(forces().collect()) else { return Vec::new() };
    let scatter_n = median(forces().map(|it| (it - middle_n).abs()).collect()).unwrap_or(0.0);
    let far_n = (DEVIATIONS * NORMAL * scatter_n).max(PART * middle_n.abs());
    let is_far = |force_n: &f64| (force_n - middle_n).abs() > far_n;
    if forces().filter(is_far).count() * RARE > readings.len() {
        return Vec::new();
    }
    let mut left_out = Vec::new();
    for (time_s, reading) in readings {
        if let Some(force_n) = reading.ok().map(f64::from).filter(is_far) {
            left_out.push(LeftOut { time_s: *time_s, force_n });
            *reading = Err(SampleFlag::Spike);
        }
    }
    left_out
}

/// The sentence about the outliers: their number, and the first of them.
#[must_use]
pub fn sentence(left_out: &[LeftOut]) -> String {
    const SHOWN: usize = 3;
    let one = |it: &LeftOut| format!("{:.2} N at {:.3} s", it.force_n, it.time_s);
    let shown: Vec<String> = left_out.iter().take(SHOWN).map(one).collect();
    let more = if left_out.len() > SHOWN { ", ..." } else { "" };
    let count = counted(left_out.len() as u64, "reading");
    format!("{count} far from all others: {}{more}", shown.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn left_out(seconds: u32, force_n: impl Fn(u32) -> f32) -> Vec<LeftOut> {
        let mut record = Record::new(16.0);
        (0..16 * seconds).for_each(|i| record.push(f64::from(i) / 16.0, Ok(force_n(i))));
        let Settled { forces_n, left_out, saturated, log_s } = record.settle();
        assert_eq!(forces_n.len() as u32, (16 * seconds).min(1024));
        assert_eq!(forces_n.iter().filter(|it| it.is_none()).count(), left_out.len());
        assert_eq!((saturated, log_s), (0, f64::from(seconds) - 1.0 / 16.0));
        left_out
    }

    #[test]
    fn a_spike_is_left_out_and_a_swing_or_a_step_is_not() {
        let spiked = |at: u32| move |i: u32| if i == at { 9999.0 } else { 630.0 };
        let spike = LeftOut { time_s: 18.75, force_n: 9999.0 };
        assert_eq!(left_out(40, spiked(300)), [spike]);
        assert_eq!(left_out(200, spiked(300)), [], "before the seconds that count");
        assert_eq!(left_out(200, spiked(3000)), [LeftOut { time_s: 187.5, ..spike }]);
        let swing = |i: u32| 630.0 * (1.0 - 0.05 * (0.3 * i as f32).cos());
        assert_eq!(left_out(40, swing), []);
        assert_eq!(left_out(40, |i| if i % 97 == 0 { 640.0 } else { 630.0 }), []);
        assert_eq!(left_out(40, |i| if i < 64 { 0.0 } else { 630.0 }), [], "hung up late");
    }

    #[test]
    fn the_first_ones_are_said() {
        let one = |i: u32| LeftOut { time_s: f64::from(i), force_n: -1.0 };
        assert_eq!(sentence(&[one(3)]), "1 reading far from all others: -1.00 N at 3.000 s");
        let said = sentence(&[1, 2, 3, 4].map(one));
        assert!(said.starts_with("4 readings far") && said.ends_with("at 3.000 s, ..."), "{said}");
    }
}
