//! Measures the actual sampling period by the board's clock.

use crate::sample::Sample;

const TWO_TO_32: f32 = 4_294_967_296.0;

/// Statistics of the time between consecutive samples.
#[derive(Clone, Copy, Debug, Default)]
pub struct PeriodMeter {
    last: Option<(u32, u32)>,
    ticks: u64,
    periods: u32,
    shortest: Option<u32>,
    longest: u32,
}

impl PeriodMeter {
    /// Takes a sample; the time across a gap is not used.
    pub fn add(&mut self, sample: &Sample) {
        let next_to = |index: u32| index.wrapping_add(1) == sample.index;
        if let Some((_, stamp)) = self.last.filter(|&(index, _)| next_to(index)) {
            let ticks = sample.stamp.wrapping_sub(stamp);
            self.ticks += u64::from(ticks);
            self.periods = self.periods.saturating_add(1);
            self.shortest = Some(self.shortest.map_or(ticks, |s| s.min(ticks)));
            self.longest = self.longest.max(ticks);
        }
        self.last = Some((sample.index, sample.stamp));
    }

    /// Mean period, s; `None` before two samples.
    #[must_use]
    pub fn mean_s(&self, clock_hz: u32) -> Option<f32> {
        let shortest = self.shortest?;
        // Single precision suffices for this small difference.
        let beyond = self.ticks - u64::from(self.periods) * u64::from(shortest);
        // In halves, because the board converts 32 bits to `f32` in one instruction.
        let beyond = (beyond >> 32) as u32 as f32 * TWO_TO_32 + beyond as u32 as f32;
        let mean = shortest as f32 + beyond / self.periods as f32;
        Some(mean / clock_hz as f32)
    }

    /// Shortest and longest period in clock ticks; `None` before two samples.
    #[must_use]
    pub fn extremes(&self) -> Option<(u32, u32)> {
        self.shortest.map(|shortest| (shortest, self.longest))
    }
}
