//! Property tests with a fixed seed.

use floe::sim::simulate;
use floe_core::RawSample;
use proptest::prelude::*;
use proptest::test_runner::{RngAlgorithm, TestRng, TestRunner};

use crate::brute::Pull;
use crate::{feed, scenes};

/// Seed, printed with every failure.
const SEED: [u8; 32] = *b"floe properties, the same always";

fn runner(cases: u32) -> TestRunner {
    let config = ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() };
    TestRunner::new_with_rng(config, TestRng::from_seed(RngAlgorithm::ChaCha, &SEED))
}

/// Runs a test on `cases` values of a strategy, which are always the same.
///
/// # Panics
/// The test fails.
pub fn check<S: Strategy>(
    cases: u32,
    strategy: S,
    test: impl Fn(S::Value) -> Result<(), TestCaseError>,
) {
    println!("seed {:?}", String::from_utf8_lossy(&SEED));
    runner(cases).run(&strategy, test).unwrap_or_else(|error| panic!("{error}"));
}

/// Pulls of blocks within the range of the field study, 60 s with noise, and a seed.
pub fn pulls() -> impl Strategy<Value = (Pull, u64)> {
    let block = (300.0..3000.0_f64, 0.3..0.9_f64, 0.05..0.5_f64);
    let cable = (5e3..60e3_f64, 0.004..0.04_f64, -0.1..0.1_f64, 0.0..4.0_f64);
    (block, cable, 0..1000_u64).prop_map(|((weight_n, mu, difference), cable, seed)| {
        let (stiffness_n_per_m, winch_m_per_s, slope_rad, noise_n) = cable;
        let mu_s = mu + difference;
        let (duration_s, d) = (60.0, Pull::default());
        #[rustfmt::skip]
        let pull = Pull { weight_n, mu, mu_s, stiffness_n_per_m, winch_m_per_s, slope_rad, noise_n, duration_s, ..d };
        (pull, seed)
    })
}

/// The forces of a pull, N.
///
/// # Panics
/// The pull cannot be simulated.
#[must_use]
pub fn forces_n((pull, seed): &(Pull, u64)) -> Vec<f64> {
    let simulation = simulate(&scenes::scene(pull), *seed).expect("the scene is valid");
    simulation.samples.iter().map(|sample| sample.force_n).collect()
}

/// The forces of a pull as samples.
#[must_use]
pub fn samples(test: &(Pull, u64)) -> Vec<RawSample> {
    feed::in_a_row(&forces_n(test)).collect()
}
