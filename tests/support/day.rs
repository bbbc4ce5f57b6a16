//! A first day on the ice: forces on the load cell, and console input.

use floe::sim::terms::Weighing;
use floe::sim::{Measurement, Scene, simulate};

/// Codes per newton.
pub const SPAN: f64 = 429.5;
/// Code of the empty hook.
const ZERO: f64 = 12_345.0;
/// Standard deviation of the converter's noise, in codes, and its seed.
pub const NOISE: (f64, u64) = (12.0, 5);
/// Shift of the zero after the pull, N.
pub const MOVED_N: f64 = 0.9;

/// Ticks at which parts of the day begin (16 per second).
const HANGING: u64 = 260;
const PULLED: u64 = 1040;
const SLACK: u64 = 2000;

/// Tick of the `status` command, after which the display shows the result.
pub const ASKED: u64 = 1950;
/// Tick before the end of the next event, at which the display is compared.
pub const LOOKED: u64 = 1969;

/// Force of the block on the tripod, N: 630 N, amplitude 5 degrees, period 2 s, noise 2 N.
#[must_use]
pub fn swinging(seconds: f64) -> Vec<f64> {
    let length_m = 9.80665 / std::f64::consts::PI.powi(2);
    let weighing = Some(Weighing { swing_deg: 5.0, length_m, damping_per_s: 0.0 });
    forces(&Scene { weighing, ..pull(seconds) }, 3)
}

/// The pull of test DFF8-13.
fn pull(duration_s: f64) -> Scene {
    let measurement = Measurement { white_n: 2.0, ..Measurement::default() };
    Scene { duration_s, measurement, ..Scene::default() }
}

fn forces(scene: &Scene, seed: u64) -> Vec<f64> {
    let simulation = simulate(scene, seed).expect("a valid scene");
    simulation.samples.iter().map(|sample| sample.force_n).collect()
}

/// Converter codes of forces, with `span` codes per newton.
#[must_use]
pub fn codes(forces_n: impl IntoIterator<Item = f64>, span: f64) -> Vec<i32> {
    forces_n.into_iter().map(|force_n| (ZERO + span * force_n).round() as i32).collect()
}

/// Forces on the cell during the whole day, N.
#[must_use]
pub fn day() -> Vec<f64> {
    let mut forces_n = vec![0.0; HANGING as usize];
    forces_n.extend(swinging(44.0));
    forces_n.resize(PULLED as usize, 0.0);
    forces_n.extend(forces(&pull(60.0), 1));
    forces_n.truncate(SLACK as usize);
    forces_n.resize(2400, MOVED_N);
    forces_n
}

/// Console input: each line is typed before the tick of its number.
pub const DAY: [(u64, &str); 22] = [
    (1, "clock 2027-03-02T10:15:00Z\n"),
    (2, "self-test\n"),
    (110, "tare\n"),
    (255, "accept\n"),
    (270, "weigh\n"),
    (930, "accept\n"),
    (950, "set range 5000\n"),
    (951, "set winch 0.0157\n"),
    (952, "set kind sliding\n"),
    (953, "set snow 10\n"),
    (954, "set size 1.2 1 0.3\n"),
    (955, "set track fresh\n"),
    (956, "set cable 15\n"),
    (957, "set name first pull\n"),
    (958, "set winch-std 0.0002\n"),
    (1030, "start\n"),
    (1500, "note wind from the side\n"),
    (ASKED, "status\n"),
    (1990, "stop\n"),
    (2010, "tare\n"),
    (2160, "accept\n"),
    (2161, "status\n"),
];
