//! Logs of 250 and 1000 Hz, whose samples the core averages in blocks: nothing may be lost by that,
//! and no coefficient or frequency may be off.
//!
//! `cargo test -p floe-tests --test fast_samples -- --nocapture` prints the figures.

use floe::sim::Scene;
use floe_tests::scenes::stored;
use floe_tests::score::{Score, run};

/// Slips of 66 blocks, twice as long as the rests.
fn heavy(rate_hz: f64) -> Scene {
    let mut scene = stored("honesty/base");
    scene.measurement.white_n = 6.0;
    Scene {
        rate_hz,
        duration_s: 40.0,
        weight_n: 3000.0,
        winch_m_per_s: 0.2,
        mu_s: 0.8,
        mu: 0.6,
        ..scene
    }
}

#[test]
fn slips_longer_than_their_rests_are_read() {
    for rate_hz in [100.0, 250.0, 1000.0] {
        let score = Score::of(&heavy(rate_hz), usize::MAX, 4);
        let read = score.share_read();
        let [mu_s, mu] = score.errors.map(|errors| errors.coverage());
        println!("{rate_hz} Hz: {read:.3} are read, cover {mu_s:.3} {mu:.3}");
        assert!(read > 0.95, "{rate_hz} Hz: {read} are read");
        assert!(mu_s.min(mu) > 0.88, "{rate_hz} Hz: {mu_s} {mu}");
    }
}

/// The mean over a block makes a slip look slower; that is taken off. Of eight records: the largest
/// error of omega, standard deviations, and its mean, parts of omega.
#[test]
fn blocks_do_not_slow_the_slips() {
    let base = stored("honesty/base");
    let truth = (base.stiffness_n_per_m * 9.806_65 / base.weight_n).sqrt();
    for rate_hz in [250.0, 1000.0] {
        let scene = Scene { rate_hz, duration_s: 60.0, ..stored("honesty/base") };
        let errors: Vec<(f64, f64)> = (1..=8)
            .map(|seed| {
                let omega = run(&scene, seed).report.omega_rad_per_s.unwrap();
                let off = f64::from(omega.value) - truth;
                (off / truth, off / f64::from(omega.std))
            })
            .collect();
        let mean = errors.iter().map(|e| e.0).sum::<f64>() / errors.len() as f64;
        let worst = errors.iter().map(|e| e.1.abs()).fold(0.0, f64::max);
        println!("{rate_hz} Hz: omega {:+.3} %, at most {worst:.1} std", 100.0 * mean);
        assert!(mean.abs() < 4e-4 && worst < 3.5, "{rate_hz} Hz: {mean} {worst}");
    }
}
