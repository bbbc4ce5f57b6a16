//! Corrections of an event's forces, and of their variances, estimated after its fit.

use crate::fit::posterior::Posterior;
use crate::fit::{Fit, Forces, Variances};
use crate::stats::normal_equations::Gradient;

/// An oscillation of variance 1 about both lines: `Fs` and `Fe` each have its variance, half the
/// drop and `Fp` half of it.
pub(crate) const UNSURE_OSCILLATION: Variances = [0.0, 0.0, 1.0, 0.5, 0.0, 0.0, 0.5];

/// Correction of an event from the estimates, after its fit, of its corners, of an oscillation that
/// may be the cable's, or of its onset.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Correction {
    /// Shift of the event's unknowns.
    pub(crate) moved: Gradient,
    /// Variances of `Fs` and `Fp` that the correction adds, N².
    pub(crate) static_n2: f32,
    pub(crate) dynamic_n2: f32,
}

impl Correction {
    pub(crate) fn is_finite(&self) -> bool {
        (self.static_n2 + self.dynamic_n2).is_finite() && self.moved.iter().all(|x| x.is_finite())
    }
}

impl Posterior {
    /// Applies a correction.
    pub(crate) fn apply(&mut self, correction: &Correction) {
        let Correction {
            moved: [onset, rate, static_n, half_drop_n, inverse_omega, rate_change],
            ..
        } = correction;
        let c = &mut self.cycle;
        c.onset += onset;
        c.rate += rate;
        c.static_n += static_n;
        c.half_drop_n += half_drop_n;
        c.omega = 1.0 / (c.inverse_omega() + inverse_omega);
        c.rate_change += rate_change;
        self.widen(correction.static_n2, correction.dynamic_n2);
    }
}

impl Forces {
    /// Applies a correction.
    pub(crate) fn apply(&mut self, correction: &Correction) {
        let Correction { moved: [_, _, static_n, half_drop_n, ..], .. } = correction;
        self.static_n += static_n;
        self.dynamic_n += static_n - half_drop_n;
        self.static_n2 += correction.static_n2;
        self.dynamic_n2 += correction.dynamic_n2;
    }
}

impl Fit {
    /// Adds `times` their own variances to those of `Fs`, `d` and `Fp`, for noise with correlated
    /// neighbours. The variances of the quantities that events share stay the same.
    pub(crate) fn widen_forces(&mut self, times: f32) {
        let [_, _, static_n2, half_drop_n2, _, _, dynamic_n2] = self.variances;
        self.widen(&[0.0, 0.0, static_n2, half_drop_n2, 0.0, 0.0, dynamic_n2], times);
    }
}
