//! Decimation of fast logs to a rate that the window holds.
//!
//! A slip lasts a tenth of a second to a few seconds; at 2000 Hz that is thousands of samples, with
//! hardly more information than their means over a few milliseconds. Above [`FASTEST_HZ`] the
//! samples of equal blocks of indices are averaged; a block with fewer than half its samples is
//! missing. Up to that rate a sample is a block and nothing is computed. Delay: two blocks.
//!
//! The mean over a block of `f` samples exceeds the force in its middle by `(f² − 1)/24 f²` of the
//! force's second derivative, per block squared, which makes a slip look slower (by .1 % at 250 Hz,
//! seven standard deviations of a long test). The blocks' second difference takes that off.

use core::num::NonZeroU32;

use crate::num::math;
use crate::sample::{ForcePoint, SampleTime};

/// Fastest rate at which samples are used as they come, Hz: the window then holds two seconds.
pub(crate) const FASTEST_HZ: f32 = 128.0;

/// Averages blocks of samples.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Decimator {
    factor: NonZeroU32,
    block: u32,
    mean_n: f32,
    count: u32,
    /// The last two complete blocks, the newest last.
    last: [Option<ForcePoint>; 2],
}

impl Decimator {
    /// For a rate of 1 to 2000 Hz.
    pub(crate) fn new(rate_hz: f32) -> Self {
        let factor = -math::floor(-rate_hz / FASTEST_HZ) as u32;
        let factor = NonZeroU32::new(factor).unwrap_or(NonZeroU32::MIN);
        Self { factor, block: 0, mean_n: 0.0, count: 0, last: [None; 2] }
    }

    /// Samples per block.
    pub(crate) fn factor(&self) -> f32 {
        self.factor.get() as f32
    }

    /// Is a block more than a sample?
    pub(crate) fn averages(&self) -> bool {
        self.factor > NonZeroU32::MIN
    }

    /// Block of an index.
    pub(crate) fn block(&self, index: u32) -> u32 {
        index / self.factor
    }

    /// Takes a good sample with an index past all earlier ones; gives a block, with
    /// the block's number as its index, when the one after it is complete.
    #[inline]
    pub(crate) fn step(&mut self, sample: ForcePoint) -> Option<ForcePoint> {
        if self.averages() { self.average(sample) } else { Some(sample) }
    }

    fn average(&mut self, sample: ForcePoint) -> Option<ForcePoint> {
        let block = self.block(sample.index);
        let place = sample.index % self.factor;
        let complete = if block == self.block { None } else { self.end() };
        self.block = block;
        self.count += 1;
        self.mean_n += (sample.force_n - self.mean_n) / self.count as f32;
        // One block a step: if the block before has just been completed, this one, whose only
        // sample is its last, waits for the next step.
        let ended = if place + 1 == self.factor.get() && complete.is_none() {
            self.end()
        } else {
            complete
        };
        self.sharpen(ended?)
    }

    /// Ends the block under way; `None` if it holds fewer than half its samples.
    fn end(&mut self) -> Option<ForcePoint> {
        let block = ForcePoint { index: self.block, force_n: self.mean_n };
        let enough = self.count * 2 >= self.factor.get() && self.count > 0;
        (self.count, self.mean_n) = (0, 0.0);
        enough.then_some(block)
    }

    /// Takes a complete block. Gives the one before, as the force in its middle if it has both
    /// neighbours.
    fn sharpen(&mut self, next: ForcePoint) -> Option<ForcePoint> {
        let [before, this] = self.last;
        self.last = [this, Some(next)];
        let mut this = this?;
        if let Some(before) = before
            && next.index - before.index == 2
        {
            let (samples, bend_n) =
                (self.factor(), before.force_n - 2.0 * this.force_n + next.force_n);
            this.force_n -= (1.0 - 1.0 / (samples * samples)) / 24.0 * bend_n;
        }
        Some(this)
    }

    /// The blocks that are left at the end, one a call, until `None`.
    pub(crate) fn finish(&mut self) -> Option<ForcePoint> {
        match self.end() {
            Some(block) => self.sharpen(block).or_else(|| self.last[1].take()),
            None => self.last[1].take(),
        }
    }

    /// A moment in blocks, as a moment in samples: a block's mean belongs to the middle
    /// of its samples.
    pub(crate) fn moment(&self, blocks: SampleTime) -> SampleTime {
        if !self.averages() {
            return blocks;
        }
        let after = blocks.fraction * self.factor() + 0.5 * (self.factor() - 1.0);
        let whole = math::floor(after);
        SampleTime {
            index: blocks.index.saturating_mul(self.factor.get()).saturating_add(whole as u32),
            fraction: after - whole,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(index: u32) -> ForcePoint {
        ForcePoint { index, force_n: 100.0 + index as f32 }
    }

    #[test]
    fn slow_samples_pass_as_they_are() {
        let mut d = Decimator::new(16.0);
        assert_eq!(d.step(sample(7)), Some(sample(7)));
        assert_eq!(d.finish(), None);
        let moment = SampleTime { index: 3, fraction: 0.25 };
        assert_eq!(d.moment(moment), moment);
    }

    #[test]
    fn a_block_is_the_line_at_its_middle() {
        let mut d = Decimator::new(512.0);
        let blocks: [Option<ForcePoint>; 13] = core::array::from_fn(|i| d.step(sample(i as u32)));
        assert_eq!(blocks.iter().flatten().count(), 2);
        let block = blocks[11].unwrap();
        let middle = d.moment(SampleTime { index: block.index, fraction: 0.0 });
        assert!((block.force_n - (100.0 + middle.index as f32 + middle.fraction)).abs() < 1e-4);
    }

    #[test]
    fn half_empty_blocks_are_missing() {
        let mut d = Decimator::new(512.0);
        assert_eq!(d.step(sample(0)), None);
        // Block 0 has one of four samples, block 1 two, the last of which ends it.
        assert_eq!(d.step(sample(6)), None);
        assert_eq!(d.step(sample(7)), None);
        assert_eq!(d.finish().map(|block| block.index), Some(1));
        assert_eq!(d.finish(), None);
    }

    /// A swing of 42 blocks, as that of DFF8-13 at 128 Hz: the blocks are the force in their middles.
    #[test]
    fn a_block_is_a_swing_at_its_middle() {
        let mut d = Decimator::new(1024.0);
        let force_n = |at: f32| 500.0 + 300.0 * (0.15 * at / 8.0).sin();
        let mut worst_n = 0.0_f32;
        for index in 0..800 {
            let Some(block) = d.step(ForcePoint { index, force_n: force_n(index as f32) }) else {
                continue;
            };
            if block.index > 0 {
                let middle = d.moment(SampleTime { index: block.index, fraction: 0.0 });
                let middle = middle.index as f32 + middle.fraction;
                worst_n = worst_n.max((block.force_n - force_n(middle)).abs());
            }
        }
        // The mean alone is off by up to .28 N.
        assert!(worst_n < 2e-3, "{worst_n}");
    }
}
