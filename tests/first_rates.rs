//! A change of the loading rate near the first slip but outside it, by a winch that speeds up or a
//! cable that tightens. No earlier event gives the rate, and the lines end some samples away from
//! the slip.
//!
//! `cargo test -p floe-tests --test first_rates -- --nocapture` prints the figures.

use floe::sim::Scene;
use floe::sim::terms::WinchProfile;
use floe_core::Event;
use floe_tests::scenes::stored;
use floe_tests::score::{self, Tried, run};

const SEEDS: u64 = 12;

/// The base scene with a rate that changes by `factor`, `after_s` seconds after its first onset.
fn changed(seed: u64, factor: f64, after_s: f64) -> Scene {
    let scene = Scene { duration_s: 20.0, ..stored("honesty/base") };
    let onset_s = run(&scene, seed).truths[0].onset_s;
    let steps = vec![[onset_s + after_s, factor]];
    let winch_profile = Some(WinchProfile::Steps { steps, period_s: None });
    Scene { winch_profile, ..scene }
}

/// Errors of both coefficients of the first event, in combined standard deviations; `None` if
/// refused.
fn off(tried: &Tried) -> Option<[f64; 2]> {
    let &(truth, found) = tried.pairs.iter().find(|(truth, _)| *truth == 0)?;
    let (truth, Event { mu_s, mu, .. }) = (&tried.truths[truth], tried.found[found]);
    Some([score::off(&mu_s?, truth.mu_s), score::off(&mu?, truth.mu)])
}

#[test]
fn the_first_event_knows_that_its_rate_changed() {
    for factor in [1.05, 1.2, 1.7] {
        for after_s in [-0.4, -0.1, 0.08, 0.3, 0.5] {
            let tried = (1..=SEEDS).map(|seed| run(&changed(seed, factor, after_s), seed));
            let off: Vec<[f64; 2]> = tried.filter_map(|it| off(&it)).collect();
            assert!(off.len() as u64 > SEEDS / 2, "{factor}, {after_s} s: {} are read", off.len());
            for (place, what) in ["mu_s", "mu"].into_iter().enumerate() {
                let worst = off.iter().map(|it| it[place].abs()).fold(0.0, f64::max);
                println!(
                    "rate x {factor} {after_s} s after the onset, {what}: worst {worst:.1} std"
                );
                assert!(worst < 5.0, "rate x {factor}, {after_s} s, {what}: {worst:.1} std");
            }
        }
    }
}

/// The first rests are those of a winch that comes up to speed in seconds. What they teach is
/// forgotten once three events contradict it: the later events are right.
#[test]
fn a_winch_that_came_up_to_speed_is_forgotten() {
    const LATER: u32 = 6;
    for (weight_n, winch_m_per_s) in [(3000.0, 0.02), (300.0, 0.008)] {
        let fraction = |tenth: u32| 1.0 - 0.9 * (-f64::from(tenth) / 20.0).exp();
        let steps = (0..150).map(|tenth| [f64::from(tenth) / 10.0, fraction(tenth)]).collect();
        let base = stored("honesty/base");
        let scene = Scene {
            duration_s: 80.0,
            weight_n,
            mu_s: 0.85,
            mu: 0.5,
            winch_m_per_s,
            winch_profile: Some(WinchProfile::Steps { steps, period_s: None }),
            ..base
        };
        let mut off = [vec![], vec![]];
        for seed in 1..=SEEDS {
            let Tried { truths, found, pairs, .. } = run(&scene, seed);
            for (truth, event) in
                pairs.iter().map(|&(truth, found_at)| (&truths[truth], &found[found_at]))
            {
                if event.index < LATER {
                    continue;
                }
                off[0].extend(event.mu_s.map(|it| score::off(&it, truth.mu_s)));
                off[1].extend(event.mu.map(|it| score::off(&it, truth.mu)));
            }
        }
        for (off, what) in off.iter().zip(["mu_s", "mu"]) {
            let within = off.iter().filter(|off| off.abs() < 1.96).count();
            println!("{weight_n} N, {what}: {within} of {} covered", off.len());
            assert!(off.len() > 60 && within as f64 > 0.9 * off.len() as f64, "{what}: {within}");
        }
    }
}

/// With a steady winch the intervals are much narrower than with a changing one.
#[test]
fn a_steady_winch_costs_nothing() {
    let std = |scene: &dyn Fn(u64) -> Scene| {
        let tried = (1..=SEEDS).map(|seed| run(&scene(seed), seed));
        let mu = tried.filter_map(|it| it.found.first().and_then(|event| event.mu));
        let mut std: Vec<f32> = mu.map(|it| it.combined_std()).collect();
        assert!(std.len() as u64 > SEEDS / 2, "{} first events are read", std.len());
        std.sort_by(f32::total_cmp);
        std[std.len() / 2]
    };
    let (steady, changes) =
        (std(&|seed| changed(seed, 1.0, 0.3)), std(&|seed| changed(seed, 1.2, 0.3)));
    println!(
        "median standard deviation of the first mu: {steady:.4}, {changes:.4} where the rate changes"
    );
    assert!(changes > 5.0 * steady, "{steady} {changes}");
}
