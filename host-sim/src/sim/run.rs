//! A scene as a stream of samples.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

use super::motion::{Segment, Segments};
use super::scene::{Scene, SceneError};
use super::state::Phase;
use super::truth::{EventBuilder, TrueEvent};

/// One sample of a log, with the truth beside it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Number of the sampling period, from 0.
    pub index: u64,
    /// Time as the log has it, s.
    pub time_s: f64,
    /// Force as the log has it, N.
    pub force_n: f64,
    /// Force in the cable, N.
    pub true_force_n: f64,
    /// What the block did.
    pub phase: Phase,
}

/// Computes a test sample by sample, in constant memory apart from the events.
#[derive(Debug)]
pub struct Run {
    segments: Segments,
    segment: Segment,
    builder: EventBuilder,
    events: Vec<TrueEvent>,
    noise: ChaCha8Rng,
    white_n: f64,
    rate_hz: f64,
    next_index: u64,
    count: u64,
}

impl Run {
    /// Starts a test. The same scene and seed give the same samples.
    ///
    /// # Errors
    /// A value of the scene out of its range.
    pub fn new(scene: &Scene, seed: u64) -> Result<Self, SceneError> {
        scene.validate()?;
        let mut segments = Segments::new(scene);
        let segment = segments.next().ok_or_else(|| SceneError("no motion".to_owned()))?;
        let mut run = Self {
            segments,
            segment,
            builder: EventBuilder::new(scene),
            events: Vec::new(),
            noise: ChaCha8Rng::seed_from_u64(seed),
            white_n: scene.measurement.white_n,
            rate_hz: scene.rate_hz,
            next_index: 0,
            count: scene.sample_count(),
        };
        run.enter(segment);
        Ok(run)
    }

    /// Events that ended before the last sample taken.
    #[must_use]
    pub fn events(&self) -> &[TrueEvent] {
        let now_s = self.next_index.saturating_sub(1) as f64 / self.rate_hz;
        let ended = self.events.partition_point(|e| e.stop_s <= now_s);
        &self.events[..ended]
    }

    fn enter(&mut self, segment: Segment) {
        self.events.extend(self.builder.push(&segment));
        self.segment = segment;
    }

    fn advance_to(&mut self, time_s: f64) {
        while self.segment.to.time_s < time_s {
            match self.segments.next() {
                Some(segment) => self.enter(segment),
                None => return,
            }
        }
    }
}

impl Iterator for Run {
    type Item = Sample;

    fn next(&mut self) -> Option<Sample> {
        if self.next_index >= self.count {
            return None;
        }
        let index = self.next_index;
        self.next_index += 1;
        let time_s = index as f64 / self.rate_hz;
        self.advance_to(time_s);
        let true_force_n = self.segment.force_n(time_s);
        let mut force_n = true_force_n;
        if self.white_n > 0.0 {
            let z: f64 = StandardNormal.sample(&mut self.noise);
            force_n += self.white_n * z;
        }
        Some(Sample { index, time_s, force_n, true_force_n, phase: self.segment.phase })
    }
}
