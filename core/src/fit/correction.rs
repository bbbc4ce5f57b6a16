//! A correction of an event's forces, estimated after its fit.

use crate::fit::Forces;
use crate::fit::posterior::Posterior;
use crate::stats::normal_equations::Gradient;

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
