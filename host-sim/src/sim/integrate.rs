//! Numerical integration of the block on a cable, where the closed form does not hold: Verner's
//! adaptive Runge-Kutta method of order 9(8) with its dense output of order 8, from the crate
//! `differential-equations`.
//!
//! The dense output of a step is kept as a polynomial of degree 9; onset, stop, slack and taut are
//! roots of that polynomial. (The dense output of the crate's Dormand-Prince 8(5,3) is four digits
//! less accurate than its steps.)

use differential_equations::error::Error;
use differential_equations::interpolate::Interpolation;
use differential_equations::methods::{Adaptive, ExplicitRungeKutta, Ordinary};
use differential_equations::ode::{ODE, OrdinaryNumericalMethod};
use differential_equations::status::Status;

use super::physics::Physics;
use super::state::{End, Phase, State};
use super::step::{COUNT, NODES, Step, Vector, to_state, to_vector};

/// Default relative tolerance of a step.
pub const TOLERANCE: f64 = 5e-14;

pub(super) type Method = ExplicitRungeKutta<Ordinary, Adaptive, f64, Vector, 9, 16, 21>;

/// Equations (2) and (3) with all terms. The time counts from the start of the phase.
struct Equations<'a> {
    physics: &'a Physics,
    phase: Phase,
    from: State,
}

impl ODE<f64, Vector> for Equations<'_> {
    fn diff(&self, t: f64, y: &Vector, dydt: &mut Vector) {
        let physics = self.physics;
        let state = State { time_s: self.from.time_s + t, ..self.from };
        let state = to_state(self.phase, *y, state);
        let (v, x, age) = (state.speed_m_per_s, state.position_m, state.contact_s);
        let winch = physics.winch_m_per_s(state.time_s);
        let accelerate =
            |force_n: f64| (force_n - physics.resistance_n(&state)) / physics.mass_kg();
        let stiffness = || physics.stiffness_n_per_m(state.force_n, x);
        let ageing = |v: f64| physics.ageing(v, age);
        *dydt = match self.phase {
            Phase::Stick => {
                let creep = physics.creep_m_per_s(&state);
                [stiffness() * (winch - creep), 0.0, creep, ageing(creep)]
            }
            Phase::Slip => {
                let faster = accelerate(state.force_n);
                let lost = physics.damping_n_s_per_m() * faster;
                [stiffness() * (winch - v) - lost, faster, v, ageing(v)]
            }
            Phase::SlackSliding => [v - winch, accelerate(0.0), v, ageing(v)],
            Phase::SlackStuck => [-winch, 0.0, 0.0, ageing(0.0)],
        };
    }
}

/// Result of one step.
#[derive(Clone, Copy, Debug)]
pub struct Advance {
    /// The step.
    pub step: Step,
    /// State at the end of the step.
    pub to: State,
    /// Why the step ended.
    pub end: End,
    /// Whether the phase continues with the same laws.
    pub goes_on: bool,
    /// Mean force of resistance over the distance, N.
    pub mean_resistance_n: f64,
    /// Mean dynamic coefficient over the distance.
    pub mean_mu: f64,
}

/// Integrator of one phase.
pub struct Integrator {
    phase: Phase,
    from: State,
    limits: Limits,
    /// Boxed because of its size; without `Debug`.
    method: Box<Method>,
}

impl std::fmt::Debug for Integrator {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Integrator").field("phase", &self.phase).finish_non_exhaustive()
    }
}

/// Tolerances and longest step of a phase.
#[derive(Clone, Copy, Debug)]
struct Limits {
    relative: f64,
    absolute: Vector,
    first_s: f64,
    longest_s: f64,
}

impl Limits {
    fn new(phase: Phase, from: &State, physics: &Physics, relative: f64) -> Self {
        let mechanics = physics.mechanics(from);
        let omega = mechanics.omega_rad_per_s();
        let reach_n = mechanics.reference_static_force_n.min(1e3 * mechanics.weight_n);
        let speed = mechanics.winch_m_per_s.abs() + reach_n / (omega * mechanics.mass_kg);
        let u = match phase {
            Phase::Stick | Phase::Slip => mechanics.weight_n,
            Phase::SlackSliding | Phase::SlackStuck => speed / omega,
        };
        // A quarter of a stick, or a turn of the ellipse: longer steps resolve nothing.
        let stick_s = mechanics.weight_n / mechanics.loading_rate_n_per_s().abs();
        let longest_s = (0.25 * stick_s).max(6.0 / omega).min(1e6);
        let longest_s = longest_s.min(physics.longest_step_s());
        Self {
            relative,
            absolute: [u, speed, speed / omega, 1e-3].map(|scale| scale * relative),
            first_s: (0.05 / omega).min(longest_s),
            longest_s,
        }
    }

    fn method(&self, equations: &Equations, t: f64, y: &Vector) -> Result<Method, String> {
        let mut method = verner_9(self.relative, self.absolute, self.longest_s).h0(self.first_s);
        method.init(equations, t, t + 1e12, y).map_err(|e| explain(&e))?;
        Ok(method)
    }
}

/// The method with its tolerances and longest step.
pub(super) fn verner_9(relative: f64, absolute: Vector, longest_s: f64) -> Method {
    ExplicitRungeKutta::rkv988e()
        .rtol(relative)
        .atol(absolute)
        .h_max(longest_s)
        .max_steps(usize::MAX)
        .max_rejects(1000)
}

/// Repeats a step until it is accepted.
pub(super) fn accepted_step(
    method: &mut Method,
    equations: &impl ODE<f64, Vector>,
) -> Result<(), String> {
    loop {
        method.step(equations).map_err(|e| explain(&e))?;
        if !matches!(method.status(), Status::RejectedStep) {
            return Ok(());
        }
    }
}

pub(super) fn explain(error: &Error<f64, Vector>) -> String {
    format!("the integrator gave up: {error:?}")
}

impl Integrator {
    /// Starts a phase.
    ///
    /// # Errors
    /// The method cannot start.
    pub fn new(
        phase: Phase,
        from: State,
        physics: &Physics,
        tolerance: f64,
    ) -> Result<Self, String> {
        let limits = Limits::new(phase, &from, physics, tolerance);
        let equations = Equations { physics, phase, from };
        let method = limits.method(&equations, 0.0, &to_vector(phase, &from))?;
        Ok(Self { phase, from, limits, method: Box::new(method) })
    }

    /// Takes one step, at most up to the time `until_s`.
    ///
    /// # Errors
    /// The method cannot continue.
    pub fn advance(&mut self, physics: &Physics, until_s: f64) -> Result<Advance, String> {
        let equations = Equations { physics, phase: self.phase, from: self.from };
        let method = &mut self.method;
        let start_s = method.t();
        let left_s = until_s - self.from.time_s - start_s;
        if method.h() >= left_s {
            method.set_h(left_s);
        }
        accepted_step(method, &equations)?;
        let step = dense(method, self.phase, start_s)?;
        let mut advance = self.find_end(step, start_s, &equations)?;
        // Rounding must not leave a remainder too short for a step.
        if until_s.is_finite() && (until_s - advance.to.time_s).abs() <= 1e-12 * until_s {
            advance.to.time_s = until_s;
        }
        Ok(advance)
    }

    fn find_end(&self, step: Step, start_s: f64, equations: &Equations) -> Result<Advance, String> {
        let physics = equations.physics;
        let start = State { time_s: self.from.time_s + start_s, ..self.from };
        let event = first_event(&step, &start, physics);
        let kink = first_kink(&step, &start, physics);
        let (fraction, end, to) = match (event, kink) {
            (Some((fraction, end)), kink) if kink.is_none_or(|k| fraction <= k) => {
                (fraction, end, self.polish(&step, start_s, fraction, end, equations)?)
            }
            (_, kink) => {
                let fraction = kink.unwrap_or(1.0);
                (fraction, End::Continue, step.state(&start, fraction * step.length_s))
            }
        };
        let goes_on = event.is_none() && kink.is_none();
        let (mean_resistance_n, mean_mu) = if self.phase.is_moving() {
            step.averages(physics, &start, fraction)
        } else {
            (0.0, 0.0)
        };
        let to = settle(end, to, physics);
        Ok(Advance { step, to, end, goes_on, mean_resistance_n, mean_mu })
    }

    /// Refines an event: the dense output is accurate to about 1e-12; a separate step to the event
    /// and one Newton step there give time and state to rounding.
    fn polish(
        &self,
        step: &Step,
        start_s: f64,
        fraction: f64,
        end: End,
        equations: &Equations,
    ) -> Result<State, String> {
        let length_s = fraction * step.length_s;
        let mut y = step.values(fraction);
        if length_s > 0.0 {
            let mut method = self.limits.method(equations, start_s, &step.values(0.0))?;
            method.set_h(length_s);
            method.step(equations).map_err(|e| explain(&e))?;
            if !matches!(method.status(), Status::RejectedStep) {
                y = *method.y();
            }
        }
        let value = |t: f64, y: Vector| {
            let state = State { time_s: self.from.time_s + start_s + t, ..self.from };
            event_value(end, &to_state(self.phase, y, state), equations.physics)
        };
        let near = 1e-3;
        let before = value((fraction - near) * step.length_s, step.values(fraction - near));
        let after = value((fraction + near) * step.length_s, step.values(fraction + near));
        let slope = (after - before) / (2.0 * near * step.length_s);
        let shift_s = -value(length_s, y) / slope;
        let mut t = length_s;
        // At the very start of a step the correction must not lead to a time before it.
        if shift_s.abs() < 1e-6 * step.length_s && t + shift_s >= 0.0 {
            let mut rate = [0.0; 4];
            equations.diff(start_s + t, &y, &mut rate);
            for (value, rate) in y.iter_mut().zip(rate) {
                *value += rate * shift_s;
            }
            t += shift_s;
        }
        let state = State { time_s: self.from.time_s + start_s + t, ..self.from };
        Ok(to_state(self.phase, y, state))
    }
}

fn dense(method: &mut Method, phase: Phase, start_s: f64) -> Result<Step, String> {
    let mut at_nodes = at_nodes(method, start_s)?;
    // The ends are the exact values of the method, without the rounding of the dense output.
    at_nodes[0] = *method.y_prev();
    at_nodes[COUNT - 1] = *method.y();
    Ok(Step::new(phase, method.t() - start_s, at_nodes))
}

/// The dense output of the last step, which began at `start_s`.
pub(super) fn at_nodes(method: &mut Method, start_s: f64) -> Result<[Vector; COUNT], String> {
    let (end_s, mut at_nodes) = (method.t(), [[0.0; 4]; COUNT]);
    for (node, values) in NODES.iter().zip(&mut at_nodes) {
        let t = (start_s + node * (end_s - start_s)).min(end_s);
        *values = method.interpolate(t).map_err(|e| explain(&e))?;
    }
    Ok(at_nodes)
}

/// A function of the state that falls through zero at an event.
fn event_value(end: End, state: &State, physics: &Physics) -> f64 {
    match end {
        End::Onset => physics.mechanics(state).static_force_n(state) - state.force_n,
        End::Stop => state.speed_m_per_s - physics.rest_m_per_s(),
        End::Slack => state.force_n,
        End::Taut => state.slack_m,
        End::Continue => 1.0,
    }
}

/// The position in a step, as a fraction, where the cable passes the kink of its stiffness.
fn first_kink(step: &Step, start: &State, physics: &Physics) -> Option<f64> {
    let pulled = matches!(step.phase, Phase::Stick | Phase::Slip) && physics.has_kink();
    let to_kink = |_: f64, y: &Vector| physics.to_kink_n(&to_state(step.phase, *y, *start));
    if pulled { step.first_fall(to_kink) } else { None }
}

/// The first event in a step, at a fraction of its length.
fn first_event(step: &Step, start: &State, physics: &Physics) -> Option<(f64, End)> {
    let possible: &[End] = match step.phase {
        Phase::Stick if physics.winch_m_per_s(start.time_s) < 0.0 => &[End::Onset, End::Slack],
        Phase::Stick => &[End::Onset],
        Phase::Slip => &[End::Slack, End::Stop],
        Phase::SlackSliding => &[End::Taut, End::Stop],
        Phase::SlackStuck => &[End::Taut],
    };
    let fall = |end: End| {
        let value = |fraction: f64, y: &Vector| {
            let time_s = start.time_s + fraction * step.length_s;
            event_value(end, &to_state(step.phase, *y, State { time_s, ..*start }), physics)
        };
        step.first_fall(value).map(|fraction| (fraction, end))
    };
    let events = possible.iter().filter_map(|&end| fall(end));
    events.min_by(|a, b| a.0.total_cmp(&b.0))
}

/// Sets the state variables that an event fixes to their exact values.
fn settle(end: End, to: State, physics: &Physics) -> State {
    match end {
        End::Onset => State { speed_m_per_s: physics.onset_speed_m_per_s(to.time_s), ..to },
        End::Stop => State { speed_m_per_s: 0.0, rest_since_s: to.time_s, ..to },
        End::Slack => State { force_n: 0.0, ..to },
        End::Taut => {
            let stretching = physics.winch_m_per_s(to.time_s) - to.speed_m_per_s;
            let force_n = physics.damping_n_s_per_m() * stretching.max(0.0);
            State { slack_m: 0.0, force_n, ..to }
        }
        End::Continue => to,
    }
}
