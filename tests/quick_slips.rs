//! Slips that recur as fast as they can be fitted, and faster: samples wait in the window. What the
//! coefficients do not need is left out then, and intervals get wide, but no sample is lost and no
//! event becomes wrong and sure.
//!
//! `cargo test -p floe-tests --test quick_slips -- --nocapture` prints the figures.

use floe::sim::Scene;
use floe_tests::scenes::quick;
use floe_tests::score::{self, Tried, run};

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
            let [found, read, worst] =
                judged(&Scene { duration_s: 240.0, ..quick(recurrence, slip) });
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
