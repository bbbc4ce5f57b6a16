//! The equations of the model against Newton's law in small steps.
//!
//! Every number of the closed forms, in the core (single precision) and in the
//! simulator (double), over a grid of blocks, cables, winches, frictions and
//! slopes. Numbers in parentheses are the paper's.

use floe::sim::motion::{Method, Segment, Segments};
use floe::sim::truth::{EventBuilder, TrueEvent};
use floe::sim::{Phase, Scene};
use floe_core::model::corner::Corner;
use floe_core::model::{self, CycleParams};
use floe_core::num::math;
use floe_core::units::STANDARD_GRAVITY_M_PER_S2 as GRAVITY_M_PER_S2;
use floe_tests::brute::{Block, Pull, State, Truth};
use floe_tests::scenes;

/// Largest relative error of the core: a few roundings of single precision.
const SINGLE: f64 = 1e-6;
/// Largest relative error of the simulator: what the small steps leave.
const DOUBLE: f64 = 1e-7;

/// The grid, and where a message says which case failed.
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

/// The case as the core's closed form sees it, in seconds.
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

/// Two events by small steps, and the sliding states of the first.
struct Brute {
    events: [Truth; 2],
    slip: Vec<State>,
}

/// Where the tests start: well below `Fs`, with the cable taut.
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

/// Runs a check on every case whose cable stays taut, or on the others.
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

/// Both pieces meet the stick line with its slope: difference quotients of the
/// integrated force on either side of the stop against `k w`.
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

/// From integrated forces, whose slope enters as a component of gravity.
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

/// The equations of motion carried on past the stop, as the inequality has it.
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
        // The lowest of states 0.02 rad apart.
        agree("(31) least speed", got.into(), least, 1e-4 * size, pull);
        assert!(got < 0.0, "(31): the block sticks again, {pull:?}");
    });
}

/// Blocks whose cable goes slack: long, just so, and only for a moment while the block
/// slides on (a fast winch, `d < Fp < a`).
fn slack_cases() -> Vec<Pull> {
    let mut cases = Vec::new();
    for (mu_s, mu) in [(1.5, 0.3), (1.0, 0.4), (0.85, 0.42), (0.8, 0.41), (0.78, 0.4)] {
        for (weight_n, stiffness_n_per_m) in
            [(300.0, 230e3), (630.0, 23e3), (3000.0, 23e3), (630.0, 2.3e3)]
        {
            for winch_m_per_s in [0.001, 360.0 / 23e3, 0.1, 0.4] {
                for slope_rad in [-0.1, 0.0, 0.1] {
                    let mut pull = Pull {
                        weight_n,
                        stiffness_n_per_m,
                        winch_m_per_s,
                        mu_s,
                        mu,
                        slope_rad,
                        gravity_m_per_s2: GRAVITY_M_PER_S2,
                        ..Pull::default()
                    };
                    pull.step_s = 0.02 / omega(&pull);
                    cases.push(pull);
                }
            }
        }
    }
    cases
}

#[test]
fn core_force_of_a_cable_that_goes_slack() {
    let (mut rested, mut caught) = (0, 0);
    for pull in slack_cases() {
        let mut block = Block::resting(&pull, start_n(&pull));
        let (mut states, mut events) = (Vec::new(), Vec::new());
        while events.is_empty() || !block.state.sliding {
            events.extend(block.step(&pull, pull.step_s));
            states.push(block.state);
        }
        let (event, cycle) = (events[0], closed(&pull));
        assert_eq!(event.slack, cycle.shape().is_slack(), "{pull:?}");
        if !event.slack {
            continue;
        }
        let onset_s = event.onset_s;
        let force_n = SINGLE * event.peak_n;
        agree("re-stick force", cycle.restick_n().into(), event.restick_n, 4.0 * force_n, &pull);
        let slide_s = event.stop_s - onset_s;
        let since_s = slide_s.max(1.0 / omega(&pull));
        agree("slide", cycle.slide_time().into(), slide_s, 4.0 * SINGLE * since_s, &pull);
        let shape = cycle.shape();
        // A time is rounded once where the slack is taken up for long.
        let steepest = omega(&pull) * f64::from(cycle.amplitude_n());
        for state in states.iter().filter(|s| s.time_s > onset_s) {
            let since_s = state.time_s - onset_s;
            let rate = if since_s < slide_s { steepest } else { cycle.rate.into() };
            let tolerance = 8.0 * force_n + 4.0 * SINGLE * rate * since_s;
            let got = shape.force(since_s as f32).0;
            agree("force", got.into(), pull.force_n(state), tolerance, &pull);
        }
        if event.restick_n > 0.0 {
            caught += 1;
        } else {
            rested += 1;
        }
    }
    println!("{rested} rest on a slack cable, {caught} are caught sliding");
    assert!(rested >= 100 && caught >= 10, "{rested} {caught}");
}

/// Pieces of motion of the simulator up to the second stop, and its events.
fn simulated(pull: &Pull) -> (Vec<Segment>, Vec<TrueEvent>) {
    let scene = Scene { start_force_n: start_n(pull), ..scenes::scene(pull) };
    let mut builder = EventBuilder::new(1.0);
    let (mut segments, mut events) = (Vec::new(), Vec::new());
    for segment in Segments::new(&scene, 0, Method::ClosedForm) {
        events.extend(builder.push(&segment));
        segments.push(segment);
        if events.len() == 2 {
            break;
        }
    }
    (segments, events)
}

fn simulator_agrees(pull: &Pull, brute: &Brute) {
    let (segments, events) = simulated(pull);
    let time_s = DOUBLE * brute.events[1].stop_s;
    let force_n = DOUBLE * brute.events[0].peak_n;
    let agree = |equation: &str, got, brute, tolerance| {
        agree(equation, got, brute, tolerance, pull);
    };
    for (event, brute) in events.iter().zip(brute.events) {
        assert_eq!(event.slack, brute.slack, "{pull:?}");
        agree("(22) onset", event.onset_s, brute.onset_s, time_s);
        agree("(25) stop", event.stop_s, brute.stop_s, time_s);
        agree("(1) onset force", event.static_force_n, brute.static_n, force_n);
        agree("(10) peak force", event.peak_force_n, brute.peak_n, force_n);
        agree("(16) re-stick force", event.restick_force_n, brute.restick_n, force_n);
        agree("(28) mu_s", event.mu_s, brute.mu_s, DOUBLE);
        agree("(28) mu", event.mu, brute.mu, DOUBLE);
    }
    let speed = DOUBLE * brute.events[0].top_speed_m_per_s.max(pull.winch_m_per_s);
    for state in &brute.slip {
        let inside = |s: &&Segment| s.phase.is_moving() && s.to.time_s >= state.time_s;
        let Some(segment) = segments.iter().find(inside) else { continue };
        let got = segment.state(state.time_s);
        // Near a stop the times of both differ by their own error.
        agree("(7) force", got.force_n, pull.force_n(state), 10.0 * force_n);
        agree("(13) speed", got.speed_m_per_s, state.speed_m_per_s, 10.0 * speed);
    }
}

#[test]
fn simulator_on_a_taut_cable() {
    for_each(false, 100, simulator_agrees);
}

#[test]
fn simulator_on_a_cable_that_goes_slack() {
    for_each(true, 5, |pull, brute| {
        simulator_agrees(pull, brute);
        let (segments, _) = simulated(pull);
        assert!(segments.iter().any(|s| s.phase == Phase::SlackSliding));
    });
}

/// Test DFF8-13 in sampling periods of 1/16 s.
fn dff8_13() -> CycleParams {
    let (static_n, half_drop_n) = (781.2, 289.8);
    CycleParams { onset: 0.0, rate: 22.5, static_n, half_drop_n, omega: 1.1828, rate_change: 0.0 }
}

/// `F' = r (1 - f exp((F - Fs) / c))` back from the onset, and Newton's law from there on.
#[test]
fn core_force_of_a_creeping_block() {
    const STEP: f64 = 1e-4;
    let cycle = dff8_13();
    let [r, fs, omega] = [cycle.rate, cycle.static_n, cycle.omega].map(f64::from);
    let (fp, shape) = (f64::from(cycle.dynamic_n()), cycle.shape());
    for (f, c) in [(0.2, 30.0), (0.5, 10.0), (0.5, 30.0), (0.8, 60.0)] {
        let missing_n = (-c * f64::ln(1.0 - f)) as f32;
        let corner = Corner { smoothing: 0.0, missing_n, range_n: c as f32 };
        let model = |time: f64| {
            let since_onset = time as f32;
            f64::from(shape.force(since_onset).0 + corner.shift(&shape, since_onset).force_n)
        };
        let creeping = |force_n: f64| r * (1.0 - f * ((force_n - fs) / c).exp());
        let mut force_n = fs;
        for i in 0..60_000 {
            let half = force_n - 0.5 * STEP * creeping(force_n);
            force_n -= STEP * creeping(half);
            let time = -STEP * f64::from(i + 1);
            let error = model(time) - force_n;
            assert!(error.abs() < 1e-3, "f {f}, c {c}: {error} N at {time}");
        }
        let (mut force_n, mut rate, mut time) = (fs, (1.0 - f) * r, 0.0);
        while time < 1.0 || rate < r {
            rate += STEP * omega * omega * (fp - force_n - 0.5 * STEP * rate);
            force_n += STEP * rate;
            time += STEP;
            // The stop is followed to first order: f² q² / 2 d is left.
            let error = model(time) - force_n;
            assert!(error.abs() < 0.45, "f {f}, c {c}: {error} N at {time}");
        }
        let error = model(time + 3.0) - (force_n + 3.0 * r);
        assert!(error.abs() < 0.45, "f {f}, c {c}: {error} N after the stop");
    }
}

/// The mean over an aperture around each moment.
#[test]
fn core_force_that_a_converter_averages() {
    const PIECES: i32 = 400;
    let (cycle, aperture) = (dff8_13(), 0.6);
    let shape = cycle.shape();
    let corner = Corner { smoothing: aperture * aperture / 24.0, missing_n: 0.0, range_n: 30.0 };
    for i in 0..600 {
        let since_onset = 0.01 * i as f32 - 1.5;
        let mean = (0..PIECES).fold(0.0, |sum, piece| {
            let part = (f64::from(piece) + 0.5) / f64::from(PIECES) - 0.5;
            let time = f64::from(since_onset) + part * f64::from(aperture);
            sum + f64::from(shape.force(time as f32).0) / f64::from(PIECES)
        });
        let model = shape.force(since_onset).0 + corner.shift(&shape, since_onset).force_n;
        let error = f64::from(model) - mean;
        let plain = f64::from(shape.force(since_onset).0) - mean;
        assert!(error.abs() < 0.15 + 0.1 * plain.abs(), "{error} N at {since_onset}, not {plain}");
    }
}
