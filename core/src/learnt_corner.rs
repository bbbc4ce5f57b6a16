//! How much the corners of a test's events are rounded off, from what the fits leave over.
//!
//! The score of a fitted event tells its own `κ`, `h` and `ln c`, all six unknowns free;
//! the scores of the events add up. `κ` and `h` are zero until they are significantly above
//! it; a little before that they widen the intervals.

use crate::corner::{Corner, NUMBERS};
use crate::fit::{DYNAMIC, Data, Fit, STATIC};
use crate::math;
use crate::model::{Gradient};
use crate::shared::surely;
use crate::solve::{Factor, Normal, dot};

/// What the events share.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LearntCorner {
    /// What the events of a fading past tell of the three numbers: their normal equations,
    /// in units of the noise. The other unknowns are zero.
    told: Normal,
    /// Number of these events, and Σ of the squared surprises of their scores.
    count: f32,
    surprise: f32,
    /// The numbers that are most likely by all that was told.
    best: Gradient,
    /// What the next event is expected to have.
    corner: Corner,
    /// Variances of `κ` and `h` while they are only possible.
    possible: Gradient,
    events: u32,
    /// So many events were asked.
    debug: [f32; 10],
}

/// What is known of the corners after an event, for this event.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Effect {
    /// By how much its unknowns move.
    pub(crate) moved: Gradient,
    /// Variances that are left of this, of `Fs` and `Fp`, N².
    pub(crate) static_n2: f32,
    pub(crate) dynamic_n2: f32,
}

/// Where there is no sign of a round corner, so many events are asked, and then one of so
/// many.
const FIRST: u32 = 12;
const SELDOM: u32 = 8;
/// Part by which the past fades with every event that is asked.
const FADE: f32 = 1.0 - 1.0 / 40.0;
/// Events before which nothing counts.
const LEAST_EVENTS: f32 = 2.5;
/// Standard errors beyond which a number counts, and beyond which it is possible.
const SIGNIFICANT: f32 = 3.0;
const POSSIBLE: f32 = 2.0;
/// The range that is thought of before the events tell it, parts of the drop, and one over
/// the variance of its logarithm.
const RANGE: f32 = 0.05;
const RANGE_KNOWN: f32 = 2.0;
/// Largest `κ`, periods²: a mean over more than a period.
const MOST_SMOOTHING: f32 = 0.1;
/// Most that the range changes with an event, in its logarithm, and its least part of `h`.
const MOST_STEP: f32 = 0.7;
const LEAST_RANGE: f32 = 0.125;

/// Most that an event moves the onset, periods, and the swing, parts of it.
const MOST_ONSET: f32 = 0.3;
const MOST_SWING: f32 = 0.1;

impl LearntCorner {
    /// What the next event's corners are expected to be.
    pub(crate) fn expected(&self, drop_n: f32) -> Corner {
        if self.count > 0.0 {
            return self.corner;
        }
        Corner { range_n: RANGE * drop_n, ..Corner::default() }
    }

    /// Takes what an event's residuals tell.
    pub(crate) fn learn(&mut self, data: &Data<'_>, fit: &Fit, noise_n2: f32) -> Effect {
        self.events = self.events.wrapping_add(1);
        let is_sharp = data.corner.is_sharp() && self.possible.iter().all(|v| *v <= 0.0);
        if is_sharp && self.events > FIRST && !self.events.is_multiple_of(SELDOM) {
            return Effect::default();
        }
        let effect = Own::of(data, fit).and_then(|own| self.take(&own, &data.corner, noise_n2));
        effect.unwrap_or_default()
    }

    fn take(&mut self, own: &Own, was: &Corner, noise_n2: f32) -> Option<Effect> {
        let used = numbers(was);
        if self.count <= 0.0 {
            (self.best, self.corner) = (used, *was);
            for (unknown, row) in self.told.matrix.iter_mut().enumerate() {
                row[unknown] = 1.0;
            }
            self.told.matrix[0][0] = 0.0;
            self.told.matrix[1][1] = 0.0;
            self.told.matrix[2][2] = RANGE_KNOWN;
            self.told.right[2] = RANGE_KNOWN * used[2];
        }
        self.count = FADE * self.count + 1.0;
        let score = own.normal.right;
        let (to_used, to_best) = (own.times(&used), own.times(&self.best));
        for i in 0..NUMBERS {
            for j in 0..=i {
                let sum = &mut self.told.matrix[i][j];
                *sum = FADE * *sum + own.normal.matrix[i][j] / noise_n2;
            }
            let right = &mut self.told.right[i];
            *right = FADE * *right + (score[i] + to_used[i]) / noise_n2;
        }
        // The range does not get lost while nothing tells it.
        self.told.matrix[2][2] += (1.0 - FADE) * RANGE_KNOWN;
        self.told.right[2] += (1.0 - FADE) * RANGE_KNOWN * used[2];

        let free = self.told.factor(0.0)?;
        self.best = free.solve(&self.told.right);
        let to_new = own.times(&self.best);
        self.surprise *= FADE;
        for k in 0..2 {
            // Before the event times after it: its expectation is the variance.
            let surprise = (score[k] + to_used[k] - to_best[k]) * (score[k] + to_used[k] - to_new[k]);
            self.surprise += 0.5 * surprise / (own.normal.matrix[k][k] * noise_n2);
        }
        let excess = (self.surprise / (self.count - 1.0).max(1.0)).max(1.0);
        let factor = self.decide(&free, excess, &used)?;
        let mut steps = numbers(&self.corner);
        for (step, used) in steps.iter_mut().zip(used) {
            *step -= used;
        }
        let [onset, .., swing, _] = own.moved(&steps);
        let far = (onset / MOST_ONSET).abs().max((swing / (MOST_SWING * own.swing)).abs());
        if far > 1.0 {
            for step in &mut steps {
                *step /= far;
            }
            self.corner = Corner {
                smoothing: used[0] + steps[0],
                missing_n: used[1] + steps[1],
                range_n: math::exp(used[2] + steps[2]),
            };
        }
        Some(self.effect(own, &steps, &factor, excess))
    }

    /// Which numbers count.
    fn decide(&mut self, free: &Factor, excess: f32, used: &Gradient) -> Option<Factor> {
        let mut likely = self.told;
        let mut counts = [false; 2];
        for k in 0..2 {
            let square = self.best[k] * self.best[k];
            let variance = excess * free.variance(k);
            let enough = self.count > LEAST_EVENTS && self.best[k] > 0.0;
            let beyond = |limit: f32| if enough { surely(square, limit * limit * variance) } else { 0.0 };
            let sure = beyond(SIGNIFICANT);
            counts[k] = sure > 0.0;
            self.possible[k] = (1.0 - sure) * beyond(POSSIBLE) * square;
            // Around zero, within its own size; or nothing but zero.
            const ZERO: f32 = 1e12;
            let diagonal = &mut likely.matrix[k][k];
            *diagonal += if counts[k] { 1.0 / (sure * square) } else { ZERO * *diagonal };
        }
        let factor = likely.factor(0.0)?;
        let numbers = factor.solve(&likely.right);
        let value = |k: usize| if counts[k] { numbers[k].max(0.0) } else { 0.0 };
        let missing_n = value(1);
        let range = used[2] + (numbers[2] - used[2]).clamp(-MOST_STEP, MOST_STEP);
        self.corner = Corner {
            smoothing: value(0).min(MOST_SMOOTHING),
            missing_n,
            range_n: math::exp(range).max(LEAST_RANGE * missing_n),
        };
        Some(factor)
    }

    fn effect(&self, own: &Own, steps: &Gradient, factor: &Factor, excess: f32) -> Effect {
        let variance_of = |force: &Gradient| {
            let mut by = Gradient::default();
            for (by, response) in by.iter_mut().zip(&own.response) {
                *by = dot(response, force);
            }
            let possible = by.iter().zip(self.possible).fold(0.0, |sum, (by, v)| sum + v * by * by);
            excess * factor.covariance(&by, &by) + possible
        };
        Effect { moved: own.moved(steps), static_n2: variance_of(&STATIC), dynamic_n2: variance_of(&DYNAMIC) }
    }

    pub(crate) fn debug(&self) -> [(f32, f32, f32); 3] {
        let Some(f) = self.told.factor(0.0) else { return Default::default() };
        let e = (self.surprise / (self.count - 1.0).max(1.0)).max(1.0);
        [(self.best[0], math::sqrt(f.variance(0)), self.corner.smoothing),
        (self.best[1], math::sqrt(f.variance(1)), self.corner.missing_n),
        (self.best[2], e, self.corner.range_n)]
    }
    pub(crate) fn debug2(&self) -> [f32; 10] {
        self.debug
    }
}

fn numbers(corner: &Corner) -> Gradient {
    [corner.smoothing, corner.missing_n, math::ln(corner.range_n), 0.0, 0.0, 0.0]
}

/// What an event tells of the corners by itself.
struct Own {
    /// Normal equations of the three numbers, the unknowns free.
    normal: Normal,
    /// By how much the unknowns fall when a number grows by one.
    response: [Gradient; NUMBERS],
    swing: f32,
}

/// A number of which less than this part of the information is left when the unknowns are
/// free is lost in rounding.
const LEAST_OWN: f32 = 1e-3;

impl Own {
    fn of(data: &Data<'_>, fit: &Fit) -> Option<Self> {
        let (corner, cycle) = (&data.corner, &fit.cycle);
        let shape = cycle.shape();
        let mut products = [Gradient::default(); NUMBERS];
        let mut normal = Normal::default();
        for (time, force_n, weight) in data.levels() {
            let since_onset = time - cycle.onset;
            let (force, mut gradient) = shape.force(time);
            let shift = corner.shift(&shape, since_onset);
            gradient[0] -= shift.rate;
            let mut by = Gradient::default();
            for (k, product) in products.iter_mut().enumerate() {
                by[k] = shift.by[k];
                for (sum, g) in product.iter_mut().zip(gradient) {
                    *sum += weight * by[k] * g;
                }
            }
            normal.add(force_n - force - shift.force_n, &by, weight);
        }
        let (alone, right) = fit.alone(data);
        let alone = alone.factor(0.0)?;
        let response = products.map(|product| alone.solve(&product));
        for i in 0..NUMBERS {
            let whole = normal.matrix[i][i];
            for j in 0..=i {
                normal.matrix[i][j] -= dot(&products[i], &response[j]);
            }
            normal.right[i] -= dot(&response[i], &right);
            if i < 2 && !(normal.matrix[i][i] > LEAST_OWN * whole) {
                return None;
            }
        }
        Some(Self { normal, response, swing: cycle.swing() })
    }

    /// By how much the unknowns move when the numbers do.
    fn moved(&self, steps: &Gradient) -> Gradient {
        let mut moved = Gradient::default();
        for (response, step) in self.response.iter().zip(steps) {
            for (moved, by) in moved.iter_mut().zip(response) {
                *moved -= step * by;
            }
        }
        moved
    }

    /// The information times a vector.
    fn times(&self, numbers: &Gradient) -> Gradient {
        let mut product = Gradient::default();
        for i in 0..NUMBERS {
            for j in 0..NUMBERS {
                product[i] += self.normal.matrix[i.max(j)][i.min(j)] * numbers[j];
            }
        }
        product
    }
}
