//! Where friction itself decides which slips have coefficients, the mean of those that have is not
//! that of all, and its interval says so.
//!
//! `cargo test -p floe-tests --test chosen_events -- --nocapture` prints the figures.

use floe::sim::Scene;
use floe_core::Estimate;
use floe_tests::scenes::stored;
use floe_tests::score::run;

/// Errors of the means of `mu_s` and `mu` in standard deviations: root mean square and largest.
fn means(name: &str, scene: &Scene) -> [(f64, f64); 2] {
    const SEEDS: u64 = 24;
    let mut all = [const { Vec::new() }; 2];
    for seed in 1..=SEEDS {
        let report = run(scene, seed).report;
        let off = |it: Estimate, truth: f64| {
            let (random, common) = (f64::from(it.std_error.unwrap()), f64::from(it.common_std));
            (f64::from(it.mean) - truth) / random.hypot(common)
        };
        all[0].push(off(report.mu_s.unwrap(), scene.mu_s));
        all[1].push(off(report.mu.unwrap(), scene.mu));
    }
    all.map(|z| {
        let rms = (z.iter().map(|z| z * z).sum::<f64>() / z.len() as f64).sqrt();
        let worst = z.iter().fold(0.0_f64, |worst, z| worst.max(z.abs()));
        println!("{name}: rms {rms:.2}, at most {worst:.1} standard deviations");
        (rms, worst)
    })
}

/// The range of the cell ends at the mean highest force, and half of the slips are cut off.
#[test]
fn cut_tops_are_in_the_mean_s_interval() {
    let mut scene = Scene { duration_s: 120.0, ..stored("honesty/base") };
    scene.measurement.range_n = scene.mu_s * scene.weight_n;
    for (rms, worst) in means("cut off", &scene) {
        assert!(rms < 2.2 && worst < 4.0, "{rms} {worst}");
    }
}

/// Slips so small that many of them drown in the noise.
#[test]
fn small_slips_are_in_the_mean_s_interval() {
    let scene = Scene { duration_s: 120.0, mu_s: 0.63, mu: 0.6, ..stored("honesty/base") };
    for (rms, worst) in means("small", &scene) {
        assert!(rms < 2.2 && worst < 4.0, "{rms} {worst}");
    }
}
