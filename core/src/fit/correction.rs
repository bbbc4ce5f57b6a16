//! A correction of an event's forces, estimated after its fit.

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
