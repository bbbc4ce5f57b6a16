//! The innovation: a sample minus the stick line's forecast, with its standard deviation.

use crate::detector::Detector;
use crate::sample::{ForcePoint, since};

/// The stick line describes the force while the standard deviation of its innovations is less than
/// this multiple of the noise's. Tuned: a lower limit rejects lines that a ripple bends, a higher
/// one accepts the lines of a block that never rests.
const LINE_FITS: f32 = 2.5;

impl Detector {
    /// Sample minus the line's forecast, N. `None` with fewer than four samples on the line.
    pub(super) fn off_line_n(&self, now: ForcePoint) -> Option<f32> {
        self.stick.off_n(self.stick.time(now.index), now.force_n)
    }

    /// Standard deviation of the innovation in units of a late sample's noise, one or more.
    pub(super) fn spread(&self, index: u32) -> f32 {
        self.stick.spread(self.stick.time(index), self.variance(index))
    }

    /// Variance of a sample at rest in units of that of a late sample, long after the re-stick.
    #[inline(always)]
    pub(super) fn variance(&self, index: u32) -> f32 {
        self.profile.get().map_or(1.0, |it| it.variance(since(self.stick.origin, index)))
    }

    /// Does the cable flop after slips?
    pub(super) fn flops(&self) -> bool {
        self.profile.get().is_some_and(|profile| !profile.is_flat())
    }

    /// Does the stick line describe the force? `false` where the block never rests long enough,
    /// `true` while the scatter of the innovations is unknown.
    #[inline(never)]
    pub(super) fn line_fits(&self) -> bool {
        self.line_std_n.is_infinite() || self.line_std_n < LINE_FITS * self.std_n
    }
}
