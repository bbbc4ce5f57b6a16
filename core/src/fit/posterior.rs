//! Posterior of one event's unknowns: means and variances.

use crate::fit::{Fit, Variances};
use crate::model::CycleParams;

/// Length below which slips are averaged over the onset, periods: half of them or more have at most
/// one sample.
pub(crate) const RESOLVED: f32 = 1.5;
/// Length above which the samples always determine a slip's length, periods: it has two at least.
pub(crate) const CLEAR: f32 = 2.0;
/// Least relative standard deviation of the swing at which a slip is not resolved. Tuned to little:
/// with half or twice as much a hundredth of the events of `jitter_10` gets or loses its
/// coefficients.
const SWING_KNOWN: f32 = 0.2;

/// Means and variances of one event's unknowns; forces in N, times in periods.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Posterior {
    /// The cycle with the mean values.
    pub cycle: CycleParams,
    /// Time in which the force depends on the slide, periods: up to the stop, or up to a slack
    /// cable.
    pub fall_time: f32,
    /// Parts of these two variances that are common to all events, N²: from the corners, and from
    /// the scatter of the slips' samples, which may be the same in all of them.
    pub common_n2: (f32, f32),
    /// Variances of the unknowns and of `Fp`.
    pub variances: Variances,
}

impl Posterior {
    /// Variances of `Fs` and of `Fp`, N².
    pub(crate) fn forces_n2(&self) -> (f32, f32) {
        let [_, _, static_n2, .., dynamic_n2] = self.variances;
        (static_n2, dynamic_n2)
    }

    /// Variance of the swing, periods².
    pub(crate) fn swing_variance(&self) -> f32 {
        let [.., swing, _, _] = self.variances;
        swing
    }

    /// Adds to the variances of `Fs` and of `Fp`, N².
    pub(crate) fn widen(&mut self, by_static_n2: f32, by_dynamic_n2: f32) {
        let [_, _, static_n2, .., dynamic_n2] = &mut self.variances;
        *static_n2 += by_static_n2;
        *dynamic_n2 += by_dynamic_n2;
    }

    /// Is the slip resolved: long enough for the samples, with a known swing?
    #[inline(never)]
    pub(crate) fn is_resolved(&self) -> bool {
        let most = SWING_KNOWN * self.cycle.inverse_omega();
        self.fall_time >= RESOLVED && self.swing_variance() < most * most
    }

    /// Does the slip determine the swing well enough for the next events? `variance` is that of its
    /// swing without the prior. In a slip of less than two periods one sample leaves an error of
    /// the swing that is not normal and does not average out over such events.
    pub(crate) fn determines_swing(&self, variance: f32) -> bool {
        // Relative standard deviation of a well-known swing.
        const WELL: f32 = 0.08;
        let well = WELL * self.cycle.inverse_omega();
        self.is_resolved() && (self.fall_time > CLEAR || variance < well * well)
    }

    /// Adds the uncertainty of a slip that may have begun anywhere within a period before and
    /// after, with any length: the standard deviation of `Fs` follows from that of the onset, and
    /// `Fp` gets half of it.
    pub(crate) fn begin_anywhere(&mut self) {
        // Variance of a uniform distribution from −1 to 1.
        const UNIFORM: f32 = 1.0 / 3.0;
        let CycleParams { rate, omega, .. } = self.cycle;
        let onset_n2 = UNIFORM * rate * rate;
        self.widen(onset_n2, 0.25 * onset_n2);
        self.variances[0] += UNIFORM;
        self.variances[4] += 1.0 / (omega * omega);
    }

    /// The posterior at the best fit, for a noise of this variance, N².
    pub(crate) fn at(fit: &Fit, noise_n2: f32) -> Self {
        let variances = fit.variances.map(|variance| noise_n2 * variance);
        let (fall_time, common_n2) = (fit.shape.fall_time(), (0.0, 0.0));
        Self { cycle: *fit.cycle(), fall_time, common_n2, variances }
    }
}
