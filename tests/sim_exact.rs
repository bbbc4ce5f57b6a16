//! The closed form against a brute-force integration of the equations of motion.

use floe::sim::motion::Segments;
use floe::sim::state::End;
use floe::sim::{Method, Phase, Scene, simulate};
use floe_core::units::STANDARD_GRAVITY_M_PER_S2 as GRAVITY;

/// Force, speed, slack and distance by classical Runge-Kutta with a tiny step; events are taken at
/// the end of their step. Uses equations (2) and (3) only.
struct BruteForce<'a> {
    scene: &'a Scene,
    phase: Phase,
    /// Force divided by stiffness (negative when slack), and speed.
    extension_m: f64,
    speed_m_per_s: f64,
}

impl BruteForce<'_> {
    fn accelerate(&self, extension_m: f64, speed: f64) -> (f64, f64) {
        let s = self.scene;
        let (sin, cos) = s.slope_rad().sin_cos();
        let force_n = s.stiffness_n_per_m * extension_m.max(0.0);
        let resistance_n = s.weight_n * (sin + s.mu * cos);
        (s.winch_m_per_s - speed, (force_n - resistance_n) / (s.weight_n / GRAVITY))
    }

    fn step(&mut self, h: f64) -> Option<End> {
        let (sin, cos) = self.scene.slope_rad().sin_cos();
        let static_n = self.scene.weight_n * (sin + self.scene.mu_s * cos);
        if self.phase == Phase::Stick {
            self.extension_m += self.scene.winch_m_per_s * h;
            let onset = self.extension_m * self.scene.stiffness_n_per_m >= static_n;
            self.phase = if onset { Phase::Slip } else { Phase::Stick };
            return onset.then_some(End::Onset);
        }
        let (e, v) = (self.extension_m, self.speed_m_per_s);
        let k1 = self.accelerate(e, v);
        let k2 = self.accelerate(e + 0.5 * h * k1.0, v + 0.5 * h * k1.1);
        let k3 = self.accelerate(e + 0.5 * h * k2.0, v + 0.5 * h * k2.1);
        let k4 = self.accelerate(e + h * k3.0, v + h * k3.1);
        self.extension_m += h / 6.0 * (k1.0 + 2.0 * k2.0 + 2.0 * k3.0 + k4.0);
        self.speed_m_per_s += h / 6.0 * (k1.1 + 2.0 * k2.1 + 2.0 * k3.1 + k4.1);
        if self.speed_m_per_s > 0.0 {
            return None;
        }
        self.speed_m_per_s = 0.0;
        self.phase = Phase::Stick;
        Some(End::Stop)
    }
}

/// Times of onsets and stops, and the force at each sample.
fn brute_force(scene: &Scene, h: f64) -> (Vec<(End, f64)>, Vec<f64>) {
    let mut block = BruteForce { scene, phase: Phase::Stick, extension_m: 0.0, speed_m_per_s: 0.0 };
    let per_sample = (1.0 / scene.rate_hz / h).round() as u64;
    let (mut events, mut forces) = (Vec::new(), Vec::new());
    for step in 0..(scene.duration_s / h).round() as u64 {
        if step % per_sample == 0 {
            forces.push(scene.stiffness_n_per_m * block.extension_m.max(0.0));
        }
        if let Some(end) = block.step(h) {
            events.push((end, (step + 1) as f64 * h));
        }
    }
    (events, forces)
}

fn agrees(scene: &Scene, h: f64, force_tolerance_n: f64) {
    let (events, forces) = brute_force(scene, h);
    let exact = simulate(scene, 0).unwrap();
    assert!(exact.events.len() >= 2, "the case must have events");
    let expected: Vec<f64> = exact.events.iter().flat_map(|e| [e.onset_s, e.stop_s]).collect();
    // The end of the test may cut the last slip, of which only the onset is there.
    assert!(
        (0..2).contains(&(events.len() - expected.len())),
        "{} {}",
        events.len(),
        expected.len()
    );
    assert_eq!(exact.samples.len(), forces.len());
    for ((_, brute), exact) in events.iter().zip(expected) {
        // Each event is late by up to one step in this integration, and delays all that follow.
        let tolerance = h * (events.len() as f64 + 1.0);
        assert!((brute - exact).abs() < tolerance, "{brute} {exact} {tolerance}");
    }
    for (sample, brute) in exact.samples.iter().zip(&forces) {
        let difference = (sample.true_force_n - brute).abs();
        assert!(difference < force_tolerance_n, "{} s: {difference} N", sample.time_s);
    }
}

fn short() -> Scene {
    Scene { duration_s: 8.0, ..Scene::default() }
}

#[test]
fn dff8_13_agrees_with_brute_force() {
    agrees(&short(), 1.0 / 16.0 / 65536.0, 0.2);
}

#[test]
fn uphill_and_downhill_agree_with_brute_force() {
    for slope_deg in [-6.0, 6.0] {
        agrees(&Scene { slope_deg, ..short() }, 1.0 / 16.0 / 65536.0, 0.2);
    }
}

#[test]
fn slack_cable_agrees_with_brute_force() {
    let scene = Scene { mu_s: 1.0, mu: 0.4, ..short() };
    assert!(simulate(&scene, 0).unwrap().events.iter().all(|e| e.slack && e.slack_m > 0.0));
    agrees(&scene, 1.0 / 16.0 / 65536.0, 0.2);
}

/// At a high pull rate the cable goes slack and taut again while the block moves.
#[test]
fn cable_taut_again_while_sliding_agrees_with_brute_force() {
    let scene = Scene { mu_s: 0.8, mu: 0.5, winch_m_per_s: 0.3, duration_s: 4.0, ..short() };
    let phases: Vec<_> =
        Segments::new(&scene, 0, Method::ClosedForm).take(4).map(|s| s.phase).collect();
    assert_eq!(phases, [Phase::Stick, Phase::Slip, Phase::SlackSliding, Phase::Slip]);
    agrees(&scene, 1.0 / 16.0 / 65536.0, 1.5);
}

#[test]
fn equations_16_22_25_and_31_hold() {
    for (weight_n, mu_s, mu, k, w) in [
        (630.0, 1.24, 0.78, 23e3, 0.0157),
        (3000.0, 0.7, 0.4, 23e3, 0.02),
        (300.0, 1.1, 0.7, 23e3, 0.04),
        (900.0, 1.0, 0.62, 230e3, 0.001),
    ] {
        let scene = Scene {
            weight_n,
            mu_s,
            mu,
            stiffness_n_per_m: k,
            winch_m_per_s: w,
            duration_s: 60.0,
            ..Scene::default()
        };
        let events = simulate(&scene, 0).unwrap().events;
        assert!(events.len() > 1, "{weight_n} N: the case must have events");
        let drop_n = (mu_s - mu) * weight_n;
        let omega = (k / (weight_n / GRAVITY)).sqrt();
        let a = drop_n.hypot(k * w / omega);
        for pair in events.windows(2) {
            let (e, next) = (&pair[0], &pair[1]);
            let close = |x: f64, y: f64| assert!((x - y).abs() < 1e-9 * y.abs(), "{x} {y}");
            close(e.restick_force_n, 2.0 * mu * weight_n - mu_s * weight_n);
            close(e.peak_force_n, mu * weight_n + a);
            close(next.stick_s, 2.0 * drop_n / (k * w));
            let half_turn = (drop_n / a).acos() + std::f64::consts::FRAC_PI_2;
            close(e.slip_s, 2.0 / omega * half_turn);
        }
    }
}
