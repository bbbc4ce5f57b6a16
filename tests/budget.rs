//! The error budget: its arithmetic compared with the formula for drawn inputs, coverage of the
//! intervals for inputs drawn from their standard deviations, means of few events, the sensitivity
//! to damping compared with an integration of the damped block, and the losses of the whole test
//! applied to every event.
//!
//! `cargo test -p floe-tests --test budget -- --nocapture` prints the figures.

use floe::sim::Scene;
use floe::sim::terms::Variation;
use floe_core::estimator::Estimator;
use floe_core::{
    Coefficient, Config, Event, InputStd, Losses, Newtons, Pipeline, RawSample, Reading, budget,
};
use floe_tests::feed;
use floe_tests::normal::Normal;

fn dff8_13() -> Scene {
    Scene::from_toml(include_str!("../host-sim/scenes/dff8-13.toml")).unwrap()
}

const STD: InputStd = InputStd {
    weight: 0.005,
    slope_rad: 0.004,
    zero_n: Some(1.5),
    span: 0.002,
    damping: 0.0,
    winch: 0.0,
};

/// Errors of weight, slope, zero and span, drawn in units of their standard deviations.
fn draw(random: &mut Normal) -> [f64; 4] {
    [(); 4].map(|()| random.sample())
}

fn wrong(config: &Config, [weight, slope, ..]: [f64; 4]) -> Config {
    let weight_n = config.weight_n * (1.0 + weight as f32 * STD.weight);
    let slope_rad = config.slope_rad + slope as f32 * STD.slope_rad;
    Config { weight_n, slope_rad, std: STD, ..*config }
}

fn measured(force_n: f64, [_, _, zero, span]: [f64; 4]) -> f64 {
    let zero_n = zero * f64::from(STD.zero_n.unwrap());
    force_n * (1.0 + span * f64::from(STD.span)) + zero_n
}

#[test]
fn contributions_add_up_to_what_drawn_inputs_do() {
    let (weight_n, slope_rad) = (630.0_f64, 6.0_f64.to_radians());
    let config = Config {
        weight_n: weight_n as f32,
        slope_rad: slope_rad as f32,
        std: STD,
        ..Config::default()
    };
    let (sin, cos) = slope_rad.sin_cos();
    let mut pipeline = Pipeline::new(&config).unwrap();
    let scene = Scene { slope_deg: 6.0, duration_s: 40.0, ..dff8_13() };
    let samples = floe::sim::simulate(&scene, 1).unwrap().samples;
    let samples = samples.iter().map(|s| feed::force(s.index, s.force_n));
    for sample in samples {
        let _ = pipeline.step(sample);
    }
    let report = pipeline.report();
    let entries = budget(&config, &report).unwrap();
    for (i, mean) in [report.mu_s.unwrap(), report.mu.unwrap()].into_iter().enumerate() {
        let mut random = Normal::new(7);
        let force_n = weight_n * (sin + f64::from(mean.mean) * cos);
        let errors: Vec<f64> = (0..20_000)
            .map(|_| {
                let drawn = draw(&mut random);
                let wrong = wrong(&config, drawn);
                let (sin, cos) = f64::from(wrong.slope_rad).sin_cos();
                let force_n = measured(force_n, drawn);
                (force_n / f64::from(wrong.weight_n) - sin) / cos - f64::from(mean.mean)
            })
            .collect();
        let drawn = floe_tests::score::rms(&errors);
        let own = entries.iter().map(|e| f64::from(e.shares[i].contribution).powi(2));
        let summed = own.sum::<f64>().sqrt();
        println!("drawn {drawn:.5}, budget {summed:.5}");
        // 20 000 draws: half a percent; nonlinear terms: one percent.
        assert!((summed / drawn - 1.0).abs() < 0.02, "{summed} {drawn}");
        assert!((summed / f64::from(mean.systematic_std) - 1.0).abs() < 1e-3);
    }
}

/// Fraction of true values in the 95 % intervals, for events and for means.
#[test]
fn intervals_hold_when_the_inputs_are_drawn() {
    let variation = Variation { mu_s_fraction: 0.01, mu_fraction: 0.01 };
    let scene = Scene { variation: Some(variation), duration_s: 40.0, ..dff8_13() };
    let right = floe_tests::both::config(&scene);
    let mut random = Normal::new(11);
    let (mut events, mut means) = ((0, 0), (0, 0));
    let seeds = 300;
    for seed in 1..=seeds {
        let drawn = draw(&mut random);
        let simulation = floe::sim::simulate(&scene, seed).unwrap();
        let samples = simulation.samples.iter();
        let samples = samples.map(|s| feed::force(s.index, measured(s.force_n, drawn)));
        let outcome = feed::replay(&wrong(&right, drawn), samples);
        let (mut truths, hz) = (simulation.events, scene.rate_hz);
        truths.pop();
        for event in &outcome.events {
            let onset_s = floe_tests::both::periods(event) / hz;
            let near = truths.iter().find(|t| (t.onset_s - onset_s).abs() < 0.1);
            let Some((truth, mu)) = near.zip(event.mu) else { continue };
            let (low, high) = mu.ci95();
            events.0 += usize::from((f64::from(low)..=f64::from(high)).contains(&truth.mu));
            events.1 += 1;
        }
        // The mean estimates the friction from which the events are drawn.
        let (low, high) = outcome.report.mu.unwrap().ci95().unwrap();
        means.0 += usize::from((f64::from(low)..=f64::from(high)).contains(&scene.mu));
        means.1 += 1;
    }
    assert!(events.1 as u64 > 15 * seeds && means.1 as u64 == seeds, "{events:?} {means:?}");
    for (what, (inside, all)) in [("events", events), ("means", means)] {
        let coverage = f64::from(inside as u32) / f64::from(all as u32);
        println!("{what}: {inside} of {all}, {coverage:.3}");
        // The events of a record share the draw, so both have the scatter of 300 draws, 3 x 0.0126.
        assert!((0.91..=0.99).contains(&coverage), "{what}: {coverage}");
    }
}

#[test]
fn means_of_few_events_cover_and_one_gives_none() {
    const NOISE: f64 = 0.0007;
    for scatter in [0.02, 0.05] {
        for count in [1, 2, 3, 5] {
            let mut random = Normal::new(3);
            let (trials, mut inside) = (4000, 0);
            for _ in 0..trials {
                let mut estimator = Estimator::default();
                for _ in 0..count {
                    let value = 0.78 * (1.0 + scatter * random.sample()) + NOISE * random.sample();
                    estimator.add(Coefficient::random(value as f32, NOISE as f32));
                }
                let estimate = estimator.estimate().unwrap();
                let ci95 = estimate.ci95();
                assert_eq!(ci95.is_some(), count > 1);
                inside += usize::from(ci95.is_some_and(|(low, high)| (low..=high).contains(&0.78)));
            }
            let coverage = inside as f64 / f64::from(trials);
            println!("scatter {scatter}, {count} events: {coverage:.3}");
            assert!(count == 1 || (0.90..=0.99).contains(&coverage), "{count}: {coverage}");
        }
    }
}

/// Force at the samples of a damped block, by Runge-Kutta integration; drag `2 D sqrt(k M)` on the
/// block.
fn damped(scene: &Scene, damping: f64) -> Vec<f64> {
    let (k, w) = (scene.stiffness_n_per_m, scene.winch_m_per_s);
    let mass = scene.weight_n / 9.80665;
    let drag = 2.0 * damping * (k * mass).sqrt();
    let (static_n, dynamic_n) = (scene.mu_s * scene.weight_n, scene.mu * scene.weight_n);
    let steps = 500_u32;
    let dt = 1.0 / scene.rate_hz / f64::from(steps);
    let rate = |[f, v]: [f64; 2]| [k * (w - v), (f - dynamic_n - drag * v) / mass];
    let (mut state, mut slips) = ([300.0, 0.0], false);
    let mut forces = Vec::new();
    for _ in 0..(scene.duration_s * scene.rate_hz) as usize {
        forces.push(state[0]);
        for _ in 0..steps {
            if !slips {
                state[0] += k * w * dt;
                slips = state[0] >= static_n;
                continue;
            }
            let at = |by: [f64; 2], h: f64| [state[0] + h * by[0], state[1] + h * by[1]];
            let a = rate(state);
            let b = rate(at(a, dt / 2.0));
            let c = rate(at(b, dt / 2.0));
            let d = rate(at(c, dt));
            let mean = [0, 1].map(|i| (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]) / 6.0);
            state = at(mean, dt);
            if state[1] < 0.0 {
                (state[1], slips) = (0.0, false);
            }
        }
    }
    forces
}

#[test]
fn the_dampings_sensitivity_is_what_a_damped_block_shows() {
    let fast = Scene { winch_m_per_s: 0.04, ..dff8_13() };
    let heavy = Scene { weight_n: 3000.0, mu_s: 0.9, mu: 0.55, ..dff8_13() };
    for (name, scene) in [("dff8-13", dff8_13()), ("fast", fast), ("heavy", heavy)] {
        let scene = Scene { duration_s: 120.0, ..scene };
        let config = Config { weight_n: scene.weight_n as f32, ..Config::default() };
        let means = |damping: f64| {
            let mut random = Normal::new(5);
            let forces = damped(&scene, damping);
            let samples = (0..).zip(forces).map(|(index, force_n)| RawSample {
                index,
                reading: Reading::Force(Newtons((force_n + 0.5 * random.sample()) as f32)),
            });
            let report = feed::replay(&config, samples).report;
            (report, [report.mu_s.unwrap().mean, report.mu.unwrap().mean].map(f64::from))
        };
        let (report, plain) = means(0.0);
        let entries = budget(&config, &report).unwrap();
        let line = entries.iter().find(|e| e.input == floe_core::Input::Damping).unwrap();
        let stated = -f64::from(line.shares[1].sensitivity.unwrap());
        for damping in [0.005, 0.01] {
            let (_, lossy) = means(damping);
            let [of_mu_s, of_mu] = [0, 1].map(|i| (lossy[i] - plain[i]) / damping);
            println!("{name}, {damping}: mu_s {of_mu_s:+.4}, mu {of_mu:+.4}, stated {stated:+.4}");
            assert!((of_mu / stated - 1.0).abs() < 0.2, "{name}: {of_mu} {stated}");
            assert!(of_mu_s.abs() < 0.25 * stated, "{name}: {of_mu_s} {stated}");
        }
    }
}

/// Configuration, events of a lossy cable as reported live and with the losses of the whole test,
/// and the report.
fn lossy(damping_std: f32) -> (Config, [Vec<Event>; 2], floe_core::Report) {
    let scene =
        Scene::from_toml(include_str!("../host-sim/scenes/honesty/damping_5.toml")).unwrap();
    let std = InputStd { damping: damping_std, ..InputStd::EXACT };
    let config = Config { weight_n: scene.weight_n as f32, std, ..Config::default() };
    let samples = floe::sim::simulate(&scene, 3).unwrap().samples;
    let samples = || samples.iter().map(|s| feed::force(s.index, s.force_n));
    let then = feed::replay(&config, samples());
    let outcome = feed::replay_in_hindsight(&config, samples());
    assert_eq!(then.report, outcome.report);
    (config, [then.events, outcome.events], outcome.report)
}

#[test]
fn events_hold_the_losses_of_the_whole_test() {
    let (config, [then, known], report) = lossy(0.005);
    let losses = Losses::of(&config, &report);
    let entries = budget(&config, &report).unwrap();
    let line = entries.iter().find(|e| e.input == floe_core::Input::Damping).unwrap();
    let by_mu = |event: &Event| {
        let (mu_s, mu) = (event.mu_s.unwrap(), event.mu.unwrap());
        -std::f32::consts::FRAC_PI_2 * (mu_s.value - mu.value)
    };
    assert_eq!(then.len(), known.len());
    // Every other input is exact, so the systematic part comes from the losses only.
    for (then, known) in then.iter().zip(&known) {
        let (mu_s, mu) = (known.mu_s.unwrap().systematic_std, known.mu.unwrap().systematic_std);
        let own = (by_mu(known) * report.damping_std).abs();
        assert!((mu / own - 1.0).abs() < 1e-4, "{mu} {own}");
        assert!((mu_s / line.shares[0].contribution - 1.0).abs() < 1e-4, "{mu_s} {line:?}");
        let value = |event: &Event| (event.mu_s.unwrap().value, event.mu.unwrap().value);
        assert_eq!(value(then), value(known));
    }
    // The losses were unknown at the first event and nearly known at the last.
    let systematic = |event: &Event| event.mu.unwrap().systematic_std;
    let (first, last) = (then[0], *then.last().unwrap());
    assert!((systematic(&first) / (by_mu(&first) * 0.005).abs() - 1.0).abs() < 1e-4, "{first:?}");
    assert!(systematic(&known[0]) > 5.0 * systematic(&first), "{report:?}");
    assert!((systematic(&last) / systematic(known.last().unwrap()) - 1.0).abs() < 0.1);
    // The correction removes the error: the mean is wrong by the losses.
    assert!(losses.put_on([first.mu_s, first.mu])[1].unwrap().systematic_std > 0.02);
}

#[test]
fn losses_that_are_known_exactly_change_no_event() {
    let (.., [then, known], report) = lossy(0.0);
    assert!(then.len() > 20, "{}", then.len());
    assert_eq!(then, known);
    assert!(report.damping_std.abs() < f32::EPSILON);
}
