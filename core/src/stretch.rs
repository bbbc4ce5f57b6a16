//! Stretches of a record that are no events: a constant force, and what was not understood.
//!
//! A cable that is tightened and held and a block that slides evenly are the same constant force.
//! The samples are taken in blocks of a second, 16 samples at least. A stretch goes on while the
//! blocks' means agree within their scatter and have no significant slope. Work per sample: one
//! mean and one squared difference.

use crate::event::{Event, Reason};
use crate::num::math::{self, larger};
use crate::sample::{ForcePoint, SampleTime};
use crate::stats::line::Line;

/// Fewest samples of a block: their scatter tells its own size to a fifth, `1/√(2 × 15)`.
const LEAST_BLOCK: f32 = 16.0;
/// Fewest and most blocks of a stretch: a shorter one may be a slow stick line, a longer one is
/// given in parts.
const BLOCKS: (u32, u32) = (8, 128);
/// Standard deviations beyond which a difference or a slope is no chance: of normal ones one in 16 000.
const SURE: f32 = 4.0;
/// Standard deviations of a rise with which a stretch is not given: it may be a slow stick line. Less
/// than [`SURE`]: a stretch that is left out is no error.
const UNLIKELY: f32 = 3.0;
/// Block means that differ by less than this part of the force are equal. A choice: with less, friction
/// that wanders ends a stretch where there is hardly any noise.
const SAME: f32 = 0.01;
/// Largest scatter of a constant force's samples, parts of the weight: more of it hides slips.
const LARGEST_SCATTER: f32 = 0.06;
/// The same where the force has to rise before anything can slip: more of it may be slips.
const QUIET_SCATTER: f32 = 0.01;
/// Standard deviations by which the highest of 300 000 normal samples lies above their mean.
const HIGHEST: f32 = 4.5;
/// Longest gap within a stretch, periods: as the detector's, for a slip may hide in a longer one.
const LONGEST_GAP: u32 = 8;

/// A stretch of samples that belongs to no event.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Stretch {
    /// Its first moment.
    pub start: SampleTime,
    /// Its last moment.
    pub stop: SampleTime,
    /// What it was.
    pub kind: StretchKind,
}

/// What a [`Stretch`] was.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum StretchKind {
    /// A constant force.
    Steady {
        /// Mean force over the weight.
        force_over_weight: f32,
        /// One standard deviation of that mean, from the scatter of the means of blocks.
        std: f32,
        /// Whether the block moved: with a winch that is known to turn it did. `None`: held
        /// or sliding, the force alone cannot tell.
        moving: Option<bool>,
    },
    /// Falls of the force that are no slips.
    NotUnderstood(Reason),
}

/// Finds constant forces.
// In this order: what every sample touches first.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
struct SteadyForce {
    last: ForcePoint,
    /// Samples of a block.
    block: u32,
    /// Of the block under way: samples, mean, and Σ of squared differences of neighbours, N².
    count: u32,
    mean_n: f32,
    steps_n2: f32,
    /// Σ of its squared distances from its mean, N²; mean of that variance over the full blocks.
    squares_n2: f32,
    variance_n2: f32,
    /// First index of the stretch.
    start: u32,
    /// The means of the full blocks, a line over their number; their variance by the noise, N².
    means: Line,
    noise_n2: f32,
    /// The samples scatter too much to be called steady.
    scatters: bool,
}

/// A stretch that ended: first and last index, its blocks' means, whether its samples scatter.
type Steady = (u32, u32, Line, bool);

impl SteadyForce {
    fn new(rate_hz: f32) -> Self {
        Self {
            block: larger(rate_hz, LEAST_BLOCK) as u32,
            start: 0,
            last: ForcePoint::ZERO,
            count: 0,
            mean_n: 0.0,
            steps_n2: 0.0,
            squares_n2: 0.0,
            variance_n2: 0.0,
            means: Line::default(),
            noise_n2: 0.0,
            scatters: false,
        }
    }

    /// Takes a sample; does it fill a block?
    fn take(&mut self, now: ForcePoint) -> bool {
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
    #[inline(never)]
    fn end(&mut self, next: u32) -> Option<Steady> {
        let (start, means) = (self.start, self.means);
        // What rises significantly is as likely a slow stick line.
        let rises = self.slope_over_std2() > UNLIKELY * UNLIKELY;
        let stop = self.last.index.saturating_sub(self.count);
        self.clear_block();
        (self.start, self.means) = (next, Line::default());
        (self.noise_n2, self.variance_n2) = (0.0, 0.0);
        let is_told = means.count >= BLOCKS.0 && (self.scatters || !rises);
        is_told.then_some((start, stop, means, self.scatters))
    }

    fn clear_block(&mut self) {
        (self.count, self.mean_n, self.steps_n2, self.squares_n2) = (0, 0.0, 0.0, 0.0);
    }

    /// The force, N, that only a rise takes a constant force beyond. `None` unless it was constant
    /// for eight blocks, with samples that scatter by less than `most_n`.
    fn ceiling_n(&self, most_n: f32) -> Option<f32> {
        let variance_n2 = self.variance_n2 + self.scatter_n2(0.0);
        let is_constant =
            self.means.count >= BLOCKS.0 && !self.scatters && variance_n2 < most_n * most_n;
        is_constant.then(|| self.means.level_n + HIGHEST * math::sqrt(variance_n2))
    }

    fn end_block(&mut self, most_n: f32) -> Option<Steady> {
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

    /// Does a block's mean agree with the blocks before it, and have those no slope?
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
        larger(self.means.residual() / free, larger(self.noise_n2, noise_n2))
    }

    fn rises(&self) -> bool {
        self.slope_over_std2().abs() > SURE * SURE
    }

    /// Square of the slope of the means over its variance, with the sign of the slope.
    fn slope_over_std2(&self) -> f32 {
        let slope = self.means.slope().unwrap_or(0.0);
        slope * slope.abs() * self.means.slope_weight() / self.scatter_n2(0.0)
    }
}

/// Finds stretches and gives them in order, one a step.
#[derive(Clone, Debug)]
#[repr(C)]
pub(crate) struct Stretches {
    steady: SteadyForce,
    weight_n: f32,
    moving: Option<bool>,
    /// The newest one that was not understood, while it may grow.
    open: Option<Stretch>,
    /// First and last moment of the newest complete one.
    handed_out: (SampleTime, SampleTime),
    /// Complete ones, oldest first.
    ready: [Option<Stretch>; 3],
}

impl Stretches {
    /// For a rate in hertz and a weight; `winch` if it is known to turn.
    pub(crate) fn new(rate_hz: f32, weight_n: f32, winch: bool) -> Self {
        let steady = SteadyForce::new(rate_hz);
        Self {
            steady,
            weight_n,
            moving: winch.then_some(true),
            open: None,
            handed_out: (SampleTime::ZERO, SampleTime::ZERO),
            ready: [None; 3],
        }
    }

    /// Takes a sample; does it end a block?
    #[inline(always)]
    pub(crate) fn take(&mut self, now: ForcePoint) -> bool {
        if now.index - self.steady.last.index > LONGEST_GAP {
            let steady = self.steady.end(now.index);
            self.end_steady(steady);
        }
        let ends = self.steady.take(now);
        if ends {
            let steady = self.steady.end_block(LARGEST_SCATTER * self.weight_n);
            self.end_steady(steady);
        }
        ends
    }

    /// Force, N, that a slip has to begin above: where the force is constant nothing rose.
    pub(crate) fn ceiling_n(&self) -> Option<f32> {
        self.steady.ceiling_n(QUIET_SCATTER * self.weight_n)
    }

    /// A slip or a gap ends a constant force at the index `last` at the latest. `None`: it was
    /// found later, in samples taken for a constant force, so there was none.
    pub(crate) fn interrupt(&mut self, last: Option<u32>) {
        let next = self.steady.last.index + 1;
        let steady = self.steady.end(next);
        // A slip begins a little before it is seen.
        if let Some((start, stop, means, scatters)) = steady
            && let Some(last) = last.filter(|&last| last > start)
        {
            self.end_steady(Some((start, stop.min(last), means, scatters)));
        }
    }

    /// Takes a fall that is no slip.
    pub(crate) fn refuse(&mut self, start: SampleTime, stop: SampleTime, reason: Reason) {
        let kind = StretchKind::NotUnderstood(reason);
        match &mut self.open {
            Some(open) if open.kind == kind => open.stop = stop,
            _ => {
                self.end_before(start);
                self.open = Some(Stretch { start, stop, kind });
            }
        }
    }

    /// What was not understood ends where an event begins; it is dropped if it is not older.
    pub(crate) fn end_before(&mut self, onset: SampleTime) {
        self.open = self.open.filter(|open| open.start.precedes(onset));
        if let Some(open) = self.open.as_mut().filter(|open| onset.precedes(open.stop)) {
            open.stop = onset;
        }
        self.close();
    }

    /// Onset and stop of an event without the part in the newest stretch; `None` if all of it is.
    pub(crate) fn outside(&self, event: &Event) -> Option<(SampleTime, SampleTime)> {
        let Event { onset, stop, .. } = *event;
        let (from, to) = self.handed_out;
        if !(from.precedes(stop) && onset.precedes(to)) {
            Some((onset, stop))
        } else if to.precedes(stop) {
            Some((to, stop))
        } else {
            onset.precedes(from).then_some((onset, from))
        }
    }

    /// Completes the stretch that was not understood.
    pub(crate) fn close(&mut self) {
        if let Some(open) = self.open.take() {
            self.push(open);
        }
    }

    /// The oldest one that is complete.
    pub(crate) fn next(&mut self) -> Option<Stretch> {
        // Nearly always there is none: nothing is moved for that.
        self.ready[0]?;
        let [first, second, last] = self.ready;
        self.ready = [second, last, None];
        first
    }

    #[inline(never)]
    fn end_steady(&mut self, steady: Option<Steady>) {
        let Some((start, stop, means, scatters)) = steady else { return };
        let [start, stop] = [start, stop].map(|index| SampleTime { index, fraction: 0.0 });
        if scatters {
            let goes_on = |open: &mut Stretch| open.stop.index + 1 >= start.index;
            if !self.open.as_mut().is_some_and(goes_on) {
                self.close();
            }
            return self.refuse(start, stop, Reason::Scatters);
        }
        self.close();
        let count = means.count as f32;
        let slope = means.slope().unwrap_or(0.0);
        let squares_n2 = means.residual() + slope * slope * means.slope_weight();
        let std = math::sqrt(squares_n2 / (count * (count - 1.0))) / self.weight_n;
        let force_over_weight = means.level_n / self.weight_n;
        let kind = StretchKind::Steady { force_over_weight, std, moving: self.moving };
        self.push(Stretch { start, stop, kind });
    }

    /// There is room: a step completes at most a constant force, the stretch that was open before
    /// it and one of an event, and gives one.
    fn push(&mut self, mut stretch: Stretch) {
        if stretch.start.precedes(self.handed_out.1) {
            stretch.start = self.handed_out.1;
        }
        if !stretch.start.precedes(stretch.stop) {
            return;
        }
        self.handed_out = (stretch.start, stretch.stop);
        if let Some(place) = self.ready.iter_mut().find(|place| place.is_none()) {
            *place = Some(stretch);
        }
    }
}
