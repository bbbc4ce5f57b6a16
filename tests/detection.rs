//! Scenes in which nothing is known beforehand: every slip is to be found, and none
//! invented, whatever the noise, the sampling and the cable.

use floe::bench::matching::Detection;
use floe::sim::terms::Sag;
use floe::sim::{Measurement, Scene};
use floe_tests::score::run;

/// What was found in records with these seeds.
fn found(scene: &Scene, seeds: impl IntoIterator<Item = u64>) -> Detection {
    let mut detection = Detection::default();
    seeds.into_iter().for_each(|seed| detection.add(run(scene, seed).detection));
    detection
}

fn noisy(white_n: f64) -> Measurement {
    Measurement { white_n, ..Measurement::default() }
}

fn finds(what: &str, scene: &Scene, least_f1: f64) {
    let detection = found(scene, 1..=12);
    assert!(detection.hits + detection.misses > 100, "{what}: {detection:?}");
    assert!(detection.f1() >= least_f1, "{what}: {:.3} {detection:?}", detection.f1());
}

/// A block that slides evenly.
fn smooth(measurement: Measurement) -> Scene {
    Scene { start_sliding: true, measurement, ..Scene::default() }
}

#[test]
fn a_first_look_at_the_noise_invents_nothing() {
    let scene = smooth(Measurement { flicker_n: 1.0, ..noisy(2.0) });
    let unlucky = [288, 325, 981];
    assert_eq!(found(&scene, unlucky).false_alarms, 0);
}

#[test]
fn coarse_steps_invent_nothing() {
    for step in [0.3, 1.0, 3.0] {
        let scene = smooth(Measurement { step_n: step * 2.0, ..noisy(2.0) });
        assert_eq!(found(&scene, 1..=60).false_alarms, 0, "{step}");
    }
}

#[test]
fn a_record_begins_without_false_slips() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../host-sim/scenes/hard/all.toml");
    let scene = Scene::from_toml(&std::fs::read_to_string(file).unwrap()).unwrap();
    assert_eq!(found(&scene, [129, 379, 433, 472]).false_alarms, 0);
}

/// A dozen samples of stick and four of slip, noise of a thirtieth of the drop.
#[test]
fn short_sticks_in_noise_are_found() {
    let scene = Scene {
        weight_n: 1200.0,
        mu_s: 0.57,
        mu: 0.39,
        stiffness_n_per_m: 65_000.0,
        winch_m_per_s: 0.0136,
        rate_hz: 25.0,
        measurement: noisy(13.5),
        ..Scene::default()
    };
    finds("short sticks", &scene, 0.97);
}

#[test]
fn a_block_that_hardly_rests_is_found() {
    let pulled = |winch_m_per_s, rate_hz| Scene {
        winch_m_per_s,
        rate_hz,
        duration_s: 60.0,
        measurement: noisy(2.0),
        ..Scene::default()
    };
    finds("0.4 m/s", &pulled(0.4, 16.0), 0.99);
    // Two samples a slip, and less than one a stick.
    finds("0.25 m/s at 8 Hz", &pulled(0.25, 8.0), 0.85);
}

#[test]
fn a_light_block_on_a_slack_cable_is_found() {
    let slack = Scene { mu_s: 1.0, mu: 0.4, measurement: noisy(2.0), ..Scene::default() };
    finds("100 N", &Scene { weight_n: 100.0, ..slack.clone() }, 0.99);
    finds("0.1 m/s", &Scene { winch_m_per_s: 0.1, ..slack }, 0.999);
}

/// The stick line is bent from its start: no straight line tells the noise.
#[test]
fn a_cable_that_lies_on_the_ice_hides_no_slip() {
    let scene = Scene {
        weight_n: 600.0,
        mu_s: 0.575,
        mu: 0.25,
        stiffness_n_per_m: 7600.0,
        winch_m_per_s: 0.0165,
        rate_hz: 32.0,
        sag: Some(Sag { weight_n_per_m: 0.7, height_m: 0.3 }),
        measurement: noisy(0.4),
        ..Scene::default()
    };
    finds("sag", &scene, 0.99);
}
