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

pub(crate) use data::{Data, Samples};
pub(crate) use levenberg_marquardt::Fitting;

use crate::fit::correction::Correction;
use crate::fit::levenberg_marquardt::Pass;
use crate::model::{CycleParams, Shape};
use crate::stats::normal_equations::{Factor, Gradient, Normal};
use crate::stats::prior::Prior;

/// A fitted event.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Fit {
    /// The fitted cycle.
    pub shape: Shape,
    /// The normal equations at the fit.
    normal: Normal,
    /// `Fs` and `Fp`.
    pub forces: Forces,
    /// Variances of the unknowns, in units of the noise variance.
    pub variances: Gradient,
    /// Variances added to those of `Fs` and `Fp` since the fit, in units of the noise variance.
    wider: (f32, f32),
    /// Whether the iteration converged.
    pub converged: bool,
}

/// Variances of the unknowns and of `Fs` and `Fp`, in units of the noise variance.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Variances {
    unknowns: Gradient,
    forces: (f32, f32),
}

impl Variances {
    /// An oscillation of variance 1 about both lines: `Fs` and `Fe` each have its variance, `Fp`
    /// half of it.
    pub(crate) const UNSURE_OSCILLATION: Self =
        Self { unknowns: [0.0, 0.0, 1.0, 0.5, 0.0, 0.0], forces: (1.0, 0.5) };

    /// Adds an error of this variance that shifts the unknowns by `moved`, and the forces as
    /// unknowns shifted by `apart` do.
    fn add(&mut self, moved: &Gradient, apart: &Gradient, variance: f32) {
        for (sum, by) in self.unknowns.iter_mut().zip(moved) {
            *sum += variance * by * by;
        }
        let (by_static, by_dynamic) = forces_by(apart);
        self.forces.0 += variance * by_static * by_static;
        self.forces.1 += variance * by_dynamic * by_dynamic;
    }
}

/// `Fs` and `Fp`, N, with their variances in units of the noise variance.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Forces {
    /// `Fs`.
    pub static_n: f32,
    /// `Fp`.
    pub dynamic_n: f32,
    /// Variance of `Fs`.
    pub static_variance: f32,
    /// Variance of `Fp`.
    pub dynamic_variance: f32,
}

impl Forces {
    /// The forces of a cycle, with variances from the factor of its information matrix.
    fn new(cycle: &CycleParams, information: &Factor) -> Self {
        let (static_n, dynamic_n) = (cycle.static_n, cycle.dynamic_n());
        let static_variance = information.spread(&STATIC, FIRST);
        let dynamic_variance = information.spread(&DYNAMIC, FIRST);
        Self { static_n, dynamic_n, static_variance, dynamic_variance }
    }

    fn widen(&mut self, (static_variance, dynamic_variance): (f32, f32)) {
        self.static_variance += static_variance;
        self.dynamic_variance += dynamic_variance;
    }

    /// Applies a correction found after the fit; `noise_n2` is the unit of the variances, N².
    pub(crate) fn apply(&mut self, correction: &Correction, noise_n2: f32) {
        let (static_n, dynamic_n) = forces_by(&correction.moved);
        self.static_n += static_n;
        self.dynamic_n += dynamic_n;
        self.static_variance += correction.static_n2 / noise_n2;
        self.dynamic_variance += correction.dynamic_n2 / noise_n2;
    }
}

/// `Fs` as a combination of the unknowns.
pub(crate) const STATIC: Gradient = [0.0, 0.0, 1.0, 0.0, 0.0, 0.0];
/// `Fp = Fs − d` as a combination of the unknowns.
pub(crate) const DYNAMIC: Gradient = [0.0, 0.0, 1.0, -1.0, 0.0, 0.0];
/// The first unknown with a coefficient in either force.
const FIRST: usize = 2;
/// The places of the loading rate and of the swing among the unknowns.
const RATE: usize = 1;
pub(crate) const SWING: usize = 4;

/// Shift of `Fs` and `Fp` for a shift of the unknowns.
fn forces_by([_, _, static_n, half_drop_n, ..]: &Gradient) -> (f32, f32) {
    (*static_n, static_n - half_drop_n)
}

impl Fit {
    /// The unknowns.
    #[must_use]
    pub(crate) fn cycle(&self) -> &CycleParams {
        self.shape.cycle()
    }

    /// Weighted sum of squared residuals, the priors' included, N².
    #[must_use]
    pub(crate) fn cost(&self) -> f32 {
        self.normal.cost
    }

    /// By how much less the squared residuals of samples and lines would be, N², without this prior
    /// of the loading rate.
    pub(crate) fn by_rate_n2(&self, rate: Prior) -> f32 {
        let pull = rate.weight * (rate.mean - self.cycle().rate);
        let variance = self.variances[RATE];
        pull * pull * variance / (1.0 - rate.weight * variance)
    }

    /// Subtracts the squared residuals, N², of samples that became part of a stick line from the
    /// cost.
    pub(crate) fn leave(&mut self, left_n2: f32) {
        self.normal.cost -= left_n2;
    }

    /// Multiplies all variances by the ratio of the event's own mean square residual to the noise.
    pub(crate) fn scale(&mut self, ratio: f32) {
        let Forces { static_variance, dynamic_variance, .. } = self.forces;
        let forces = (static_variance, dynamic_variance);
        self.widen(&Variances { unknowns: self.variances, forces }, ratio - 1.0);
    }

    /// Adds `times` their own variances to those of `Fs`, `d` and `Fp`, for noise with correlated
    /// neighbours. The variances of the quantities that events share stay the same.
    pub(crate) fn widen_forces(&mut self, times: f32) {
        let Forces { static_variance, dynamic_variance, .. } = self.forces;
        let [_, _, static_n2, half_drop_n2, ..] = self.variances;
        let unknowns = [0.0, 0.0, static_n2, half_drop_n2, 0.0, 0.0];
        let forces = (static_variance, dynamic_variance);
        self.widen(&Variances { unknowns, forces }, times);
    }

    /// Adds `times` the given variances, of errors beyond the noise.
    pub(crate) fn widen(&mut self, wider: &Variances, times: f32) {
        if times == 0.0 {
            return;
        }
        for (variance, more) in self.variances.iter_mut().zip(wider.unknowns) {
            *variance += times * more;
        }
        let forces = (times * wider.forces.0, times * wider.forces.1);
        self.wider = (self.wider.0 + forces.0, self.wider.1 + forces.1);
        self.forces.widen(forces);
    }

    /// Variances added to those of `Fs` and `Fp` since the fit, N².
    pub(crate) fn wider_n2(&self, noise_n2: f32) -> (f32, f32) {
        (noise_n2 * self.wider.0, noise_n2 * self.wider.1)
    }

    /// The forces without the prior of the loading rate: it is subtracted from the normal
    /// equations.
    ///
    /// `None` when the event alone does not determine them.
    #[must_use]
    pub(crate) fn forces_alone(&self, rate: Prior) -> Option<Forces> {
        let expected = [(rate, self.cycle().rate)];
        let Alone { factor, right } = without(&self.normal, Gradient::default(), 1, &expected)?;
        let [_, _, by_static, by_drop, ..] = factor.solve(&right);
        let mut forces = self.forces_at(by_static, by_drop, &factor);
        forces.widen(self.wider);
        Some(forces)
    }

    /// The forces after a shift of `Fs` and of half the drop, N, with the variances of an
    /// information matrix.
    fn forces_at(&self, by_static: f32, by_drop: f32, information: &Factor) -> Forces {
        let mut cycle = *self.cycle();
        cycle.static_n += by_static;
        cycle.half_drop_n += by_drop;
        Forces::new(&cycle, information)
    }

    /// The normal equations without the prior of the swing.
    pub(crate) fn without_swing(&self, swing: Prior) -> Option<Alone> {
        let value = self.cycle().inverse_omega();
        without(&self.normal, Gradient::default(), SWING, &[(swing, value)])
    }

    /// A pass over the data at the fit. The fit ended with a step whose result was not evaluated,
    /// and what that left is no noise: it would add up over the events.
    pub(crate) fn anew(&self) -> Pass {
        Pass::at(*self.cycle())
    }

    /// The event's normal equations, from those of such a pass, without the priors of all unknowns
    /// but the last, the rate change. `None` where they are singular.
    #[must_use]
    pub(crate) fn alone(&self, data: &Data<'_>, normal: &Normal) -> Option<Alone> {
        let [expected @ .., _] = data.priors(self.cycle());
        without(normal, normal.right, 0, &expected)
    }
}

/// The normal equations of an event without priors, at its fit: their factor and right-hand side.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Alone {
    pub(crate) factor: Factor,
    pub(crate) right: Gradient,
}

/// Normal equations without the priors of the unknowns from `first` on; each prior comes with the
/// unknown's value.
#[inline(never)]
fn without(
    normal: &Normal,
    mut right: Gradient,
    first: usize,
    expected: &[(Prior, f32)],
) -> Option<Alone> {
    let mut matrix = normal.matrix;
    for (i, (right, (prior, value))) in right.iter_mut().skip(first).zip(expected).enumerate() {
        matrix.add_to_diagonal(first + i, -prior.weight);
        *right -= prior.weight * (prior.mean - value);
    }
    Some(Alone { factor: matrix.factor(0.0)?, right })
}

/// Variance of a force due to rounding in single precision, N²: the noise of a quiet cell may be
/// less.
pub(crate) fn rounding_n2(force_n: f32) -> f32 {
    // Fifty units of 2⁻²⁴, for all that a residual is computed from.
    const ROUNDING: f32 = 3e-6;
    let rounding_n = ROUNDING * force_n;
    rounding_n * rounding_n
}
