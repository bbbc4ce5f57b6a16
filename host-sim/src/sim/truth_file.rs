//! True values of a simulated log as a JSON file.

use serde::Serialize;

use super::bound;
use super::motion::Method;
use super::run::{Run, Sample};
use super::scene::Scene;
use super::state::Phase;
use super::truth::TrueEvent;

/// Name and version of this format; changes when a meaning changes.
pub const SCHEMA: &str = "floe-truth/1";

/// The truth of a simulated log.
#[derive(Clone, Debug, Serialize)]
pub struct Truth {
    /// [`SCHEMA`].
    pub schema: &'static str,
    /// Always true: the log is not a field record.
    pub synthetic: bool,
    /// Seed of all random numbers.
    pub seed: u64,
    /// How the motion was computed.
    pub method: String,
    /// The terms that were on.
    pub terms: Vec<&'static str>,
    /// The scene, with its defaults.
    pub scene: Scene,
    /// Every event that ended within the record.
    pub events: Vec<TrueEvent>,
    /// State of the block at each sample, run-length encoded: the first index of each run.
    pub states: Vec<StateRun>,
}

/// A run of samples with the same state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct StateRun {
    /// Index of its first sample.
    pub from_index: u32,
    /// The state.
    pub state: Phase,
}

/// Collects the truth while the samples are generated.
#[derive(Clone, Debug, Default)]
pub struct TruthBuilder {
    states: Vec<StateRun>,
}

impl TruthBuilder {
    /// Takes the next sample.
    pub fn push(&mut self, sample: &Sample) {
        if self.states.last().is_none_or(|last| last.state != sample.phase) {
            self.states.push(StateRun { from_index: sample.index, state: sample.phase });
        }
    }

    /// The truth of a run that has ended.
    #[must_use]
    pub fn finish(self, scene: &Scene, seed: u64, run: &Run) -> Truth {
        let mut events = run.events().to_vec();
        bound::set_bounds(scene, &mut events);
        Truth {
            schema: SCHEMA,
            synthetic: true,
            seed,
            method: Method::for_scene(scene).to_string(),
            terms: scene.terms(),
            scene: scene.clone(),
            events,
            states: self.states,
        }
    }
}
