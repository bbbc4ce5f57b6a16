//! Feeds samples to the core and collects events and report.

use floe::replay::without_losses;
use floe_core::signal::window::WINDOW;
use floe_core::{Config, Event, Losses, Newtons, Pipeline, RawSample, Reading, Report, Stretch};

/// Results of a pipeline.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// All events, including the pending one.
    pub events: Vec<Event>,
    /// Stretches without events.
    pub stretches: Vec<Stretch>,
    /// The report at the end.
    pub report: Report,
}

/// A force in newtons at an index.
#[must_use]
pub fn force(index: u32, force_n: f64) -> RawSample {
    RawSample { index, reading: Reading::Force(Newtons(force_n as f32)) }
}

/// Samples from consecutive forces, with indices from zero.
pub fn in_a_row(forces_n: &[f64]) -> impl Iterator<Item = RawSample> + '_ {
    (0..).zip(forces_n).map(|(index, &force_n)| force(index, force_n))
}

/// Feeds a whole test.
///
/// # Panics
/// The configuration is refused.
pub fn replay(config: &Config, samples: impl IntoIterator<Item = RawSample>) -> Outcome {
    replay_with(config, samples, |_, event| event)
}

/// Feeds a whole test, and applies the cable's losses known at its end to every event, as a replay
/// does.
///
/// # Panics
/// The configuration is refused.
pub fn replay_in_hindsight(
    config: &Config,
    samples: impl IntoIterator<Item = RawSample>,
) -> Outcome {
    let mut outcome = replay_with(config, samples, without_losses);
    let losses = Losses::of(config, &outcome.report);
    for event in &mut outcome.events {
        [event.mu_s, event.mu] = losses.put_on([event.mu_s, event.mu]);
    }
    outcome
}

/// Feeds a whole test; `told` converts each event before it is kept.
fn replay_with(
    config: &Config,
    samples: impl IntoIterator<Item = RawSample>,
    told: impl Fn(&Pipeline, Event) -> Event,
) -> Outcome {
    let mut pipeline = Pipeline::new(config).expect("the configuration is valid");
    let (mut events, mut stretches) = (Vec::new(), Vec::new());
    for sample in samples {
        let step = pipeline.step(sample);
        events.extend(step.event.map(|event| told(&pipeline, event)));
        stretches.extend(step.stretch);
    }
    events.extend(finish_with(&mut pipeline, &told));
    let report = pipeline.report();
    stretches.extend(std::iter::from_fn(|| pipeline.finish_stretch()));
    Outcome { events, stretches, report }
}

/// Feeds samples to a running test.
pub fn feed(pipeline: &mut Pipeline, samples: impl IntoIterator<Item = RawSample>) -> Vec<Event> {
    samples.into_iter().filter_map(|sample| pipeline.step(sample).event).collect()
}

/// Ends a test.
///
/// # Panics
/// The pipeline does not stop returning events.
pub fn finish(pipeline: &mut Pipeline) -> Vec<Event> {
    finish_with(pipeline, &|_, event| event)
}

fn finish_with(pipeline: &mut Pipeline, told: &impl Fn(&Pipeline, Event) -> Event) -> Vec<Event> {
    // The window holds samples still to be processed; a slip takes two or more.
    const MOST: usize = WINDOW / 2;
    let next = || {
        let event = pipeline.finish()?;
        Some(told(pipeline, event))
    };
    let events: Vec<Event> = std::iter::from_fn(next).take(MOST).collect();
    assert!(events.len() < MOST, "finish gives the pending events and then nothing");
    events
}
