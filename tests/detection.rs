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

/// The stick line is bent from its start: no straight line tells the noise.
#[test]
fn a_cable_that_sags_hides_no_slip() {
    let sag = Some(Sag { weight_n_per_m: 0.9, height_m: 0.3 });
    let scene = Scene { rate_hz: 50.0, sag, measurement: noisy(2.0), ..Scene::default() };
    let detection = found(&scene, 1..=12);
    assert!(detection.hits + detection.misses > 100, "{detection:?}");
    assert!(detection.f1() >= 0.99, "{:.3} {detection:?}", detection.f1());
}
