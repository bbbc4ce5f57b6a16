//! Records without slips: no event is invented, the actual kind of force is reported, and events
//! are in order.

use floe::bench::matching::Detection;
use floe::bench::scenes::phase;
use floe::sim::winch::WinchProfile;
use floe::sim::{Scene, simulate};
use floe_core::{Config, Event, Reason, SampleTime, Stretch, StretchKind};
use floe_tests::feed;
use floe_tests::normal::Normal;
use floe_tests::score;

mod back;
mod hand;
mod hum;
mod order;

const WEIGHT_N: f64 = 630.0;
const HZ: f64 = 16.0;
const NOISE_N: f64 = 2.0;
const SEEDS: u64 = 30;

/// Results for a record.
struct Outcome {
    events: Vec<Event>,
    stretches: Vec<Stretch>,
}

impl Outcome {
    /// Number of events with a coefficient.
    fn coefficients(&self) -> usize {
        self.events.iter().filter(|e| e.mu_s.is_some() || e.mu.is_some()).count()
    }

    fn steady(&self) -> Vec<(f64, f64, Option<bool>)> {
        let steady = |s: &Stretch| match s.kind {
            StretchKind::Steady { force_over_weight, std, moving } => {
                Some((f64::from(force_over_weight), f64::from(std), moving))
            }
            StretchKind::NotUnderstood(_) => None,
        };
        self.stretches.iter().filter_map(steady).collect()
    }

    fn reasons(&self) -> Vec<Reason> {
        let reason = |s: &Stretch| match s.kind {
            StretchKind::NotUnderstood(reason) => Some(reason),
            StretchKind::Steady { .. } => None,
        };
        self.stretches.iter().filter_map(reason).collect()
    }
}

fn config() -> Config {
    Config { weight_n: WEIGHT_N as f32, ..Config::default() }
}

fn read(config: &Config, forces_n: impl IntoIterator<Item = f64>) -> Outcome {
    let samples = (0..).zip(forces_n).map(|(index, force_n)| feed::force(index, force_n));
    let feed::Outcome { events, stretches, .. } = feed::replay(config, samples);
    Outcome { events, stretches }
}

/// A force as function of time, s, with white noise.
fn noisy(seed: u64, seconds: f64, force_n: impl Fn(f64) -> f64) -> Vec<f64> {
    let mut normal = Normal::new(seed);
    let samples = (seconds * HZ) as u32;
    (0..samples).map(|i| force_n(f64::from(i) / HZ) + NOISE_N * normal.sample()).collect()
}

/// Periods between two times.
fn since(from: SampleTime, to: SampleTime) -> f64 {
    (to.index - from.index) as f64 + f64::from(to.fraction - from.fraction)
}

/// Runs a check for every seed.
fn each(record: impl Fn(u64) -> Vec<f64>, check: impl Fn(u64, &Outcome)) {
    for seed in 1..=SEEDS {
        check(seed, &read(&config(), record(seed)));
    }
}

#[test]
fn a_cable_tightened_and_held_is_a_constant_force() {
    for (start_s, rate) in [(0.0, 360.0), (0.0, 720.0), (5.0, 360.0)] {
        let top_s = |seed| start_s + (0.3 + 0.9 * phase(seed)) * 360.0 / rate;
        let held =
            |seed| noisy(seed, 60.0, move |t| rate * (t.min(top_s(seed)) - start_s).max(0.0));
        each(held, |seed, outcome| {
            assert!(outcome.events.is_empty(), "{seed} {:?}", outcome.events);
            let truth = rate * (top_s(seed) - start_s) / WEIGHT_N;
            let [(mean, std, None)] = outcome.steady()[..] else { panic!("{seed}") };
            assert!((mean - truth).abs() < 5.0 * std && std < 3e-4, "{seed} {mean} {truth} {std}");
        });
    }
}

#[test]
fn a_pause_before_the_pull_costs_no_event() {
    let scene = Scene { start_force_n: 300.0, ..Scene::default() };
    let pulled = simulate(&scene, 1).unwrap();
    let truths = pulled.events.len();
    each(
        |seed| {
            let hold_s = 20.0 + phase(seed);
            let samples = pulled.samples.iter().map(|s| s.force_n).collect::<Vec<_>>();
            let hold = (hold_s * HZ) as usize;
            let noise = noisy(seed, hold_s + 121.0, |_| 0.0);
            let forces = std::iter::repeat_n(300.0, hold).chain(samples);
            forces.zip(noise).map(|(force_n, noise_n)| force_n + noise_n).collect()
        },
        |seed, outcome| {
            assert!(outcome.events.len().abs_diff(truths) <= 1, "{seed} {}", outcome.events.len());
            let hold_s = 20.0 + phase(seed);
            assert!(f64::from(outcome.events[0].onset.index) / HZ > hold_s);
            assert_eq!(outcome.steady().len(), 1, "{seed}");
        },
    );
}

/// Steady sliding with white noise, coloured noise and coarse steps, and an idle cell.
#[test]
fn steady_sliding_is_no_event() {
    let coloured = |seed, memory: f64| {
        let (mut normal, mut noise) = (Normal::new(seed), 0.0);
        let next = move |_| {
            noise = memory * noise + (1.0 - memory * memory).sqrt() * NOISE_N * normal.sample();
            491.4 + noise
        };
        (0..1600).map(next).collect::<Vec<f64>>()
    };
    let none = |seed: u64, outcome: &Outcome| {
        assert!(outcome.events.is_empty(), "{seed} {:?}", outcome.events);
        assert!(outcome.reasons().is_empty(), "{seed}");
    };
    let white = |seed| noisy(seed, 100.0, |_| 491.4);
    each(white, |seed, outcome| {
        none(seed, outcome);
        let long = |s: &Stretch| since(s.start, s.stop) / HZ;
        assert!(outcome.stretches.iter().map(long).sum::<f64>() > 85.0, "{seed}");
    });
    each(|seed| noisy(seed, 100.0, |_| 0.0), none);
    each(|seed| white(seed).iter().map(|f| (f / 1.5).round() * 1.5).collect(), none);
    each(|seed| coloured(seed, 0.5), none);
}

#[test]
fn only_a_winch_that_turns_makes_a_constant_force_a_motion() {
    let forces = noisy(1, 60.0, |_| 491.4);
    let told = |winch_m_per_s| {
        let config = Config { winch_m_per_s, ..config() };
        read(&config, forces.iter().copied()).steady().iter().map(|s| s.2).collect::<Vec<_>>()
    };
    assert_eq!((told(None), told(Some(0.0157))), (vec![None], vec![Some(true)]));
}

/// The winch runs backwards at the speed of the pull or three times as fast, with and without
/// rests, so the force falls evenly.
#[test]
fn winding_back_is_no_slip() {
    let trapezium = |seed, top_n: f64, [up_s, rest_s, down_s]: [f64; 3]| {
        let shift_s = phase(seed) / HZ;
        noisy(seed, 90.0, move |t| {
            let t = (t + shift_s) % (up_s + down_s + 2.0 * rest_s);
            let up = (t / up_s).min(1.0);
            let down = ((t - up_s - rest_s) / down_s).clamp(0.0, 1.0);
            top_n * (up - down)
        })
    };
    for times in [[2.0, 1.0, 2.0], [2.0, 0.0, 2.0], [3.0, 0.0, 1.0]] {
        each(
            |seed| trapezium(seed, 700.0, times),
            |seed, outcome| {
                assert!(outcome.events.is_empty(), "{times:?} {seed}");
                assert_eq!(outcome.reasons(), [Reason::WoundBack], "{times:?} {seed}");
            },
        );
    }
}

/// The winch runs backwards, and the force has no noise.
#[test]
fn winding_back_without_noise_is_no_slip() {
    let force_n = |i: i32| 300.0 + 4.0 * f64::from((i % 100 - 50).abs());
    let outcome = read(&config(), (0..1920).map(force_n));
    assert!(outcome.events.is_empty(), "{:?}", outcome.events);
    assert_eq!(outcome.reasons(), [Reason::WoundBack]);
}

/// The winch runs backwards a little between true slips, fast and slowly, before and after the
/// swing is known: all slips are found, and almost nothing else.
#[test]
fn winding_back_between_slips_is_no_slip() {
    let turns: [(&str, &[[f64; 2]], f64, f64); 7] = [
        ("as fast", &[[9.0, -1.0], [9.5, 1.0]], 11.0, NOISE_N),
        ("slow", &[[9.0, -0.3], [11.0, 1.0]], 13.0, NOISE_N),
        // Longer than the longest slip, or with noise that hides the shape of the fall.
        ("slow, for a second", &[[9.0, -0.3], [10.0, 1.0]], 11.0, NOISE_N),
        ("for a second, in noise", &[[9.0, -1.0], [10.0, 1.0]], 11.0, 5.0),
        ("fast", &[[9.0, -3.0], [9.3, 1.0]], 11.0, NOISE_N),
        ("brief", &[[6.0, -1.0], [6.25, 1.0]], 7.0, NOISE_N),
        ("before the first slip", &[[0.7, -1.0], [1.2, 1.0]], 6.1, NOISE_N),
    ];
    for (how, steps, period_s, white_n) in turns {
        let (steps, period_s) = (steps.to_vec(), Some(period_s));
        let winch_profile = Some(WinchProfile::Steps { steps, period_s });
        let mut scene = Scene { winch_profile, duration_s: 120.0, ..Scene::default() };
        scene.measurement.white_n = white_n;
        let mut all = Detection::default();
        for seed in 1..=12 {
            all.add(score::run(&scene, seed).detection);
        }
        println!("{how}: {all:?}, F1 {:.3}", all.f1());
        assert!(all.f1() > 0.98, "{how}: {all:?}");
    }
}

/// Pulled and released by hand every 8 s, with the winch running on, and with a pause.
#[test]
fn a_cable_let_go_gives_no_coefficient() {
    for (rate, pull_s) in [(69.0, 8.0), (69.0, 5.0), (360.0, 1.6)] {
        let let_go = |seed| {
            noisy(seed, 90.0, move |t| {
                let t = (t + phase(seed) / HZ) % 8.0;
                if t < pull_s { rate * t } else { 0.0 }
            })
        };
        each(let_go, |seed, outcome| {
            assert_eq!(outcome.coefficients(), 0, "{rate} {seed} {:?}", outcome.events);
            let reasons = outcome.events.iter().map(|e| e.reason);
            assert!(
                reasons.eq(outcome.events.iter().map(|_| Some(Reason::LetGo))),
                "{rate} {seed}"
            );
            assert!(outcome.events.len() > 9, "{rate} {seed}");
        });
    }
}

/// A block with so much water drag that it never stops, integrated in small steps.
fn dragged(seed: u64, drag_n_s_per_m: f64, mu: f64) -> Vec<f64> {
    const STEP_S: f64 = 2.5e-4;
    let (stiffness, winch, mass) = (23_000.0, 0.01565, WEIGHT_N / 9.81);
    let (mut stretch, mut speed, mut slides) = (-phase(seed) * winch / HZ, 0.0, false);
    let mut normal = Normal::new(seed);
    let sample = |_| {
        for _ in 0..(1.0 / (HZ * STEP_S)) as u32 {
            let force_n = stiffness * stretch;
            slides |= force_n > 1.24 * WEIGHT_N;
            if slides {
                speed += STEP_S * (force_n - mu * WEIGHT_N - drag_n_s_per_m * speed) / mass;
            }
            stretch += STEP_S * (winch - speed);
        }
        stiffness * stretch + NOISE_N * normal.sample()
    };
    (0..1440).map(sample).collect()
}

/// The block breaks away and then slides steadily: a slip without a rest.
#[test]
fn a_breakaway_into_steady_sliding_gives_no_coefficient() {
    for (drag, mu) in [(1500.0, 0.7), (3000.0, 0.75), (8000.0, 0.6)] {
        each(
            |seed| dragged(seed, drag, mu),
            |seed, outcome| {
                let reasons: Vec<_> = outcome.events.iter().map(|e| e.reason).collect();
                assert_eq!(reasons, [Some(Reason::NoRest)], "{drag} {seed}");
                assert_eq!(outcome.coefficients(), 0, "{drag} {seed}");
                assert!(!outcome.steady().is_empty(), "{drag} {seed}");
            },
        );
    }
}

fn pulled(scene: &Scene, seed: u64) -> Vec<f64> {
    let mut scene = scene.clone();
    scene.measurement.white_n = NOISE_N;
    simulate(&scene, seed).unwrap().samples.iter().map(|s| s.force_n).collect()
}

#[test]
fn a_cell_wired_the_other_way_round_is_said() {
    let record = |seed| pulled(&Scene::default(), seed).iter().map(|f| -f).collect();
    each(record, |seed, outcome| {
        assert!(outcome.events.is_empty(), "{seed}");
        assert_eq!(outcome.reasons(), [Reason::Negative], "{seed}");
    });
}

#[test]
fn a_weight_that_cannot_be_is_said() {
    let config = Config { weight_n: 63.0, ..config() };
    let outcome = read(&config, pulled(&Scene::default(), 1));
    assert!(outcome.events.len() > 60 && outcome.coefficients() == 0);
    assert!(outcome.events.iter().all(|e| e.reason == Some(Reason::Implausible)));
}

/// Two teeth of a saw in seven samples.
#[test]
fn the_teeth_of_a_steep_saw_are_found_and_refused() {
    for seed in 1..=SEEDS {
        let mut noise = Normal::new(seed);
        let saw = |i: u32| 100.0 + 400.0 * (f64::from(i) * 2.0 / 7.0).fract();
        let outcome = read(&config(), (0..1000).map(|i| saw(i) + NOISE_N * noise.sample()));
        assert!(outcome.events.len() > 200, "{seed} {}", outcome.events.len());
        assert!(outcome.events.iter().all(|e| e.reason == Some(Reason::Aliased)), "{seed}");
    }
}

/// Recurrences of three samples, and of two.
#[test]
fn a_recurrence_of_less_than_four_samples_is_refused() {
    for rate_hz in [1.7, 1.235] {
        let scene = Scene { rate_hz, duration_s: 600.0, ..Scene::default() };
        let config = Config { rate_hz: rate_hz as f32, ..config() };
        let outcome = read(&config, pulled(&scene, 1));
        let aliased = outcome.events.iter().filter(|e| e.reason == Some(Reason::Aliased)).count();
        // Two samples a slip may as well be hum: then no slip is seen, and this is said.
        let scatters = outcome.reasons() == [Reason::Scatters];
        assert!(aliased > 0 || scatters, "{rate_hz} {:?}", outcome.reasons());
        assert!(aliased * 50 >= outcome.events.len() * 49, "{rate_hz} {aliased}");
    }
}

/// Recurrences of 1.1 and .85 samples: the apparent slips are slower, and the apparent cable softer
/// than the winch's speed implies. Events that agree with the winch's speed are still reported.
#[test]
fn slips_made_of_the_samples_of_faster_ones_are_refused_where_the_winch_tells() {
    let fast = |stiffness_n_per_m| {
        let scene = Scene { stiffness_n_per_m, duration_s: 120.0, ..Scene::default() };
        let known = Config { winch_m_per_s: Some(scene.winch_m_per_s as f32), ..config() };
        let record = pulled(&scene, 3);
        let count = |config| read(config, record.iter().copied()).coefficients();
        (count(&known), count(&config()))
    };
    let (told, not_told) = fast(1.3e6);
    assert!(not_told > 100 && told < 10, "{told} {not_told}");
    let (told, not_told) = fast(23e3);
    assert!(told > 60 && told == not_told, "{told} {not_told}");
}
