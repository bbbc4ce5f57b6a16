//! Estimate of a possible drift of the load cell's zero during a test.
//!
//! The zero is taken before the test. When it moves, it adds the same force to `Fs` and `Fp`, the
//! same number to both coefficients, and nothing to their difference, the drop. Friction that
//! scatters between events does not persist, and friction that changes permanently also changes the
//! drop, except by coincidence. So a persistent shift of `mu` without a shift of the drop may be a
//! drift of the zero. It cannot be corrected, since friction may cause the same; it widens the
//! intervals.
//!
//! The shift is the mean of the last `K` events less that of the first `K`, `K` = 1, 4 and 16, as
//! far as it is significant. The scatter is estimated from second differences, to which a smooth
//! drift adds nothing. Where the drop `D = mu_s − mu` has shifted by `δD`, friction explains up to
//! `δD mu/D` of a shift of the same sign (both coefficients in proportion), and up to `δD` of one
//! of the other sign (`mu` alone), and at least what it explains in the means over more events. The
//! rest is extrapolated to the whole test, as if it had grown linearly.

use crate::coefficient::Coefficient;
use crate::num::math;
use crate::stats::fading_trend::FADE;
use crate::stats::significance::surely;

/// Number of first events that are no reference: the core still learns the shared quantities there,
/// for which two events are needed (`stats/fading_trend.rs`).
const LEARNING: f32 = 2.0;
/// Numbers of events in a mean, each four times the one before: few resolve a quick move, many a
/// small one.
const SPANS: [f32; 3] = [1.0, 4.0, 16.0];
/// Number of second differences at which the variance of the scatter is doubled, as a margin for
/// its own error; the margin is larger with fewer.
const FEW: f32 = 20.0;
/// Least variance of the scatter of `mu`, as a part of the drop's variance (stated and scatter): a
/// few events may happen to lie on a line. Tuned: with .1 the intervals of noise with a correlation
/// of .9 are a fifteenth wider, with .5 friction that wanders is 3.8 standard deviations off (3.2).
const LEAST_SHARE: f32 = 0.25;
/// Standard errors beyond which a shift of `mu` is significant: of normal variables one in 2000.
/// Three means are tested with every event.
const SIGNIFICANT: f32 = 3.5;
/// Standard errors beyond which a shift of the drop is significant: fewer, since what friction may
/// explain is not attributed to the zero.
const DROP_SIGNIFICANT: f32 = 2.0;
/// Mean square of the zero's part in an unexplained shift: either all of it or nothing, with equal
/// odds.
const SHARE: f32 = 0.5;
/// Least part of the test from which a shift is extrapolated to the whole; it then doubles.
const LEAST_PART: f32 = 0.5;

/// `mu`, the drop `mu_s − mu`, and their stated variances: of one event, or means over events.
type Values = [f32; 4];

/// What is known of a change of friction.
#[derive(Clone, Copy, Debug, Default)]
struct Friction {
    /// Part of the shift of `mu` that it explains.
    shift: f32,
    /// How surely the drop shows that there is one, 0 to 1.
    sure: f32,
}

/// Means over the first and over the last events.
#[derive(Clone, Copy, Debug, Default)]
struct Span {
    first: Values,
    last: Values,
}

/// Estimator of a possible drift of the zero.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Drift {
    /// Number of events with both coefficients.
    events: f32,
    spans: [Span; SPANS.len()],
    /// The last event and the one before it.
    before: [Values; 2],
    /// Second differences of `mu` and of the drop: Σ of their squares less the expectation from the
    /// stated variances, in units of an event's variance; and their number.
    second_differences: [f32; 2],
    count: f32,
    /// Mean over the events of the shifts found since the test began, and the square of the largest
    /// shift with a fading memory; in the unit of the coefficients.
    mean: f32,
    square: f32,
    /// The newest shift.
    last: f32,
}

impl Drift {
    /// Standard deviation of both coefficients of an event due to the drift.
    pub(crate) fn std(&self) -> f32 {
        math::sqrt(SHARE * self.square)
    }

    /// Standard deviation of the means over all events due to the drift: from the mean of the
    /// shifts, but at least half of the newest one, as if it had grown linearly before it became
    /// significant.
    pub(crate) fn mean_std(&self) -> f32 {
        math::sqrt(SHARE) * math::larger(self.mean.abs(), 0.5 * self.last.abs())
    }

    /// Updates the estimate with an event's coefficients.
    pub(crate) fn take(&mut self, mu_s: Coefficient, mu: Coefficient) {
        let variance = mu.std * mu.std;
        let event = [mu.value, mu_s.value - mu.value, variance, variance + mu_s.std * mu_s.std];
        if !event.iter().all(|value| value.is_finite()) {
            return;
        }
        self.events += 1.0;
        let taken = self.events - LEARNING;
        if taken <= 0.0 {
            return;
        }
        self.add_second_difference(event, taken);
        let [of_mu, of_drop] = self.second_differences.map(|sum| self.scatter(sum));
        let [.., stated_of_drop] = event;
        let margin = 1.0 + (FEW / self.count) * (FEW / self.count);
        let least = LEAST_SHARE * (margin * of_drop + stated_of_drop);
        let scatter = [math::larger(margin * of_mu, least), of_drop];
        let (mut moved, mut friction) = (0.0_f32, Friction::default());
        // The longest first: what friction explains in a mean over many events it also explains in
        // one over few.
        for (span, &length) in self.spans.iter_mut().rev().zip(SPANS.iter().rev()) {
            span.take(event, taken, length);
            if taken > length && self.count > 0.0 {
                let lag = LEARNING + 1.5 * length - 0.5;
                let part = math::larger(1.0 - lag / self.events, LEAST_PART);
                let whole = span.moved(scatter, length, &mut friction) / part;
                if whole.abs() > moved.abs() {
                    moved = whole;
                }
            }
        }
        // The zero may come back, and friction may hide its shift, so a shift found fades slowly,
        // unless friction is known to have changed by now.
        let open = 1.0 - friction.sure;
        self.mean = open * self.mean + (moved - open * self.mean) / self.events;
        self.last = moved;
        self.square = math::larger(moved * moved, FADE * open * self.square);
    }

    /// Updates the second differences with the one that ends at this event.
    fn add_second_difference(&mut self, event: Values, taken: f32) {
        let [last, older] = self.before;
        self.before = [event, last];
        if taken < 3.0 {
            return;
        }
        self.count = FADE * self.count + 1.0;
        for (i, sum) in self.second_differences.iter_mut().enumerate() {
            let difference = event[i] - 2.0 * last[i] + older[i];
            let stated = event[i + 2] + 4.0 * last[i + 2] + older[i + 2];
            *sum = FADE * *sum + (difference * difference - stated) / 6.0;
        }
    }

    /// Variance between events beyond the stated one.
    fn scatter(&self, sum: f32) -> f32 {
        math::larger(sum / self.count, 0.0)
    }
}

impl Span {
    /// Updates the means over `length` events with an event, the `number`th.
    fn take(&mut self, event: Values, number: f32, length: f32) {
        let share = 1.0 / math::smaller(number, length);
        mix(&mut self.last, event, share);
        if number <= length {
            self.first = self.last;
        }
    }

    /// The significant shift of `mu` that friction does not explain. `mu_scatter` and
    /// `drop_scatter` are variances. `friction` is what longer means know of it, and is updated.
    fn moved(
        &self,
        [mu_scatter, drop_scatter]: [f32; 2],
        length: f32,
        friction: &mut Friction,
    ) -> f32 {
        let by = |i: usize| self.last[i] - self.first[i];
        let variance =
            |i: usize, scatter: f32| (self.last[i] + self.first[i] + 2.0 * scatter) / length;
        let (mu, drop, [level, usual_drop, ..]) = (by(0), by(1), self.last);
        let of_drop = variance(3, drop_scatter);
        let sure = surely(drop * drop, DROP_SIGNIFICANT * DROP_SIGNIFICANT * of_drop);
        let by = sure * if (mu > 0.0) == (drop > 0.0) { level / usual_drop } else { 1.0 };
        let explained = math::larger(by * drop.abs(), friction.shift * 1_f32.copysign(mu));
        friction.shift = math::smaller(explained, mu.abs()).copysign(mu);
        let significant = SIGNIFICANT * SIGNIFICANT;
        friction.sure = math::larger(friction.sure, surely(drop * drop, significant * of_drop));
        let rest = math::larger(mu.abs() - explained, 0.0).copysign(mu);
        let of_rest = variance(2, mu_scatter) + by * by * of_drop;
        rest * surely(rest * rest, significant * of_rest)
    }
}

fn mix(mean: &mut Values, event: Values, share: f32) {
    for (mean, value) in mean.iter_mut().zip(event) {
        *mean += share * (value - *mean);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::Random;

    const STD: f32 = 0.001;

    /// Uniform, of variance one.
    fn noise(random: &mut Random) -> f32 {
        3.464 * (random.even() - 0.5)
    }

    /// The estimate after events whose coefficients `(mu_s, mu)` shift by `moved`, each with its
    /// noise and with a relative scatter of its own.
    fn after(events: u32, scatter: f32, moved: impl Fn(f32) -> (f32, f32)) -> Drift {
        let (mut drift, mut random) = (Drift::default(), Random(1));
        for i in 0..events {
            let (mu_s, mu) = moved(i as f32);
            let mut measured = |value: f32| {
                let value = value * (1.0 + scatter * noise(&mut random)) + STD * noise(&mut random);
                Coefficient::random(value, STD)
            };
            drift.take(measured(1.24 + mu_s), measured(0.78 + mu));
        }
        drift
    }

    #[test]
    fn a_move_of_both_coefficients_may_be_the_zeros() {
        for moved in [
            |i: f32| 0.0005 * i,
            |i: f32| 0.03 * (i / 20.0).sin(),
            |i: f32| if i < 30.0 { 0.0 } else { 0.03 },
        ] {
            let drift = after(60, 0.0, |i| (moved(i), moved(i)));
            assert!(drift.std() * 1.96 > moved(59.0).abs(), "{drift:?}");
            assert!(drift.std() < 0.04 && drift.mean_std() < drift.std(), "{drift:?}");
        }
    }

    #[test]
    fn friction_is_no_drift() {
        let slow = |i: f32| 0.1 * (i / 20.0).sin();
        for (what, drift) in [
            ("steady", after(400, 0.0, |_| (0.0, 0.0))),
            ("scatters", after(400, 0.1, |_| (0.0, 0.0))),
            ("mu_s alone", after(100, 0.0, |i| (slow(i), 0.0))),
            ("mu alone", after(100, 0.0, |i| (0.0, slow(i)))),
            ("in proportion", after(100, 0.0, |i| (1.24 * slow(i), 0.78 * slow(i)))),
        ] {
            // Less than a twentieth of what friction does.
            assert!(drift.std() < 0.004, "{what}: {drift:?}");
        }
    }

    #[test]
    fn a_scatter_hides_what_is_smaller_and_not_what_is_larger() {
        let drifts = |size: f32| after(300, 0.02, |i| (size * i / 300.0, size * i / 300.0)).std();
        assert!(drifts(0.002) < STD && drifts(0.1) > 0.05, "{} {}", drifts(0.002), drifts(0.1));
    }

    #[test]
    fn what_is_no_number_is_left_out() {
        let mut drift = after(20, 0.0, |_| (0.0, 0.0));
        let odd = |value, std| Coefficient::random(value, std);
        drift.take(odd(f32::NAN, STD), odd(0.78, STD));
        drift.take(odd(1.24, f32::INFINITY), odd(0.78, STD));
        assert!(drift.std().abs() < STD && drift.spans[0].last[0].is_finite());
    }
}
