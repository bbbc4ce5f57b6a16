//! What a replay gathers while the samples go through the core.

use std::io;
use std::iter::Peekable;
use std::vec;

use floe_core::{Config, Effect, Event, Pipeline, Report, SampleFlag, Step, Stretch};

use crate::error::InputError;
use crate::log::winch_marks::WinchMark;
use crate::log::{Log, Sample};

use super::events::{Events, Means};
use super::known::KnownOptions;
use super::rails::Rails;
use super::result::{
    ChangeSummary, EffectSummary, EventSummary, LogSummary, ReplayResult, TestSummary,
};
use super::stretches::Stretches;
use super::timeline::Timeline;
use super::{doubts, held, level, without_losses};

pub(super) struct Gathered<'a> {
    config: &'a Config,
    pipeline: Pipeline,
    keeps_means: bool,
    period_s: f64,
    /// What was said of the winch, still to come.
    winch_marks: Peekable<vec::IntoIter<WinchMark>>,
    /// Time of the first of all.
    marked_s: Option<f64>,
    timeline: Timeline,
    events: Events,
    /// Whether the events could be kept.
    kept: io::Result<()>,
    changes: Vec<ChangeSummary>,
    stretches: Stretches,
    rails: Rails,
}

impl<'a> Gathered<'a> {
    pub fn new(config: &'a Config, pipeline: Pipeline, log: &Log, keeps_means: bool) -> Self {
        let rate_hz = log.rate_hz();
        let marks = log.metadata().winch_marks.clone().unwrap_or_default();
        Self {
            config,
            pipeline,
            keeps_means,
            period_s: 1.0 / rate_hz,
            marked_s: marks.first().map(|mark| mark.from_s),
            winch_marks: marks.into_iter().peekable(),
            timeline: Timeline::new(rate_hz),
            events: Events::default(),
            kept: Ok(()),
            changes: Vec::new(),
            stretches: Stretches::default(),
            rails: Rails::default(),
        }
    }

    /// Takes the next sample; `read_n`: its force before a zero was taken off. `observe` sees what the
    /// core made of it: a step is long, and stays where it is.
    pub fn take(&mut self, sample: Sample, read_n: Option<f32>, observe: impl FnOnce(&Step)) {
        self.timeline.push(sample.raw.index, sample.time_s);
        let next_s = sample.time_s + 0.5 * self.period_s;
        while let Some(mark) = self.winch_marks.next_if(|mark| mark.from_s < next_s) {
            self.pipeline.mark_winch(mark.turns);
        }
        let step = self.pipeline.step(sample.raw);
        if let Some(force_n) = step.sample.force_n {
            // The limit is that of the cell, which knows no zero.
            self.rails.push(read_n.unwrap_or(force_n));
        }
        if step.sample.flag == SampleFlag::Good {
            self.events.recurrence.sample(sample.time_s, self.period_s);
        }
        if let Some(event) = &step.event {
            self.keep(event);
        }
        if let Some(change) = &step.change {
            self.changes.push(ChangeSummary::new(change, self.timeline.seconds(change.onset)));
        }
        if let Some(stretch) = &step.stretch {
            let (start_s, stop_s) = self.add(stretch);
            self.events.recurrence.stretch(start_s, stop_s);
        }
        observe(&step);
    }

    fn keep(&mut self, event: &Event) {
        if self.kept.is_ok() {
            let event = without_losses(&self.pipeline, *event);
            let seconds = |time| self.timeline.seconds(time);
            let event = EventSummary::new(&event, seconds(event.onset), seconds(event.stop));
            held::rise_to(&event, &mut self.stretches.steady, self.config, self.marked_s);
            let (pipeline, keeps_means) = (&self.pipeline, self.keeps_means);
            let means = || if keeps_means { so_far(pipeline) } else { Means::default() };
            self.kept = self.events.push(event, means);
        }
    }

    /// Gives its begin and its end.
    fn add(&mut self, it: &Stretch) -> (f64, f64) {
        let (start_s, stop_s) = (self.timeline.seconds(it.start), self.timeline.seconds(it.stop));
        self.stretches.add(it, self.config, start_s, stop_s);
        (start_s, stop_s)
    }

    /// Takes what the core still holds at the end of the log.
    ///
    /// # Errors
    /// The events could not be kept.
    fn finish(&mut self) -> Result<Report, InputError> {
        while let (Some(event), true) = (self.pipeline.finish(), self.kept.is_ok()) {
            self.keep(&event);
        }
        std::mem::replace(&mut self.kept, Ok(())).map_err(|e| {
            InputError::new(format!(
                "events cannot be kept in a temporary file: {e}; name a folder with room in TMPDIR"
            ))
        })?;
        while let Some(stretch) = self.pipeline.finish_stretch() {
            self.add(&stretch);
        }
        let report = self.pipeline.report();
        // The last events, which come after the last step, may have shown a change.
        if let Some(change) = &report.change
            && self.changes.last().is_none_or(|it| it.event != change.event)
        {
            self.changes.push(ChangeSummary::new(change, self.timeline.seconds(change.onset)));
        }
        Ok(report)
    }

    /// The result, at the end of the log.
    ///
    /// # Errors
    /// The events could not be kept.
    pub fn result(
        mut self,
        path: &str,
        log: &Log,
        known: &KnownOptions,
    ) -> Result<ReplayResult, InputError> {
        let report = self.finish()?;
        let Self { config, pipeline, mut events, changes, stretches, mut winch_marks, .. } = self;
        events.start = log.start();
        let log_summary = LogSummary {
            path: path.to_string(),
            format: log.format().name().to_string(),
            rate_hz: log.rate_hz(),
            duration_s: self.timeline.duration_s(),
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
        let mut effects: Vec<_> = pipeline.findings().iter().map(EffectSummary::from).collect();
        let is_level = |it: &&mut EffectSummary| it.found && it.name == Effect::Level.name();
        if let Some(it) = effects.iter_mut().find(is_level) {
            it.parameters = level::parameters(&result.changes, &result.events);
        }
        let stretches = stretches.with_changes(&result.changes, config);
        let mut result = ReplayResult { effects, stretches, ..result };
        if known.both_zeros(&log.metadata().known).is_some() {
            result.budget.iter_mut().for_each(|line| line.is_unmeasured = false);
        }
        let doubts = doubts::doubts(log, (config, known), &report, &result);
        let late = winch_marks.next().and_then(|mark| mark.after(self.timeline.last_s()));
        let late = late.into_iter().collect();
        result.log.warnings = [log.warnings(), doubts, self.rails.warnings(), late].concat();
        Ok(result)
    }
}

/// Both means as they are known now.
fn so_far(pipeline: &Pipeline) -> Means {
    let report = pipeline.report();
    [report.mu_s.into(), report.mu.into()]
}
