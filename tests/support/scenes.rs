//! Pulls used by several tests, and the scenes in files.

use std::path::Path;

use floe::sim::Scene;
use floe_core::units::STANDARD_GRAVITY_M_PER_S2;
use floe_core::{Config, InputStd};

use crate::brute::Pull;

/// White noise of every scene, N.
pub const NOISE_N: f64 = 2.0;

/// Test DFF8-13.
#[must_use]
pub fn dff8_13() -> Pull {
    Pull { noise_n: NOISE_N, ..Pull::default() }
}

/// The heaviest block of the field study.
#[must_use]
pub fn heavy() -> Pull {
    Pull { weight_n: 3000.0, mu_s: 0.9, mu: 0.55, ..dff8_13() }
}

/// The fastest winch.
#[must_use]
pub fn fast() -> Pull {
    Pull { winch_m_per_s: 0.04, ..dff8_13() }
}

/// Mean values of the study's tests on snow.
#[must_use]
pub fn snow() -> Pull {
    Pull { weight_n: 900.0, mu_s: 1.0, mu: 0.62, ..dff8_13() }
}

/// The lightest block, with slips of 1.8 samples.
#[must_use]
pub fn light() -> Pull {
    Pull { weight_n: 300.0, mu_s: 0.9, mu: 0.56, ..dff8_13() }
}

/// A scene of `host-sim/scenes`; `hard/flop` is the file `hard/flop.toml`.
///
/// # Panics
/// The scene does not exist, or cannot be read.
#[must_use]
pub fn stored(name: &str) -> Scene {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../host-sim/scenes");
    let file = folder.join(format!("{name}.toml"));
    let text = std::fs::read_to_string(&file).unwrap_or_else(|e| panic!("{name}: {e}"));
    Scene::from_toml(&text).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// Slips that last and recur these numbers of samples, on a cable that swings in twice the slip's
/// time; the winch stretches it by a drop within a rest.
#[must_use]
pub fn quick(recurrence: f64, slip: f64) -> Scene {
    let base = stored("honesty/base");
    let (weight_n, mu_s, mu) = (630.0, 1.0, 0.7);
    let omega = std::f64::consts::PI * base.rate_hz / slip;
    let stiffness_n_per_m = omega * omega * weight_n / STANDARD_GRAVITY_M_PER_S2;
    let drop_n = 2.0 * (mu_s - mu) * weight_n;
    let winch_m_per_s = drop_n / stiffness_n_per_m * base.rate_hz / (recurrence - slip);
    Scene { weight_n, mu_s, mu, stiffness_n_per_m, winch_m_per_s, ..base }
}

/// Configuration of the core for a pull.
#[must_use]
pub fn config(pull: &Pull) -> Config {
    Config {
        rate_hz: pull.rate_hz as f32,
        weight_n: pull.weight_n as f32,
        slope_rad: pull.slope_rad as f32,
        std: InputStd::EXACT,
        ..Config::default()
    }
}

/// The pull as a scene of the simulator, with white noise only.
#[must_use]
pub fn scene(pull: &Pull) -> Scene {
    let mut scene = Scene {
        weight_n: pull.weight_n,
        mu_s: pull.mu_s,
        mu: pull.mu,
        stiffness_n_per_m: pull.stiffness_n_per_m,
        winch_m_per_s: pull.winch_m_per_s,
        slope_deg: pull.slope_rad.to_degrees(),
        rate_hz: pull.rate_hz,
        duration_s: pull.duration_s,
        ..Scene::default()
    };
    scene.measurement.white_n = pull.noise_n;
    scene
}
