//! Several forms of a drifting zero: the events' intervals cover the truth once the drift is
//! detected, and varying friction does not widen them.
//!
//! `cargo test -p floe-tests --test zero_drift -- --nocapture` prints the figures.

use floe::sim::Scene;
use floe::sim::terms::Variation;
use floe_tests::score::{Score, run, run_with};

const SEEDS: u64 = 12;
/// Amplitude of the drifts, N: 2.5 % of `Fs`, 4 % of `Fp`.
const SIZE_N: f64 = 20.0;
const LENGTH_S: f64 = 300.0;

fn scene() -> Scene {
    let scene = Scene::from_toml(include_str!("../host-sim/scenes/dff8-13.toml")).unwrap();
    Scene { duration_s: LENGTH_S, ..scene }
}

/// Checks the coverage of `mu_s` and `mu` with a zero that depends on the time.
fn check(name: &str, scene: &Scene, zero_n: impl Fn(f64) -> f64, (least, most): (f64, f64)) {
    let mut score = Score::default();
    (1..=SEEDS).for_each(|seed| score.add(&run_with(scene, seed, &zero_n)));
    assert!(score.detection.f1() > 0.999, "{name}: {:?}", score.detection);
    assert!(score.share_read() > 0.95, "{name}: {} read", score.share_read());
    for errors in &score.errors {
        println!("{name}: 95 % of errors {:.2} %, coverage {:.3}", errors.p95(), errors.coverage());
        assert!((least..=most).contains(&errors.coverage()), "{name}: {}", errors.coverage());
    }
}

#[test]
fn a_drift_of_any_kind_is_in_the_intervals() {
    let part = |time_s: f64| time_s / LENGTH_S;
    let sine = |time_s: f64, period_s: f64| (std::f64::consts::TAU * time_s / period_s).sin();
    check("ramp", &scene(), |t| SIZE_N * part(t), (0.9, 0.99));
    check("settling", &scene(), |t| SIZE_N * (1.0 - (-5.0 * part(t)).exp()), (0.9, 0.99));
    check("sine of 120 s", &scene(), |t| SIZE_N * sine(t, 120.0), (0.9, 0.995));
    check("sine of 600 s", &scene(), |t| SIZE_N * sine(t, 600.0), (0.9, 0.99));
    check("step", &scene(), |t| if part(t) < 0.4 { 0.0 } else { SIZE_N }, (0.9, 0.995));
}

/// Friction with a scatter of 2 % hides a drift of 3 % until the scatter averages out: the
/// intervals of earlier events do not include the drift.
#[test]
fn a_scatter_of_the_friction_hides_a_drift_for_a_while() {
    let vary = |fraction| {
        let variation = Variation { mu_s_fraction: fraction, mu_fraction: fraction };
        Scene { variation: Some(variation), duration_s: 600.0, ..scene() }
    };
    let wave = |t: f64| 2.0 * SIZE_N * (std::f64::consts::TAU * t / 240.0).sin();
    check("sine of 40 N under 2 %", &vary(0.02), wave, (0.7, 0.99));
    for fraction in [0.02, 0.1] {
        check(&format!("{fraction} alone"), &vary(fraction), |_| 0.0, (0.93, 0.97));
    }
}

/// The report states a drift only if there is one.
#[test]
fn the_report_says_how_far_the_zero_may_have_moved() {
    let told = |zero_n: &dyn Fn(f64) -> f64| run_with(&scene(), 3, zero_n).report;
    let drifted = told(&|t| SIZE_N * t / LENGTH_S);
    let zero_n = f64::from(drifted.zero_n.unwrap());
    assert!((0.5 * SIZE_N..SIZE_N).contains(&zero_n), "{zero_n}");
    let steady = run(&scene(), 3).report;
    assert_eq!(steady.zero_n, None);
    // The mean is wrong by half of the zero's final shift.
    let mean = drifted.mu.unwrap();
    let off = (f64::from(mean.mean) - 0.78) / f64::from(mean.combined_std().unwrap());
    assert!(off > 0.5 && off < 1.96, "{off}");
}
