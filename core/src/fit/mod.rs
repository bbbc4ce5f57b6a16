//! The model fitted to a whole event: stick line, slip samples, stick line.
//!
//! Least squares for the six unknowns of a [`CycleParams`] by damped Gauss-Newton
//! (Levenberg, Marquardt). A stick line of any length enters as two observations,
//! its level and its slope, which is all that a straight line holds; the samples
//! around the slip enter one by one; what earlier events told of the loading rate
//! and of omega enters as two more.

pub mod correction;
pub mod posterior;
pub mod residuals;

use core::ops::ControlFlow;

use crate::fit::correction::Correction;
use crate::model::CycleParams;
use crate::model::corner::{Corner, Shift};
use crate::noise::ripple::ColoredNoise;
use crate::stats::line::Line;
use crate::stats::normal_equations::{Factor, Gradient, Normal, UNKNOWNS, dot};
use crate::stats::prior::{Prior, loosened};

/// The samples of the slip and its surroundings, one a period.
#[derive(Clone, Copy, Debug, Default)]
pub struct Samples<'a> {
    /// Time of the first, sampling periods from the event's origin.
    pub start: f32,
    /// Forces, N; NaN where a sample is missing or bad.
    pub forces_n: &'a [f32],
    /// Weight of those later than a time, one over their variance; 1 for the others.
    pub rest_weight: f32,
    /// That time, periods.
    pub rest_from: f32,
}

impl<'a> Samples<'a> {
    /// Of equal weight.
    #[must_use]
    pub fn new(start: f32, forces_n: &'a [f32]) -> Self {
        Self { start, forces_n, rest_weight: 1.0, rest_from: f32::INFINITY }
    }

    /// Time of the last sample, or before the first if there is none.
    #[must_use]
    pub fn end(&self) -> f32 {
        self.start + self.forces_n.len() as f32 - 1.0
    }

    /// Weight of a sample at a time.
    fn weight(&self, time: f32) -> f32 {
        if time > self.rest_from { self.rest_weight } else { 1.0 }
    }

    /// Times, periods, and forces, N, of the good samples.
    pub fn good(&self) -> impl Iterator<Item = (f32, f32)> + '_ {
        let start = self.start;
        let timed = self.forces_n.iter().enumerate().map(move |(i, &f)| (start + i as f32, f));
        timed.filter(|(_, force_n)| !force_n.is_nan())
    }
}

/// Everything one event's fit is made from.
#[derive(Clone, Copy, Debug)]
pub struct Data<'a> {
    /// Stick line up to the first point.
    pub before: &'a Line,
    /// The samples in between.
    pub samples: Samples<'a>,
    /// Stick line after the last point.
    pub after: &'a Line,
    /// How far the force wanders about both lines.
    pub wander: ColoredNoise,
    /// Loading rate from earlier events, N per period.
    pub rate: Prior,
    /// Swing `1/ω` from earlier events, periods.
    pub inverse_omega: Prior,
    /// Change of the loading rate over the slip, N per period.
    pub rate_change: Prior,
    /// What rounds off the corners.
    pub corner: Corner,
    /// Held onset, for events whose onset the samples cannot tell.
    pub onset: Prior,
}

/// A fitted event.
#[derive(Clone, Copy, Debug)]
pub struct Fit {
    /// The unknowns.
    pub cycle: CycleParams,
    /// The normal equations at the fit.
    normal: Normal,
    /// The forces.
    pub forces: Forces,
    /// Variances of the unknowns, in units of the noise variance.
    pub variances: Gradient,
    /// Whether the iteration settled.
    pub converged: bool,
}

/// `Fs` and `Fp` with their variances, N and units of the noise variance.
#[derive(Clone, Copy, Debug)]
pub struct Forces {
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
    /// Of a cycle, with the factor of its information matrix.
    fn new(cycle: &CycleParams, information: &Factor) -> Self {
        Self {
            static_n: cycle.static_n,
            dynamic_n: cycle.dynamic_n(),
            static_variance: information.variance(&STATIC.0, STATIC.1),
            dynamic_variance: information.variance(&DYNAMIC.0, DYNAMIC.1),
        }
    }

    /// Takes what is known of the corners since the fit.
    pub(crate) fn take(&mut self, effect: &Correction, noise_n2: f32) {
        self.static_n += dot(&effect.moved, &STATIC.0);
        self.dynamic_n += dot(&effect.moved, &DYNAMIC.0);
        self.static_variance += effect.static_n2 / noise_n2;
        self.dynamic_variance += effect.dynamic_n2 / noise_n2;
    }
}

/// `Fs` and `Fp` as combinations of the unknowns, and the first of these.
pub(crate) const STATIC: (Gradient, usize) = ([0.0, 0.0, 1.0, 0.0, 0.0, 0.0], 2);
pub(crate) const DYNAMIC: (Gradient, usize) = ([0.0, 0.0, 1.0, -1.0, 0.0, 0.0], 2);

impl Fit {
    /// Weighted sum of squared residuals, the priors' included, N².
    #[must_use]
    pub fn cost(&self) -> f32 {
        self.normal.cost
    }

    /// The forces as the event would give them without what was expected of its
    /// loading rate: the expectation is taken out of the normal equations again.
    ///
    /// `None` when the event alone does not determine them.
    #[must_use]
    pub fn forces_alone(&self, rate: Prior) -> Option<Forces> {
        let (normal, right) = self.without([(1, (rate, self.cycle.rate))]);
        let factor = normal.factor(0.0)?;
        let [_, _, by_static, by_drop, ..] = factor.solve(&right);
        let mut cycle = self.cycle;
        cycle.static_n += by_static;
        cycle.half_drop_n += by_drop;
        Some(Forces::new(&cycle, &factor))
    }

    /// The normal equations without what is expected of all but the bend, the last one.
    #[must_use]
    pub fn alone(&self, data: &Data<'_>) -> (Normal, Gradient) {
        let expected = data.priors(&self.cycle).into_iter().enumerate();
        self.without(expected.take(UNKNOWNS - 1))
    }

    /// The normal equations without what was expected of some unknowns with these values.
    fn without(
        &self,
        expected: impl IntoIterator<Item = (usize, (Prior, f32))>,
    ) -> (Normal, Gradient) {
        let (mut normal, mut right) = (self.normal, Gradient::default());
        for (unknown, (prior, value)) in expected {
            normal.matrix[unknown][unknown] -= prior.weight;
            right[unknown] = -prior.weight * (prior.mean - value);
        }
        (normal, right)
    }
}

/// Most iterations before giving up; one or two are usual.
const MOST_STEPS: u8 = 24;
/// Settled when the next step, which is still taken, is below this share of a standard
/// deviation, squared: what it leaves is its square.
const SETTLED: f32 = 1e-2;
/// The same when the iterations are used up: a sample may sit right on an end of
/// the slip, where the sum of squares has a kink.
const NEARLY_SETTLED: f32 = 0.05;
/// Damping after the first refused step, and below which it is none.
const DAMPING: f32 = 1e-3;
/// Damping beyond which the data do not determine the unknowns.
const MOST_DAMPING: f32 = 1e9;

/// A fit under way, so that a board can do one iteration a tick.
///
/// Every [`Fitting::step`] wants the same data, but for what is expected, which may
/// become better known meanwhile.
#[derive(Clone, Copy, Debug)]
pub struct Fitting {
    cycle: CycleParams,
    normal: Normal,
    damping: f32,
    steps: u8,
}

impl Fitting {
    /// Starts from a guess.
    #[must_use]
    pub fn new(data: &Data<'_>, guess: &CycleParams) -> Self {
        let cycle = limited(*guess);
        Self { cycle, normal: data.normal(&cycle), damping: 0.0, steps: 0 }
    }

    /// One iteration. Breaks with the fit, or with `None` when the data do not
    /// determine the unknowns.
    ///
    /// `noise_n2` is the variance of a sample: it decides only when the iteration
    /// has settled.
    pub fn step(&mut self, data: &Data<'_>, noise_n2: f32) -> ControlFlow<Option<Fit>> {
        self.steps += 1;
        let Some(factor) = self.normal.factor(self.damping) else { return self.refuse() };
        let step = factor.solve(&self.normal.right);
        // What the step is expected to gain: in units of the noise, its length squared.
        let gain = dot(&step, &self.normal.right);
        let least_n2 = noise_n2 + rounding_n2(self.cycle.static_n);
        let trial = limited(moved(&self.cycle, &step));
        if self.damping > 0.0 && gain < SETTLED * least_n2 {
            return ControlFlow::Break(self.settled(true));
        }
        if gain.min(data.nonlinearity_n2(&self.cycle, &step)) < SETTLED * least_n2 {
            (self.cycle, self.normal.cost) = (trial, self.normal.cost - gain);
            return ControlFlow::Break(self.fit(&factor, true));
        }
        let next = data.normal(&trial);
        // Rounding may make a good step look a little worse. A NaN cost compares false and
        // is a refused step.
        if next.cost <= self.normal.cost + SETTLED * least_n2 {
            (self.cycle, self.normal) = (trial, next);
            self.damping = if self.damping > DAMPING { 0.1 * self.damping } else { 0.0 };
        } else if let ControlFlow::Break(fit) = self.refuse() {
            return ControlFlow::Break(fit);
        }
        if self.steps < MOST_STEPS {
            return ControlFlow::Continue(());
        }
        ControlFlow::Break(self.settled(gain < NEARLY_SETTLED * least_n2))
    }

    /// Smaller steps from here on.
    fn refuse(&mut self) -> ControlFlow<Option<Fit>> {
        self.damping = (10.0 * self.damping).max(DAMPING);
        if self.damping > MOST_DAMPING || self.steps > MOST_STEPS {
            return ControlFlow::Break(None);
        }
        ControlFlow::Continue(())
    }

    fn settled(&self, converged: bool) -> Option<Fit> {
        // What is all but singular in single precision gets the least help that it needs.
        const LEAST_HELP: f32 = 1e-5;
        let factor = self.normal.factor(0.0).or_else(|| self.normal.factor(LEAST_HELP));
        self.fit(&factor?, converged)
    }

    fn fit(&self, information: &Factor, converged: bool) -> Option<Fit> {
        let Self { cycle, normal, .. } = *self;
        let (forces, variances) = (Forces::new(&cycle, information), information.variances());
        normal.cost.is_finite().then_some(Fit { cycle, normal, forces, variances, converged })
    }
}

impl Data<'_> {
    /// Starts from a guess and returns the best fit near it, see [`Fitting`].
    #[must_use]
    pub fn fit(&self, guess: &CycleParams, noise_n2: f32) -> Option<Fit> {
        let mut fitting = Fitting::new(self, guess);
        loop {
            if let ControlFlow::Break(fit) = fitting.step(self, noise_n2) {
                return fit;
            }
        }
    }

    /// Weighted sum of squared residuals at a trial cycle, N².
    #[must_use]
    pub fn cost(&self, cycle: &CycleParams) -> f32 {
        self.normal(cycle).cost
    }

    /// Squared residuals, N², that a step may leave because the model is no straight
    /// line: where the slide turns by an angle `φ`, `δd φ + (d + q) φ²/2` on each sample. Onset,
    /// swing and, as `φ = atan(q/d)` at either end, the drop turn it.
    ///
    /// Without limit where the cable goes slack: there the force has kinks.
    fn nonlinearity_n2(&self, cycle: &CycleParams, step: &Gradient) -> f32 {
        if !cycle.is_taut() {
            return f32::INFINITY;
        }
        let (d, q) = (cycle.half_drop_n, cycle.rate * cycle.inverse_omega());
        let turn = 2.0 * q * step[3].abs() / (d * d + q * q);
        let angle = cycle.omega * (step[0].abs() + core::f32::consts::PI * step[4].abs()) + turn;
        let bend_n = (step[3].abs() + 0.5 * (d + q) * angle) * angle;
        self.samples.forces_n.len() as f32 * bend_n * bend_n
    }

    /// The normal equations at a trial cycle.
    fn normal(&self, cycle: &CycleParams) -> Normal {
        let shape = cycle.shape();
        let shift = |since_onset| match self.corner.is_sharp() {
            true => Shift::default(),
            false => self.corner.shift(&shape, since_onset),
        };
        let mut normal = Normal::default();
        for (time, force_n) in self.samples.good() {
            let (force, mut gradient) = shape.force(time);
            let shift = shift(time - cycle.onset);
            gradient[0] -= shift.rate;
            let weight = self.samples.weight(time);
            normal.add(force_n - force - shift.force_n, &gradient, weight);
        }
        let (before, after) = (self.before, self.after);
        let shifted = |since_onset, (level_n, by): (f32, Gradient)| {
            (level_n + shift(since_onset).force_n, by)
        };
        let since_onset = before.time - cycle.onset;
        let level = shifted(since_onset, shape.before(since_onset));
        add_line(&mut normal, before, &self.wander, [level, shape.slope_before()]);
        let since_onset = after.time - cycle.onset;
        let level = shifted(since_onset, shape.after(since_onset));
        add_line(&mut normal, after, &self.wander, [level, shape.slope_after()]);
        for (unknown, (prior, value)) in self.priors(cycle).into_iter().enumerate() {
            normal.add_one(prior.mean - value, unknown, prior.weight);
        }
        normal
    }

    /// Times, periods, forces, N, and weights of samples and lines.
    pub fn levels(&self) -> impl Iterator<Item = (f32, f32, f32)> + '_ {
        let weight = |line: &Line| loosened(line.weight, self.wander.level);
        let line = move |line: &Line| (line.time, line.level_n, weight(line));
        let samples = self.samples.good().map(|(time, n)| (time, n, self.samples.weight(time)));
        samples.chain([line(self.before), line(self.after)])
    }

    /// What is expected of each unknown, and its value.
    #[must_use]
    pub fn priors(&self, cycle: &CycleParams) -> [(Prior, f32); UNKNOWNS] {
        let free = Prior::default();
        [
            (self.onset, cycle.onset),
            (self.rate, cycle.rate),
            (free, cycle.static_n),
            (free, cycle.half_drop_n),
            (self.inverse_omega, cycle.inverse_omega()),
            (self.rate_change, cycle.rate_change),
        ]
    }
}

/// A line as two observations, its level and its slope, each as far off as the force
/// wanders.
fn add_line(
    normal: &mut Normal,
    line: &Line,
    wander: &ColoredNoise,
    [level, slope]: [(f32, Gradient); 2],
) {
    if line.weight <= 0.0 {
        return;
    }
    // The rate is that next to the slip: on its way to the line's middle the force wanders off.
    let far = wander.level + wander.slope * line.time * line.time;
    normal.add(line.level_n - level.0, &level.1, loosened(line.weight, far));
    if let Some(measured) = line.slope() {
        let weight = loosened(line.slope_weight(), wander.slope);
        normal.add(measured - slope.0, &slope.1, weight);
    }
}

fn moved(cycle: &CycleParams, step: &Gradient) -> CycleParams {
    // Omega and the rate stay positive by never losing more than two thirds at once.
    let grown = |value: f32, by: f32| (value + by).clamp(0.33 * value, 3.0 * value);
    CycleParams {
        onset: cycle.onset + step[0].clamp(-1.0, 1.0),
        rate: grown(cycle.rate, step[1]),
        static_n: cycle.static_n + step[2],
        half_drop_n: grown(cycle.half_drop_n, step[3]),
        omega: 1.0 / grown(cycle.inverse_omega(), step[4]),
        rate_change: cycle.rate_change + step[5],
    }
}

/// Variance of what single precision leaves of a force, N²: a quiet cell's noise may be
/// less.
pub(crate) fn rounding_n2(force_n: f32) -> f32 {
    const ROUNDING: f32 = 3e-6;
    let rounding_n = ROUNDING * force_n;
    rounding_n * rounding_n
}

/// Keeps the unknowns where the formulas hold.
fn limited(cycle: CycleParams) -> CycleParams {
    const TINY: f32 = 1e-12;
    CycleParams {
        rate: cycle.rate.max(TINY),
        half_drop_n: cycle.half_drop_n.max(TINY),
        omega: cycle.omega.clamp(1e-3, 60.0),
        ..cycle
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_short_step_settles_a_fit_and_a_long_one_does_not() {
        let (static_n, half_drop_n) = (781.2, 289.8);
        let truth = CycleParams {
            onset: 3.3,
            rate: 22.5,
            static_n,
            half_drop_n,
            omega: 1.1828,
            rate_change: 0.0,
        };
        let shape = truth.shape();
        let forces_n: [f32; 12] = core::array::from_fn(|i| shape.force(i as f32).0);
        let (line, free) = (Line::default(), Prior::default());
        let data = Data {
            before: &line,
            samples: Samples::new(0.0, &forces_n),
            after: &line,
            wander: ColoredNoise::NONE,
            rate: free,
            inverse_omega: free,
            rate_change: Prior { mean: 0.0, weight: 1e6 },
            onset: free,
            corner: Corner::default(),
        };
        let first_step = |onset, half_drop_n| {
            Fitting::new(&data, &CycleParams { onset, half_drop_n, ..truth }).step(&data, 4.0)
        };
        let ControlFlow::Break(Some(fit)) = first_step(3.303, 291.0) else { panic!("settles") };
        assert!((fit.forces.static_n - static_n).abs() < 0.02 && fit.cost() < 0.04);
        assert!(first_step(3.4, 300.0).is_continue());
    }
}
