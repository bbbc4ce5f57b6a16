//! Slips that recur as fast as they can be fitted, and faster: samples wait in the window. What the
//! coefficients do not need is left out then, and intervals get wide, but no sample is lost and no
//! event becomes wrong and sure.
//!
//! `cargo test -p floe-tests --test quick_slips -- --nocapture` prints the figures.

use floe::sim::Scene;
use floe_core::Config;
use floe_core::units::STANDARD_GRAVITY_M_PER_S2;
use floe_tests::feed;
use floe_tests::normal::Normal;
use floe_tests::saw::{Slip, saw};
use floe_tests::scenes::{quick, stored};
use floe_tests::score::{self, Tried, run};

/// Parts of the true events that are found, and that have both coefficients; the largest error of
/// one, combined standard deviations; the largest ratio of the median combined standard deviation
/// of a coefficient over the root mean square of its errors.
fn judged(scene: &Scene) -> [f64; 4] {
    let Tried { truths, found, pairs, .. } = run(scene, 1);
    let (mut read, mut worst) = (0, 0.0_f64);
    let mut all_of = [const { Vec::new() }; 2];
    for &(truth, event) in &pairs {
        let (truth, event) = (&truths[truth], &found[event]);
        read += usize::from(event.mu_s.is_some() && event.mu.is_some());
        let both = [(event.mu_s, truth.mu_s), (event.mu, truth.mu)];
        for (all, (coefficient, truth)) in all_of.iter_mut().zip(both) {
            let Some(it) = coefficient else { continue };
            worst = worst.max(score::off(&it, truth).abs());
            all.push((f64::from(it.combined_std()), f64::from(it.value) - truth));
        }
    }
    let wide = all_of.iter_mut().map(|all| {
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        let squares: f64 = all.iter().map(|(_, error)| error * error).sum();
        all[all.len() / 2].0 / (squares / all.len() as f64).sqrt()
    });
    let (wide, all) = (wide.fold(0.0, f64::max), truths.len() as f64);
    [pairs.len() as f64 / all, read as f64 / all, worst, wide]
}

#[test]
fn slips_that_cannot_all_be_fitted_in_time_are_found_and_right() {
    for recurrence in [4.5, 5.5, 6.5, 7.6, 9.0] {
        for slip in [0.7, 1.0, 1.5, 2.1] {
            let [found, read, worst, wide] =
                judged(&Scene { duration_s: 240.0, ..quick(recurrence, slip) });
            let of = format!("recurrence {recurrence}, slip {slip}");
            println!(
                "{of}: found {found:.3}, read {read:.3}, worst {worst:.1} std, {wide:.2} wide"
            );
            assert!(found > 0.99, "{of}: {found} are found");
            assert!(worst < 5.0, "{of}: {worst} standard deviations");
            // Slips of a sample or less begin at several guesses: there is not always time for them.
            let least = if slip > 1.0 { 0.95 } else { 0.5 };
            assert!(read > least, "{of}: {read} are read");
            // From nine samples on there is time to fit places of the onset for most of them.
            assert!(recurrence < 9.0 || wide < 4.0, "{of}: intervals {wide} times the errors");
        }
    }
}

/// A light block on paper that slips every seven to twelve samples, no two times alike: one that was
/// missed, in more noise than its neighbours would bear, must not hide the next. Slips of less than
/// half the usual drop do not count, they may drown in the noise. The slips last a third of a sample:
/// the few that come out longer by chance must not make aliases of the others.
#[test]
fn irregular_slips_are_found_and_read() {
    for (white_n, least, least_read) in [(0.0013, 0.92, 0.8), (0.002, 0.75, 0.65)] {
        let (mut seen, mut read, mut all) = (0, 0, 0);
        for seed in 1..=6 {
            let mut scene = stored("terms/irregular");
            scene.measurement.white_n = white_n;
            let Tried { truths, found, pairs, .. } = run(&scene, seed);
            let drop = |i: usize| truths[i].mu_s - truths[i].mu;
            let mut drops: Vec<f64> = (0..truths.len()).map(drop).collect();
            drops.sort_by(f64::total_cmp);
            let counts = |i: usize| drop(i) > 0.5 * drops[drops.len() / 2];
            all += (0..truths.len()).filter(|&i| counts(i)).count();
            for &(_, event) in pairs.iter().filter(|pair| counts(pair.0)) {
                seen += 1;
                read += usize::from(found[event].mu_s.is_some() && found[event].mu.is_some());
            }
        }
        let [found, read] = [seen, read].map(|it| it as f64 / all as f64);
        println!("irregular, {white_n} N of noise: {found:.3} of {all} are found, {read:.3} read");
        assert!(found > least, "{white_n} N: {found} are found");
        assert!(read > least_read, "{white_n} N: {read} are read");
    }
}

/// Friction that slows a slip down makes it last longer than weight and winch tell; by a factor of
/// three the stiffness from the winch is nine times that from the slips. Such slips are no aliases:
/// those recur faster than the samples, and would make the ratio as large as their own recurrence.
#[test]
fn slips_that_friction_slows_down_are_read() {
    const RATE: f64 = 22.5;
    const OMEGA: f64 = 1.18;
    let slip = Slip { static_n: 781.0, dynamic_n: 491.0, omega: OMEGA };
    for ratio in [1.0, 4.0, 9.0] {
        let base = Config { weight_n: 630.0, rate_hz: 16.0, ..Config::default() };
        let by_inertia = 16.0 * OMEGA * OMEGA * 630.0 / STANDARD_GRAVITY_M_PER_S2;
        let winch_m_per_s = Some((RATE / (ratio * by_inertia)) as f32);
        let config = Config { winch_m_per_s, ..base };
        let mut normal = Normal::new(7);
        let (mut forces_n, onsets) = saw(&[slip; 80], RATE, 20.3);
        forces_n.iter_mut().for_each(|it| *it += 2.0 * normal.sample());
        let events = feed::replay(&config, feed::in_a_row(&forces_n)).events;
        let read = events.iter().filter(|it| it.mu_s.is_some() && it.mu.is_some()).count();
        println!("stiffer by {ratio}: {read} of {}", onsets.len());
        assert!(read + 4 > onsets.len(), "{ratio}: {read} of {}", onsets.len());
    }
}
