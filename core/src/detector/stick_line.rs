//! The stick line: a straight line fitted recursively to the samples of a resting block. Where it
//! is begun anew its initial part is kept.

use crate::num::math;
use crate::sample::{ForcePoint, since};
use crate::stats::line::Line;

/// Fewest samples of a stick line: two determine it, two more test it.
pub(super) const LINE_POINTS: u32 = 4;
/// Upper limit of a line's mean time, periods: it keeps the precision of times however long the
/// block rests. A power of two: the shift by it is exact.
const MOST_MEAN_TIME: f32 = 64.0;

/// The stick line since the last re-stick.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Stick {
    /// Index of the first sample: time zero of `first`.
    pub(crate) origin: u32,
    /// The current line: ends at the next onset.
    pub(crate) line: Line,
    /// Index at time zero of `line`: kept near the mean time, so that a rest of days costs no
    /// precision.
    pub(super) line_origin: u32,
    /// The initial line, before it was begun anew; `None` if it was not.
    first: Option<Line>,
    /// How many times the line has begun anew.
    pub(super) renewals: u8,
    /// The loading rate has changed: the winch paused, or turned at another speed.
    pub(crate) broken: bool,
    /// Next index to be taken into the line.
    pub(crate) next: u32,
    /// Highest sample since the re-stick.
    pub(crate) highest: ForcePoint,
    /// Number of the last samples in a row off the line and on one side of it, negative below.
    pub(super) strikes: i8,
}

impl Stick {
    /// A block at rest from the index `origin` on.
    pub(super) fn new(origin: u32, highest: ForcePoint) -> Self {
        Self { origin, line_origin: origin, next: origin, highest, ..Self::default() }
    }

    /// Do all samples so far lie on one line?
    pub(crate) fn is_straight(&self) -> bool {
        self.first.is_none()
    }

    /// The initial line, from the last re-stick on; times from an index on.
    #[inline(never)]
    pub(crate) fn first_from(&self, index: u32) -> Line {
        self.first.map_or_else(|| self.line_from(index), |first| moved(first, self.origin, index))
    }

    /// The current line; times from an index on.
    pub(crate) fn line_from(&self, index: u32) -> Line {
        moved(self.line, self.line_origin, index)
    }

    /// Number of samples of the initial line.
    pub(crate) fn first_count(&self) -> u32 {
        self.first.as_ref().unwrap_or(&self.line).count
    }

    /// Keeps the initial line, and begins the current one anew at an index.
    pub(super) fn start_line(&mut self, index: u32) {
        self.first.get_or_insert_with(|| moved(self.line, self.line_origin, self.origin));
        self.strikes = 0;
        (self.line, self.line_origin) = (Line::default(), index);
        self.renewals = self.renewals.saturating_add(1);
    }

    /// Drops a line that does not describe the force: only the last samples before the highest one
    /// are used, one by one.
    pub(super) fn forget_line(&mut self) {
        (self.line, self.first) = (Line::default(), self.first.map(|_| Line::default()));
        self.next = self.next.min(self.origin.max(self.highest.index.saturating_sub(3)));
    }

    /// Time of an index on the line's time axis, periods.
    #[inline(always)]
    pub(super) fn time(&self, index: u32) -> f32 {
        since(self.line_origin, index)
    }

    /// Sample minus the line's forecast at its time, N. `None` with fewer than four samples.
    #[inline(always)]
    pub(super) fn off_n(&self, time: f32, force_n: f32) -> Option<f32> {
        let slope = self.line.slope().filter(|_| self.line.count >= LINE_POINTS)?;
        Some(force_n - self.line.at(time, slope))
    }

    /// A sample's distance from the line in units of the innovation's standard deviation, for late
    /// samples with a noise of one; `variance` is the sample's. `None` with fewer than two.
    #[inline(always)]
    pub(super) fn innovation_n(&self, time: f32, force_n: f32, variance: f32) -> Option<f32> {
        let slope = self.line.slope()?;
        Some((force_n - self.line.at(time, slope)) / self.spread(time, variance))
    }

    /// Standard deviation of an innovation, units of a late sample's; `variance` is the sample's.
    #[inline(always)]
    pub(super) fn spread(&self, time: f32, variance: f32) -> f32 {
        math::rough_sqrt(variance + self.line.leverage(time))
    }

    /// Takes a sample into the line; `weight` is one over the sample's variance.
    #[inline(always)]
    pub(super) fn take(&mut self, time: f32, force_n: f32, weight: f32) {
        self.line.add(time, force_n, weight, weight);
        if self.line.time >= MOST_MEAN_TIME {
            self.line.shift(MOST_MEAN_TIME);
            self.line_origin += MOST_MEAN_TIME as u32;
        }
    }
}

/// A line with its time origin moved from one index to another.
fn moved(mut line: Line, from: u32, to: u32) -> Line {
    line.shift(since(from, to));
    line
}
