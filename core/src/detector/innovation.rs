//! The innovation: how far a sample lies from the stick line's forecast, and how sure that is.

use crate::detector::Detector;
use crate::noise::flop::FlopProfile;
use crate::sample::{ForcePoint, since};

/// The line describes the force while its innovations scatter by less than this, in standard
/// deviations of the noise from sample to sample. Tuned: a lower one distrusts lines that a
/// ripple bends, a higher one trusts the lines of a block that never rests.
const LINE_FITS: f32 = 2.5;

impl Detector {
    /// Sample minus the line's forecast, N. `None` with fewer than four samples on the line.
    #[inline(never)]
    pub(super) fn off_line_n(&self, now: ForcePoint) -> Option<f32> {
        self.stick.off_n(self.stick.time(now.index), now.force_n)
    }

    /// Standard deviation of that in units of a late sample's noise, one or more; the
    /// sample's own variance as from [`Self::variance`].
    #[inline(never)]
    pub(super) fn spread(&self, now: ForcePoint, variance: f32) -> f32 {
        self.stick.spread(self.stick.time(now.index), variance)
    }

    /// Variance of a resting block's sample over that of a late one.
    #[inline(always)]
    pub(super) fn variance(&self, index: u32) -> f32 {
        let profile = self.profile.get().filter(|it| !it.is_flat());
        profile.map_or(1.0, |it| self.flop_variance(it, index))
    }

    #[inline(never)]
    fn flop_variance(&self, profile: &FlopProfile, index: u32) -> f32 {
        profile.variance(since(self.stick.origin, index))
    }

    /// Does the stick line describe the force, or does the block never rest long
    /// enough?
    #[inline(never)]
    pub(super) fn line_fits(&self) -> bool {
        self.line_std_n.is_infinite() || self.line_std_n < LINE_FITS * self.std_n
    }
}
