//! The model fitted to a whole event: stick line, slip samples, stick line.
//!
//! Least squares for the six unknowns of a [`Cycle`] by damped Gauss-Newton
//! (Levenberg, Marquardt). A stick line of any length enters as two observations,
//! its level and its slope, which is all that a straight line holds; the samples
//! around the slip enter one by one; what earlier events told of the loading rate
//! and of omega enters as two more.

use crate::line::Line;
use crate::model::{Cycle, Gradient, UNKNOWNS};
use crate::solve::{Factor, Normal, dot};

/// What is known of a quantity beforehand.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Prior {
    /// Expected value.
    pub mean: f32,
    /// One over its variance, in units of one over the noise variance; zero: unknown.
    pub weight: f32,
}

/// One sample of the slip and its surroundings.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Point {
    /// Time, sampling periods from the event's origin.
    pub time: f32,
    /// Force, N.
    pub force_n: f32,
    /// Weight; zero for a sample that is missing or bad.
    pub weight: f32,
}

/// Everything one event's fit is made from.
#[derive(Clone, Copy, Debug)]
pub struct Data<'a> {
    /// Stick line up to the first point.
    pub before: &'a Line,
    /// The samples in between.
    pub points: &'a [Point],
    /// Stick line after the last point.
    pub after: &'a Line,
    /// Loading rate from earlier events, N per period.
    pub rate: Prior,
    /// Swing `1/ω` from earlier events, periods.
    pub swing: Prior,
    /// Change of the loading rate over the slip, N per period.
    pub bend: Prior,
    /// Held onset, for events whose onset the samples cannot tell.
    pub onset: Prior,
}

/// A fitted event.
#[derive(Clone, Copy, Debug)]
pub struct Fit {
    /// The unknowns.
    pub cycle: Cycle,
    /// Weighted sum of squared residuals, the priors' included, N².
    pub cost: f32,
    /// The normal equations at the fit.
    normal: Normal,
    /// Factor of the information matrix: covariances in units of the noise variance.
    pub information: Factor,
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

/// `Fs` and `Fp` as combinations of the unknowns.
const STATIC: Gradient = [0.0, 0.0, 1.0, 0.0, 0.0, 0.0];
const DYNAMIC: Gradient = [0.0, 0.0, 1.0, -1.0, 0.0, 0.0];

impl Fit {
    /// The forces of the fit.
    #[must_use]
    pub fn forces(&self) -> Forces {
        forces(&self.cycle, &Gradient::default(), &self.information)
    }

    /// The forces as the event would give them without what was expected of its
    /// loading rate: the expectation is taken out of the normal equations again.
    ///
    /// `None` when the event alone does not determine them.
    #[must_use]
    pub fn forces_alone(&self, rate: Prior) -> Option<Forces> {
        let (mut normal, mut right) = (self.normal, Gradient::default());
        normal.matrix[1][1] -= rate.weight;
        right[1] = -rate.weight * (rate.mean - self.cycle.rate);
        let factor = normal.factor(0.0)?;
        Some(forces(&self.cycle, &factor.solve(&right), &factor))
    }

    /// Variance of an unknown, in units of the noise variance.
    #[must_use]
    pub fn variance(&self, unknown: usize) -> f32 {
        self.information.variance(unknown)
    }
}

/// Most iterations before giving up; 3 to 5 are usual.
const MOST_STEPS: u32 = 24;
/// Settled when a step is below this share of a standard deviation, squared.
const SETTLED: f32 = 1e-3;
/// The same when the iterations are used up: a sample may sit right on an end of
/// the slip, where the sum of squares has a kink.
const NEARLY_SETTLED: f32 = 0.05;

impl Data<'_> {
    /// Starts from a guess and returns the best fit near it.
    ///
    /// `noise_n2` is the variance of a point of weight one: it decides only when
    /// the iteration has settled. `None` when the data do not determine the
    /// unknowns.
    #[must_use]
    pub fn fit(&self, guess: &Cycle, noise_n2: f32) -> Option<Fit> {
        let mut cycle = limited(*guess);
        let mut normal = self.normal(&cycle);
        let mut damping = 1e-3;
        let mut converged = false;
        for _ in 0..MOST_STEPS {
            let step = normal.factor(damping)?.solve(&normal.right);
            let gain = dot(&step, &normal.right);
            let trial = limited(moved(&cycle, &step));
            let next = self.normal(&trial);
            // A NaN cost compares false and is a refused step.
            let better = next.cost <= normal.cost;
            if better {
                (cycle, normal) = (trial, next);
                damping *= 0.1;
            } else {
                damping = (damping * 10.0).max(1e-3);
            }
            converged = gain < NEARLY_SETTLED * noise_n2;
            if gain < SETTLED * noise_n2 {
                break;
            }
        }
        let information = normal.factor(0.0)?;
        normal.cost.is_finite().then_some(Fit {
            cycle,
            cost: normal.cost,
            normal,
            information,
            converged,
        })
    }

    /// Weighted sum of squared residuals at a trial cycle, N².
    #[must_use]
    pub fn cost(&self, cycle: &Cycle) -> f32 {
        self.normal(cycle).cost
    }

    /// The normal equations at a trial cycle.
    fn normal(&self, cycle: &Cycle) -> Normal {
        let shape = cycle.shape();
        let mut normal = Normal::default();
        for point in self.points.iter().filter(|p| p.weight > 0.0) {
            let (force, gradient) = shape.force(point.time);
            normal.add(point.force_n - force, &gradient, point.weight);
        }
        let (before, after) = (self.before, self.after);
        add_line(
            &mut normal,
            before,
            shape.before(before.time - cycle.onset),
            shape.slope_before(),
        );
        add_line(&mut normal, after, shape.after(after.time - cycle.onset), shape.slope_after());
        for (unknown, (prior, value)) in self.priors(cycle).into_iter().enumerate() {
            normal.add_one(prior.mean - value, unknown, prior.weight);
        }
        normal
    }

    /// What is expected of each unknown, and its value.
    #[must_use]
    pub fn priors(&self, cycle: &Cycle) -> [(Prior, f32); UNKNOWNS] {
        let free = Prior::default();
        [
            (self.onset, cycle.onset),
            (self.rate, cycle.rate),
            (free, cycle.static_n),
            (free, cycle.half_drop_n),
            (self.swing, cycle.swing()),
            (self.bend, cycle.bend),
        ]
    }
}

fn forces(cycle: &Cycle, step: &Gradient, information: &Factor) -> Forces {
    Forces {
        static_n: cycle.static_n + dot(step, &STATIC),
        dynamic_n: cycle.dynamic_n() + dot(step, &DYNAMIC),
        static_variance: information.covariance(&STATIC, &STATIC),
        dynamic_variance: information.covariance(&DYNAMIC, &DYNAMIC),
    }
}

/// A line as two observations: its level at its mean time, and its slope.
fn add_line(normal: &mut Normal, line: &Line, level: (f32, Gradient), slope: (f32, Gradient)) {
    if line.weight <= 0.0 {
        return;
    }
    normal.add(line.level_n - level.0, &level.1, line.weight);
    if let Some(measured) = line.slope() {
        normal.add(measured - slope.0, &slope.1, line.slope_weight());
    }
}

fn moved(cycle: &Cycle, step: &Gradient) -> Cycle {
    // Omega and the rate stay positive by never losing more than two thirds at once.
    let grown = |value: f32, by: f32| (value + by).clamp(0.33 * value, 3.0 * value);
    Cycle {
        onset: cycle.onset + step[0].clamp(-1.0, 1.0),
        rate: grown(cycle.rate, step[1]),
        static_n: cycle.static_n + step[2],
        half_drop_n: grown(cycle.half_drop_n, step[3]),
        omega: 1.0 / grown(cycle.swing(), step[4]),
        bend: cycle.bend + step[5],
    }
}

/// Keeps the unknowns where the formulas hold.
fn limited(cycle: Cycle) -> Cycle {
    const TINY: f32 = 1e-12;
    Cycle {
        rate: cycle.rate.max(TINY),
        half_drop_n: cycle.half_drop_n.max(TINY),
        omega: cycle.omega.clamp(1e-3, 60.0),
        ..cycle
    }
}
