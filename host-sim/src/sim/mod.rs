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

pub mod exact;
pub mod measurement;
pub mod motion;
pub mod run;
pub mod scene;
pub mod state;
pub mod truth;
mod validate;
pub mod write;

pub use measurement::Measurement;
pub use run::{Run, Sample};
pub use scene::{Scene, SceneError, Start};
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
/// A value of the scene out of its range.
pub fn simulate(scene: &Scene, seed: u64) -> Result<Simulation, SceneError> {
    let mut run = Run::new(scene, seed)?;
    let samples = run.by_ref().collect();
    Ok(Simulation { samples, events: run.events().to_vec() })
}
