//! Oscillations around a constant force are not slips.

use std::f64::consts::TAU;

use floe::bench::scenes::phase;
use floe_core::Config;
use floe_tests::normal::Normal;

use crate::{HZ, NOISE_N, SEEDS, config, noisy, read};

/// Mains hum on a block that slides steadily: sampled at 16 Hz, 50 Hz appears with a period of
/// eight samples, 60 Hz with four. Its falls may be detected, but almost none has coefficients.
#[test]
fn hum_on_a_steady_slide_has_no_coefficients() {
    for (hz, noise) in
        [(50.0, 1.0), (50.0, 0.25), (50.3, 0.25), (60.0, 1.0), (60.0, 0.25), (60.0, 0.05)]
    {
        let (mut seen, mut believed) = (0, 0);
        let humming = |seed| {
            let hum = move |t: f64| 20.0 * (TAU * (hz * t + phase(seed))).sin();
            let white = noisy(seed, 120.0, |_| 0.0);
            let at = |(i, noise_n): (usize, f64)| 491.4 + noise * noise_n + hum(i as f64 / HZ);
            white.into_iter().enumerate().map(at).collect::<Vec<f64>>()
        };
        for seed in 1..=SEEDS {
            let events = read(&config(), humming(seed)).events;
            seen += events.len();
            believed += events.iter().filter(|it| it.mu_s.is_some()).count();
        }
        println!("{hz} Hz, {noise} of the noise: {believed} of {seen} falls with coefficients");
        assert!(believed * 50 < seen.max(50), "{hz} Hz, {noise}: {believed} of {seen}");
    }
}

/// Hum on a cable without force, of 20 N around zero: a cable does not push. At most one fall in a
/// thousand has a coefficient.
#[test]
fn hum_without_a_force_has_no_coefficients() {
    for hz in [50.0, 50.3, 60.0] {
        let (mut seen, mut believed) = (0, 0);
        for seed in 1..=SEEDS {
            let hum = |t: f64| 20.0 * (TAU * (hz * t + phase(seed))).sin();
            let outcome = read(&config(), noisy(seed, 120.0, hum));
            (seen, believed) = (seen + outcome.events.len(), believed + outcome.coefficients());
        }
        println!("{hz} Hz around zero: {believed} of {seen} falls with coefficients");
        assert!(believed * 1000 < seen.max(1000), "{hz} Hz: {believed} of {seen}");
    }
}

/// A cable that is tightened for a second and held for half a minute, at rates at which the mains appear
/// with a period of less than three samples: slips never recur as fast.
#[test]
fn fast_hum_on_a_cable_that_is_held_is_no_slip() {
    for rate_hz in [20.0, 25.0, 32.0, 80.0, 100.0, 125.0, 250.0, 500.0, 1000.0] {
        for (hz, hum_n) in [(50.02, 5.0), (50.02, 20.0), (60.03, 5.0), (60.03, 20.0)] {
            // Blocks of two samples and more are averaged above 128 Hz.
            let block = (rate_hz / 128.0_f64).ceil().max(1.0);
            let cycles = hz * block / rate_hz;
            if (cycles - cycles.round()).abs() < 1.0 / 3.0 {
                continue;
            }
            for seed in 1..=2 {
                let config = Config { rate_hz: rate_hz as f32, ..config() };
                let mut normal = Normal::new(seed);
                let force_n = |i: u32| {
                    let t = f64::from(i) / rate_hz;
                    let hum_n = hum_n * (TAU * (hz * t + phase(seed))).sin();
                    400.0 * t.min(1.0) + hum_n + NOISE_N * normal.sample()
                };
                let seen = read(&config, (0..(31.0 * rate_hz) as u32).map(force_n)).events.len();
                assert_eq!(seen, 0, "{rate_hz} Hz, {hum_n} N at {hz} Hz, seed {seed}");
            }
        }
    }
}

/// A slow oscillation around a constant force rises as fast as it falls and has no rests. It is not
/// taken for slips at any amplitude, except the first one or two.
#[test]
fn a_slow_swing_has_no_coefficients() {
    for (period_s, swing_n) in [(1.0, 100.0), (1.5, 60.0), (2.0, 60.0), (3.0, 100.0), (5.0, 100.0)]
    {
        for seed in 1..=8 {
            let swing = |t: f64| 500.0 + swing_n * (TAU * t / period_s + phase(seed)).sin();
            let outcome = read(&config(), noisy(seed, 120.0, swing));
            let (seen, believed) = (outcome.events.len(), outcome.coefficients());
            println!("{swing_n} N in {period_s} s, seed {seed}: {believed} of {seen}");
            assert!(
                believed <= 2,
                "{swing_n} N in {period_s} s, seed {seed}: {believed} of {seen}"
            );
        }
    }
}
