//! Prior knowledge of a quantity, and the weight of a finding by its significance.

use crate::num::math::smaller;

/// Prior of a quantity: its expected value and its precision.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Prior {
    /// Expected value.
    pub mean: f32,
    /// One over its variance, in units of one over the noise variance; zero: unknown.
    pub weight: f32,
}

impl Prior {
    /// The prior with a variance added to its own, in units of the noise variance.
    pub(crate) fn loosened(self, variance: f32) -> Self {
        Self { weight: loosened(self.weight, variance), ..self }
    }
}

/// The precision `weight` after a variance was added: one over `1/weight + variance`.
pub(crate) fn loosened(weight: f32, variance: f32) -> f32 {
    weight / (1.0 + variance * weight)
}

/// Weight of a finding by its size: 0 up to the limit, rising linearly to 1 at twice that.
#[inline(never)]
pub(crate) fn surely(size: f32, limit: f32) -> f32 {
    if size > limit { smaller(size / limit - 1.0, 1.0) } else { 0.0 }
}

/// An event's own measurement: its estimate and variance with the prior taken out.
///
/// `mean` and `variance` are the fitted ones; the precisions subtract. `None` when no more than the
/// part `least` of the fitted precision is the event's own; up to twice that part its precision is
/// reduced.
pub(crate) fn without_prior(
    mean: f32,
    variance: f32,
    prior: Prior,
    noise_n2: f32,
    least: f32,
) -> Option<(f32, f32)> {
    let (fitted, expected) = (1.0 / variance, prior.weight / noise_n2);
    let own = fitted - expected;
    let sure = surely(own, least * fitted);
    // The difference of the means keeps its precision, that of the products would not.
    (sure > 0.0).then(|| (mean + expected / own * (mean - prior.mean), 1.0 / (sure * own)))
}
