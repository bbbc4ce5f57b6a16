//! Disturbances much larger than the test's forces: a knock, an overflow of the converter for some
//! samples, noise before the pull, a block that was frozen in. They hide the slips of some seconds;
//! later slips are still evaluated.

use floe::sim::{Measurement, Scene, TrueEvent, simulate};
use floe_core::{Config, Event};
use floe_tests::feed::Outcome;
use floe_tests::normal::Normal;
use floe_tests::saw::{Slip, saw};
use floe_tests::{both, feed, score};

const HZ: f64 = 16.0;
const DURATION_S: f64 = 240.0;

/// Slips of DFF8-13 and the core's events, with the forces, N, changed by `disturb`.
fn disturbed(seed: u64, disturb: impl FnOnce(&mut [f64])) -> (Vec<TrueEvent>, Vec<Event>) {
    let (truths, outcome) = replayed(seed, disturb);
    (truths, outcome.events)
}

/// The same, with all that the core gives.
fn replayed(seed: u64, disturb: impl FnOnce(&mut [f64])) -> (Vec<TrueEvent>, Outcome) {
    let measurement = Measurement { white_n: 2.0, ..Measurement::default() };
    let scene = Scene { duration_s: DURATION_S, measurement, ..Scene::default() };
    let simulation = simulate(&scene, seed).expect("a scene");
    let mut forces: Vec<f64> = simulation.samples.iter().map(|sample| sample.force_n).collect();
    disturb(&mut forces);
    let config = Config { weight_n: scene.weight_n as f32, ..Config::default() };
    (simulation.events, feed::replay(&config, feed::in_a_row(&forces)))
}

/// Number of slips after a time without coefficients, or with an error of five standard deviations.
fn missed(truths: &[TrueEvent], found: &[Event], from_s: f64) -> usize {
    let onset_s = |event: &Event| both::periods(event) / HZ;
    let is_read = |truth: &TrueEvent| {
        let event = found.iter().find(|it| (onset_s(it) - truth.onset_s).abs() < 2.0 / HZ);
        event.and_then(|event| event.mu_s.zip(event.mu)).is_some_and(|(mu_s, mu)| {
            [(mu_s, truth.mu_s), (mu, truth.mu)].iter().all(|(got, truth)| {
                let off = score::off(got, *truth);
                off.abs() < 5.0
            })
        })
    };
    let due: Vec<_> = truths.iter().filter(|truth| truth.onset_s > from_s).collect();
    assert!(due.len() > 40, "{} slips after {from_s} s", due.len());
    due.into_iter().filter(|truth| !is_read(truth)).count()
}

#[test]
fn a_knock_hides_no_more_than_a_few_slips_after_it() {
    const AT: usize = 40 * 16;
    for force_n in [-50_000.0, -5000.0, 1500.0, 4000.0, 50_000.0, 999_999.0] {
        for length in [1, 2, 3, 6, 10, 20, 40] {
            let (truths, found) = disturbed(1, |forces| forces[AT..AT + length].fill(force_n));
            let missed = missed(&truths, &found, 42.5);
            assert!(missed <= 12, "{force_n} N for {length} samples: {missed} of {}", truths.len());
            if force_n.abs() <= 5000.0 {
                assert!(missed <= 4, "{force_n} N for {length} samples: {missed}");
            }
        }
    }
}

#[test]
fn an_overflow_before_the_first_slip_hides_a_minute_at_most() {
    for force_n in [-50_000.0, 5000.0, 50_000.0, 999_999.0] {
        for length in [1, 3, 10, 40] {
            let (truths, found) = disturbed(2, |forces| forces[20..20 + length].fill(force_n));
            let missed = missed(&truths, &found, 80.0);
            assert_eq!(missed, 0, "{force_n} N for {length} samples");
        }
    }
}

#[test]
fn noise_at_first_hides_no_slip_of_the_second_half() {
    for noise_n in [20.0, 100.0, 500.0, 2000.0] {
        for length in [48, 160, 320, 960] {
            let mut noise = Normal::new(3);
            let (truths, found) = disturbed(3, |forces| {
                forces[..length].iter_mut().for_each(|it| *it += noise_n * noise.sample());
            });
            let missed = missed(&truths, &found, 110.0);
            assert!(missed <= 1, "{noise_n} N for {length} samples: {missed}");
        }
    }
}

/// The first slip falls by up to seven times as much as the others, after a wait on the tightened
/// cable of up to two minutes.
#[test]
fn slips_after_a_block_has_broken_loose_are_found() {
    for (static_n, held) in (0..12).map(|i| ([1200.0, 1500.0, 2500.0, 4000.0][i % 4], i / 4 * 960))
    {
        let mut noise = Normal::new(4);
        let mut load = |i: usize| 23.0 * i.saturating_sub(held) as f64 + 2.0 * noise.sample();
        let length = held + (static_n / 23.0) as usize;
        let (truths, found) = disturbed(4, |forces| {
            forces.rotate_right(length);
            (0..length).for_each(|i| forces[i] = load(i));
        });
        let shift_s = length as f64 / HZ;
        let moved = |truth: &TrueEvent| TrueEvent { onset_s: truth.onset_s + shift_s, ..*truth };
        let end_s = DURATION_S - shift_s - 2.0;
        let truths: Vec<_> = truths.iter().filter(|it| it.onset_s < end_s).map(moved).collect();
        let missed = missed(&truths, &found, shift_s + 10.0);
        assert!(missed <= 1, "{static_n} N, held for {held}: {missed} of {}", truths.len());
    }
}

/// A cable is held, then pulled: the first slip begins above the force at which it was held, all
/// others below it.
#[test]
fn slips_below_the_force_at_which_a_cable_was_held_are_found() {
    const HELD: usize = 400;
    let slip = |static_n, dynamic_n| Slip { static_n, dynamic_n, omega: 1.18 };
    for (seed, rate) in (1..=10).flat_map(|seed| [30.0, 40.0].map(|rate| (seed, rate))) {
        let mut noise = Normal::new(seed);
        let mut slips = vec![slip(700.0, 580.0)];
        slips.extend((0..60).map(|_| slip(560.0 + 6.0 * noise.sample(), 460.0)));
        let (pulled, onsets) = saw(&slips, rate, 100.0 / rate);
        let forces: Vec<f64> = std::iter::repeat_n(600.0, HELD).chain(pulled).collect();
        let forces: Vec<f64> = forces.iter().map(|it| it + 2.0 * noise.sample()).collect();
        let config = Config { weight_n: 630.0, ..Config::default() };
        let events = feed::replay(&config, feed::in_a_row(&forces)).events;
        let is_found = |onset: &f64| {
            let off = |it: &Event| (both::periods(it) - HELD as f64 - onset).abs();
            events.iter().any(|it| off(it) < 2.0)
        };
        let missed = onsets.iter().filter(|onset| !is_found(onset)).count();
        assert!(
            missed == 0 || (seed, missed) == (1, 1),
            "seed {seed}, {rate} N: {missed} of {}",
            onsets.len()
        );
    }
}

/// The zero is as good as the test's largest force allows; that of a knock is none of the test's.
#[test]
fn a_knock_says_nothing_of_the_zero() {
    for force_n in [10_000.0, 999_999.0] {
        for length in [1, 3, 8, 12, 40] {
            let knock = |forces: &mut [f64]| forces[400..400 + length].fill(force_n);
            let zero_n = f64::from(replayed(5, knock).1.report.zero_std_n);
            assert!((0.7..0.9).contains(&zero_n), "{force_n} N for {length} samples: {zero_n} N");
        }
    }
}

/// Two falls in one disturbance, without a rest between them, must not be taken for a change of
/// weight.
#[test]
fn a_small_knock_changes_no_weight() {
    let file = include_str!("../host-sim/scenes/honesty/short_sticks.toml");
    let scene = Scene { duration_s: 120.0, ..Scene::from_toml(file).expect("a scene") };
    let winch_m_per_s = Some(scene.winch_m_per_s as f32);
    let config = Config { weight_n: scene.weight_n as f32, winch_m_per_s, ..Config::default() };
    for seed in [40, 41] {
        let simulation = simulate(&scene, seed).expect("a scene");
        let forces: Vec<f64> = simulation.samples.iter().map(|sample| sample.force_n).collect();
        for at in 640..720 {
            for (length, by_n) in [(3, -356.0), (3, 356.0), (2, -630.0), (5, -235.0)] {
                let mut forces = forces.clone();
                forces[at..at + length].iter_mut().for_each(|it| *it += by_n);
                let outcome = feed::replay(&config, feed::in_a_row(&forces));
                let ratio = outcome.report.weight_ratio;
                assert!((ratio - 1.0).abs() < 1e-6, "seed {seed}, {by_n} N at {at}: {ratio}");
                let missed = missed(&simulation.events, &outcome.events, 48.0);
                assert!(missed <= 1, "seed {seed}, {by_n} N at {at}: {missed}");
            }
        }
    }
}
