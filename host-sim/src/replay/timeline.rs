//! Conversion of sample times to the log's own seconds.

use floe_core::SampleTime;

/// Samples remembered; an event is complete long before this many have passed.
const REMEMBERED: usize = 4096;

/// The times of the latest samples.
#[derive(Clone, Debug)]
pub struct Timeline {
    rate_hz: f64,
    /// Index and time of sample `index`, at `index % REMEMBERED`.
    recent: Vec<Option<(u32, f64)>>,
    first_s: Option<f64>,
    last: (u32, f64),
}

impl Timeline {
    /// A timeline without samples.
    #[must_use]
    pub fn new(rate_hz: f64) -> Self {
        Self { rate_hz, recent: vec![None; REMEMBERED], first_s: None, last: (0, 0.0) }
    }

    /// Takes the next sample.
    pub fn push(&mut self, index: u32, time_s: f64) {
        self.first_s.get_or_insert(time_s);
        self.last = (index, time_s);
        if let Some(place) = self.recent.get_mut(index as usize % REMEMBERED) {
            *place = Some(self.last);
        }
    }

    /// A moment in the log's seconds: counted at the sampling rate from the last sample at or
    /// before it, also through a gap.
    #[must_use]
    pub fn seconds(&self, moment: SampleTime) -> f64 {
        let oldest = moment.index.saturating_sub(REMEMBERED as u32 - 1);
        let before = (oldest..=moment.index).rev().find_map(|index| self.at(index));
        let (index, time_s) = before.unwrap_or(self.last);
        let periods = f64::from(moment.index) - f64::from(index) + f64::from(moment.fraction);
        time_s + periods / self.rate_hz
    }

    /// From the first to the last sample.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.first_s.map_or(0.0, |first_s| self.last.1 - first_s)
    }

    /// Time of the last sample.
    #[must_use]
    pub fn last_s(&self) -> f64 {
        self.last.1
    }

    fn at(&self, index: u32) -> Option<(u32, f64)> {
        self.recent.get(index as usize % REMEMBERED).copied()?.filter(|&(i, _)| i == index)
    }
}

#[cfg(test)]
#[allow(clippy::float_cmp)] // exact by construction
mod tests {
    use super::*;

    #[test]
    fn moments_follow_the_logs_own_clock() {
        let mut timeline = Timeline::new(16.0);
        for index in 0..100 {
            timeline.push(index, 5.0 + index as f64 / 16.0);
        }
        timeline.push(200, 30.0);
        let at = |index, fraction| timeline.seconds(SampleTime { index, fraction });
        assert_eq!(at(0, 0.5), 5.03125);
        assert_eq!(at(99, 0.0), 11.1875);
        assert_eq!(at(101, 0.0), 11.3125);
        assert_eq!(at(200, 0.5), 30.03125);
        assert_eq!(timeline.duration_s(), 25.0);
    }

    #[test]
    fn a_moment_before_all_that_is_remembered_is_extrapolated() {
        let mut timeline = Timeline::new(16.0);
        for index in 0..3 * REMEMBERED as u32 {
            timeline.push(index, index as f64 / 16.0);
        }
        assert_eq!(timeline.seconds(SampleTime { index: 16, fraction: 0.0 }), 1.0);
    }
}
