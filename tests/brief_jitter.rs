//! Time stamps with jitter and slips of about two samples. Such slips leave almost no residuals,
//! and only the differences between their swings reveal the errors of the stamps.
//!
//! `cargo test -p floe-tests --test brief_jitter -- --nocapture` prints the figures. Figures that
//! miss their aims are listed in `tests/golden/brief-jitter-not-yet.csv`.

use floe::sim::Scene;
use floe_tests::aims::{self, COVERAGE, Check, share_limits};
use floe_tests::scenes::stored;
use floe_tests::score::{self, quantile, run};

const SEEDS: u64 = 6;

/// Errors of `mu_s` in combined standard deviations, and the median of these standard deviations,
/// for a cable `stiffer` times as stiff as that of scene `jitter`.
fn off(stiffer: f64, jitter: &str) -> (Vec<f64>, f64) {
    let scene = stored(&format!("honesty/{jitter}"));
    let stiffness_n_per_m = stiffer * scene.stiffness_n_per_m;
    let scene = Scene { stiffness_n_per_m, ..scene };
    let (mut off, mut stds, mut due) = (Vec::new(), Vec::new(), 0);
    for seed in 1..=SEEDS {
        let tried = run(&scene, seed);
        due += tried.truths.len();
        for &(truth, found) in &tried.pairs {
            let Some(mu_s) = tried.found[found].mu_s else { continue };
            off.push(score::off(&mu_s, tried.truths[truth].mu_s));
            stds.push(f64::from(mu_s.combined_std()));
        }
    }
    assert!(off.len() * 10 > due * 9, "{jitter}, k x {stiffer}: {} of {due} read", off.len());
    (off, quantile(stds.into_iter(), 0.5))
}

#[test]
fn swings_that_differ_tell_a_jitter() {
    let mut checks = Vec::new();
    for stiffer in [1.5, 2.0] {
        for jitter in ["jitter_2", "jitter_10"] {
            let (off, std) = off(stiffer, jitter);
            let share = |most: f64| {
                off.iter().filter(|it| it.abs() < most).count() as f64 / off.len() as f64
            };
            let (inside, near) = (share(1.96), share(5.0));
            println!(
                "k x {stiffer}, {jitter}: {} events, {inside:.3} in 95 %, {near:.4} within five, ± {std:.5}",
                off.len()
            );
            // .70 and .94 without the use of the swings' differences.
            let row = format!("{jitter} k x {stiffer}");
            let coverage = share_limits(COVERAGE, off.len());
            checks.push(Check::between(&row, "coverage of mu_s", inside, coverage));
            checks.push(Check::most(&row, "share beyond five of mu_s", 1.0 - near, 0.005));
        }
        let (steady, jitters) = (off(stiffer, "base").1, off(stiffer, "jitter_2").1);
        println!("k x {stiffer}: ± {steady:.5} without, ± {jitters:.5} with 2 ms");
        assert!(jitters > 1.2 * steady, "k x {stiffer}: {steady} {jitters}");
    }
    aims::hold("brief-jitter", &checks);
}
