//! Slips that recur as fast as they can be fitted, and faster: samples wait in the window. What the
//! coefficients do not need is left out then, and intervals get wide, but no sample is lost and no
//! event becomes wrong and sure.
//!
//! `cargo test -p floe-tests --test quick_slips -- --nocapture` prints the figures.

use floe::sim::Scene;
use floe_core::units::STANDARD_GRAVITY_M_PER_S2;
use floe_tests::scenes::stored;
use floe_tests::score::{self, Tried, run};

/// Four minutes of slips that last and recur this many samples.
fn quick(recurrence: f64, slip: f64) -> Scene {
    let base = stored("honesty/base");
    let (weight_n, mu_s, mu) = (630.0, 1.0, 0.7);
    let omega = std::f64::consts::PI * base.rate_hz / slip;
    let stiffness_n_per_m = omega * omega * weight_n / STANDARD_GRAVITY_M_PER_S2;
    let drop_n = 2.0 * (mu_s - mu) * weight_n;
    let winch_m_per_s = drop_n / stiffness_n_per_m * base.rate_hz / (recurrence - slip);
    Scene { duration_s: 240.0, weight_n, mu_s, mu, stiffness_n_per_m, winch_m_per_s, ..base }
}

/// Parts of the true events that are found, and that have both coefficients; the largest error of
/// one, combined standard deviations.
fn judged(scene: &Scene) -> [f64; 3] {
    let Tried { truths, found, pairs, .. } = run(scene, 1);
    let (mut read, mut worst) = (0, 0.0_f64);
    for &(truth, event) in &pairs {
        let (truth, event) = (&truths[truth], &found[event]);
        read += usize::from(event.mu_s.is_some() && event.mu.is_some());
        for (coefficient, truth) in [(event.mu_s, truth.mu_s), (event.mu, truth.mu)] {
            worst = worst.max(coefficient.map_or(0.0, |it| score::off(&it, truth).abs()));
        }
    }
    let all = truths.len() as f64;
    [pairs.len() as f64 / all, read as f64 / all, worst]
}

#[test]
fn slips_that_cannot_all_be_fitted_in_time_are_found_and_right() {
    for recurrence in [4.5, 5.5, 6.5, 7.6, 9.0] {
        for slip in [0.7, 1.0, 1.5, 2.1] {
            let [found, read, worst] = judged(&quick(recurrence, slip));
            let of = format!("recurrence {recurrence}, slip {slip}");
            println!("{of}: found {found:.3}, read {read:.3}, worst {worst:.1} std");
            assert!(found > 0.99, "{of}: {found} are found");
            assert!(worst < 5.0, "{of}: {worst} standard deviations");
            // Slips of a sample or less begin at several guesses: there is not always time for them.
            let least = if slip > 1.0 { 0.95 } else { 0.5 };
            assert!(read > least, "{of}: {read} are read");
        }
    }
}
