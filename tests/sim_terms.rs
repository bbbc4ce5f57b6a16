//! Every term of a scene compared with a brute-force integration of its equation, and the
//! measurement chain compared with its documented behaviour.

use floe::sim::measurement::{Chance, Flop, Hum, Late};
use floe::sim::terms::{
    Breaking, Creep, Drag, HoldTime, RateDependence, Sag, Tilt, Variation, WinchProfile,
};
use floe::sim::{Measurement, Phase, Scene, simulate};
use floe_core::units::STANDARD_GRAVITY_M_PER_S2 as GRAVITY;

/// Steps per sample in the brute-force integration.
const STEPS: u64 = 1 << 15;

/// The equations of a scene as documented.
struct Equations {
    stiffness: Box<dyn Fn(f64, f64) -> f64>,
    winch: Box<dyn Fn(f64) -> f64>,
    resistance: Box<dyn Fn(f64, f64) -> f64>,
    static_n: Box<dyn Fn(f64, f64) -> f64>,
    creep: Box<dyn Fn(f64) -> f64>,
    mass: Box<dyn Fn(f64) -> f64>,
}

impl Equations {
    /// The linear block, which each case modifies.
    fn linear(s: &Scene) -> Self {
        let (weight, mu, mu_s) = (s.weight_n, s.mu, s.mu_s);
        let (k, w) = (s.stiffness_n_per_m, s.winch_m_per_s);
        Self {
            stiffness: Box::new(move |_, _| k),
            winch: Box::new(move |_| w),
            resistance: Box::new(move |_, _| mu * weight),
            static_n: Box::new(move |_, _| mu_s * weight),
            creep: Box::new(|_| 0.0),
            mass: Box::new(move |_| weight / GRAVITY),
        }
    }

    /// Force at each sample and times of stops, by classical Runge-Kutta.
    fn solve(&self, duration_s: f64, start_n: f64) -> (Vec<f64>, Vec<f64>) {
        let h = 1.0 / 16.0 / STEPS as f64;
        // Force, speed, way; time of rest; moving.
        let (mut y, mut rest_since, mut moving) = ([start_n, 0.0, 0.0], 0.0, false);
        let (mut forces, mut stops) = (Vec::new(), Vec::new());
        for step in 0..(duration_s * 16.0) as u64 * STEPS {
            let t = step as f64 * h;
            if step % STEPS == 0 {
                forces.push(y[0]);
            }
            let rate = |t: f64, y: [f64; 3]| {
                let winch = (self.winch)(t);
                let k = (self.stiffness)(y[0], y[2]);
                if moving {
                    let a = (y[0] - (self.resistance)(y[1], y[2])) / (self.mass)(t);
                    [k * (winch - y[1]), a, y[1]]
                } else {
                    let creep = (self.creep)(y[0]);
                    [k * (winch - creep), 0.0, creep]
                }
            };
            let at = |y: [f64; 3], k: [f64; 3], s: f64| std::array::from_fn(|i| y[i] + s * k[i]);
            let k1 = rate(t, y);
            let k2 = rate(t + 0.5 * h, at(y, k1, 0.5 * h));
            let k3 = rate(t + 0.5 * h, at(y, k2, 0.5 * h));
            let k4 = rate(t + h, at(y, k3, h));
            y = std::array::from_fn(|i| {
                y[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i])
            });
            if moving && y[1] <= 0.0 {
                (moving, y[1], rest_since) = (false, 0.0, t + h);
                stops.push(t + h);
            } else if !moving && y[0] >= (self.static_n)(y[2], t + h - rest_since) {
                (moving, y[1]) = (true, (self.creep)(y[0]));
            }
        }
        (forces, stops)
    }
}

fn agrees(name: &str, scene: &Scene, equations: &Equations) {
    let simulated = simulate(scene, 0).unwrap();
    let (forces, stops) = equations.solve(scene.duration_s, scene.start_force_n);
    assert!(simulated.events.len() >= 2, "{name}: the case must have events");
    assert_eq!(simulated.events.len(), stops.len(), "{name}: stops");
    assert_eq!(simulated.samples.len(), forces.len(), "{name}: samples");
    let pairs = simulated.samples.iter().zip(&forces);
    let worst = pairs.map(|(s, f)| (s.true_force_n - f).abs()).fold(0.0, f64::max);
    let times = simulated.events.iter().zip(&stops);
    let late = times.map(|(e, s)| (e.stop_s - s).abs()).fold(0.0, f64::max);
    println!("{name}: force {worst:.3} N, stops {late:.1e} s");
    // Each event of the brute-force integration is late by up to a step of 2 µs.
    assert!(worst < 0.2 && late < 5e-5, "{name}: {worst} N, {late} s");
    // The term must also have an effect.
    let plain = simulate(&Scene { duration_s: scene.duration_s, ..plain(scene) }, 0).unwrap();
    let pairs = simulated.samples.iter().zip(&plain.samples);
    let effect = pairs.map(|(a, b)| (a.true_force_n - b.true_force_n).abs()).fold(0.0, f64::max);
    assert!(effect > 1.0, "{name}: makes no difference");
}

fn plain(scene: &Scene) -> Scene {
    let (weight_n, mu_s, mu) = (scene.weight_n, scene.mu_s, scene.mu);
    Scene { weight_n, mu_s, mu, ..Scene::default() }
}

fn base() -> Scene {
    Scene { duration_s: 7.0, ..Scene::default() }
}

#[test]
fn shortening_cable() {
    let scene = Scene { shortening: true, cable_length_m: 2.0, ..base() };
    let mut e = Equations::linear(&scene);
    e.stiffness = Box::new(|_, x| 23_000.0 * 2.0 / (2.0 - x));
    agrees("shortening", &scene, &e);
}

#[test]
fn sagging_cable() {
    let sag = Sag { weight_n_per_m: 0.9, height_m: 0.3 };
    let scene = Scene { sag: Some(sag), start_force_n: 250.0, ..base() };
    let mut e = Equations::linear(&scene);
    e.stiffness = Box::new(|f, _| {
        let hanging = f.max(0.9 * 15.0 * 15.0 / (8.0 * 0.3));
        1.0 / (1.0 / 23_000.0 + 0.9 * 0.9 * 3375.0 / (12.0 * hanging.powi(3)))
    });
    agrees("sag", &scene, &e);
}

#[test]
fn winch_that_ripples() {
    let profile = WinchProfile::Ripple { fraction: 0.3, period_s: 0.7 };
    let scene = Scene { winch_profile: Some(profile), ..base() };
    let mut e = Equations::linear(&scene);
    let w = scene.winch_m_per_s;
    e.winch = Box::new(move |t| w * (1.0 + 0.3 * (std::f64::consts::TAU * t / 0.7).sin()));
    agrees("ripple", &scene, &e);
}

#[test]
fn winch_that_stops_and_goes() {
    let profile = WinchProfile::StopAndGo { go_s: 0.9, stop_s: 0.35 };
    let scene = Scene { winch_profile: Some(profile), ..base() };
    let mut e = Equations::linear(&scene);
    let w = scene.winch_m_per_s;
    e.winch = Box::new(move |t| if t % 1.25 < 0.9 { w } else { 0.0 });
    agrees("stop and go", &scene, &e);
}

#[test]
fn friction_that_depends_on_speed() {
    let rate = RateDependence { reference_m_per_s: 0.05, per_decade: -0.1 };
    let scene = Scene { rate_dependence: Some(rate), ..base() };
    let mut e = Equations::linear(&scene);
    e.resistance = Box::new(|v, _| 630.0 * (0.78 - 0.1 * (1.0 + v.max(0.0) / 0.05).log10()));
    agrees("rate dependence", &scene, &e);
}

#[test]
fn friction_that_grows_with_rest() {
    let hold = HoldTime { reference_s: 1.0, per_decade: 0.289 };
    let scene = Scene { mu_s: 1.0, hold_time: Some(hold), ..base() };
    let mut e = Equations::linear(&scene);
    e.static_n =
        Box::new(|_, rest: f64| 630.0 * (1.0 + 0.289 * rest.max(1e-300).log10()).max(0.78));
    agrees("hold time", &scene, &e);
}

#[test]
fn creep_before_the_onset() {
    let scene = Scene { creep: Some(Creep { onset_fraction: 0.5, range_n: 30.0 }), ..base() };
    let mut e = Equations::linear(&scene);
    let w = scene.winch_m_per_s;
    e.creep = Box::new(move |f| 0.5 * w * ((f - 781.2) / 30.0).exp());
    agrees("creep", &scene, &e);
}

#[test]
fn tilting_beam() {
    let scene = Scene { slope_deg: 1.0, tilt: Some(Tilt { deg_per_m: 40.0 }), ..base() };
    let mut e = Equations::linear(&scene);
    let slope = |x: f64| (1.0 + 40.0 * x).to_radians();
    e.resistance = Box::new(move |_, x| 630.0 * (slope(x).sin() + 0.78 * slope(x).cos()));
    e.static_n = Box::new(move |x, _| 630.0 * (slope(x).sin() + 1.24 * slope(x).cos()));
    agrees("tilt", &scene, &e);
}

#[test]
fn drag_of_water() {
    let scene = Scene { drag: Some(Drag { n_s2_per_m2: 500.0, n_s_per_m: 0.0 }), ..base() };
    let mut e = Equations::linear(&scene);
    e.resistance = Box::new(|v, _| 0.78 * 630.0 + 500.0 * v * v);
    agrees("drag", &scene, &e);
}

#[test]
fn breaking_block() {
    let scene = Scene { breaking: Some(Breaking { at_s: 3.0, weight_n: 420.0 }), ..base() };
    let (forces, events) = {
        let s = simulate(&scene, 0).unwrap();
        (s.samples, s.events)
    };
    assert!(events.iter().any(|e| (e.weight_n - 630.0).abs() < 1e-9));
    let light: Vec<_> = events.iter().filter(|e| (e.weight_n - 420.0).abs() < 1e-9).collect();
    assert!(light.len() > 1, "{}", light.len());
    // The first event may slip from a force above its own limit.
    for event in light.iter().skip(1) {
        assert!((event.static_force_n - 1.24 * 420.0).abs() < 1e-9);
        assert!((event.restick_force_n - 0.32 * 420.0).abs() < 1e-9);
    }
    assert!(forces.iter().filter(|s| s.time_s > 3.1).all(|s| s.true_force_n < 1.25 * 630.0));
}

#[test]
fn coefficients_vary_by_what_is_asked() {
    let variation = Variation { mu_s_fraction: 0.05, mu_fraction: 0.1 };
    let scene = Scene { variation: Some(variation), duration_s: 7200.0, ..Scene::default() };
    let events = simulate(&scene, 3).unwrap().events;
    let moments = |of: &dyn Fn(&floe::sim::TrueEvent) -> f64| {
        let n = events.len() as f64;
        let mean = events.iter().map(of).sum::<f64>() / n;
        (mean, (events.iter().map(|e| (of(e) - mean).powi(2)).sum::<f64>() / n).sqrt())
    };
    let ((mu_s, spread_s), (mu, spread)) = (moments(&|e| e.mu_s), moments(&|e| e.mu));
    assert!((mu_s / 1.24 - 1.0).abs() < 0.01 && (spread_s / 0.062 - 1.0).abs() < 0.06);
    assert!((mu / 0.78 - 1.0).abs() < 0.01 && (spread / 0.078 - 1.0).abs() < 0.06);
}

#[test]
fn slack_bounds_hold_in_every_state() {
    let scene = Scene { mu_s: 1.0, mu: 0.4, ..base() };
    let mut without_force = 0;
    for sample in simulate(&scene, 0).unwrap().samples {
        assert!(sample.true_force_n >= -1e-9);
        let slack = matches!(sample.phase, Phase::SlackSliding | Phase::SlackStuck);
        assert!(!slack || sample.true_force_n.abs() < 1e-9);
        without_force += u32::from(slack);
    }
    assert!(without_force > 4, "{without_force}");
}

fn measured(measurement: Measurement) -> Vec<floe::sim::Sample> {
    simulate(&Scene { measurement, ..base() }, 7).unwrap().samples
}

/// The average over the aperture compared with a fine sum.
#[test]
fn aperture_averages() {
    let flop = Some(Flop { amplitude_n: 30.0, hz: 3.3, decay_per_s: 3.0 });
    let hum = Some(Hum { amplitude_n: 4.0, hz: 60.0 });
    let seen = measured(Measurement { aperture_s: 0.05, flop, hum, ..Measurement::default() });
    let fine = Scene {
        rate_hz: 1600.0,
        measurement: Measurement { flop, hum, ..Measurement::default() },
        ..base()
    };
    let fine = simulate(&fine, 0).unwrap().samples;
    for sample in seen.iter().take(seen.len() - 2) {
        let first = sample.index as usize * 100;
        // Trapezium over 80 intervals.
        let inner: f64 = fine[first + 1..first + 80].iter().map(|s| s.force_n).sum();
        let mean = (inner + 0.5 * (fine[first].force_n + fine[first + 80].force_n)) / 80.0;
        assert!((sample.force_n - mean).abs() < 0.05, "{} {mean}", sample.force_n);
    }
}

#[test]
fn steps_and_range_shape_the_reading() {
    let settings = Measurement { step_n: 5.0, range_n: 500.0, ..Measurement::default() };
    for sample in measured(settings) {
        let expected = ((sample.true_force_n / 5.0).round() * 5.0).min(500.0);
        assert!((sample.force_n - expected).abs() < 1e-9);
    }
}

#[test]
fn faults_strike_as_often_as_asked() {
    let chance = |probability| Some(Chance { probability });
    let scene = |measurement| Scene { duration_s: 3600.0, measurement, ..Scene::default() };
    let count = |m: Measurement| simulate(&scene(m), 11).unwrap().samples;
    let all = 57_600.0;
    let near = |n: f64, p: f64| (n / all - p).abs() < 4.0 * (p * (1.0 - p) / all).sqrt();

    let dropped = count(Measurement { dropped: chance(0.02), ..Measurement::default() });
    assert!(near(all - dropped.len() as f64, 0.02));
    assert!(dropped.windows(2).all(|w| w[1].index > w[0].index));

    let repeated = count(Measurement { repeated: chance(0.01), ..Measurement::default() });
    assert!(near(repeated.len() as f64 - all, 0.01));
    let twice = repeated.windows(2).filter(|w| w[1].index == w[0].index);
    assert!(near(twice.count() as f64, 0.01));

    let settings = Measurement { spikes: chance(0.005), range_n: 5000.0, ..Measurement::default() };
    let spikes = count(settings);
    assert!(near(spikes.iter().filter(|s| s.force_n > 4999.0).count() as f64, 0.0025));

    let late = Some(Late { probability: 0.03, delay_s: 0.02 });
    let late = count(Measurement { late, ..Measurement::default() });
    let differ = late.iter().filter(|s| (s.force_n - s.true_force_n).abs() > 1e-6);
    assert!(near(differ.count() as f64, 0.03));
}

/// A clock that is slow by 1 % records 121.2 s as 120 s.
#[test]
fn clock_error_stretches_the_record() {
    let exact = simulate(&Scene::default(), 0).unwrap().events;
    let measurement = Measurement { clock_ppm: 10_000.0, ..Measurement::default() };
    let slow = simulate(&Scene { measurement, ..Scene::default() }, 0).unwrap().events;
    // The record of the slow clock ends later.
    assert!(!exact.is_empty() && slow.len() >= exact.len(), "{} {}", exact.len(), slow.len());
    for (e, s) in exact.iter().zip(&slow) {
        assert!((e.onset_s / 1.01 - s.onset_s).abs() < 1e-9);
    }
}

/// Equal seeds give equal logs, and enabling a term leaves the random draws of the others
/// unchanged.
#[test]
fn terms_do_not_disturb_each_other() {
    let white = Measurement { white_n: 2.0, ..Measurement::default() };
    let both = Measurement { dropped: Some(Chance { probability: 0.1 }), ..white.clone() };
    let noise = |m: Measurement| -> Vec<(u32, f64)> {
        measured(m).iter().map(|s| (s.index, s.force_n)).collect()
    };
    let (alone, with) = (noise(white.clone()), noise(both));
    assert_eq!(alone, noise(white));
    assert!(with.len() < alone.len() && with.iter().all(|s| alone.contains(s)));
}

#[test]
fn wrong_scenes_are_refused_by_name() {
    let refused = |text: &str, expected: &str| {
        let error = Scene::from_toml(text).unwrap_err().to_string();
        assert!(error.contains(expected) && !error.contains('\n'), "{error}");
    };
    let good = "weight_n = 630.0\nmu_s = 1.24\nmu = 0.78\nstiffness_n_per_m = 23000.0\n\
                winch_m_per_s = 0.015\n";
    assert!(Scene::from_toml(good).is_ok());
    refused("mu_s = 1.0", "missing field `weight_n`");
    refused(&good.replace("630.0", "-1.0"), "weight_n = -1");
    refused(&good.replace("630.0", "nan"), "weight_n = NaN");
    refused(&good.replace("1.24", "0.5"), "mu_s = 0.5");
    refused(&format!("{good}slope_deg = 40.0"), "slides down by itself");
    refused(&format!("{good}colour = 3"), "line 6");
    refused(&format!("{good}shortening = true\ncable_length_m = 1.0"), "cable_length_m = 1");
    let in_measurement = |line: &str| format!("{good}[measurement]\n{line}");
    refused(&in_measurement("white_n = -1.0"), "measurement.white_n = -1");
    refused(&in_measurement("spikes = { probability = 0.1 }"), "range_n");
    refused(&in_measurement("aperture_s = 0.1"), "measurement.aperture_s = 0.1");
    refused("weight_n = ", "line 1");
}
