//! The model's equations compared with integration of Newton's law in small steps.
//!
//! Every quantity of the closed forms, in the core (single precision) and in the simulator
//! (double), over a grid of blocks, cables, winches, frictions and slopes. Numbers in parentheses
//! are equation numbers of the paper.

use floe_core::model::{self, CycleParams};
use floe_core::num::math;
use floe_core::units::STANDARD_GRAVITY_M_PER_S2 as GRAVITY_M_PER_S2;
use floe_tests::brute::{Block, Pull, State, Truth};

mod corner;
mod simulator;
mod slack;

/// Largest relative error of the core: a few roundings in single precision.
const SINGLE: f64 = 1e-6;

/// The grid of cases.
fn cases() -> Vec<Pull> {
    let mut cases = Vec::new();
    for weight_n in [300.0, 3000.0] {
        for stiffness_n_per_m in [2.3e3, 23e3, 230e3] {
            for winch_m_per_s in [0.001, 360.0 / 23e3, 0.04] {
                for difference in [0.004, 0.1, 0.46, 0.9] {
                    for slope_deg in [-6.0_f64, 0.0, 6.0] {
                        let mut pull = Pull {
                            weight_n,
                            stiffness_n_per_m,
                            winch_m_per_s,
                            mu_s: 0.78 + difference,
                            slope_rad: slope_deg.to_radians(),
                            gravity_m_per_s2: GRAVITY_M_PER_S2,
                            ..Pull::default()
                        };
                        pull.step_s = 0.02 / omega(&pull);
                        cases.push(pull);
                    }
                }
            }
        }
    }
    cases
}

fn omega(pull: &Pull) -> f64 {
    (pull.stiffness_n_per_m * pull.gravity_m_per_s2 / pull.weight_n).sqrt()
}

/// Parameters of the core's closed form for a case, in seconds.
fn closed(pull: &Pull) -> CycleParams {
    let drop_n = pull.weight_n * pull.slope_rad.cos() * (pull.mu_s - pull.mu);
    CycleParams {
        onset: 0.0,
        rate: (pull.stiffness_n_per_m * pull.winch_m_per_s) as f32,
        static_n: pull.resistance_n(pull.mu_s) as f32,
        half_drop_n: drop_n as f32,
        omega: omega(pull) as f32,
        rate_change: 0.0,
    }
}

/// Two events from integration in small steps, and the sliding states of the first.
struct Brute {
    events: [Truth; 2],
    slip: Vec<State>,
}

/// Force at the start of the tests, N: well below `Fs`, with a taut cable.
fn start_n(pull: &Pull) -> f64 {
    (pull.resistance_n(2.0 * pull.mu - pull.mu_s)).max(0.0)
}

fn brute(pull: &Pull) -> Brute {
    let mut block = Block::resting(pull, start_n(pull));
    let (mut events, mut slip) = (Vec::new(), Vec::new());
    while events.len() < 2 {
        let event = block.step(pull, pull.step_s);
        if events.is_empty() && block.state.sliding {
            slip.push(block.state);
        }
        events.extend(event);
    }
    Brute { events: [events[0], events[1]], slip }
}

#[track_caller]
fn agree(equation: &str, got: f64, brute: f64, tolerance: f64, pull: &Pull) {
    let error = (got - brute).abs();
    assert!(error <= tolerance, "{equation}: {got} but by small steps {brute}, {pull:?}");
}

/// Runs a check on every case whose cable goes slack, or on all others.
fn for_each(slack: bool, at_least: usize, check: impl Fn(&Pull, &Brute)) {
    let mut count = 0;
    for pull in cases() {
        let brute = brute(&pull);
        if brute.events[0].slack == slack {
            check(&pull, &brute);
            count += 1;
        }
    }
    println!("{count} cases");
    assert!(count >= at_least, "only {count} cases");
}

#[test]
fn core_forces_and_times_of_a_cycle() {
    for_each(false, 100, |pull, brute| {
        let (cycle, [event, next]) = (closed(pull), brute.events);
        let force = SINGLE * event.peak_n;
        let agree = |equation: &str, got: f32, brute, tolerance| {
            agree(equation, got.into(), brute, tolerance, pull);
        };
        let amplitude_n = event.peak_n - pull.resistance_n(pull.mu);
        agree("(10) amplitude", cycle.amplitude_n(), amplitude_n, force);
        agree("(10) peak force", cycle.peak_n(), event.peak_n, force);
        agree("(16) re-stick force", cycle.restick_n(), event.restick_n, force);
        let rest_s = next.onset_s - event.stop_s;
        agree("(22) time of rest", cycle.rest_time(), rest_s, SINGLE * rest_s);
        let slide_s = event.stop_s - event.onset_s;
        agree("(25) time of sliding", cycle.slide_time(), slide_s, SINGLE * slide_s);
    });
}

#[test]
fn core_speed_and_ellipse_along_a_slip() {
    for_each(false, 100, |pull, brute| {
        let (cycle, onset_s) = (closed(pull), brute.events[0].onset_s);
        let (amplitude_n, omega) = (f64::from(cycle.amplitude_n()), omega(pull));
        let (k, w) = (pull.stiffness_n_per_m, pull.winch_m_per_s);
        let shape = cycle.shape();
        // Rounding of the angle and of the force, relative to the ellipse.
        let rounding = SINGLE * (4.0 + brute.events[0].peak_n / amplitude_n);
        for state in &brute.slip {
            let (force_n, gradient) = shape.force((state.time_s - onset_s) as f32);
            let force_error_n = rounding * amplitude_n;
            agree("(7) force", force_n.into(), pull.force_n(state), force_error_n, pull);
            let speed = model::speed_m_per_s(w as f32, k as f32, -gradient[0]);
            let speed_error = rounding * omega * amplitude_n / k;
            agree("(13) speed", speed.into(), state.speed_m_per_s, speed_error, pull);
            let across = (pull.force_n(state) - f64::from(cycle.dynamic_n())) / amplitude_n;
            let along = k * (w - state.speed_m_per_s) / (omega * amplitude_n);
            agree("(15) ellipse", 1.0, across.hypot(along), rounding, pull);
        }
    });
}

/// Both pieces meet the stick line with its slope: difference quotients of the integrated force on
/// both sides of the stop agree with `k w`.
#[test]
fn core_rate_at_the_stop() {
    for_each(false, 100, |pull, brute| {
        let (cycle, event) = (closed(pull), brute.events[0]);
        let last = brute.slip[brute.slip.len() - 1];
        let sliding = pull.moved(pull.mu, &last, event.stop_s - last.time_s);
        let h = 1e-4 / omega(pull);
        let quotient = |state: &State, h: f64| {
            (pull.force_n(&pull.moved(pull.mu, state, h)) - pull.force_n(state)) / h
        };
        let curved = omega(pull) * f64::from(cycle.amplitude_n()) * 1e-4;
        let resting = State { sliding: false, speed_m_per_s: 0.0, ..sliding };
        for (state, h) in [(sliding, -h), (resting, h)] {
            let brute = quotient(&state, h);
            agree("(18) rate at the stop", cycle.rate.into(), brute, curved, pull);
        }
        let before = cycle.shape().force(cycle.slide_time() * (1.0 - 1e-6)).1[0];
        agree("(18) rate of the ellipse", (-before).into(), cycle.rate.into(), curved, pull);
    });
}

/// Coefficients from integrated forces on a slope, which adds a component of gravity.
#[test]
fn core_coefficients_on_a_slope() {
    for_each(false, 100, |pull, brute| {
        let event = brute.events[0];
        let read = |force_n: f64| {
            let (weight, slope) = (pull.weight_n as f32, math::sin_cos(pull.slope_rad as f32));
            f64::from(model::coefficient(force_n as f32, weight, slope))
        };
        agree("(28) mu_s", read(event.static_n), pull.mu_s, SINGLE, pull);
        let centre_n = 0.5 * (event.static_n + event.restick_n);
        agree("(28) mu", read(centre_n), pull.mu, SINGLE, pull);
    });
}

/// Least speed by integration beyond the stop, compared with the inequality.
#[test]
fn core_least_speed() {
    for_each(false, 100, |pull, brute| {
        let cycle = closed(pull);
        let mut state = brute.slip[0];
        let mut least = 0.0_f64;
        while state.time_s < brute.slip[0].time_s + 8.0 / omega(pull) {
            state = pull.moved(pull.mu, &state, pull.step_s);
            least = least.min(state.speed_m_per_s);
        }
        let (k, w) = (pull.stiffness_n_per_m, pull.winch_m_per_s);
        let got = model::least_speed_m_per_s(&cycle, w as f32, k as f32);
        let size = omega(pull) * f64::from(cycle.amplitude_n()) / k;
        // The lowest of states at distances of 0.02 rad.
        agree("(31) least speed", got.into(), least, 1e-4 * size, pull);
        assert!(got < 0.0, "(31): the block sticks again, {pull:?}");
    });
}
