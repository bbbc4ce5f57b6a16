//! Floe's pipeline as a method, as in the firmware and the replay.

use floe_core::{Coefficient, Config, Event, Newtons, Phase, Pipeline, RawSample, Reading};

use super::method::{Found, Method, Sample, Setup, Tick, Value};

/// The method; if the pipeline rejects the setup there are no events.
#[derive(Clone, Debug)]
pub struct Floe {
    rate_hz: f64,
    pipeline: Option<Pipeline>,
}

impl Method for Floe {
    const NAME: &'static str = "floe";

    fn new(setup: &Setup) -> Self {
        let config = Config {
            rate_hz: setup.rate_hz as f32,
            weight_n: setup.weight_n as f32,
            slope_rad: setup.slope_rad as f32,
            range_n: setup.range_n.map(|range_n| range_n as f32),
            ..Config::default()
        };
        Self { rate_hz: setup.rate_hz, pipeline: Pipeline::new(&config).ok() }
    }

    fn step(&mut self, sample: Sample) -> Tick {
        let reading = Reading::Force(Newtons(sample.force_n));
        let Some(pipeline) = &mut self.pipeline else { return Tick::default() };
        let step = pipeline.step(RawSample { index: sample.index, reading });
        Tick {
            slips: step.phase == Phase::Slip,
            event: step.event.map(|event| found(&event, self.rate_hz)),
        }
    }

    fn finish(&mut self) -> Option<Found> {
        let event = self.pipeline.as_mut()?.finish()?;
        Some(found(&event, self.rate_hz))
    }

    fn state_bytes(&self) -> usize {
        size_of::<Pipeline>()
    }
}

fn found(event: &Event, rate_hz: f64) -> Found {
    let value = |c: Coefficient| Value { value: c.value.into(), std: Some(c.std.into()) };
    Found {
        onset_s: (event.onset.index as f64 + f64::from(event.onset.fraction)) / rate_hz,
        mu_s: event.mu_s.map(value),
        mu: event.mu.map(value),
    }
}
