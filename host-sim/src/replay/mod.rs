//! A recorded log through the core: `floe replay`.

use floe_core::{Config, Event, Pipeline, SampleFlag, Step, Stretch};

use crate::error::InputError;
use crate::log::{Log, Sample};

pub mod abridged;
pub mod batches;
pub mod budget;
pub mod doubts;
pub mod events;
pub mod given;
pub mod input;
pub mod known;
pub mod quantities;
pub mod rails;
mod recurrence;
pub mod result;
pub mod samples;
mod slide;
pub mod stretches;
pub mod table;
pub mod test;
pub mod timeline;

use events::{Events, Means};
use rails::Rails;
use result::{ChangeSummary, EffectSummary, EventSummary, LogSummary, ReplayResult, TestSummary};
use stretches::Stretches;
use test::{Around, TestOptions};
use timeline::Timeline;

/// Runs a whole log through the core in constant memory.
/// The log is read on a second thread.
///
/// `path` is only named in the result. `observe` sees every sample's time, in the
/// log's own seconds, and what the core made of it.
///
/// # Errors
/// A line of the log that cannot be used.
pub fn replay(
    path: &str,
    log: &mut Log,
    config: &Config,
    observe: impl FnMut(f64, &Step),
) -> Result<ReplayResult, InputError> {
    let around = Around { keeps_means: true, ..TestOptions::default().around() };
    replay_with(path, log, config, around, observe)
}

/// The same with what the caller says beside the configuration. A zero of the load cell to
/// take off needs the whole log in memory.
///
/// # Errors
/// A line of the log that cannot be used.
pub fn replay_with(
    path: &str,
    log: &mut Log,
    config: &Config,
    around: Around,
    mut observe: impl FnMut(f64, &Step),
) -> Result<ReplayResult, InputError> {
    let Around { known, keeps_means } = around;
    let zero = known.zero(log);
    let refused = |error: floe_core::ConfigError| InputError::new(error.to_string());
    // A zero is taken off what is within the range, which is that of the cell.
    let range_n = config.range_n.filter(|_| zero.is_nothing());
    let mut pipeline = Pipeline::new(&Config { range_n, ..*config }).map_err(refused)?;
    let (mut timeline, period_s) = (Timeline::new(log.rate_hz()), 1.0 / log.rate_hz());
    let (mut events, mut changes, mut kept) = (Events::default(), Vec::new(), Ok(()));
    let (mut stretches, mut rails) = (Stretches::default(), Rails::default());
    let means = |pipeline: &Pipeline| if keeps_means { so_far(pipeline) } else { Means::default() };
    let mut marks = log.metadata().winch_marks.clone().into_iter().flatten().peekable();
    let mut take = |sample: Sample| {
        timeline.push(sample.raw.index, sample.time_s);
        while let Some(mark) = marks.next_if(|it| it.from_s < sample.time_s + 0.5 * period_s) {
            pipeline.mark_winch(mark.turns);
        }
        let step = pipeline.step(sample.raw);
        observe(sample.time_s, &step);
        if let Some(force_n) = step.sample.force_n {
            rails.push(force_n);
        }
        if step.sample.flag == SampleFlag::Good {
            events.recurrence.sample(sample.time_s, period_s);
        }
        if let Some(event) = &step.event
            && kept.is_ok()
        {
            kept = events.push(summary(event, &pipeline, &timeline), || means(&pipeline));
        }
        if let Some(change) = &step.change {
            changes.push(ChangeSummary::new(change, timeline.seconds(change.onset)));
        }
        if let Some(stretch) = &step.stretch {
            let (start_s, stop_s) = add(&mut stretches, stretch, config, &timeline);
            events.recurrence.stretch(start_s, stop_s);
        }
    };
    if zero.is_nothing() {
        batches::for_each_sample(log, take)?;
    } else {
        let mut samples = Vec::new();
        batches::for_each_sample(log, |sample| samples.push(sample))?;
        zero.take_off(&mut samples, config);
        samples.into_iter().for_each(&mut take);
    }
    while let (Some(event), true) = (pipeline.finish(), kept.is_ok()) {
        kept = events.push(summary(&event, &pipeline, &timeline), || means(&pipeline));
    }
    kept.map_err(|e| {
        InputError::new(format!(
            "events cannot be kept in a temporary file: {e}; name a folder with room in TMPDIR"
        ))
    })?;
    while let Some(stretch) = pipeline.finish_stretch() {
        add(&mut stretches, &stretch, config, &timeline);
    }
    events.start = log.start();
    let report = pipeline.report();
    // The last events may have told one, after the last step.
    if let Some(change) = &report.change
        && changes.last().is_none_or(|it| it.event != change.event)
    {
        changes.push(ChangeSummary::new(change, timeline.seconds(change.onset)));
    }
    let log_summary = LogSummary {
        path: path.to_string(),
        format: log.format().name().to_string(),
        rate_hz: log.rate_hz(),
        duration_s: timeline.duration_s(),
        synthetic: log.metadata().synthetic.clone(),
        ..LogSummary::from(report.counters)
    };
    let test = TestSummary {
        test_id: log.metadata().test_id.clone(),
        weight_n: config.weight_n.into(),
        slope_rad: config.slope_rad.into(),
        mass_kg: config.mass_kg.map(f64::from),
    };
    let result = ReplayResult::new(log_summary, test, (config, &report), events, changes);
    let effects = pipeline.findings().iter().map(EffectSummary::from).collect();
    let mut result = ReplayResult { effects, stretches, ..result };
    let doubts = doubts::doubts(log, (config, &known), &report, result.sags());
    result.log.warnings = [log.warnings(), doubts, rails.warnings()].concat();
    Ok(result)
}

/// Both means as they are known now.
fn so_far(pipeline: &Pipeline) -> Means {
    let report = pipeline.report();
    [report.mu_s.into(), report.mu.into()]
}

/// Gives its begin and its end.
fn add(
    stretches: &mut Stretches,
    it: &Stretch,
    config: &Config,
    timeline: &Timeline,
) -> (f64, f64) {
    let (start_s, stop_s) = (timeline.seconds(it.start), timeline.seconds(it.stop));
    stretches.add(it, config, start_s, stop_s);
    (start_s, stop_s)
}

fn summary(event: &Event, pipeline: &Pipeline, timeline: &Timeline) -> EventSummary {
    let event = without_losses(pipeline, *event);
    EventSummary::new(&event, timeline.seconds(event.onset), timeline.seconds(event.stop))
}

/// An event that just came without the losses of the cable: what they are the whole test tells,
/// with [`floe_core::Losses::put_on`].
#[must_use]
pub fn without_losses(pipeline: &Pipeline, event: Event) -> Event {
    let [mu_s, mu] = pipeline.losses().taken_off([event.mu_s, event.mu]);
    Event { mu_s, mu, ..event }
}
