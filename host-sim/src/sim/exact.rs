//! The linear block on a cable in closed form, from event to event.
//!
//! Within a phase the motion is a line, an ellipse or a parabola, and the time of its end is an
//! arctangent or a quotient: without time steps or iterations, and accurate to rounding. Angles on
//! the ellipse are `atan2` of quantities formed without cancellation, so that `Fs - Fp` may be tiny
//! and the cable may just touch `F = 0`.

use std::f64::consts::PI;

use super::root;
use super::state::{End, Mechanics, Phase, State};
use super::step::Step;

/// A piece of motion in closed form.
#[derive(Clone, Debug, PartialEq)]
pub enum Motion {
    /// A step of the numerical integrator, not in closed form; boxed because of its size.
    Step(Box<Step>),
    /// `F = F0 + k w t`, the block at rest.
    Line {
        /// `k w`, N/s.
        rate_n_per_s: f64,
    },
    /// `F = Fp + A cos omega t + B sin omega t` (7), on a taut cable.
    Ellipse {
        /// Centre `Fp`, N.
        centre_n: f64,
        /// `A = F0 - Fp`, N.
        cosine_n: f64,
        /// `B = k (w - v0) / omega`, N.
        sine_n: f64,
        /// `omega`, rad/s.
        omega_rad_per_s: f64,
        /// `k`, N/m.
        stiffness_n_per_m: f64,
        /// `w`, m/s.
        winch_m_per_s: f64,
    },
    /// `F = 0` while the block, if it moves, slows down by friction alone.
    Slack {
        /// `Fp / M`, m/s²; zero for a block at rest.
        deceleration_m_per_s2: f64,
        /// `w`, m/s.
        winch_m_per_s: f64,
    },
}

impl Motion {
    /// The motion that starts from `phase` under `mechanics`.
    #[must_use]
    pub fn start(phase: Phase, from: &State, mechanics: &Mechanics) -> Self {
        let winch_m_per_s = mechanics.winch_m_per_s;
        match phase {
            Phase::Stick => Self::Line { rate_n_per_s: mechanics.loading_rate_n_per_s() },
            Phase::Slip => {
                let omega = mechanics.omega_rad_per_s();
                let k = mechanics.stiffness_n_per_m;
                Self::Ellipse {
                    centre_n: mechanics.dynamic_force_n,
                    cosine_n: from.force_n - mechanics.dynamic_force_n,
                    sine_n: k * (winch_m_per_s - from.speed_m_per_s) / omega,
                    omega_rad_per_s: omega,
                    stiffness_n_per_m: k,
                    winch_m_per_s,
                }
            }
            Phase::SlackSliding => Self::Slack {
                deceleration_m_per_s2: mechanics.dynamic_force_n / mechanics.mass_kg,
                winch_m_per_s,
            },
            Phase::SlackStuck => Self::Slack { deceleration_m_per_s2: 0.0, winch_m_per_s },
        }
    }

    /// Force `t` seconds after `from`, N.
    #[must_use]
    pub fn force_n(&self, from: &State, t: f64) -> f64 {
        match *self {
            Self::Step(ref step) => step.state(from, t).force_n,
            Self::Line { rate_n_per_s } => from.force_n + rate_n_per_s * t,
            Self::Ellipse { centre_n, cosine_n, sine_n, omega_rad_per_s, .. } => {
                let (sin, cos) = (omega_rad_per_s * t).sin_cos();
                centre_n + cosine_n * cos + sine_n * sin
            }
            Self::Slack { .. } => 0.0,
        }
    }

    /// The state `t` seconds after `from`.
    #[must_use]
    pub fn state(&self, from: &State, t: f64) -> State {
        if let Self::Step(step) = self {
            return step.state(from, t);
        }
        let force_n = self.force_n(from, t);
        let next = State { time_s: from.time_s + t, force_n, ..*from };
        match *self {
            Self::Line { .. } | Self::Step(_) => next,
            Self::Ellipse {
                cosine_n,
                sine_n,
                omega_rad_per_s: omega,
                stiffness_n_per_m: k,
                winch_m_per_s: winch,
                ..
            } => {
                let (sin, cos) = (omega * t).sin_cos();
                let slope = omega * (sine_n * (cos - 1.0) - cosine_n * sin);
                State {
                    // v = w - F'/k (3), integrated from the start.
                    speed_m_per_s: from.speed_m_per_s - slope / k,
                    position_m: from.position_m + winch * t - (force_n - from.force_n) / k,
                    ..next
                }
            }
            Self::Slack { deceleration_m_per_s2, winch_m_per_s } => {
                let way = (from.speed_m_per_s - 0.5 * deceleration_m_per_s2 * t) * t;
                State {
                    speed_m_per_s: from.speed_m_per_s - deceleration_m_per_s2 * t,
                    position_m: from.position_m + way,
                    slack_m: from.slack_m + way - winch_m_per_s * t,
                    ..next
                }
            }
        }
    }
}

/// Duration of `phase` from `from` on, the reason for its end, and the state there. The duration is
/// infinite if nothing ends the phase.
#[must_use]
pub fn finish(phase: Phase, from: &State, mechanics: &Mechanics) -> (f64, End, State) {
    let motion = Motion::start(phase, from, mechanics);
    match phase {
        Phase::Stick => finish_stick(from, mechanics),
        Phase::Slip => finish_slip(&motion, from, mechanics),
        Phase::SlackSliding => finish_slack_sliding(&motion, from, mechanics),
        Phase::SlackStuck => {
            let slack_m = from.slack_m;
            let duration_s = match mechanics.winch_m_per_s {
                w if w < 0.0 => f64::INFINITY,
                w if slack_m > 0.0 => slack_m / w,
                _ => 0.0,
            };
            let end = State { slack_m: 0.0, time_s: from.time_s + duration_s, ..*from };
            (duration_s, End::Taut, end)
        }
    }
}

fn finish_stick(from: &State, mechanics: &Mechanics) -> (f64, End, State) {
    let rate = mechanics.loading_rate_n_per_s();
    if rate < 0.0 && from.force_n < mechanics.static_force_n(from) {
        let duration_s = from.force_n / -rate;
        let end = State { force_n: 0.0, time_s: from.time_s + duration_s, ..*from };
        return (duration_s, End::Slack, end);
    }
    let duration_s = match mechanics.hold {
        None => loading_time_s(from, mechanics, mechanics.reference_static_force_n),
        Some(_) => held_time_s(from, mechanics),
    };
    let time_s = from.time_s + duration_s;
    let limit_n = mechanics.static_force_n(&State { time_s, ..*from });
    let force_n = from.force_n.max(limit_n);
    (duration_s, End::Onset, State { force_n, time_s, ..*from })
}

/// Time until the force reaches a limit.
fn loading_time_s(from: &State, mechanics: &Mechanics, limit_n: f64) -> f64 {
    let missing_n = limit_n - from.force_n;
    if missing_n > 0.0 { missing_n / mechanics.loading_rate_n_per_s() } else { 0.0 }
}

/// Time until the force catches up with a limit that grows with the logarithm of the time of rest.
///
/// While the limit is still its floor `Fp` the gap closes at a constant rate; from there on the gap
/// is a line minus a logarithm, convex, with one sign change.
fn held_time_s(from: &State, mechanics: &Mechanics) -> f64 {
    let rate = mechanics.loading_rate_n_per_s();
    let at = |t: f64| State { time_s: from.time_s + t, ..*from };
    let gap_n = |t: f64| from.force_n + rate * t - mechanics.static_force_n(&at(t));
    let floor_s = loading_time_s(from, mechanics, mechanics.dynamic_force_n);
    if gap_n(floor_s) >= 0.0 || rate <= 0.0 {
        return if rate > 0.0 { floor_s } else { f64::INFINITY };
    }
    let mut late_s = 2.0 * floor_s + 1.0;
    while gap_n(late_s) < 0.0 {
        late_s *= 2.0;
    }
    root::crossing(gap_n, floor_s, late_s)
}

/// Duration and end of a slip, from the angles on the ellipse at its start and its end.
fn finish_slip(motion: &Motion, from: &State, mechanics: &Mechanics) -> (f64, End, State) {
    let Motion::Ellipse { centre_n, cosine_n, sine_n, omega_rad_per_s: omega, .. } = *motion else {
        return endless(from);
    };
    let rest_n = mechanics.loading_rate_n_per_s() / omega; // F'/omega where v = 0
    let start = start_angle(cosine_n, sine_n);
    let half_length_n = cosine_n.hypot(sine_n);
    if half_length_n > centre_n {
        let under = ((half_length_n - centre_n) * (half_length_n + centre_n)).sqrt();
        let slack_angle = PI - under.atan2(centre_n);
        if slack_angle > start {
            let duration_s = (slack_angle - start) / omega;
            let end = motion.state(from, duration_s);
            return (duration_s, End::Slack, State { force_n: 0.0, slack_m: 0.0, ..end });
        }
    }
    // a² - (k w/omega)²; exactly A² for a slip that starts from rest.
    let moving_n = rest_n - sine_n;
    let chord2 = cosine_n * cosine_n - moving_n * (sine_n + rest_n);
    if chord2 < 0.0 || (chord2 == 0.0 && rest_n == 0.0) {
        return endless(from);
    }
    let chord_n = chord2.sqrt();
    let stop_angle = PI + rest_n.atan2(chord_n);
    let duration_s = ((stop_angle - start) / omega).max(0.0);
    let end = motion.state(from, duration_s);
    let force_n = (centre_n - chord_n).max(0.0);
    (duration_s, End::Stop, at_rest(State { force_n, ..end }))
}

/// The angle of `(A, B)` on the ellipse, in the range in which the block moves forward: from below
/// zero after an onset, beyond pi when the cable is taut again.
fn start_angle(cosine_n: f64, sine_n: f64) -> f64 {
    let angle = sine_n.atan2(cosine_n);
    if angle > 0.5 * PI { 2.0 * PI - angle } else { -angle }
}

fn finish_slack_sliding(motion: &Motion, from: &State, mechanics: &Mechanics) -> (f64, End, State) {
    let deceleration = mechanics.dynamic_force_n / mechanics.mass_kg;
    let v = from.speed_m_per_s;
    let stop_s = v / deceleration;
    // Root of the slack, s + (v - w) t - d t²/2 = 0, without cancellation.
    let excess = v - mechanics.winch_m_per_s;
    let root = (excess * excess + 2.0 * deceleration * from.slack_m).sqrt();
    let taut_s = if excess >= 0.0 {
        (excess + root) / deceleration
    } else {
        2.0 * from.slack_m / (root - excess)
    };
    if taut_s < stop_s {
        let end = motion.state(from, taut_s);
        // Limited to the winch's speed, or rounding would make the cable slack again.
        let speed_m_per_s = end.speed_m_per_s.min(mechanics.winch_m_per_s);
        (taut_s, End::Taut, State { slack_m: 0.0, speed_m_per_s, ..end })
    } else {
        let end = motion.state(from, stop_s);
        (stop_s, End::Stop, at_rest(State { slack_m: end.slack_m.max(0.0), ..end }))
    }
}

/// The end of a block that never stops.
fn endless(from: &State) -> (f64, End, State) {
    (f64::INFINITY, End::Continue, State { time_s: f64::INFINITY, ..*from })
}

fn at_rest(state: State) -> State {
    State { speed_m_per_s: 0.0, rest_since_s: state.time_s, ..state }
}
