//! Losses, friction that changes within a slip, the winch's programmes and the cell's errors, each
//! compared with a brute-force integration of its equation or with its documented behaviour.

use floe::sim::along_slip::AlongSlip;
use floe::sim::damping::CableDamping;
use floe::sim::measurement::{Coloured, Hum, Jitter, Lag, Ramp};
use floe::sim::rate_and_state::RateAndState;
use floe::sim::rocking::Rocking;
use floe::sim::stribeck::Stribeck;
use floe::sim::terms::Drag;
use floe::sim::winch::WinchProfile;
use floe::sim::{
    Measurement, Method, Phase, STANDARD_GRAVITY_M_PER_S2 as GRAVITY, Scene, Simulation, simulate,
    simulate_by,
};

const WEIGHT_N: f64 = 630.0;
const K: f64 = 23_000.0;
const W: f64 = 360.0 / K;

fn base() -> Scene {
    Scene { duration_s: 6.0, ..Scene::default() }
}

/// Forces on the block: friction, N, by speed, distance and time since the onset; dashpot, N s/m;
/// and the speed of the winch by time.
struct Laws<'a> {
    friction_n: &'a dyn Fn(f64, f64, f64) -> f64,
    dashpot: f64,
    winch: &'a dyn Fn(f64) -> f64,
}

/// Truth of one slip.
struct Slip {
    onset_s: f64,
    stop_s: f64,
    peak_n: f64,
    /// Average friction over the distance, N.
    friction_n: f64,
}

impl Laws<'_> {
    /// Spring and dashpot as separate elements, in steps of half a microsecond: forces at 16 Hz,
    /// and slips.
    fn solve(&self, duration_s: f64) -> (Vec<f64>, Vec<Slip>) {
        let steps = 1_u64 << 17;
        let h = 1.0 / 16.0 / steps as f64;
        let (mut stretch, mut v, mut x, mut at) = (0.0_f64, 0.0_f64, 0.0_f64, (0.0, 0.0));
        let (mut moving, mut work) = (false, 0.0);
        let (mut forces, mut slips): (Vec<f64>, Vec<Slip>) = (Vec::new(), Vec::new());
        for step in 0..(duration_s * 16.0) as u64 * steps {
            let t = step as f64 * h;
            let w = (self.winch)(t);
            let force = (K * stretch + self.dashpot * (w - v)).max(0.0);
            if step % steps == 0 {
                forces.push(force);
            }
            if moving {
                let friction = (self.friction_n)(v, x - at.0, t - at.1);
                v += h * (force - friction) / (WEIGHT_N / GRAVITY);
                work += friction * v * h;
                let slip = slips.last_mut().unwrap();
                slip.peak_n = slip.peak_n.max(force);
                if v <= 0.0 {
                    (moving, v) = (false, 0.0);
                    (slip.stop_s, slip.friction_n) = (t, work / (x - at.0));
                }
            } else if force >= 1.24 * WEIGHT_N {
                (moving, at, work, v) = (true, (x, t), 0.0, 1e-3 * W);
                let nan = f64::NAN;
                slips.push(Slip { onset_s: t, stop_s: nan, peak_n: force, friction_n: nan });
            }
            x += h * v;
            stretch += h * (w - v);
        }
        slips.retain(|slip| slip.stop_s.is_finite());
        (forces, slips)
    }
}

fn agrees(name: &str, scene: &Scene, laws: &Laws) -> Simulation {
    let simulated = simulate(scene, 0).unwrap();
    let (forces, slips) = laws.solve(scene.duration_s);
    let pairs = simulated.samples.iter().zip(&forces);
    let worst = pairs.map(|(s, f)| (s.true_force_n - f).abs()).fold(0.0, f64::max);
    println!("{name}: force {worst:.3} N, {} events", simulated.events.len());
    assert!(!slips.is_empty(), "{name}: the case must have events");
    assert_eq!(simulated.events.len(), slips.len(), "{name}");
    assert_eq!(simulated.samples.len(), forces.len(), "{name}");
    assert!(worst < 1.0, "{name}: {worst} N");
    for (event, slip) in simulated.events.iter().zip(&slips) {
        assert!((event.onset_s - slip.onset_s).abs() < 3e-4, "{name}");
        assert!((event.stop_s - slip.stop_s).abs() < 3e-4, "{name}");
        assert!((event.peak_force_n - slip.peak_n).abs() < 0.3, "{name}");
    }
    simulated
}

/// Checks that the true `mu` is the friction averaged over the distance.
fn mu_is_the_average(simulated: &Simulation, laws: &Laws, duration_s: f64, drag: bool) {
    let (_, slips) = laws.solve(duration_s);
    assert!(!slips.is_empty() && slips.len() == simulated.events.len(), "{}", slips.len());
    for (event, slip) in simulated.events.iter().zip(&slips) {
        let mu = if drag { event.dynamic_force_n / WEIGHT_N } else { event.mu };
        assert!((mu - slip.friction_n / WEIGHT_N).abs() < 1e-3, "{mu} {}", slip.friction_n);
    }
}

#[test]
fn damping_of_the_cable() {
    let damping = CableDamping { critical_fraction: 0.05 };
    let scene = Scene { cable_damping: Some(damping), ..base() };
    let dashpot = 2.0 * 0.05 * (K * WEIGHT_N / GRAVITY).sqrt();
    let laws = Laws { friction_n: &|_, _, _| 0.78 * WEIGHT_N, dashpot, winch: &|_| W };
    // The start is that of a moving cable: the force of the dashpot is there at once.
    let scene = Scene { start_force_n: dashpot * W, ..scene };
    let simulated = agrees("damping", &scene, &laws);
    // The dashpot leaves the coefficient unchanged and raises the force at the re-stick.
    for event in &simulated.events {
        assert!((event.mu - 0.78).abs() < 1e-9);
        assert!(event.restick_force_n > (2.0 * 0.78 - 1.24) * WEIGHT_N + 10.0);
    }
}

#[test]
fn drag_that_grows_with_speed() {
    let drag = Drag { n_s_per_m: 50.0, n_s2_per_m2: 200.0 };
    let scene = Scene { drag: Some(drag), ..base() };
    let friction = |v: f64, _: f64, _: f64| 0.78 * WEIGHT_N + 50.0 * v + 200.0 * v * v;
    let laws = Laws { friction_n: &friction, dashpot: 0.0, winch: &|_| W };
    let simulated = agrees("drag", &scene, &laws);
    mu_is_the_average(&simulated, &laws, scene.duration_s, true);
    assert!(simulated.events.iter().all(|e| (e.mu - 0.78).abs() < 1e-9));
}

#[test]
fn friction_along_the_slip_and_rocking() {
    let along = AlongSlip { fraction: 0.1, length_m: 0.04 };
    let scene = Scene { along_slip: Some(along), ..base() };
    let friction = |_: f64, s: f64, _: f64| {
        0.78 * WEIGHT_N * (1.0 + 0.1 * (std::f64::consts::TAU * s / 0.04).cos())
    };
    let laws = Laws { friction_n: &friction, dashpot: 0.0, winch: &|_| W };
    mu_is_the_average(&agrees("along the slip", &scene, &laws), &laws, scene.duration_s, false);

    let rocking = Rocking { fraction: 0.1, ratio: 1.7 };
    let scene = Scene { rocking: Some(rocking), ..base() };
    let omega = (K * GRAVITY / WEIGHT_N).sqrt();
    let friction = |_: f64, _: f64, t: f64| 0.78 * WEIGHT_N * (1.0 + 0.1 * (1.7 * omega * t).sin());
    let laws = Laws { friction_n: &friction, dashpot: 0.0, winch: &|_| W };
    mu_is_the_average(&agrees("rocking", &scene, &laws), &laws, scene.duration_s, false);
}

#[test]
fn friction_that_falls_smoothly_from_its_static_value() {
    let scene = Scene { stribeck: Some(Stribeck { falling_m_per_s: 0.02 }), ..base() };
    let friction = |v: f64, _: f64, _: f64| WEIGHT_N * (0.78 + 0.46 * (-(v / 0.02).powi(2)).exp());
    let laws = Laws { friction_n: &friction, dashpot: 0.0, winch: &|_| W };
    let simulated = agrees("Stribeck", &scene, &laws);
    mu_is_the_average(&simulated, &laws, scene.duration_s, false);
    for event in &simulated.events {
        assert!((event.mu_s - event.peak_force_n / WEIGHT_N).abs() < 1e-12);
        assert!(event.mu_s > 1.24 && event.mu > 0.78);
    }
}

/// One law solved with two tolerances; the peaks agree with the law's static value.
#[test]
fn rate_and_state() {
    let law =
        RateAndState { reference_m_per_s: 1e-3, direct: 0.012, evolving: 0.045, renewal_m: 2e-5 };
    let scene = Scene { mu_s: 0.78, rate_and_state: Some(law), duration_s: 12.0, ..base() };
    let fine = simulate(&scene, 0).unwrap().events;
    let rough = simulate_by(&scene, 0, Method::Integrator { tolerance: 1e-9 }).unwrap().events;
    assert!(fine.len() > 4 && fine.len() == rough.len(), "{}", fine.len());
    for (a, b) in fine.iter().zip(&rough).skip(1) {
        assert!((a.onset_s - b.onset_s).abs() < 1e-4 && (a.mu - b.mu).abs() < 1e-5);
        // At the peak the block moves at the winch's speed, and the contacts have the age of the
        // rest.
        let most = 0.78 + 0.012 * (W / 1e-3).ln() + 0.045 * (1e-3 * a.stick_s / 2e-5).ln();
        assert!((a.mu_s - most).abs() < 0.06, "{} {most}", a.mu_s);
        // At high speed the contacts have their smallest age.
        assert!(a.mu < 0.78 && a.mu > 0.5 && a.slip_s < 0.3, "{a:?}");
    }
}

#[test]
fn winches_follow_their_programmes() {
    let pulled = |profile| simulate(&Scene { winch_profile: Some(profile), ..base() }, 1).unwrap();
    // Tightened for a second, held, then pulled.
    let steps = vec![[1.0, 0.0], [4.0, 1.0]];
    let held = pulled(WinchProfile::Steps { steps, period_s: None });
    for s in &held.samples {
        let line = 360.0 * s.time_s.min(1.0) + 360.0 * (s.time_s - 4.0).max(0.0);
        assert!(s.time_s > 5.1 || (s.true_force_n - line).abs() < 1e-6, "{s:?}");
    }
    assert!((held.events[0].onset_s - (1.24 * WEIGHT_N / 360.0 + 3.0)).abs() < 1e-9);
    // Wound back until the cable is slack, then on: nothing slips before the slack is taken up.
    let steps = vec![[1.0, -2.0], [2.0, 1.0]];
    let back = pulled(WinchProfile::Steps { steps, period_s: None });
    assert!(back.samples.iter().any(|s| s.phase == Phase::SlackStuck));
    let taut_s = 3.0;
    assert!(back.samples.last().is_some_and(|s| s.time_s > taut_s + 2.0));
    for s in back.samples.iter().filter(|s| s.time_s > taut_s && s.time_s < taut_s + 2.0) {
        assert!((s.true_force_n - 360.0 * (s.time_s - taut_s)).abs() < 1e-6, "{s:?}");
    }
    // Slower until the end of the first slip.
    let profile = Some(WinchProfile::FirstSlip { factor: 0.5 });
    let first = Scene { winch_profile: profile, duration_s: 9.0, ..base() };
    let first = simulate(&first, 1).unwrap();
    assert!((first.events[0].onset_s - 2.0 * 1.24 * WEIGHT_N / 360.0).abs() < 1e-9);
    assert!((first.events[0].loading_rate_n_per_s - 180.0).abs() < 1e-9);
    assert!((first.events[1].loading_rate_n_per_s - 360.0).abs() < 1e-9);
    // Pauses: the line is flat at times, and the pauses have the requested duration.
    let profile = WinchProfile::Pauses { every_s: 4.0, least_s: 0.5, most_s: 0.5 };
    let long = Scene { winch_profile: Some(profile), duration_s: 400.0, ..base() };
    let samples = simulate(&long, 1).unwrap().samples;
    let flat = samples.windows(2).filter(|w| (w[0].true_force_n - w[1].true_force_n).abs() < 1e-9);
    let share = flat.count() as f64 / samples.len() as f64;
    assert!((share - 0.5 / 4.5 * 0.87).abs() < 0.03, "{share}");
}

#[test]
fn a_periodic_programme_begins_anew() {
    let steps = vec![[0.0, 1.0], [0.5, -1.0], [1.0, 0.0]];
    let profile = WinchProfile::Steps { steps, period_s: Some(2.0) };
    let scene = Scene { winch_profile: Some(profile), ..base() };
    for s in simulate(&scene, 0).unwrap().samples {
        let phase = s.time_s % 2.0;
        let expected = 360.0 * phase.min(1.0 - phase).max(0.0);
        assert!((s.true_force_n - expected).abs() < 1e-6, "{} s: {}", s.time_s, s.true_force_n);
    }
}

fn measured(measurement: Measurement) -> Vec<floe::sim::Sample> {
    simulate(&Scene { measurement, ..base() }, 7).unwrap().samples
}

#[test]
fn a_cell_that_lags() {
    let lag = Some(Lag { time_s: 0.03 });
    let seen = measured(Measurement { lag, ..Measurement::default() });
    let fine = Scene { rate_hz: 1600.0, duration_s: 6.0, ..Scene::default() };
    let fine = simulate(&fine, 7).unwrap().samples;
    let mut shown_n = fine[0].force_n;
    for (i, pair) in fine.windows(2).enumerate() {
        if i % 100 == 0 {
            let at = &seen[i / 100];
            assert!((at.force_n - shown_n).abs() < 0.3, "{} {shown_n}", at.force_n);
        }
        // Trapezium over 0.6 ms.
        let h = 1.0 / 1600.0 / 0.03;
        let mean_n = 0.5 * (pair[0].force_n + pair[1].force_n);
        shown_n = ((1.0 - 0.5 * h) * shown_n + h * mean_n) / (1.0 + 0.5 * h);
    }
}

#[test]
fn stamps_that_jitter_and_ramps() {
    let jitter = Some(Jitter { std_s: 5e-3 });
    let samples = measured(Measurement { jitter, ..Measurement::default() });
    // On the first line an error of the time appears as an error of the force.
    let line = samples.iter().take(32).map(|s| s.force_n / 360.0 - s.time_s);
    let errors: Vec<f64> = line.collect();
    let rms = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
    assert!((0.003..0.007).contains(&rms), "{rms}");

    let ramp = Some(Ramp { zero_n_per_s: 2.0, span_per_s: 0.01 });
    for s in measured(Measurement { ramp, ..Measurement::default() }) {
        let expected = s.true_force_n * (1.0 + 0.01 * s.time_s) + 2.0 * s.time_s;
        assert!((s.force_n - expected).abs() < 1e-9);
    }
}

#[test]
fn hum_of_the_mains_is_folded() {
    let hum = Some(Hum { amplitude_n: 5.0, hz: 50.0 });
    for s in measured(Measurement { hum, ..Measurement::default() }) {
        let folded = 5.0 * (std::f64::consts::TAU * 2.0 * s.time_s).sin();
        assert!((s.force_n - s.true_force_n - folded).abs() < 1e-6);
    }
}

/// Coloured noise leaves the white noise unchanged: it adds the same with and without white noise.
#[test]
fn new_terms_leave_the_others_alone() {
    let white = Measurement { white_n: 2.0, ..Measurement::default() };
    let coloured = Some(Coloured { std_n: 3.0, correlation: 0.9 });
    let plain = measured(white.clone());
    let both = measured(Measurement { coloured, ..white });
    let alone = measured(Measurement { coloured, ..Measurement::default() });
    let added: Vec<f64> = plain.iter().zip(&both).map(|(a, b)| b.force_n - a.force_n).collect();
    assert_eq!((added.len(), plain.len()), (alone.len(), both.len()));
    for (added, alone) in added.iter().zip(&alone) {
        assert!((added - (alone.force_n - alone.true_force_n)).abs() < 1e-9, "{added} {alone:?}");
    }
    // A record holds about ten correlation times.
    let variance = added.iter().map(|x| x * x).sum::<f64>() / added.len() as f64;
    assert!((1.0..30.0).contains(&variance), "{variance}");
}

#[test]
fn what_does_not_go_together_is_refused() {
    let good = "weight_n = 630.0\nmu_s = 1.24\nmu = 0.78\nstiffness_n_per_m = 23000.0\n\
                winch_m_per_s = 0.015\n";
    for (lines, expected) in [
        ("[cable_damping]\ncritical_fraction = 3.0", "cable_damping.critical_fraction = 3"),
        (
            "[cable_damping]\ncritical_fraction = 0.1\n[winch_profile]\nkind = \"ripple\"\n\
             fraction = 0.1\nperiod_s = 1.0",
            "not with a winch that ripples",
        ),
        ("[winch_profile]\nkind = \"steps\"\nsteps = [[2.0, 0.0], [1.0, 1.0]]", "out of order"),
        ("[measurement.lag]\ntime_s = 0.0", "measurement.lag.time_s = 0"),
        ("[measurement]\naperture_s = 0.01\nlag = { time_s = 0.03 }", "not together"),
        ("[measurement.jitter]\nstd_s = 0.05", "measurement.jitter.std_s = 0.05"),
        ("[stribeck]\nfalling_m_per_s = -1.0", "stribeck.falling_m_per_s = -1"),
    ] {
        let error = Scene::from_toml(&format!("{good}{lines}")).unwrap_err().to_string();
        assert!(error.contains(expected) && !error.contains('\n'), "{error}");
    }
}
