//! Detection of a constant force: the samples are averaged in blocks of a second, 16 samples at
//! least, and a stretch goes on while the block means agree within their scatter and have no
//! significant slope. Work per sample: one mean and one squared difference.

use crate::num::math::{self, larger};
use crate::sample::{ForcePoint, RawSample};
use crate::stats::line::Line;
use crate::stats::significance::{SIGNIFICANT, SURE};

/// Fewest samples of a block: they give their standard deviation to a fifth, `1/√(2 × 15)`.
const LEAST_BLOCK: f32 = 16.0;
/// Fewest and most blocks of a stretch: a shorter one may be a slow stick line, a longer one is
/// given in parts.
const BLOCKS: (u32, u32) = (8, 128);
/// Block means that differ by less than this part of the force are equal. A choice: with less,
/// friction that wanders ends a stretch where there is hardly any noise.
const SAME: f32 = 0.01;
/// Standard deviations by which the highest of 300 000 normal samples lies above their mean.
const HIGHEST: f32 = 4.5;

/// Stands for no sample: the first one comes a gap after it, whatever its index.
const BEFORE_ALL: ForcePoint = ForcePoint { index: RawSample::LAST_INDEX + 1, force_n: 0.0 };

/// Finds constant forces.
// Field order: first what every sample touches.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
pub(super) struct SteadyForce {
    pub(super) last: ForcePoint,
    /// Samples of a block.
    block: u32,
    /// The block under way: number of samples, mean, Σ of squared differences of neighbours, N².
    count: u32,
    mean_n: f32,
    steps_n2: f32,
    /// Σ of squared distances from the block's mean, N²; mean variance in the full blocks, N².
    squares_n2: f32,
    variance_n2: f32,
    /// First index of the stretch.
    start: u32,
    /// Line through the means of the full blocks over their number; their variance by noise, N².
    means: Line,
    noise_n2: f32,
    /// The samples scatter too much to be called steady.
    scatters: bool,
}

/// A stretch that ended: first and last index, its blocks' means, whether its samples scatter.
pub(super) type Steady = (u32, u32, Line, bool);

impl SteadyForce {
    pub(super) fn new(rate_hz: f32) -> Self {
        let block = larger(rate_hz, LEAST_BLOCK) as u32;
        Self { block, last: BEFORE_ALL, ..Self::default() }
    }

    /// Takes a sample; does it fill a block?
    pub(super) fn take(&mut self, now: ForcePoint) -> bool {
        let step_n = if self.count > 0 { now.force_n - self.last.force_n } else { 0.0 };
        self.last = now;
        self.count += 1;
        let off_n = now.force_n - self.mean_n;
        self.mean_n += off_n / self.count as f32;
        self.squares_n2 += off_n * (now.force_n - self.mean_n);
        self.steps_n2 += step_n * step_n;
        self.count >= self.block
    }

    /// Ends the stretch with its last full block; `None` if it is too short, or rises.
    #[cold]
    pub(super) fn end(&mut self, next: u32) -> Option<Steady> {
        let (start, means) = (self.start, self.means);
        // A rise is as likely that of a slow stick line. It need not be sure: a stretch that is left
        // out is no error.
        let rises = self.slope_over_std2() > SIGNIFICANT * SIGNIFICANT;
        let stop = self.last.index.saturating_sub(self.count);
        self.clear_block();
        (self.start, self.means) = (next, Line::default());
        (self.noise_n2, self.variance_n2) = (0.0, 0.0);
        let is_reported = means.count >= BLOCKS.0 && (self.scatters || !rises);
        is_reported.then_some((start, stop, means, self.scatters))
    }

    fn clear_block(&mut self) {
        (self.count, self.mean_n, self.steps_n2, self.squares_n2) = (0, 0.0, 0.0, 0.0);
    }

    /// The force, N, that a constant force exceeds only by a rise. `None` unless it was constant
    /// for eight blocks, with samples that scatter by less than `most_n`.
    pub(super) fn ceiling_n(&self, most_n: f32) -> Option<f32> {
        let variance_n2 = self.variance_n2 + self.scatter_n2(0.0);
        let is_constant =
            self.means.count >= BLOCKS.0 && !self.scatters && variance_n2 < most_n * most_n;
        is_constant.then(|| self.means.level_n + HIGHEST * math::sqrt(variance_n2))
    }

    pub(super) fn end_block(&mut self, most_n: f32) -> Option<Steady> {
        let (count, mean_n) = (self.count as f32, self.mean_n);
        // Differences of neighbours have twice the variance of white noise.
        let sample_n2 = 0.5 * self.steps_n2 / (count - 1.0);
        let noise_n2 = sample_n2 / count;
        let first = (self.last.index + 1).saturating_sub(self.count);
        let scatters = sample_n2 > most_n * most_n;
        let block_n2 = self.squares_n2 / count;
        let goes_on = scatters == self.scatters && (scatters || self.goes_on(mean_n, noise_n2));
        let ended = (!goes_on).then(|| self.end(first)).flatten();
        self.clear_block();
        self.scatters = scatters;
        let blocks = self.means.count as f32;
        self.noise_n2 += (noise_n2 - self.noise_n2) / (blocks + 1.0);
        self.variance_n2 += (block_n2 - self.variance_n2) / (blocks + 1.0);
        self.means.add(blocks, mean_n, 1.0, 1.0);
        if self.means.count == BLOCKS.0 && !scatters && self.rises() {
            // A slow stick line.
            (self.start, self.means) = (self.last.index + 1, Line::default());
        }
        let is_long = self.means.count >= BLOCKS.1;
        ended.or_else(|| if is_long { self.end(self.last.index + 1) } else { None })
    }

    /// Does a block's mean agree with those before it, and do these have no significant slope?
    fn goes_on(&self, mean_n: f32, noise_n2: f32) -> bool {
        let means = &self.means;
        let scatter_n = SURE * math::sqrt(self.scatter_n2(noise_n2));
        let is_same =
            (mean_n - means.level_n).abs() < larger(SAME * means.level_n.abs(), scatter_n);
        means.count == 0 || (is_same && (means.count < BLOCKS.0 || !self.rises()))
    }

    /// Variance of a block's mean, N².
    #[inline(never)]
    fn scatter_n2(&self, noise_n2: f32) -> f32 {
        let free = larger(self.means.count as f32 - 2.0, 1.0);
        larger(self.means.residual_n2 / free, larger(self.noise_n2, noise_n2))
    }

    fn rises(&self) -> bool {
        self.slope_over_std2().abs() > SURE * SURE
    }

    /// Square of the slope of the means over its variance, with the sign of the slope.
    fn slope_over_std2(&self) -> f32 {
        let Line { slope, slope_weight, .. } = self.means;
        slope * slope.abs() * slope_weight / self.scatter_n2(0.0)
    }
}
