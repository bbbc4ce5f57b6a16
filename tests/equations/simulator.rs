//! The simulator's closed forms in double precision.

use floe::sim::motion::{Method, Segment, Segments};
use floe::sim::truth::{EventBuilder, TrueEvent};
use floe::sim::{Phase, Scene};
use floe_tests::brute::Pull;
use floe_tests::scenes;

use super::{Brute, agree, for_each, start_n};

/// Largest relative error of the simulator, from the integration's step size.
const DOUBLE: f64 = 1e-7;

/// Segments of the simulator's motion up to the second stop, and its events.
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
        // Near a stop the time error of the two methods dominates.
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
