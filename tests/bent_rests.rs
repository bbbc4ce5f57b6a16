//! Rests that all bend, between slips that are no half cosines: the fit of one event takes its loading
//! rate from the slip's shape then, and hardly knows it. The events together do.
//!
//! `cargo test -p floe-tests --test bent_rests -- --nocapture` prints the figures.

use std::f64::consts::PI;

use floe_core::Config;
use floe_tests::feed;
use floe_tests::normal::Normal;

const WEIGHT_N: f64 = 630.0;
/// Duration of a slip, sampling periods.
const SLIP: f64 = 15.7;
const SLIPS: usize = 60;
const NOISE_N: f64 = 1.0;

/// Rise of the force in a time since the re-stick, periods, N: fast at first, then slower and slower.
fn risen_n(time: f64) -> f64 {
    1.5 * time + 150.0 * (1.0 - (-0.03 * time).exp())
}

/// Forces, N, of a block whose slips start fast and end slowly.
fn pulled(seed: u64) -> Vec<f64> {
    let (mut normal, mut forces_n) = (Normal::new(seed), Vec::new());
    let (mut begin, mut low_n) = (0.0, 720.0);
    for _ in 0..SLIPS {
        let (static_n, dynamic_n) = (780.0 + 6.0 * normal.sample(), 630.0 + 6.0 * normal.sample());
        let drop_n = static_n - dynamic_n;
        let slips = |time: &f64| low_n + risen_n(*time) >= static_n;
        let onset = begin + (0..).map(|i| 0.01 * f64::from(i)).find(slips).unwrap();
        while (forces_n.len() as f64) < onset + SLIP {
            let now = forces_n.len() as f64;
            let force_n = if now < onset {
                low_n + risen_n(now - begin)
            } else {
                dynamic_n + drop_n * (PI * ((now - onset) / SLIP).powf(0.6)).cos()
            };
            forces_n.push(force_n + NOISE_N * normal.sample());
        }
        (begin, low_n) = (onset + SLIP, dynamic_n - drop_n);
    }
    forces_n
}

#[test]
fn slips_between_bent_rests_are_read() {
    let config = Config { weight_n: WEIGHT_N as f32, rate_hz: 16.0, ..Config::default() };
    let (mut read, records) = (0, 8);
    for seed in 1..=records {
        let events = feed::replay(&config, feed::in_a_row(&pulled(seed))).events;
        read += events.iter().filter(|it| it.mu_s.is_some() && it.mu.is_some()).count();
    }
    let part = read as f64 / (records as usize * SLIPS) as f64;
    println!("{part:.3} of the slips are read");
    // By the rate of each event alone a fifth is.
    assert!(part > 0.8, "{part}");
}
