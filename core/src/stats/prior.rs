//! Prior knowledge of a quantity.

use crate::stats::significance::surely;

/// Standard deviations beyond which a measurement contradicts its prior (normal: one in 370). Tuned:
/// with 2.5 the errors of the linear scenes are 2 % larger, with 3.5 the events of a winch whose speed
/// wanders by 1 % cover .92 (.94) at 16 Hz.
const CONTRADICTED: f32 = 3.0;
/// Least part of a fitted precision that has to be the event's own for the value to be used: a
/// smaller part may be what the last step of the fit left unsettled.
pub(crate) const LEAST_OWN: f32 = 0.01;

/// Prior of a quantity: its expected value and its precision.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Prior {
    /// Expected value.
    pub mean: f32,
    /// One over its variance, in units of one over the noise variance; zero: unknown.
    pub weight: f32,
}

impl Prior {
    /// Loosens the prior where an event's own measurement contradicts it. `value` and `variance`, in
    /// units of the noise variance, are fitted with the prior. True if it was loosened.
    ///
    /// The measurement without the prior is `(value − mean) / own` off, with the variance `1 / (own
    /// weight)` by noise and prior, where `own` is the part of the precision that is the event's.
    /// The square of what its square exceeds [`CONTRADICTED`]² variances by, over that limit,
    /// becomes variance of the prior: far beyond it the event alone decides, and near it rounding
    /// decides nothing.
    #[inline(never)]
    pub(crate) fn loosen(&mut self, value: f32, variance: f32, noise_n2: f32) -> bool {
        const LIMIT: f32 = CONTRADICTED * CONTRADICTED;
        let (own, off) = (1.0 - self.weight * variance, value - self.mean);
        let excess = self.weight * off * off / (own * noise_n2) - LIMIT;
        let is_contradicted = own > LEAST_OWN && excess > 0.0;
        if is_contradicted {
            self.weight *= own / (own + excess * excess / LIMIT);
        }
        is_contradicted
    }

    /// The prior with a variance added to its own, in units of the noise variance.
    pub(crate) fn loosened(self, variance: f32) -> Self {
        Self { weight: loosened(self.weight, variance), ..self }
    }
}

/// The precision `weight` after a variance was added: one over `1/weight + variance`.
pub(crate) fn loosened(weight: f32, variance: f32) -> f32 {
    weight / (1.0 + variance * weight)
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
