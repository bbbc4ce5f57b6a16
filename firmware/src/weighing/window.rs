//! The last 64 s of readings, as means over a quarter of a second.

use floe_core::num::math::larger;

/// Number of means kept; an even number.
pub const MEANS: usize = 256;

/// Means of consecutive groups of readings; the oldest are discarded.
#[derive(Clone, Debug)]
pub(super) struct Window {
    readings: u32,
    rate_hz: f32,
    /// The first reading; means are stored relative to it.
    origin: Option<f32>,
    means: [f32; MEANS],
    /// Complete groups since the window was last empty.
    blocks: u32,
    /// The incomplete group: readings, valid readings, and sum of the valid ones.
    taken: u32,
    good: u32,
    sum: f32,
}

impl Window {
    pub(super) fn new(readings: u32, rate_hz: f32) -> Self {
        let (origin, means) = (None, [0.0; MEANS]);
        Self { readings, rate_hz, origin, means, blocks: 0, taken: 0, good: 0, sum: 0.0 }
    }

    /// Takes a reading. A group without a valid reading empties the window, because the force
    /// meanwhile is unknown.
    pub(super) fn add(&mut self, reading: Option<f32>) {
        if let Some(reading) = reading {
            let origin = *self.origin.get_or_insert(reading);
            self.sum += reading - origin;
            self.good += 1;
        }
        self.taken += 1;
        if self.taken >= self.readings {
            self.close();
        }
    }

    fn close(&mut self) {
        let mean = self.sum / larger(self.good as f32, 1.0);
        let failed = self.good == 0;
        (self.taken, self.good, self.sum) = (0, 0, 0.0);
        if failed {
            (self.origin, self.blocks) = (None, 0);
            return;
        }
        if let Some(place) = self.means.get_mut(self.blocks as usize % MEANS) {
            *place = mean;
        }
        self.blocks = self.blocks.wrapping_add(1);
    }

    /// Number of means in the window, which are the newest ones; an even number.
    pub(super) fn len(&self) -> usize {
        (self.blocks as usize).min(MEANS) & !1
    }

    /// Reference value to which all means are relative.
    pub(super) fn origin(&self) -> f32 {
        self.origin.unwrap_or(0.0)
    }

    /// Time between two means, s.
    pub(super) fn block_s(&self) -> f32 {
        self.readings as f32 / self.rate_hz
    }

    /// Readings in a mean.
    pub(super) fn readings(&self) -> u32 {
        self.readings
    }

    /// The means, the oldest first.
    pub(super) fn means(&self) -> impl DoubleEndedIterator<Item = f32> + '_ {
        let first = self.blocks as usize - self.len();
        (first..self.blocks as usize).map(|i| self.means.get(i % MEANS).copied().unwrap_or(0.0))
    }

    /// Pairs of means at equal distances from the middle of the window, the innermost first: the
    /// later and the earlier one.
    pub(super) fn pairs(&self) -> impl Iterator<Item = (f32, f32)> + '_ {
        let half = self.len() / 2;
        self.means().skip(half).zip(self.means().rev().skip(half))
    }
}
