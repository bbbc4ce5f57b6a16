//! The stick line: a straight line through the samples of a resting block, followed
//! recursively, with its start kept.

use crate::num::math;
use crate::sample::{ForcePoint, since};
use crate::stats::line::Line;

/// Fewest samples that make a stick line: two for the line, and two that it can be wrong about.
pub(super) const LINE_POINTS: u32 = 4;
/// A line's mean time is kept below this, periods, so that times keep their digits however long
/// the block rests. A power of two: the move by it loses nothing.
const MOST_MEAN_TIME: f32 = 64.0;

/// The stick line since the last re-stick.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Stick {
    /// Index of the first sample: time zero of `first`.
    pub(crate) origin: u32,
    /// Where the line is now: ends at the next onset.
    pub(crate) line: Line,
    /// Index at time zero of `line`: stays near it, so that a block that rests for days
    /// costs no digits.
    pub(super) line_origin: u32,
    /// The line up to where it was begun anew; `None` while it has not been.
    first: Option<Line>,
    /// The rate has broken off: the winch paused, or turned at another speed.
    pub(crate) broken: bool,
    /// Next index to be taken into the line.
    pub(crate) next: u32,
    /// Highest sample since the re-stick.
    pub(crate) highest: ForcePoint,
    /// Samples in a row off the line, and how many of them on the last one's side: negative below it.
    pub(super) strikes: u8,
    pub(super) same_side: i8,
}

impl Stick {
    /// At rest from an index on.
    pub(super) fn new(origin: u32, highest: ForcePoint) -> Self {
        Self { origin, line_origin: origin, next: origin, highest, ..Self::default() }
    }

    /// Are all samples so far on one line?
    #[must_use]
    pub(crate) fn is_straight(&self) -> bool {
        self.first.is_none()
    }

    /// The line as it started, at the last re-stick; times from an index on.
    #[must_use]
    pub(crate) fn first_from(&self, index: u32) -> Line {
        self.first.map_or_else(|| self.line_from(index), |first| moved(first, self.origin, index))
    }

    /// The line as it is now; times from an index on.
    #[must_use]
    pub(crate) fn line_from(&self, index: u32) -> Line {
        moved(self.line, self.line_origin, index)
    }

    /// Keeps what the line was so far, and begins it anew from an index on.
    pub(super) fn start_line(&mut self, index: u32) {
        self.first = Some(self.first_from(self.origin));
        self.strikes = 0;
        (self.line, self.line_origin) = (Line::default(), index);
    }

    /// Drops a line that does not describe the force: only the last samples before the highest one
    /// count, one by one.
    pub(super) fn forget_line(&mut self) {
        (self.line, self.first) = (Line::default(), self.first.map(|_| Line::default()));
        self.next = self.next.min(self.origin.max(self.highest.index.saturating_sub(3)));
    }

    /// Time of an index in the line, periods.
    #[inline(always)]
    pub(super) fn time(&self, index: u32) -> f32 {
        since(self.line_origin, index)
    }

    /// Sample at such a time minus the forecast, N. `None` with fewer than four samples.
    #[inline(always)]
    pub(super) fn off_n(&self, time: f32, force_n: f32) -> Option<f32> {
        let slope = self.line.slope().filter(|_| self.line.count >= LINE_POINTS)?;
        Some(force_n - self.line.at(time, slope))
    }

    /// Standard deviation of that in units of a late sample's noise; `variance` is the sample's.
    #[inline(always)]
    pub(super) fn spread(&self, time: f32, variance: f32) -> f32 {
        math::rough_sqrt(variance + self.line.leverage(time))
    }

    /// Takes a sample into the line; its weight is one over its variance.
    #[inline(always)]
    pub(super) fn take(&mut self, time: f32, force_n: f32, weight: f32) {
        self.line.take(time, force_n, weight, weight);
        if self.line.time >= MOST_MEAN_TIME {
            self.line.shift(MOST_MEAN_TIME);
            self.line_origin += MOST_MEAN_TIME as u32;
        }
    }
}

/// A line whose time begins at one index, with times from another one on.
fn moved(mut line: Line, from: u32, to: u32) -> Line {
    line.shift(since(from, to));
    line
}
