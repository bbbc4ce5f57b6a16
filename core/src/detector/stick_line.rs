//! The stick line: a straight line through the samples of a resting block, followed
//! recursively, with its start kept and another memory on trial.

use crate::noise::forgetting::Forgetting;
use crate::sample::{ForcePoint, since};
use crate::stats::line::Line;

/// Fewest samples that make a stick line.
pub(super) const LINE_POINTS: u32 = 4;
/// Weight below which a sample does not count for the start of a line.
const LEAST_WEIGHT: f32 = 0.02;
/// A line's mean time is kept below this, periods, so that times keep their digits however long
/// the block rests.
const MOST_MEAN_TIME: f32 = 64.0;

/// The stick line since the last re-stick.
#[derive(Clone, Copy, Debug, Default)]
pub struct Stick {
    /// Index of the first sample: time zero of `first`.
    pub origin: u64,
    /// Where the line is now: ends at the next onset.
    pub line: Line,
    /// Index at time zero of `line` and `trial`: stays near them, so that a block that
    /// rests for days costs no digits.
    pub(super) line_origin: u64,
    /// The line as it started, unless `straight`.
    first: Line,
    /// All samples so far are on one line, with endless memory: `line` is also how
    /// it started.
    pub straight: bool,
    /// The rate has broken off: the winch paused, or turned at another speed.
    pub broken: bool,
    /// Weight of the next sample in `first`; zero: `first` is complete.
    first_weight: f32,
    /// The line with another memory, on trial.
    pub(super) trial: Line,
    /// Next index to be taken into the line.
    pub next: u64,
    /// Highest sample since the re-stick.
    pub highest: ForcePoint,
    /// Samples in a row off the line, and how many of them on the last one's side.
    pub(super) strikes: u32,
    pub(super) same_side: u32,
    pub(super) strike_sign: f32,
}

impl Stick {
    /// At rest from an index on.
    pub(super) fn new(origin: u64, highest: ForcePoint, straight: bool) -> Self {
        let (line_origin, next, first_weight) = (origin, origin, 1.0);
        Self { origin, line_origin, next, highest, straight, first_weight, ..Self::default() }
    }

    /// The line as it started, at the last re-stick; times from an index on.
    #[must_use]
    pub fn first_from(&self, index: u64) -> Line {
        if self.straight { self.line_from(index) } else { moved(self.first, self.origin, index) }
    }

    /// The line as it is now; times from an index on.
    #[must_use]
    pub fn line_from(&self, index: u64) -> Line {
        moved(self.line, self.line_origin, index)
    }

    /// Begins the line anew, from an index on; keeps how it started.
    pub(super) fn start_line(&mut self, index: u64) {
        self.keep_first();
        self.strikes = 0;
        (self.line, self.trial, self.line_origin) = (Line::default(), Line::default(), index);
    }

    /// Keeps how the line started: from here on it is another one.
    fn keep_first(&mut self) {
        self.first = self.first_from(self.origin);
        (self.straight, self.first_weight) = (false, 0.0);
    }

    /// Goes on with the line on trial.
    pub(super) fn take_trial(&mut self) {
        self.keep_first();
        self.line = core::mem::take(&mut self.trial);
    }

    /// Leaves out a line that does not describe the force: only the last samples
    /// before the highest one count.
    pub(super) fn forget_line(&mut self) {
        (self.line, self.first) = (Line::default(), Line::default());
        self.next = self.next.min(self.origin.max(self.highest.index.saturating_sub(3)));
    }

    /// Takes a sample into the lines; its weight is one over its variance.
    #[inline]
    pub(super) fn take(&mut self, index: u64, force_n: f32, memory: &Forgetting, weight: f32) {
        let time = since(self.line_origin, index);
        self.line.fade(memory.fade());
        self.line.add(time, force_n, weight, weight);
        if memory.has_trial() {
            self.trial.fade(memory.trial_fade());
            self.trial.add(time, force_n, weight, weight);
        }
        if !self.straight && self.first_weight > LEAST_WEIGHT {
            self.first.add(since(self.origin, index), force_n, self.first_weight, 1.0);
            self.first_weight *= memory.fade();
        }
        if self.line.time >= MOST_MEAN_TIME {
            self.line.shift(MOST_MEAN_TIME);
            self.trial.shift(MOST_MEAN_TIME);
            self.line_origin += MOST_MEAN_TIME as u64;
        }
    }
}

/// A line whose time begins at one index, with times from another one on.
fn moved(mut line: Line, from: u64, to: u64) -> Line {
    line.shift(since(from, to));
    line
}
