//! How far may the zero of the load cell have moved?
//!
//! The zero is taken before the test. When it moves it adds the same force to `Fs` and
//! `Fp`, the same number to both coefficients, and nothing to their difference, the drop.
//! Friction that scatters from event to event does not last, and friction that changes
//! for good changes the drop, unless it does so in a most peculiar way. So a lasting move
//! of `mu` that the drop does not go with may be the zero's. It cannot be taken off, for
//! friction may do the same: it widens the intervals.
//!
//! The move is the mean of the last `K` events less that of the first `K`, `K` = 1, 4 and
//! 16, as far as it is significant; what moves smoothly has no second differences, which
//! tell the scatter. Of it friction explains, where the drop `D = mu_s − mu` has moved by
//! `δD`, up to `δD mu/D` in the same direction (both coefficients in proportion), and up to
//! `δD` in the other one (`mu` alone).

use crate::event::Coefficient;
use crate::math;
use crate::shared::surely;

/// Events in which the core still learns what events share: they are no reference.
const LEARNING: f32 = 2.0;
/// Events over which a mean is taken.
const SPANS: [f32; 3] = [1.0, 4.0, 16.0];
/// So many second differences tell a scatter beyond the stated one: with fewer it needs to
/// be taken for more.
const FEW: f32 = 20.0;
/// Least part of the drop's scatter that `mu` has: a few events may happen to lie on a line.
const LEAST_SHARE: f32 = 0.25;
/// Events over which the past is forgotten: how they scatter, and a move that was seen.
const MEMORY: f32 = 40.0;
/// Standard errors beyond which a move counts, and those of a move of the drop.
const SIGNIFICANT: f32 = 4.0;
const DROP_SIGNIFICANT: f32 = 2.0;
/// Of a move without a cause: all of it is the zero's or nothing, one as likely as the
/// other. Mean square of the zero's part.
const SHARE: f32 = 0.5;
/// Least part of the test that a move is extended from to the whole.
const LEAST_PART: f32 = 0.5;

/// `mu`, the drop `mu_s − mu`, and the stated variances of the two: of an event, or means.
type Values = [f32; 4];

/// Means over the first and over the last events.
#[derive(Clone, Copy, Debug, Default)]
struct Span {
    first: Values,
    last: Values,
}

/// Follows what may be a drift of the zero.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Drift {
    /// Events with both coefficients.
    events: f32,
    spans: [Span; SPANS.len()],
    /// The last event and the one before it.
    before: [Values; 2],
    /// Sums of squared second differences over what the stated variances make of them,
    /// for `mu` and for the drop, and how many there are.
    bends: [f32; 2],
    count: f32,
    /// Variance of the zero, in units of the coefficients.
    variance: f32,
}

impl Drift {
    /// Standard deviation that the zero's drift gives to both coefficients.
    pub(crate) fn std(&self) -> f32 {
        math::sqrt(self.variance)
    }

    /// Takes an event.
    pub(crate) fn take(&mut self, mu_s: Coefficient, mu: Coefficient) {
        let variance = mu.std * mu.std;
        let event = [mu.value, mu_s.value - mu.value, variance, variance + mu_s.std * mu_s.std];
        let is_usable = event.iter().all(|value| value.is_finite()) && variance > 0.0;
        if !is_usable {
            return;
        }
        self.events += 1.0;
        let taken = self.events - LEARNING;
        if taken <= 0.0 {
            return;
        }
        self.bend(event, taken);
        let [of_mu, of_drop] = self.bends.map(|sum| self.scatter(sum));
        let scatter = [math::larger(of_mu, LEAST_SHARE * of_drop), of_drop];
        let mut seen = 0.0;
        for (span, length) in self.spans.iter_mut().zip(SPANS) {
            span.take(event, taken, length);
            if taken > length && self.count > 0.0 {
                let lag = LEARNING + 1.5 * length - 0.5;
                let part = math::larger(1.0 - lag / self.events, LEAST_PART);
                seen = math::larger(seen, span.moved(scatter, length) / (part * part));
            }
        }
        let faded = self.variance * (1.0 - 1.0 / MEMORY);
        self.variance = math::larger(SHARE * seen, faded);
    }

    /// Takes the second differences that end with an event.
    fn bend(&mut self, event: Values, taken: f32) {
        const FADE: f32 = 1.0 - 1.0 / MEMORY;
        let [last, older] = self.before;
        self.before = [event, last];
        if taken < 3.0 {
            return;
        }
        self.count = FADE * self.count + 1.0;
        for (i, sum) in self.bends.iter_mut().enumerate() {
            let bend = event[i] - 2.0 * last[i] + older[i];
            let stated = event[i + 2] + 4.0 * last[i + 2] + older[i + 2];
            *sum = FADE * *sum + (bend * bend - stated) / 6.0;
        }
    }

    /// Variance of an event beyond the stated one, with room for what few tell.
    fn scatter(&self, sum: f32) -> f32 {
        let few = FEW / self.count;
        math::larger(sum / self.count, 0.0) * (1.0 + few * few)
    }
}

impl Span {
    /// Takes an event, the one with this number, into means over so many.
    fn take(&mut self, event: Values, number: f32, length: f32) {
        let share = 1.0 / math::smaller(number, length);
        mix(&mut self.last, event, share);
        if number <= length {
            self.first = self.last;
        }
    }

    /// Squared move of `mu` that friction does not explain, as far as it is significant.
    fn moved(&self, [mu_scatter, drop_scatter]: [f32; 2], length: f32) -> f32 {
        let by = |i: usize| self.last[i] - self.first[i];
        let variance =
            |i: usize, scatter: f32| (self.last[i] + self.first[i] + 2.0 * scatter) / length;
        let (mu, drop, [level, usual_drop, ..]) = (by(0), by(1), self.last);
        let drop_n2 = variance(3, drop_scatter);
        let limit = DROP_SIGNIFICANT * DROP_SIGNIFICANT * drop_n2;
        let sure = surely(drop * drop, limit);
        let most = sure * (drop.abs() + math::rough_sqrt(limit));
        let same = (mu > 0.0) == (drop > 0.0);
        let friction = if same { most * level / usual_drop } else { most };
        let rest = mu.abs() - math::larger(friction, 0.0);
        let square = rest * rest;
        let significant = SIGNIFICANT * SIGNIFICANT * variance(2, mu_scatter);
        if rest > 0.0 { square * surely(square, significant) } else { 0.0 }
    }
}

fn mix(mean: &mut Values, event: Values, share: f32) {
    for (mean, value) in mean.iter_mut().zip(event) {
        *mean += share * (value - *mean);
    }
}
