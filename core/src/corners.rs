//! How much the corners of a test's events are rounded off: learnt from what the fits
//! leave over.
//!
//! Each event tells its own `κ`, `h` and `ln c`: by how much more or less its sum of
//! squares would be least, all six unknowns free (a score test). They count once they are
//! significantly above zero over several events. On the way there they widen the
//! intervals, later they shift the forces.

use crate::corner::{Corner, NUMBERS};
use crate::fit::{DYNAMIC, Data, Fit, STATIC};
use crate::math;
use crate::model::{Gradient, UNKNOWNS};
use crate::solve::{Normal, dot};

/// What the events share.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Corners {
    /// What the events so far told of the three numbers, of a fading past, in units of the
    /// noise: information, and its product with the numbers.
    told: Normal,
    /// Σ of the squared surprises of the events' scores, in their variances, and number.
    surprise: f32,
    count: f32,
    /// The best numbers by all that was told, and those in use.
    best: [f32; NUMBERS],
    in_use: Corner,
    /// The next event is asked, whatever its number.
    asks: bool,
    events: u32,
}

/// What the corners do to an event's unknowns.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Effect {
    /// By how much they are off, since more is known of the corners now.
    pub(crate) moved: Gradient,
    /// What is left of that: variances of `Fs` and `Fp`, N².
    pub(crate) static_n2: f32,
    pub(crate) dynamic_n2: f32,
}

/// Events that are asked without any sign of a round corner: so many at first, and later
/// one out of so many.
const FIRST: u32 = 12;
const SELDOM: u32 = 8;
/// Events over which the past is forgotten.
const MEMORY: f32 = 40.0;
/// The range is thought to be so many usual drops before the events tell it, to within
/// such a part, and no less than so many times what is missing.
const RANGE: f32 = 0.05;
const RANGE_SPREAD: f32 = 0.7;
const LEAST_RANGE: f32 = 0.125;
/// Standard errors beyond which a number counts, and beyond which it is thought possible.
const SIGNIFICANT: f32 = 3.0;
const POSSIBLE: f32 = 2.0;
/// Events before which nothing counts.
const LEAST_EVENTS: f32 = 2.5;
/// Largest `κ`, periods².
const MOST_SMOOTHING: f32 = 0.1;

impl Corners {
    /// What the next event's corners are expected to be.
    pub(crate) fn expected(&self, drop_n: f32) -> Corner {
        if self.count > 0.0 { self.in_use } else { Corner { range_n: RANGE * drop_n, ..Corner::default() } }
    }

    /// Takes what an event's residuals tell.
    pub(crate) fn learn(&mut self, data: &Data<'_>, fit: &Fit, noise_n2: f32) -> Effect {
        self.events = self.events.wrapping_add(1);
        if !(self.asks || self.events <= FIRST || self.events.is_multiple_of(SELDOM)) {
            return Effect::default();
        }
        match Own::of(data, fit) {
            Some(own) => self.take(&own, &data.corner, noise_n2),
            None => Effect::default(),
        }
    }

    fn take(&mut self, own: &Own, was: &Corner, noise_n2: f32) -> Effect {
        const FADE: f32 = 1.0 - 1.0 / MEMORY;
        let used = [was.smoothing, was.missing_n, math::ln(was.range_n)];
        if self.count <= 0.0 {
            self.best = used;
        }
        self.count = FADE * self.count + 1.0;
        self.surprise *= FADE;
        let mut surprise = Gradient::default();
        for i in 0..NUMBERS {
            let (mut right, mut expected) = (own.normal.right[i], 0.0);
            for j in 0..NUMBERS {
                let entry = own.normal.matrix[i.max(j)][i.min(j)];
                right += entry * used[j];
                expected += entry * self.best[j];
                let sum = &mut self.told.matrix[i][j];
                *sum = FADE * *sum + entry / noise_n2;
            }
            self.told.right[i] = FADE * self.told.right[i] + right / noise_n2;
            surprise[i] = right - expected;
        }
        let range_prior = 1.0 / (RANGE_SPREAD * RANGE_SPREAD);
        let mut normal = self.told;
        for i in NUMBERS..UNKNOWNS {
            normal.matrix[i][i] = 1.0;
        }
        normal.matrix[2][2] += range_prior;
        normal.right[2] += range_prior * math::ln(self.first_range_n(was));
        let Some(free) = normal.factor(0.0) else { return Effect::default() };
        let solution = free.solve(&normal.right);
        let mut widen = [0.0; NUMBERS];
        // Surprise before times what is left of it, over its variance.
        let mut left = surprise;
        for i in 0..NUMBERS {
            for j in 0..NUMBERS {
                left[i] -= own.normal.matrix[i.max(j)][i.min(j)] * (solution[j] - self.best[j]);
            }
        }
        let mut alone = own.normal;
        let known = if was.missing_n > 0.0 { NUMBERS } else { NUMBERS - 1 };
        for i in known..UNKNOWNS {
            alone.matrix[i] = Gradient::default();
            alone.matrix[i][i] = 1.0;
            surprise[i] = 0.0;
        }
        if let Some(factor) = alone.factor(0.0).filter(|_| self.count > 1.0) {
            self.surprise += factor.covariance(&surprise, &left).max(0.0) / (noise_n2 * known as f32);
        }
        for k in 0..NUMBERS {
            self.best[k] = solution[k];
        }
        let excess = (self.surprise / (self.count - 1.0).max(1.0)).max(1.0);
        for k in 0..2 {
            let square = solution[k] * solution[k];
            let variance = excess * free.variance(k);
            let enough = self.count > LEAST_EVENTS && solution[k] > 0.0;
            let ramp = |limit: f32| if enough { surely(square, limit * limit * variance) } else { 0.0 };
            let (sure, possible) = (ramp(SIGNIFICANT), ramp(POSSIBLE));
            widen[k] = (1.0 - sure) * possible * square;
            // Otherwise it is zero.
            normal.matrix[k][k] += if sure > 0.0 { 1.0 / (sure * square) } else { 1e12 * normal.matrix[k][k] };
        }
        let Some(factor) = normal.factor(0.0) else { return Effect::default() };
        let now = factor.solve(&normal.right);
        let missing_n = now[1].max(0.0);
        self.in_use = Corner {
            smoothing: now[0].clamp(0.0, MOST_SMOOTHING),
            missing_n,
            range_n: (was.range_n * math::exp((now[2] - used[2]).clamp(-0.7, 0.7))).max(LEAST_RANGE * missing_n),
        };
        self.asks = !self.in_use.is_sharp() || widen.iter().any(|&v| v > 0.0);
        let steps = [
            self.in_use.smoothing - was.smoothing,
            self.in_use.missing_n - was.missing_n,
            math::ln(self.in_use.range_n / was.range_n),
        ];
        let mut effect = Effect::default();
        for (k, response) in own.response.iter().enumerate() {
            for (moved, by) in effect.moved.iter_mut().zip(response) {
                *moved -= steps[k] * by;
            }
        }
        let variance_of = |combination: &Gradient| {
            let mut by = Gradient::default();
            for (by, response) in by.iter_mut().zip(&own.response) {
                *by = dot(response, combination);
            }
            let extra = (0..NUMBERS).fold(0.0, |sum, k| sum + widen[k] * by[k] * by[k]);
            excess * factor.covariance(&by, &by) + extra
        };
        effect.static_n2 = variance_of(&STATIC);
        effect.dynamic_n2 = variance_of(&DYNAMIC);
        effect
    }

    fn first_range_n(&self, was: &Corner) -> f32 {
        was.range_n
    }

    pub(crate) fn debug(&self) -> [(f32, f32, f32); 3] {
        let mut normal = self.told;
        for i in 0..UNKNOWNS {
            normal.matrix[i][i] += if i > 1 { 1.0 } else { 0.0 };
        }
        let Some(f) = normal.factor(0.0) else { return Default::default() };
        let e = (self.surprise / (self.count - 1.0).max(1.0)).max(1.0);
        [(self.best[0], math::sqrt(f.variance(0)), self.in_use.smoothing),
        (self.best[1], math::sqrt(f.variance(1)), self.in_use.missing_n),
        (self.best[2], e, self.in_use.range_n)]
    }
}

/// From 0 where a size is within a limit to 1 where it is twice that.
fn surely(size: f32, limit: f32) -> f32 {
    if size > limit { (size / limit - 1.0).min(1.0) } else { 0.0 }
}

/// What an event tells of the corners by itself.
struct Own {
    /// Information and score of the numbers, the unknowns free.
    normal: Normal,
    /// By how much the unknowns fall for one more of each.
    response: [Gradient; NUMBERS],
}

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
            for j in 0..=i {
                normal.matrix[i][j] -= dot(&products[i], &response[j]);
            }
            normal.right[i] -= dot(&response[i], &right);
        }
        Some(Self { normal, response })
    }
}
