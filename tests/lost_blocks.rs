//! Gaps of seconds: a slip next to a gap has coefficients if its stick lines were recorded.

use floe::sim::{Scene, TrueEvent, simulate};
use floe_core::Config;
use floe_tests::{both, feed, score};

const HZ: f64 = 16.0;
/// Samples between a slip and the gap, and samples in the gap.
const REST: f64 = 9.0;
const LOST: f64 = 32.0;

/// A gap of two seconds after every fourth slip hides the next one.
#[test]
fn a_slip_right_before_a_gap_is_read() {
    let scene = Scene { duration_s: 240.0, ..Scene::default() };
    let (mut cut, mut read) = (0, 0);
    for seed in 1..=8 {
        let simulation = simulate(&scene, seed).expect("a scene");
        let before: Vec<&TrueEvent> = simulation.events.iter().skip(3).step_by(4).collect();
        let is_lost = |time_s: f64| {
            before.iter().any(|it| {
                let periods = (time_s - it.stop_s) * HZ;
                (REST..REST + LOST).contains(&periods)
            })
        };
        let samples = simulation.samples.iter().filter(|it| !is_lost(it.index as f64 / HZ));
        let samples = samples.map(|it| feed::force(it.index, it.force_n));
        let config = Config { weight_n: scene.weight_n as f32, ..Config::default() };
        let found = feed::replay(&config, samples).events;
        for truth in &before {
            let is_it = |onset_s: f64| (onset_s - truth.onset_s).abs() < 2.0 / HZ;
            let event = found.iter().find(|it| is_it(both::periods(it) / HZ));
            cut += 1;
            let values = event.and_then(|it| it.mu_s.zip(it.mu));
            let Some((mu_s, mu)) = values else { continue };
            read += 1;
            for (got, truth) in [(mu_s, truth.mu_s), (mu, truth.mu)] {
                let off = score::off(&got, truth);
                assert!(off.abs() < 5.0, "{seed} {truth} {got:?}");
            }
        }
    }
    println!("{read} of {cut} slips right before a gap with both coefficients");
    assert!(cut > 200 && read * 20 >= cut * 19, "{read} of {cut}");
}
