//! A scene as a stream of samples.

use super::check::SceneError;
use super::converter::{Converter, Delivery};
use super::motion::{Method, Segment};
use super::scene::Scene;
use super::signal::Signal;
use super::state::Phase;
use super::truth::{EventBuilder, TrueEvent};

/// One sample of a log, with its true values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Number of the sampling period, from 0.
    pub index: u32,
    /// Time in the log, s.
    pub time_s: f64,
    /// Force in the log, N.
    pub force_n: f64,
    /// Force in the cable at the time in the log, N.
    pub true_force_n: f64,
    /// State of the block.
    pub phase: Phase,
}

/// Computes a test sample by sample, in constant memory apart from the events.
#[derive(Debug)]
pub struct Run {
    signal: Signal,
    converter: Converter,
    builder: EventBuilder,
    events: Vec<TrueEvent>,
    again: Option<Sample>,
    rate_hz: f64,
    /// True seconds in one second of the log.
    clock: f64,
    aperture_s: f64,
    next_index: u32,
    count: u32,
}

impl Run {
    /// Starts a test. The same scene and seed give the same samples.
    ///
    /// # Errors
    /// A value of the scene out of its range.
    pub fn new(scene: &Scene, seed: u64) -> Result<Self, SceneError> {
        Self::with_method(scene, seed, Method::for_scene(scene))
    }

    /// Starts a test by a given method, to compare methods.
    ///
    /// # Errors
    /// A value of the scene is out of its range, or the scene has no closed form.
    pub fn with_method(scene: &Scene, seed: u64, method: Method) -> Result<Self, SceneError> {
        scene.validate()?;
        if method == Method::ClosedForm && !scene.is_linear() {
            return Err(SceneError("the scene has no closed form".to_owned()));
        }
        let clock = 1.0 + scene.measurement.clock_ppm * 1e-6;
        Ok(Self {
            signal: Signal::new(scene, seed, method),
            converter: Converter::new(&scene.measurement, seed),
            builder: EventBuilder::new(clock),
            events: Vec::new(),
            again: None,
            rate_hz: scene.rate_hz,
            clock,
            aperture_s: scene.measurement.aperture_s,
            next_index: 0,
            count: scene.sample_count(),
        })
    }

    /// Events that ended before the last sample taken.
    #[must_use]
    pub fn events(&self) -> &[TrueEvent] {
        let now_s = self.next_index.saturating_sub(1) as f64 / self.rate_hz;
        let ended = self.events.partition_point(|e| e.stop_s <= now_s);
        self.events.get(..ended).unwrap_or_default()
    }

    /// Why the samples ended early; `None` if they did not.
    #[must_use]
    pub fn failure(&self) -> Option<&str> {
        self.signal.failure()
    }

    fn take(&mut self, index: u32) -> Sample {
        let time_s = index as f64 / self.rate_hz;
        let true_s = time_s * self.clock;
        let delay_s = self.converter.delay_s();
        let (builder, events) = (&mut self.builder, &mut self.events);
        let meet = |segment: &Segment| events.extend(builder.push(segment));
        let taken_s = (true_s + delay_s).max(0.0);
        self.signal.cover(true_s.min(taken_s), true_s.max(taken_s) + self.aperture_s, meet);
        let (true_force_n, phase) = self.signal.force_n(true_s);
        let is_true = delay_s == 0.0 && self.signal.is_seen_as_it_is();
        let seen_n = if is_true { true_force_n } else { self.signal.seen_n(taken_s) };
        let force_n = self.converter.read_n(seen_n, true_s);
        Sample { index, time_s, force_n, true_force_n, phase }
    }
}

impl Iterator for Run {
    type Item = Sample;

    fn next(&mut self) -> Option<Sample> {
        if let Some(sample) = self.again.take() {
            return Some(sample);
        }
        loop {
            if self.next_index >= self.count || self.failure().is_some() {
                return None;
            }
            let sample = self.take(self.next_index);
            self.next_index += 1;
            if self.failure().is_some() {
                return None;
            }
            match self.converter.delivery() {
                Delivery::Never => {}
                Delivery::Once => return Some(sample),
                Delivery::Twice => {
                    self.again = Some(sample);
                    return Some(sample);
                }
            }
        }
    }
}
