//! Simulated tests with known truth: `floe simulate`.
//!
//! ```text
//!  Scene ─► Segments ─► Run ─► Sample (log)
//!           motion      │
//!                       └────► TrueEvent (truth)
//! ```
//!
//! The symbols are the paper's: `F` force in the cable, `Fs` at slip onset, `Fp`
//! centre of the ellipse, `Fe` at re-stick, `k` stiffness, `w` winch speed,
//! `omega = sqrt(k/M)`.

pub mod along_slip;
pub mod bound;
mod check;
mod coloured;
mod converter;
pub mod damping;
mod decimal;
pub mod exact;
pub mod friction;
pub mod integrate;
pub mod joint;
mod lag;
pub mod measurement;
pub mod motion;
pub mod paper;
pub mod physics;
mod quadrature;
pub mod random;
pub mod rate_and_state;
pub mod rocking;
mod root;
pub mod run;
pub mod scene;
mod signal;
pub mod state;
pub mod step;
pub mod stribeck;
pub mod terms;
pub mod truth;
pub mod truth_file;
pub mod wander;
mod weighing;
pub mod winch;
pub mod write;

pub use check::SceneError;
pub use floe_core::units::STANDARD_GRAVITY_M_PER_S2;
pub use measurement::Measurement;
pub use motion::Method;
pub use run::{Run, Sample};
pub use scene::{Scene, Start};
pub use state::Phase;
pub use truth::TrueEvent;

/// A whole test in memory.
#[derive(Clone, Debug)]
pub struct Simulation {
    /// The samples of the log.
    pub samples: Vec<Sample>,
    /// Every event that ended within the record.
    pub events: Vec<TrueEvent>,
}

/// Computes a whole test. The same scene and seed give the same result.
///
/// # Errors
/// A value of the scene out of its range, or an integrator that gives up.
pub fn simulate(scene: &Scene, seed: u64) -> Result<Simulation, SceneError> {
    collect(Run::new(scene, seed)?)
}

/// Computes a whole test by a given method, to compare methods.
///
/// # Errors
/// A value of the scene is out of its range, the integrator gives up, or the scene has no closed
/// form.
pub fn simulate_by(scene: &Scene, seed: u64, method: Method) -> Result<Simulation, SceneError> {
    collect(Run::with_method(scene, seed, method)?)
}

fn collect(mut run: Run) -> Result<Simulation, SceneError> {
    let samples = run.by_ref().collect();
    match run.failure() {
        Some(failure) => Err(SceneError(failure.to_owned())),
        None => Ok(Simulation { samples, events: run.events().to_vec() }),
    }
}
