//! Several forms of a drifting zero: the events' intervals cover the truth once the drift is
//! detected, and varying friction does not widen them.
//!
//! `cargo test -p floe-tests --test zero_drift -- --nocapture` prints the figures.

use floe::sim::Scene;
use floe::sim::terms::Variation;
use floe_core::{Config, InputStd, Pipeline};
use floe_tests::feed;
use floe_tests::normal::Normal;
use floe_tests::saw::{Slip, saw};
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

/// Friction that falls by 30 % within some twenty slips takes the drop with it, which no zero does:
/// the intervals remain those of the noise.
#[test]
fn friction_that_melts_is_no_drift() {
    const WEIGHT_N: f64 = 630.0;
    for seed in 0..12 {
        let mut normal = Normal::new(seed);
        let mut truths = Vec::new();
        let mut slip = |index: u32| {
            let part = 0.7 + 0.3 * (-f64::from(index) / 20.0).exp();
            let mut around = |mu: f64| mu * part * (1.0 + 0.01 * normal.sample());
            let (mu_s, mu) = (around(1.24), around(0.78));
            truths.push(mu);
            Slip { static_n: mu_s * WEIGHT_N, dynamic_n: mu * WEIGHT_N, omega: 1.183 }
        };
        let slips: Vec<Slip> = (0..78).map(&mut slip).collect();
        let (mut forces_n, _) = saw(&slips, 22.5, 20.0);
        forces_n.iter_mut().for_each(|it| *it += 2.0 * normal.sample());
        let config =
            Config { weight_n: WEIGHT_N as f32, std: InputStd::EXACT, ..Config::default() };
        let mut pipeline = Pipeline::new(&config).expect("the configuration is valid");
        let (mut squares, mut widths) = (0.0, Vec::new());
        for sample in feed::in_a_row(&forces_n) {
            let Some(event) = pipeline.step(sample).event else { continue };
            let mu = event.mu.expect("every slip is measured");
            squares += (f64::from(mu.value) - truths[event.index as usize]).powi(2);
            widths.push(f64::from(mu.combined_std()));
        }
        widths.sort_by(f64::total_cmp);
        let rms = (squares / widths.len() as f64).sqrt();
        let ratio = widths[widths.len() / 2] / rms;
        println!("seed {seed}: the median interval is {ratio:.2} times the error");
        assert!((0.6..3.0).contains(&ratio), "seed {seed}: {ratio}");
        let zero_n = pipeline.report().zero_drift_n;
        println!("seed {seed}: the zero may have moved by {zero_n:.1} N in the mean");
        assert!(zero_n < 5.0, "seed {seed}: {zero_n} N");
    }
}
