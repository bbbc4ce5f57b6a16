//! Events and stretches are in order for arbitrary forces.

use floe::sim::{Scene, simulate};
use floe_core::Event;
use floe_tests::normal::Normal;
use proptest::prelude::*;
use proptest::test_runner::{Config as Cases, RngAlgorithm, TestRng, TestRunner};

use super::{Outcome, config, read};

/// Checks that events and stretches are in order and disjoint, and that every slip has a duration:
/// where samples are missing, the force may first be seen when it has fallen by half.
fn in_order(outcome: &Outcome) -> Result<(), TestCaseError> {
    for event in &outcome.events {
        prop_assert!(event.onset <= event.stop && event.slip_s > 0.0, "{event:?}");
    }
    for pair in outcome.events.windows(2) {
        prop_assert!(pair[0].stop <= pair[1].onset, "{pair:?}");
        prop_assert_eq!(pair[0].index + 1, pair[1].index);
    }
    for pair in outcome.stretches.windows(2) {
        prop_assert!(pair[0].stop <= pair[1].start, "{pair:?}");
    }
    for stretch in &outcome.stretches {
        prop_assert!(stretch.start <= stretch.stop, "{stretch:?}");
        let meets = |e: &&Event| e.onset < stretch.stop && stretch.start < e.stop;
        prop_assert_eq!(outcome.events.iter().find(meets), None);
    }
    Ok(())
}

#[test]
fn events_and_stretches_are_ordered_and_disjoint_in_every_scene() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../host-sim/scenes");
    let mut scenes = 0;
    for folder in [folder.join("hard"), folder.join("linear")] {
        for file in std::fs::read_dir(folder).unwrap() {
            let path = file.unwrap().path();
            if path.extension().is_none_or(|e| e != "toml") {
                continue;
            }
            let scene = Scene::from_toml(&std::fs::read_to_string(&path).unwrap()).unwrap();
            let config = floe_tests::both::config(&scene);
            scenes += 1;
            for seed in 1..=4 {
                let samples = simulate(&scene, seed).unwrap().samples;
                let outcome = read(&config, samples.iter().map(|s| s.force_n));
                in_order(&outcome).unwrap_or_else(|e| panic!("{} {seed}: {e}", path.display()));
            }
        }
    }
    assert!(scenes > 20, "{scenes}");
}

/// Amplitude, period, falling fraction, noise and scatter of a saw.
type Saw = (f64, f64, f64, f64, f64);
/// Step of a random walk, amplitude and period of an oscillation, level, seed.
type Rest = (f64, f64, f64, f64, u64);

/// Saws, random walks, oscillations and steps of arbitrary size with arbitrary noise.
#[test]
fn events_and_stretches_are_ordered_and_disjoint_whatever_the_force_does() {
    const SEED: [u8; 32] = *b"floe no slip, always the same...";
    println!("seed {:?}", String::from_utf8_lossy(&SEED));
    let parts = (0.0..500.0_f64, 2.0..60.0_f64, 0.05..0.9_f64, 0.0..40.0_f64, 0.0..0.8_f64);
    let more = (0.0..20.0_f64, 0.0..200.0_f64, 2.0..100.0_f64, -200.0..600.0_f64, 0..1000_u64);
    let cases = Cases { cases: 300, failure_persistence: None, ..Cases::default() };
    let mut runner =
        TestRunner::new_with_rng(cases, TestRng::from_seed(RngAlgorithm::ChaCha, &SEED));
    let test = |(
        (saw_n, period, fall, noise_n, scatter),
        (walk_n, swing_n, swing, level_n, seed),
    ): (Saw, Rest)| {
        let mut normal = Normal::new(seed);
        let (mut walk, mut phase, mut size) = (0.0, 0.0, 1.0);
        let force_n = |i: u32| {
            walk += walk_n * normal.sample();
            phase += 1.0 / period;
            if phase >= 1.0 {
                (phase, size) = (phase - 1.0, 1.0 + scatter * normal.sample());
            }
            let saw = if phase < 1.0 - fall { phase / (1.0 - fall) } else { (1.0 - phase) / fall };
            let swings = swing_n * (f64::from(i) / swing).sin();
            level_n + walk + saw_n * size * saw + swings + noise_n * normal.sample()
        };
        in_order(&read(&config(), (0..1500).map(force_n)))
    };
    runner.run(&(parts, more), test).unwrap_or_else(|error| panic!("{error}"));
}
