//! Slip on a slack cable. A cable does not push: where the ellipse would go below zero it hangs
//! slack.
//!
//! With `h² = a² − Fp²` the force reaches zero at the angle `π + φ − ψ`, `ψ = atan(h / Fp)`,
//! falling at `ω h`. The block then moves with `k v = ω (q + h)` and is decelerated by friction
//! alone, `k dv/dt = −ω² Fp`.
//!
//! ```text
//!  h > q: it stops before the winch has caught up     h ≤ q: the winch catches it moving
//!
//!     ╲                    ╱                             ╲                  ╱
//!      ╲                  ╱  k w                          ╲               ╱  stop, at
//!  ─────╲________________╱──── F = 0                  ─────╲_______......╱   2 Fp − Fs
//!      falls    stop   rises                              falls   catches  from the
//!                                                                          mirror point
//! ```
//!
//! - It stops `(q + h) / (ω Fp)` after the fall, with a slack of `(q + h)² / (2 Fp)` in units
//!   of force; the winch takes that up at the rate `ω q`. So the time at zero force determines
//!   `Fp`, without `k` and the weight.
//! - Or it is caught `2 h / (ω Fp)` after the fall with the force rising at `ω h`, and the
//!   same ellipse goes on from the mirror point of the fall. The rest of the cycle is later
//!   by `2 (z − atan z) / ω`, `z = h / Fp`.
//!
//! Both forms agree at `h = q`; without slack, `h = 0`, the delay is zero. Exactness:
//! `tests/equations/main.rs`.

use crate::model::CycleParams;
use crate::num::math::{self, larger};

/// Derivatives by the loading rate, `Fs`, `d` and the swing.
pub(crate) type ByShape = [f32; 4];

/// The slack of one cycle; times are since the onset, in the cycle's unit of time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Slack {
    /// Time at which the cable is taut again.
    pub(crate) taut: f32,
    /// What the block does when the cable is taut again.
    pub(crate) then: Then,
}

/// What the block does when the cable is taut again.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Then {
    /// It rests: a stick line from zero. Derivatives of the time at which it starts.
    Rests(ByShape),
    /// It still slides, on the ellipse with this delay; derivatives of the delay.
    Slides(f32, ByShape),
}

/// An angle on the ellipse with its derivatives by `q`, `Fp` and `d`.
struct Angle {
    value: f32,
    by_q: f32,
    by_centre: f32,
    by_drop: f32,
}

impl Slack {
    /// The slack, with the times at which the force reaches zero and at which the block has come to
    /// rest. `None` if the cable stays taut, or if no friction would stop the block.
    pub(crate) fn of(cycle: &CycleParams, q: f32, a2: f32, phase: f32) -> Option<(Self, f32, f32)> {
        let centre_n = cycle.dynamic_n();
        if a2 <= centre_n * centre_n || centre_n <= 0.0 {
            return None;
        }
        let h = math::sqrt(a2 - centre_n * centre_n);
        let ellipse = Ellipse { drop_n: cycle.half_drop_n, q, h, centre_n, a2 };
        let inverse_omega = cycle.inverse_omega();
        let until = math::atan2(h, centre_n);
        let falls = core::f32::consts::PI + phase - until;
        if h > q {
            let rise = ellipse.rise(falls);
            let stop = inverse_omega * (falls + (q + h) / centre_n);
            let taut = inverse_omega * rise.value;
            let then = Then::Rests(rise.time(q, inverse_omega));
            Some((Self { taut, then }, inverse_omega * falls, stop))
        } else {
            let delay = ellipse.delay(until);
            let turn = core::f32::consts::PI + 2.0 * phase + delay.value;
            let taut = inverse_omega * (falls + 2.0 * h / centre_n);
            let then = Then::Slides(inverse_omega * delay.value, delay.time(q, inverse_omega));
            Some((Self { taut, then }, inverse_omega * falls, inverse_omega * turn))
        }
    }
}

/// The ellipse of a slip that goes slack: half the drop, `q`, `h = √(a² − Fp²)` and `Fp`, N, and
/// `a²`, N².
struct Ellipse {
    drop_n: f32,
    q: f32,
    h: f32,
    centre_n: f32,
    a2: f32,
}

impl Ellipse {
    /// Angle `π + φ − ψ + (q + h)² / (2 Fp q)` at which the slack is taken up.
    fn rise(&self, falls: f32) -> Angle {
        let Self { drop_n: d, q, h, centre_n, a2 } = *self;
        let caught = (q + h) / (centre_n * q);
        let taken_up = 0.5 * caught * (q + h);
        // By h at fixed q and Fp, then h by each of them.
        let by_h = caught - centre_n / a2;
        Angle {
            value: falls + taken_up,
            by_q: d / a2 + caught - taken_up / q + by_h * q / h,
            by_centre: h / a2 - taken_up / centre_n - by_h * centre_n / h,
            by_drop: -q / a2 + by_h * d / h,
        }
    }

    /// Angle `2 (z − atan z)` by which the ellipse is delayed.
    fn delay(&self, until: f32) -> Angle {
        let Self { drop_n: d, q, h, centre_n, a2 } = *self;
        let part = 2.0 * h / (a2 * centre_n);
        Angle {
            value: 2.0 * larger(h / centre_n - until, 0.0),
            by_q: part * q,
            by_centre: -2.0 * h / (centre_n * centre_n),
            by_drop: part * d,
        }
    }
}

impl Angle {
    /// Derivatives of the time in which the phase advances by this angle.
    fn time(&self, q: f32, inverse_omega: f32) -> ByShape {
        [
            inverse_omega * inverse_omega * self.by_q,
            inverse_omega * self.by_centre,
            inverse_omega * (self.by_drop - self.by_centre),
            self.value + q * self.by_q,
        ]
    }
}

#[cfg(test)]
mod tests {
    use crate::model::CycleParams;

    /// In sampling periods: at rest on a slack cable, and caught sliding.
    fn rests() -> CycleParams {
        let (static_n, half_drop_n) = (630.0, 378.0);
        CycleParams { onset: 3.3, rate: 22.5, static_n, half_drop_n, omega: 1.18, rate_change: 0.5 }
    }

    fn slides() -> CycleParams {
        let (static_n, half_drop_n) = (504.0, 250.0);
        CycleParams {
            onset: 3.3,
            rate: 260.0,
            static_n,
            half_drop_n,
            omega: 1.18,
            rate_change: -3.0,
        }
    }

    fn moved(mut c: CycleParams, unknown: usize, by: f32) -> CycleParams {
        let mut inverse_omega = c.inverse_omega();
        let unknowns = [
            &mut c.onset,
            &mut c.rate,
            &mut c.static_n,
            &mut c.half_drop_n,
            &mut inverse_omega,
            &mut c.rate_change,
        ];
        unknowns.into_iter().skip(unknown).take(1).for_each(|value| *value += by);
        c.omega = 1.0 / inverse_omega;
        c
    }

    #[test]
    fn the_gradient_is_the_difference_quotient() {
        let steps = [1e-3, 0.02, 0.05, 0.05, 3e-4, 0.05];
        let times = [[4.5, 5.0, 7.0, 14.0, 20.0], [4.5, 6.3, 6.9, 8.0, 12.0]];
        for (cycle, times) in [(rests(), times[0]), (slides(), times[1])] {
            for time in times {
                let (_, gradient) = cycle.shape().force(time);
                for (i, step) in steps.into_iter().enumerate() {
                    let at = |by: f32| moved(cycle, i, by).shape().force(time).0;
                    let quotient = (at(step) - at(-step)) / (2.0 * step);
                    let error = (gradient[i] - quotient).abs();
                    let largest = 0.01 * gradient[i].abs() + 0.1 * cycle.rate / 22.5;
                    assert!(error < largest, "{time} {i}: {} {quotient}", gradient[i]);
                }
            }
        }
    }

    /// From taut over just slack and caught sliding to resting on a slack cable: no
    /// force jumps, at any time.
    #[test]
    fn the_force_changes_evenly_with_the_drop() {
        let with = |half_drop_n: f32| CycleParams { half_drop_n, rate_change: 0.0, ..slides() };
        for time in [6.0, 6.5, 7.0, 7.5, 9.0] {
            let mut last = with(120.0).shape().force(time);
            for step in 1..=800 {
                let half_drop_n = 120.0 + 0.25 * step as f32;
                let now = with(half_drop_n).shape().force(time);
                let slope = last.1[3].abs().max(now.1[3].abs());
                let most = 0.25 * slope * 1.2 + 0.05;
                assert!((now.0 - last.0).abs() < most, "{time} {half_drop_n}: {now:?} {last:?}");
                last = now;
            }
        }
        assert!(!with(120.0).shape().is_slack() && with(320.0).shape().is_slack());
    }

    #[test]
    fn the_stick_line_starts_where_the_cable_is_taut() {
        for cycle in [rests(), slides()] {
            let shape = cycle.shape();
            let at = |time: f32| shape.force(time).0;
            let loads = shape.loads();
            assert!((at(loads + 1.0) - at(loads) - cycle.rate - cycle.rate_change).abs() < 0.01);
            assert!((at(loads) - cycle.restick_n()).abs() < 0.01);
            assert!(shape.stop() <= loads);
        }
        assert!(rests().restick_n() < 1e-6 && rests().shape().stop() < rests().shape().loads());
    }
}
