//! Records that begin with an unloaded cable, far quieter than the pull: the first load is no slip,
//! and the noise of the pull is no scatter of its slips.

use floe::sim::{Measurement, Scene, simulate};
use floe_core::{Config, Event};
use floe_tests::feed;
use floe_tests::normal::Normal;

/// Standard deviation of the converter's noise and of the pull's, N.
const QUIET_N: f64 = 0.03;
const NOISE_N: f64 = 2.0;

/// DFF8-13 for a minute after `quiet` samples without force.
fn pulled(seed: u64, quiet: usize) -> Vec<Event> {
    let measurement = Measurement { white_n: NOISE_N, ..Measurement::default() };
    let scene = Scene { duration_s: 60.0, measurement, ..Scene::default() };
    let pull = simulate(&scene, seed).expect("a scene").samples;
    let mut noise = Normal::new(seed);
    let forces = std::iter::repeat_n(0.0, quiet).chain(pull.iter().map(|sample| sample.force_n));
    let forces: Vec<f64> = forces.map(|force_n| force_n + QUIET_N * noise.sample()).collect();
    let config = Config { weight_n: 630.0, ..Config::default() };
    feed::replay(&config, feed::in_a_row(&forces)).events
}

#[test]
fn a_quiet_zero_before_the_pull_changes_no_event() {
    for seed in 1..=20 {
        let events = pulled(seed, 0).len();
        for quiet in [3, 10, 30, 60] {
            let found = pulled(seed, quiet);
            assert_eq!(found.len(), events, "seed {seed}, {quiet} quiet samples");
            let stds: Vec<f32> = found.iter().filter_map(|event| Some(event.mu_s?.std)).collect();
            // The first event may be refused with a reason, because its noise is unknown.
            assert!(stds.len() + 1 >= events, "seed {seed}, {quiet} quiet samples");
            // Once the noise is known, all standard deviations are similar.
            let mut settled = stds[5..].to_vec();
            settled.sort_by(f32::total_cmp);
            let (usual, widest) = (settled[settled.len() / 2], settled[settled.len() - 1]);
            assert!(widest < 5.0 * usual, "seed {seed}, {quiet} quiet samples: {widest} {usual}");
        }
    }
}
