//! The integrator compared with the closed form on linear scenes, and the energy balance of both.

use floe::sim::motion::{Segment, Segments};
use floe::sim::{Method, Phase, Scene, simulate, simulate_by};
use floe_core::units::STANDARD_GRAVITY_M_PER_S2 as GRAVITY;

const INTEGRATOR: Method = Method::Integrator { tolerance: 5e-14 };

/// Largest differences of forces, relative to the weight, and of event times.
fn differences(scene: &Scene) -> (f64, f64) {
    let exact = simulate(scene, 0).unwrap();
    let integrated = simulate_by(scene, 0, INTEGRATOR).unwrap();
    assert_eq!(exact.events.len(), integrated.events.len(), "{scene:?}");
    assert!(!exact.events.is_empty(), "the case must have events");
    let force = exact.samples.iter().zip(&integrated.samples);
    let force = force.map(|(a, b)| (a.true_force_n - b.true_force_n).abs() / scene.weight_n);
    let times = exact.events.iter().zip(&integrated.events);
    let times =
        times.flat_map(|(a, b)| [(a.onset_s - b.onset_s).abs(), (a.stop_s - b.stop_s).abs()]);
    (force.fold(0.0, f64::max), times.fold(0.0, f64::max))
}

fn slack() -> Scene {
    Scene { mu_s: 1.0, mu: 0.4, ..Scene::default() }
}

fn taut_again() -> Scene {
    Scene { mu_s: 0.8, mu: 0.5, winch_m_per_s: 0.3, ..Scene::default() }
}

#[test]
fn integrator_agrees_with_closed_form() {
    let slope = Scene { slope_deg: 6.0, ..Scene::default() };
    for scene in [Scene::default(), slope, slack(), taut_again()] {
        let (force, time_s) = differences(&scene);
        println!("force {force:.1e} of the weight, events {time_s:.1e} s");
        assert!(force < 1e-9, "{force}");
        assert!(time_s < 1e-9, "{time_s}");
    }
}

/// A scene that starts at the beginning of a stick and lasts three recurrences.
fn corner(k: f64, difference: f64, w: f64) -> Scene {
    let mu = 0.6;
    let weight_n = 630.0;
    let (mu_s, restick_n) = (mu + difference, weight_n * (mu - difference));
    let omega = (k / (weight_n / GRAVITY)).sqrt();
    let stick_s = 2.0 * difference * weight_n / (k * w);
    let way_s = weight_n * (mu_s + mu) / (k * w);
    Scene {
        weight_n,
        mu_s,
        mu,
        stiffness_n_per_m: k,
        winch_m_per_s: w,
        start_force_n: restick_n.max(0.0),
        rate_hz: 16.0,
        duration_s: 3.0 * (stick_s + 6.3 / omega) + if restick_n < 0.0 { way_s } else { 0.0 },
        ..Scene::default()
    }
}

#[test]
fn corners_keep_their_event_times_to_a_microsecond() {
    let (mut worst, mut cases) = (0.0_f64, 0);
    for k in [1e3, 23e3, 230e3, 1e7] {
        for difference in [1e-4, 1e-2, 0.3, 1.0] {
            for w in [1e-4, 0.0157, 1.0] {
                let scene = corner(k, difference, w);
                let mut exact = Segments::new(&scene, 0, Method::ClosedForm);
                let mut integrated = Segments::new(&scene, 0, INTEGRATOR);
                for _ in 0..12 {
                    let a = exact.next().unwrap();
                    let b = whole_phase(&mut integrated);
                    assert_eq!((a.phase, a.end), (b.phase, b.end), "{k} {difference} {w}");
                    worst = worst.max((a.to.time_s - b.to.time_s).abs());
                    cases += 1;
                }
            }
        }
    }
    println!("{cases} events, worst difference {worst:.1e} s");
    assert!(worst < 1e-6, "{worst}");
}

/// Runs one phase up to its event.
fn whole_phase(segments: &mut Segments) -> Segment {
    loop {
        let segment = segments.next().unwrap();
        if segment.end != floe::sim::state::End::Continue {
            return segment;
        }
    }
}

/// At `a = Fp` the cable is about to go slack; a small change must not move the events.
#[test]
fn a_cable_about_to_go_slack_keeps_its_event_times() {
    let base = Scene { mu_s: 1.2, mu: 0.7, duration_s: 20.0, ..Scene::default() };
    let omega = (base.stiffness_n_per_m / (base.weight_n / GRAVITY)).sqrt();
    // a² = (0.5 Mg)² + (k w / omega)² = (0.7 Mg)²
    let sine_n = base.weight_n * (0.7_f64.powi(2) - 0.5_f64.powi(2)).sqrt();
    let touching = sine_n * omega / base.stiffness_n_per_m;
    let events = |w: f64| simulate(&Scene { winch_m_per_s: w, ..base.clone() }, 0).unwrap().events;
    let (below, at, above) =
        (events(touching * (1.0 - 1e-12)), events(touching), events(touching * (1.0 + 1e-12)));
    assert!(!below[0].slack && above[0].slack);
    assert_eq!([below.len(), above.len()], [at.len(); 2]);
    for (b, (m, a)) in below.iter().zip(at.iter().zip(&above)) {
        for (x, y) in [(b.onset_s, m.onset_s), (m.onset_s, a.onset_s), (b.stop_s, a.stop_s)] {
            assert!((x - y).abs() < 1e-6, "{x} {y}");
        }
    }
}

/// Work of the winch by Gauss-Legendre quadrature on panels that resolve the ellipse, independent
/// of the closed form's antiderivatives.
fn winch_work_j(segment: &Segment, until_s: f64, w: f64) -> f64 {
    let end_s = segment.to.time_s.min(until_s);
    let omega = segment.mechanics.omega_rad_per_s();
    let moving = segment.phase == Phase::Slip;
    let panels =
        if moving { ((end_s - segment.from.time_s) * omega * 4.0).ceil().max(1.0) } else { 1.0 };
    let width = (end_s - segment.from.time_s) / panels;
    let offset = (3.0_f64 / 5.0).sqrt() / 2.0;
    let points = [(0.5 - offset, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.5 + offset, 5.0 / 18.0)];
    let halves = |i: usize| segment.from.time_s + (i as f64) * width / 8.0;
    (0..8 * panels as usize)
        .flat_map(|i| points.map(|(x, weight)| (halves(i) + x * width / 8.0, weight)))
        .map(|(t, weight)| weight * segment.force_n(t) * width / 8.0 * w)
        .sum()
}

/// Work of the winch, and sum of friction, kinetic and elastic energy, at the end.
fn energies(scene: &Scene, method: Method) -> (f64, f64) {
    let (mut work_j, mut friction_j) = (0.0, 0.0);
    let end_s = scene.duration_s;
    let mut last = None;
    for segment in Segments::new(scene, 0, method) {
        work_j += winch_work_j(&segment, end_s, scene.winch_m_per_s);
        let to = if segment.to.time_s > end_s { segment.state(end_s) } else { segment.to };
        friction_j += segment.mechanics.dynamic_force_n * (to.position_m - segment.from.position_m);
        last = Some((segment.mechanics, to));
        if segment.to.time_s > end_s {
            break;
        }
    }
    let (mechanics, to) = last.unwrap();
    let kinetic_j = 0.5 * mechanics.mass_kg * to.speed_m_per_s.powi(2);
    let elastic_j = 0.5 * to.force_n.powi(2) / scene.stiffness_n_per_m;
    (work_j, friction_j + kinetic_j + elastic_j)
}

#[test]
fn energy_balance_closes() {
    for scene in [Scene::default(), slack(), taut_again()] {
        for method in [Method::ClosedForm, INTEGRATOR] {
            let (work_j, spent_j) = energies(&scene, method);
            println!("{method:?}: work {work_j:.6} J, open {:.1e}", spent_j / work_j - 1.0);
            assert!((spent_j / work_j - 1.0).abs() < 1e-9, "{work_j} {spent_j}");
        }
    }
}
