//! Damped Gauss-Newton (Levenberg, Marquardt), in steps of limited length.

use core::ops::ControlFlow;

use crate::fit::data::Data;
use crate::fit::{Alone, DYNAMIC, Fit, rounding_n2};
use crate::model::{CycleParams, Shape};
use crate::num::math::{larger, smaller};
use crate::stats::normal_equations::{Factor, Gradient, Normal, dot};

/// Most iterations; one or two usually suffice.
const MOST_STEPS: u8 = 24;
/// Tolerance, as a part of the noise variance. The fit has converged when the next step, which is
/// still taken, would gain less, or leave less by its nonlinearity: a tenth of a standard
/// deviation.
const SETTLED: f32 = 1e-2;
/// Tolerance when the iterations are used up, as a part of the noise variance: a sample may lie
/// right at an end of the slip, where the sum of squares has a kink. A fifth of a standard
/// deviation.
const NEARLY_SETTLED: f32 = 0.05;
/// Damping after the first refused step; each further one makes it ten times as large (Marquardt's
/// factor).
const DAMPING: f32 = 1e-3;
/// Damping below which it is set to zero. Tuned: if it is zero after one good step, the next step
/// goes too far again in a curved valley, as that of a slip with one sample.
const LEAST_DAMPING: f32 = 1e-6;
/// Damping beyond which the data do not determine the unknowns: twelve refused steps more.
const MOST_DAMPING: f32 = 1e9;

/// Longest step of the onset, in swings `1/ω`, or a period if that is more. Tuned with slips of 66
/// samples, whose first guess is ten off.
const FARTHEST: f32 = 0.25;

/// Samples per step of a pass: most slips have fewer, and take one step.
pub(crate) const SAMPLES_A_STEP: usize = 20;

/// A fit in progress, divided into steps so that a board can do one with each sample.
///
/// A *pass* adds the samples and lines to the normal equations at a trial cycle. Every
/// [`Fitting::step`] needs the same data; only the priors may become narrower meanwhile. Its time
/// is limited: `SAMPLES_A_STEP` samples, two lines, one factorisation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fitting {
    /// The best cycle so far, and the normal equations there.
    cycle: CycleParams,
    normal: Normal,
    /// Expected gain of the current trial, N².
    gain: f32,
    damping: f32,
    steps: u8,
    /// Tolerance, as a part of the noise variance.
    settled: f32,
    pass: Option<Pass>,
}

/// Normal equations at a trial cycle, with the samples added so far.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pass {
    trial: CycleParams,
    normal: Normal,
    next: usize,
}

impl Pass {
    pub(crate) fn at(trial: CycleParams) -> Self {
        Self { trial, normal: Normal::default(), next: 0 }
    }

    /// The normal equations of a whole pass over data without priors, factored. `None` where they
    /// are singular.
    pub(crate) fn alone(&self) -> Option<Alone> {
        Some(Alone { factor: self.normal.matrix.factor(0.0)?, right: self.normal.right })
    }

    /// Adds the next samples; after the last ones also the lines, and then returns true. `shape` is
    /// that of the trial.
    pub(crate) fn advance(&mut self, data: &Data<'_>, shape: &Shape) -> bool {
        data.add_samples(&mut self.normal, shape, self.next, SAMPLES_A_STEP);
        self.next += SAMPLES_A_STEP;
        let is_whole = self.next >= data.samples.forces_n.len();
        if is_whole {
            data.add_lines(&mut self.normal, shape);
        }
        is_whole
    }
}

impl Fitting {
    /// Starts from a guess.
    pub(crate) fn new(guess: &CycleParams) -> Self {
        let cycle = limited(*guess);
        // An infinite cost, so that the guess is accepted whatever it costs.
        let normal = Normal { cost: f32::INFINITY, ..Normal::default() };
        let pass = Some(Pass::at(cycle));
        Self { cycle, normal, gain: 0.0, damping: 0.0, steps: 0, settled: SETTLED, pass }
    }

    /// Starts from a guess, with at most `most_steps` steps and this tolerance, as a part of the
    /// noise variance.
    pub(crate) fn brief(guess: &CycleParams, most_steps: u8, settled: f32) -> Self {
        Self { steps: MOST_STEPS.saturating_sub(most_steps), settled, ..Self::new(guess) }
    }

    /// One step. Breaks with the fit, or with `None` when the data do not determine the unknowns.
    pub(crate) fn step(&mut self, data: &Data<'_>) -> ControlFlow<Option<Fit>> {
        if let Some(pass) = &mut self.pass {
            if !pass.advance(data, &pass.trial.shape()) {
                return ControlFlow::Continue(());
            }
            self.judge(data)?;
        }
        self.propose(data)
    }

    /// Accepts the trial at the end of its pass, or refuses it.
    fn judge(&mut self, data: &Data<'_>) -> ControlFlow<Option<Fit>> {
        let least_n2 = self.least_n2(data);
        // Rounding may make a good step look slightly worse. A NaN cost compares false and is a
        // refused step.
        let most_n2 = self.normal.cost + SETTLED * least_n2;
        let good = self.pass.as_ref().filter(|pass| pass.normal.cost <= most_n2);
        let is_good = good.is_some();
        if let Some(Pass { trial, normal, .. }) = good {
            (self.cycle, self.normal) = (*trial, *normal);
            self.damping = if self.damping > LEAST_DAMPING { 0.1 * self.damping } else { 0.0 };
        }
        self.pass = None;
        if !is_good {
            self.refuse()?;
        }
        if self.steps < MOST_STEPS {
            return ControlFlow::Continue(());
        }
        ControlFlow::Break(self.fit(self.information(), self.gain < NEARLY_SETTLED * least_n2))
    }

    /// Proposes the next trial, or ends the fit if the step to it is below the tolerance.
    fn propose(&mut self, data: &Data<'_>) -> ControlFlow<Option<Fit>> {
        self.steps += 1;
        let Some(factor) = self.normal.matrix.factor(self.damping) else {
            return self.refuse();
        };
        let step = factor.solve(&self.normal.right);
        // The expected gain of the step: its squared length in units of the noise.
        let gain = dot(&step, &self.normal.right);
        let least_n2 = self.least_n2(data);
        let trial = limited(moved(&self.cycle, &step));
        if smaller(data.nonlinearity_n2(&self.cycle, &step), gain) < self.settled * least_n2 {
            (self.cycle, self.normal.cost) = (trial, self.normal.cost - gain);
            // A damped matrix is not that of the variances.
            let factor = if self.damping > 0.0 { self.information() } else { Some(factor) };
            return ControlFlow::Break(self.fit(factor, true));
        }
        (self.gain, self.pass) = (gain, Some(Pass::at(trial)));
        ControlFlow::Continue(())
    }

    fn least_n2(&self, data: &Data<'_>) -> f32 {
        data.priors.noise_n2 + rounding_n2(self.cycle.static_n)
    }

    /// Makes the next steps smaller.
    fn refuse(&mut self) -> ControlFlow<Option<Fit>> {
        self.damping = if self.damping > 0.0 { 10.0 * self.damping } else { DAMPING };
        if self.damping > MOST_DAMPING || self.steps > MOST_STEPS {
            return ControlFlow::Break(None);
        }
        ControlFlow::Continue(())
    }

    /// Factor of the information matrix.
    fn information(&self) -> Option<Factor> {
        // A nearly singular matrix in single precision gets as little damping as it needs.
        const LEAST_HELP: f32 = 1e-5;
        let factor = |damping| self.normal.matrix.factor(damping);
        factor(0.0).or_else(|| factor(LEAST_HELP))
    }

    /// The fit at the cycle so far. `None` if the data do not determine it.
    fn fit(&self, factor: Option<Factor>, converged: bool) -> Option<Fit> {
        let factor = factor.filter(|_| self.normal.cost.is_finite())?;
        let [onset, rate, static_n2, half_drop_n2, swing, rate_change] = factor.variances();
        let dynamic_n2 = factor.spread(&DYNAMIC, 2);
        Some(Fit {
            shape: self.cycle.shape(),
            factor,
            cost: self.normal.cost,
            variances: [onset, rate, static_n2, half_drop_n2, swing, rate_change, dynamic_n2],
            wider: (0.0, 0.0),
            converged,
        })
    }
}

/// A cycle after a step, limited to where the step can be trusted.
pub(super) fn moved(cycle: &CycleParams, step: &Gradient) -> CycleParams {
    // Rate, half the drop and swing stay above zero: a step reduces them by two thirds at most, or
    // triples them. Not `clamp`, which panics at a NaN limit.
    let grown = |value: f32, by: f32| smaller(larger(value + by, 0.33 * value), 3.0 * value);
    let farthest = larger(1.0, FARTHEST * cycle.inverse_omega());
    CycleParams {
        onset: cycle.onset + larger(smaller(step[0], farthest), -farthest),
        rate: grown(cycle.rate, step[1]),
        static_n: cycle.static_n + step[2],
        half_drop_n: grown(cycle.half_drop_n, step[3]),
        omega: 1.0 / grown(cycle.inverse_omega(), step[4]),
        rate_change: cycle.rate_change + step[5],
    }
}

/// Limits the unknowns to where the formulas hold.
fn limited(cycle: CycleParams) -> CycleParams {
    // The formulas need values above zero only: this is below what single precision resolves.
    const TINY: f32 = 1e-12;
    let least_n = larger(TINY * cycle.static_n.abs(), f32::MIN_POSITIVE);
    CycleParams {
        rate: larger(cycle.rate, least_n),
        half_drop_n: larger(cycle.half_drop_n, least_n),
        omega: cycle.omega.clamp(1e-3, 60.0),
        ..cycle
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::{Priors, Samples};
    use crate::model::tests::dff8_13;
    use crate::noise::ripple::ColoredNoise;
    use crate::stats::line::Line;
    use crate::stats::prior::Prior;

    impl Data<'_> {
        /// Fits from a guess to convergence, see [`Fitting`].
        pub(crate) fn fit(&self, guess: &CycleParams) -> Option<Fit> {
            let mut fitting = Fitting::new(guess);
            loop {
                if let ControlFlow::Break(fit) = fitting.step(self) {
                    return fit;
                }
            }
        }
    }

    #[test]
    fn a_short_step_settles_a_fit_and_a_long_one_does_not() {
        let truth = dff8_13();
        let shape = truth.shape();
        let forces_n: [f32; 12] = core::array::from_fn(|i| shape.force(i as f32).0);
        let rate_change = Prior { mean: 0.0, weight: 1e6 };
        let priors = Priors { noise_n2: 4.0, rate_change, ..Priors::default() };
        let line = Line::default();
        let data = Data {
            before: &line,
            samples: Samples::new(0.0, &forces_n),
            after: &line,
            wander: ColoredNoise::NONE.into(),
            priors: &priors,
        };
        let first_step = |onset, half_drop_n| {
            let mut fitting = Fitting::new(&CycleParams { onset, half_drop_n, ..truth });
            fitting.step(&data)
        };
        let ControlFlow::Break(Some(fit)) = first_step(3.303, 291.0) else { panic!("settles") };
        assert!((fit.cycle().static_n - truth.static_n).abs() < 0.02 && fit.cost < 0.04);
        assert!(first_step(3.4, 300.0).is_continue());
    }
}
