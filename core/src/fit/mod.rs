//! The fit of the model to a whole event: stick line, slip samples, stick line.
//!
//! Least squares for the six unknowns of a [`CycleParams`] by damped Gauss-Newton (Levenberg,
//! Marquardt). A stick line of any length enters as two observations, its level and its slope,
//! which are sufficient statistics. The samples around the slip enter one by one. The priors of the
//! loading rate, its change and the swing from earlier events are three more observations, that of
//! the onset another.

pub(crate) mod correction;
pub(crate) mod data;
pub(crate) mod levenberg_marquardt;
pub(crate) mod over_onset;
pub(crate) mod posterior;
pub(crate) mod residuals;
pub(crate) mod slip_residuals;

pub(crate) use data::{Data, Priors, Samples};
pub(crate) use levenberg_marquardt::Fitting;

use crate::model::{CycleParams, Shape};
use crate::stats::normal_equations::{Factor, Gradient, UNKNOWNS, dot};
use crate::stats::prior::Prior;

/// A fitted event.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Fit {
    /// The fitted cycle.
    pub shape: Shape,
    /// Factor of the information matrix at the fit.
    factor: Factor,
    /// Weighted sum of squared residuals, the priors' included, N².
    pub cost: f32,
    /// Variances in units of the noise variance.
    pub variances: Variances,
    /// Variances added to those of `Fs` and `Fp` since the fit, in units of the noise variance.
    wider: (f32, f32),
    /// Whether the iteration converged.
    pub converged: bool,
}

/// Variances of the unknowns, in their order, and of `Fp`.
pub(crate) type Variances = [f32; UNKNOWNS + 1];

/// `Fs` and `Fp`, N, with their variances, N².
#[derive(Clone, Copy, Debug)]
pub(crate) struct Forces {
    /// `Fs`.
    pub static_n: f32,
    /// `Fp`.
    pub dynamic_n: f32,
    /// Variance of `Fs`.
    pub static_n2: f32,
    /// Variance of `Fp`.
    pub dynamic_n2: f32,
}

/// `Fs` as a combination of the unknowns.
pub(crate) const STATIC: Gradient = [0.0, 0.0, 1.0, 0.0, 0.0, 0.0];
/// `Fp = Fs − d` as a combination of the unknowns.
pub(crate) const DYNAMIC: Gradient = [0.0, 0.0, 1.0, -1.0, 0.0, 0.0];
/// The loading rate and the swing as combinations of the unknowns.
const RATE: Gradient = [0.0, 1.0, 0.0, 0.0, 0.0, 0.0];
const SWING: Gradient = [0.0, 0.0, 0.0, 0.0, 1.0, 0.0];

impl Fit {
    /// The unknowns.
    pub(crate) fn cycle(&self) -> &CycleParams {
        self.shape.cycle()
    }

    /// By how much less the squared residuals of samples and lines would be, N², without this prior
    /// of the loading rate.
    pub(crate) fn by_rate_n2(&self, rate: Prior) -> f32 {
        let pull = rate.weight * (rate.mean - self.cycle().rate);
        let [_, variance, ..] = self.variances;
        pull * pull * variance / (1.0 - rate.weight * variance)
    }

    /// Multiplies all variances by the ratio of the event's own mean square residual to the noise.
    pub(crate) fn scale(&mut self, ratio: f32) {
        let variances = self.variances;
        self.widen(&variances, ratio - 1.0);
    }

    /// Adds `times` the given variances, of errors beyond the noise.
    pub(crate) fn widen(&mut self, wider: &Variances, times: f32) {
        if times == 0.0 {
            return;
        }
        for (variance, more) in self.variances.iter_mut().zip(wider) {
            *variance += times * more;
        }
        let [_, _, static_n2, .., dynamic_n2] = wider;
        self.wider.0 += times * static_n2;
        self.wider.1 += times * dynamic_n2;
    }

    /// Variances added to those of `Fs` and `Fp` since the fit, N².
    pub(crate) fn wider_n2(&self, noise_n2: f32) -> (f32, f32) {
        (noise_n2 * self.wider.0, noise_n2 * self.wider.1)
    }

    /// The forces without the prior of the loading rate.
    ///
    /// `None` when the event alone does not determine them.
    pub(crate) fn forces_alone(&self, rate: Prior, noise_n2: f32) -> Option<Forces> {
        let Without { tied, gain } = self.without(&RATE, rate)?;
        let [_, _, static_n2, .., dynamic_n2] = self.variances;
        let cycle = self.cycle();
        let by = gain * (cycle.rate - rate.mean);
        let ([_, _, by_static, ..], by_dynamic) = (tied, dot(&tied, &DYNAMIC));
        Some(Forces {
            static_n: cycle.static_n + by * by_static,
            dynamic_n: cycle.dynamic_n() + by * by_dynamic,
            static_n2: noise_n2 * (static_n2 + gain * by_static * by_static),
            dynamic_n2: noise_n2 * (dynamic_n2 + gain * by_dynamic * by_dynamic),
        })
    }

    /// How the fit changes without the prior of one unknown. `None` where hardly anything but the
    /// prior determines it.
    fn without(&self, unknown: &Gradient, prior: Prior) -> Option<Without> {
        // Least part of the unknown's precision that is the event's own: less is rounding.
        const LEAST_OWN: f32 = 1e-4;
        let tied = self.factor.solve(unknown);
        let own = 1.0 - prior.weight * dot(&tied, unknown);
        (own > LEAST_OWN).then(|| Without { tied, gain: prior.weight / own })
    }
}

/// The change of a fit without the prior of one unknown, of weight `w`, mean `m` and value `x`. With
/// `A` the information matrix and `e` the unknown (Sherman and Morrison)
///
/// `(A − w e eᵀ)⁻¹ = A⁻¹ + g u uᵀ`, `u = A⁻¹ e`, `g = w / (1 − w eᵀ u)`,
///
/// and the unknowns are shifted by `g (x − m) u`.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Without {
    /// `u`.
    tied: Gradient,
    /// `g`.
    gain: f32,
}

/// The factored normal equations of an event without priors, at its fit, and their right-hand side.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Alone {
    pub(crate) factor: Factor,
    pub(crate) right: Gradient,
}

/// Variance of a force due to rounding in single precision, N²: the noise of a quiet cell may be
/// less.
pub(crate) fn rounding_n2(force_n: f32) -> f32 {
    // Fifty units of 2⁻²⁴, for all that a residual is computed from.
    const ROUNDING: f32 = 3e-6;
    let rounding_n = ROUNDING * force_n;
    rounding_n * rounding_n
}
