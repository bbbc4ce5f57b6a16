//! The model fitted to a whole event: stick line, slip samples, stick line.
//!
//! Least squares for the five unknowns of a [`Cycle`] by damped Gauss-Newton
//! (Levenberg, Marquardt). A stick line of any length enters as two observations,
//! its level and its slope, which is all that a straight line holds; the samples
//! around the slip enter one by one; what earlier events told of the loading rate
//! and of omega enters as two more.

use crate::line::Line;
use crate::model::{Cycle, Gradient, Shape};
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
    /// Natural frequency from earlier events, rad per period.
    pub omega: Prior,
    /// Held onset, for events whose onset the samples cannot tell.
    pub onset: Prior,
}

/// A fitted event.
#[derive(Clone, Copy, Debug)]
pub struct Fit {
    /// The five unknowns.
    pub cycle: Cycle,
    /// Weighted sum of squared residuals, the priors' included, N².
    pub cost: f32,
    /// Factor of the information matrix: covariances in units of the noise variance.
    pub information: Factor,
    /// Whether the iteration settled.
    pub converged: bool,
}

/// Most iterations before giving up; 3 to 5 are usual.
const MOST_STEPS: u32 = 16;
/// Settled when a step is below this share of a standard deviation, squared.
const SETTLED: f32 = 1e-4;

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
            if gain < SETTLED * noise_n2 {
                converged = true;
                break;
            }
        }
        let information = normal.factor(0.0)?;
        normal.cost.is_finite().then_some(Fit { cycle, cost: normal.cost, information, converged })
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
        add_line(&mut normal, &shape, self.before, Shape::before, cycle.onset);
        add_line(&mut normal, &shape, self.after, Shape::after, cycle.onset);
        add_prior(&mut normal, self.onset, cycle.onset, 0);
        add_prior(&mut normal, self.rate, cycle.rate, 1);
        add_prior(&mut normal, self.omega, cycle.omega, 4);
        normal
    }
}

/// A line as two observations: its level at its mean time, and its slope.
fn add_line(
    normal: &mut Normal,
    shape: &Shape,
    line: &Line,
    piece: impl Fn(&Shape, f32) -> (f32, Gradient),
    onset: f32,
) {
    if line.weight <= 0.0 {
        return;
    }
    let (level, gradient) = piece(shape, line.time - onset);
    normal.add(line.level_n - level, &gradient, line.weight);
    if let Some(measured) = line.slope() {
        let (slope, gradient) = shape.slope();
        normal.add(measured - slope, &gradient, line.slope_weight());
    }
}

fn add_prior(normal: &mut Normal, prior: Prior, value: f32, unknown: usize) {
    if prior.weight > 0.0 {
        let mut gradient = Gradient::default();
        gradient[unknown] = 1.0;
        normal.add(prior.mean - value, &gradient, prior.weight);
    }
}

fn moved(cycle: &Cycle, step: &Gradient) -> Cycle {
    // Omega and the rate stay positive by never losing more than two thirds at once.
    let grown = |value: f32, by: f32| (value + by).clamp(0.33 * value, 3.0 * value);
    Cycle {
        onset: cycle.onset + step[0].clamp(-2.0, 2.0),
        rate: grown(cycle.rate, step[1]),
        static_n: cycle.static_n + step[2],
        half_drop_n: grown(cycle.half_drop_n, step[3]),
        omega: grown(cycle.omega, step[4]),
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
