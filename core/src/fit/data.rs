//! The data of one event's fit: lines, samples, priors.

use crate::effect::{Effect, Effects};
use crate::fit::Fit;
use crate::model::corner::{Corner, MAY_BE_ROUND, Rounded};
use crate::model::{CycleParams, Shape};
use crate::noise::ripple::Wander;
use crate::stats::line::Line;
use crate::stats::normal_equations::{Gradient, Normal, UNKNOWNS};
use crate::stats::prior::{Prior, loosened};

/// The samples of the slip and its surroundings, one per period.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Samples<'a> {
    /// Time of the first, sampling periods from the event's origin.
    pub start: f32,
    /// Forces, N; NaN where a sample is missing or bad.
    pub forces_n: &'a [f32],
    /// Weight of the samples later than `rest_from`: the noise variance over theirs. The others
    /// have 1.
    pub rest_weight: f32,
    /// Beginning of the rest after the slip, periods.
    pub rest_from: f32,
}

impl<'a> Samples<'a> {
    /// Samples of equal weight.
    pub(crate) fn new(start: f32, forces_n: &'a [f32]) -> Self {
        Self { start, forces_n, rest_weight: 1.0, rest_from: f32::INFINITY }
    }

    /// Time of the last sample, earlier by the number of missing ones: no later than the last good
    /// sample, wherever samples are missing. Before the first if there is none.
    pub(crate) fn end(&self) -> f32 {
        self.start + self.count() as f32 - 1.0
    }

    /// Weight of a sample at a time; without the effect of a cable that flops all have the same.
    pub(crate) fn weight(&self, time: f32) -> f32 {
        const MAY_FLOP: bool = Effects::COMPILED.has(Effect::Flop);
        if MAY_FLOP && time > self.rest_from { self.rest_weight } else { 1.0 }
    }

    /// Number of the valid samples.
    pub(crate) fn count(&self) -> usize {
        self.forces_n.iter().filter(|force_n| !force_n.is_nan()).count()
    }

    /// Times, periods, and forces, N, of the valid samples.
    pub(crate) fn good(&self) -> impl Iterator<Item = (f32, f32)> + use<'a> {
        let (start, forces_n) = (self.start, self.forces_n);
        let timed = forces_n.iter().enumerate().map(move |(i, &f)| (start + i as f32, f));
        timed.filter(|(_, force_n)| !force_n.is_nan())
    }
}

/// Priors of one event's unknowns, and the shape of its corners.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Priors {
    /// Variance of the noise, N²: the unit of the priors' weights.
    pub noise_n2: f32,
    /// Prior of the loading rate, N per period.
    pub rate: Prior,
    /// Prior of the swing `1/ω`, periods.
    pub inverse_omega: Prior,
    /// Prior of the change of the loading rate over the slip, N per period.
    pub rate_change: Prior,
    /// Prior of the onset, from the slip's extremes; or the place at which the onset is held.
    pub onset: Prior,
    /// The rounding of the corners.
    pub corner: Corner,
}

impl Priors {
    /// Loosens the priors of the loading rate and its change where a fit contradicts them, as when the
    /// winch turns faster than before. True if it does: the fit has to go on.
    pub(crate) fn loosen(&mut self, fit: &Fit) -> bool {
        let ([_, rate_n2, .., change_n2, _], cycle) = (fit.variances, fit.cycle());
        self.rate.loosen(cycle.rate, rate_n2, self.noise_n2)
            | self.rate_change.loosen(cycle.rate_change, change_n2, self.noise_n2)
    }

    /// The prior of each unknown, and the unknown's value.
    pub(crate) fn with_values(&self, cycle: &CycleParams) -> [(Prior, f32); UNKNOWNS] {
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

/// All data of one event's fit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Data<'a> {
    /// Stick line up to the first sample.
    pub before: &'a Line,
    /// The samples between the two lines.
    pub samples: Samples<'a>,
    /// Stick line after the last sample.
    pub after: &'a Line,
    /// Correlated noise about both lines.
    pub wander: Wander,
    /// The priors, and the shape of the corners.
    pub priors: &'a Priors,
}

impl Data<'_> {
    /// Squared residuals, N², that a step may leave because the model is not linear. Where the step
    /// turns the slide by an angle `a`, the error of each sample is up to `δd a + (d + q) a²/2`.
    /// Onset and swing turn the slide, and so does the drop, by `φ = atan(q/d)` at either end.
    ///
    /// Infinite where the cable goes slack: there the force has kinks.
    pub(crate) fn nonlinearity_n2(&self, cycle: &CycleParams, step: &Gradient) -> f32 {
        if !cycle.is_taut() {
            return f32::INFINITY;
        }
        let (d, q) = (cycle.half_drop_n, cycle.rate * cycle.inverse_omega());
        let turn = 2.0 * q * step[3].abs() / (d * d + q * q);
        let angle = cycle.omega * (step[0].abs() + core::f32::consts::PI * step[4].abs()) + turn;
        let bend_n = (step[3].abs() + 0.5 * (d + q) * angle) * angle;
        self.samples.forces_n.len() as f32 * bend_n * bend_n
    }

    /// The model force of a shape, with the rounding of its corners, if any.
    pub(crate) fn model<'a>(&self, shape: &'a Shape) -> Model<'a> {
        let corner = &self.priors.corner;
        Model { shape, rounded: (!corner.is_sharp()).then(|| corner.at(shape)) }
    }

    /// Adds at most `most` samples, from the place `from` on, to the normal equations at a trial
    /// cycle.
    pub(crate) fn add_samples(&self, normal: &mut Normal, shape: &Shape, from: usize, most: usize) {
        let forces_n = self.samples.forces_n.get(from..).unwrap_or_default();
        let model = self.model(shape);
        let times = (0..most).map(|i| self.samples.start + (from + i) as f32);
        for (time, &measured_n) in times.zip(forces_n) {
            if measured_n.is_nan() {
                continue;
            }
            let at = model.residual(time, measured_n);
            normal.add(at.0, &at.1, self.samples.weight(time));
        }
    }

    /// Weighted squared residuals of the first `most` samples about a shape with sharp corners, N²;
    /// of the lines as well where there are fewer samples.
    pub(crate) fn squares_n2(&self, shape: &Shape, most: usize) -> f32 {
        let mut squares_n2 = 0.0;
        for (time, force_n, weight) in self.levels_in(0..self.places().min(most)) {
            let off_n = force_n - shape.force(time).0;
            squares_n2 += weight * off_n * off_n;
        }
        squares_n2
    }

    /// Adds the lines and the priors to the normal equations at a trial cycle.
    pub(crate) fn add_lines(&self, normal: &mut Normal, shape: &Shape) {
        let cycle = shape.cycle();
        let (before, after) = (self.before, self.after);
        let model = self.model(shape);
        self.add_level(normal, before, &model, &shape.before(before.time - cycle.onset));
        if let Some((slope, weight)) = slope(before, &self.wander) {
            normal.add_one(slope - cycle.rate, 1, weight);
        }
        self.add_level(normal, after, &model, &shape.after(after.time - cycle.onset));
        if let Some((slope, weight)) = slope(after, &self.wander) {
            let rate = cycle.rate + cycle.rate_change;
            normal.add(slope - rate, &[0.0, 1.0, 0.0, 0.0, 0.0, 1.0], weight);
        }
        for (unknown, (prior, value)) in self.priors.with_values(cycle).into_iter().enumerate() {
            normal.add_one(prior.mean - value, unknown, prior.weight);
        }
    }

    /// Adds the level of a line as one observation, its variance increased by the wander. `at` is
    /// the force of sharp corners there, and its gradient.
    fn add_level(&self, normal: &mut Normal, line: &Line, model: &Model<'_>, at: &(f32, Gradient)) {
        if line.weight > 0.0 {
            let level_n = at.0 + model.shift_n(line.time - model.shape.cycle().onset);
            // The unknown rate is the one next to the slip: from there to the middle of the line the
            // force wanders.
            let far = self.wander.level + self.wander.slope * line.time * line.time;
            normal.add(line.level_n - level_n, &at.1, loosened(line.weight, far));
        }
    }

    /// Time, periods, force, N, and weight of the levels at some places: samples first, then both
    /// lines.
    pub(crate) fn levels_in(
        &self,
        places: core::ops::Range<usize>,
    ) -> impl Iterator<Item = (f32, f32, f32)> + '_ {
        places.filter_map(|place| self.level(place))
    }

    /// Number of places: of samples, also where one is missing, and of both lines.
    pub(crate) fn places(&self) -> usize {
        self.samples.forces_n.len() + 2
    }

    // Not inlined: three loops use it.
    #[inline(never)]
    fn level(&self, place: usize) -> Option<(f32, f32, f32)> {
        if let Some(&force_n) = self.samples.forces_n.get(place) {
            let time = self.samples.start + place as f32;
            return (!force_n.is_nan()).then(|| (time, force_n, self.samples.weight(time)));
        }
        let line = match place - self.samples.forces_n.len() {
            0 => self.before,
            1 => self.after,
            _ => return None,
        };
        Some((line.time, line.level_n, loosened(line.weight, self.wander.level)))
    }
}

/// The model force with which the samples are compared.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Model<'a> {
    shape: &'a Shape,
    rounded: Option<Rounded<'a>>,
}

impl Model<'_> {
    /// Residual of a sample, N, and the model's derivatives.
    #[inline(always)]
    pub(crate) fn residual(&self, time: f32, measured_n: f32) -> (f32, Gradient) {
        // Changed in place, since it is large.
        let mut at = self.shape.force(time);
        at.0 = measured_n - at.0;
        if let Some(rounded) = self.rounded() {
            let shift = rounded.shift(time - self.shape.cycle().onset);
            at.0 -= shift.force_n;
            at.1[0] -= shift.rate;
        }
        at
    }

    /// Shift of the force by the corners at a time since the onset, N.
    fn shift_n(&self, since_onset: f32) -> f32 {
        self.rounded().map_or(0.0, |rounded| rounded.shift(since_onset).force_n)
    }

    #[inline(always)]
    fn rounded(&self) -> Option<&Rounded<'_>> {
        self.rounded.as_ref().filter(|_| MAY_BE_ROUND)
    }
}

/// Slope of a line, and its weight.
fn slope(line: &Line, wander: &Wander) -> Option<(f32, f32)> {
    Some((line.slope()?, loosened(line.slope_weight, wander.slope)))
}
