//! The decoded output of the board, and its comparison with the computation on this PC.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use floe::replay::events::Events;
use floe::replay::held;
use floe::replay::result::{ChangeSummary, EventSummary, LogSummary, ReplayResult, TestSummary};
use floe::replay::stretches::Stretches;
use floe_core::{
    Change, Coefficient, Config, Counts, Event, Fault, Pipeline, RawSample, Reading, Report,
    SampleFlag, SampleTime, Stretch,
};
use floe_firmware::line::{Health, Line};

use super::record::Record;
use crate::Result;

/// The decoded output of a test.
#[derive(Debug)]
pub struct Outcome {
    /// Configuration of the test.
    pub config: Config,
    /// Every event.
    pub events: Vec<Event>,
    /// Every change.
    pub changes: Vec<Change>,
    /// Stretches without events, in order.
    pub stretches: Vec<Stretch>,
    /// The last report.
    pub report: Report,
    /// The last health.
    pub health: Health,
    /// Samples shown as unusable.
    pub rejected: BTreeSet<u32>,
    /// The problems that the board reported, each once.
    pub troubles: Vec<String>,
}

/// Decodes every line.
///
/// # Errors
/// A damaged line, or no complete test among them.
pub fn decode(shown: &str) -> Result<Outcome> {
    let (mut config, mut report, mut health, mut ended) = (None, None, None, false);
    let (mut events, mut troubles, mut rejected) = (Vec::new(), Vec::new(), BTreeSet::new());
    let (mut changes, mut stretches) = (Vec::new(), Vec::new());
    for line in shown.lines() {
        match Line::parse(line).map_err(|e| format!("the board's line '{line}': {e}"))? {
            Line::Start { settings, .. } => config = Some(settings.core_config()),
            Line::Event(event) => events.push(event),
            Line::Change(change) => changes.push(change),
            Line::Stretch(stretch) => stretches.push(stretch),
            Line::Report(r) => report = Some(r),
            Line::Health(h) => health = Some(h),
            Line::End { .. } => ended = true,
            Line::Trouble(text) if !troubles.iter().any(|t| t == text) => {
                troubles.push(text.to_string());
            }
            Line::Sample(sample) if sample.flag == SampleFlag::Rejected => {
                rejected.insert(sample.index);
            }
            Line::Sample(_)
            | Line::Spike(_)
            | Line::About(_)
            | Line::Mean(_)
            | Line::Note(_)
            | Line::Weighed(_)
            | Line::Mark { .. }
            | Line::Sync { .. }
            | Line::Climate { .. }
            | Line::Info(_)
            | Line::Trouble(_) => {}
        }
    }
    match (config, report, health, ended) {
        (Some(config), Some(report), Some(health), true) => {
            Ok(Outcome { config, events, changes, stretches, report, health, rejected, troubles })
        }
        _ => Err(format!("the board did not complete a test: {troubles:?}")),
    }
}

impl Outcome {
    /// Runs the converter's codes through the core on this PC and compares every event with the
    /// board's, bit for bit. Returns a summary sentence.
    ///
    /// # Errors
    /// The first event that differs.
    pub fn compare(&self, record: &Record, delivered: &[(u64, i32)]) -> Result<String> {
        let codes: BTreeMap<u64, i32> = delivered.iter().copied().collect();
        let reading = |index: u32| match codes.get(&index.into()) {
            Some(&code) if !self.rejected.contains(&index) => Reading::Counts(Counts(code)),
            _ => Reading::Bad(Fault::Timeout),
        };
        // A busy board executes the end of the test a sample or two later.
        let counters = &self.report.counters;
        let taken = counters.samples + counters.missing;
        let periods = 0..taken.max(record.codes.len() as u32);
        let samples = periods.map(|index| RawSample { index, reading: reading(index) });
        let (events, report) = host(&self.config, samples)?;
        if events.len() != self.events.len() {
            let (board, host) = (self.events.len(), events.len());
            return Err(format!("the board found {board} events, this PC {host}"));
        }
        for (board, host) in self.events.iter().zip(&events) {
            if bits(board) != bits(host) {
                return Err(format!("event differs: board {board:?}, this PC {host:?}"));
            }
        }
        if format!("{:?}", self.report) != format!("{report:?}") {
            return Err(format!("report differs: board {:?}, this PC {report:?}", self.report));
        }
        let (events, bad) = (events.len(), self.rejected.len());
        let bad = if bad > 0 { format!("{bad} samples without a code; ") } else { String::new() };
        Ok(format!("{bad}{events} events and the report as on this PC, bit for bit"))
    }

    /// Whether the test contains the record from its first sample to its last.
    #[must_use]
    pub fn is_whole(&self, record: &Record) -> bool {
        let counters = &self.report.counters;
        counters.samples + counters.missing >= record.codes.len() as u32
    }

    /// Checks that every tick came at its exact count of the clock. A deviation is an error of the
    /// emulator, and the run would not be repeatable.
    ///
    /// # Errors
    /// The deviation.
    pub fn check_ticks(&self) -> Result<()> {
        match self.health.jitter_s {
            Some(jitter_s) if jitter_s > 0.0 => Err(format!("a tick came {jitter_s} s late")),
            _ => Ok(()),
        }
    }

    /// The result in the form of `floe replay`.
    ///
    /// # Errors
    /// The number of events exceeds the room.
    pub fn result(&self, path: &Path, record: &Record) -> Result<ReplayResult> {
        let span = |times: &[f64]| Some(times.last()? - times.first()?);
        let log = LogSummary {
            path: path.display().to_string(),
            format: record.format.to_string(),
            rate_hz: f64::from(self.config.rate_hz),
            duration_s: span(&record.times_s).unwrap_or(0.0),
            warnings: self.troubles.clone(),
            ..LogSummary::from(self.report.counters)
        };
        let test = TestSummary {
            test_id: record.test_id.clone(),
            weight_n: f64::from(self.config.weight_n),
            slope_rad: f64::from(self.config.slope_rad),
            mass_kg: None,
        };
        let seconds = |moment: SampleTime| {
            let last = record.times_s.len().saturating_sub(1);
            let index = (moment.index as usize).min(last);
            let periods = (moment.index as usize - index) as f64 + f64::from(moment.fraction);
            let time_s = record.times_s.get(index).copied().unwrap_or(0.0);
            time_s + periods / f64::from(self.config.rate_hz)
        };
        let mut stretches = Stretches::default();
        self.stretches.iter().for_each(|it| {
            stretches.add(it, &self.config, seconds(it.start), seconds(it.stop));
        });
        let mut events = Events::default();
        for e in &self.events {
            let event = EventSummary::new(e, seconds(e.onset), seconds(e.stop));
            held::rise_to(&event, &mut stretches.steady, &self.config, None);
            events.push(event, Default::default).map_err(|e| e.to_string())?;
        }
        let changes = self.changes.iter().map(|c| ChangeSummary::new(c, seconds(c.onset)));
        let inputs = (&self.config, &self.report);
        let result = ReplayResult::new(log, test, inputs, events, changes.collect());
        Ok(ReplayResult { stretches, ..result })
    }
}

/// The results that the core on this PC computes from samples.
pub fn host(
    config: &Config,
    samples: impl Iterator<Item = RawSample>,
) -> Result<(Vec<Event>, Report)> {
    let mut pipeline = Pipeline::new(config).map_err(|e| e.to_string())?;
    let mut events: Vec<Event> = samples.filter_map(|s| pipeline.step(s).event).collect();
    while let Some(event) = pipeline.finish() {
        events.push(event);
    }
    Ok((events, pipeline.report()))
}

/// All numbers of an event as bits; the other fields as text.
fn bits(event: &Event) -> (Vec<Option<u32>>, String) {
    let mut numbers: Vec<Option<f32>> = vec![
        Some(event.onset.fraction),
        Some(event.stop.fraction),
        Some(event.static_force_n),
        Some(event.dynamic_force_n),
        Some(event.peak_force_n),
        Some(event.restick_force_n),
        event.stick_s,
        Some(event.slip_s),
        Some(event.loading_rate_n_per_s),
        event.omega_rad_per_s,
    ];
    for coefficient in [event.mu_s, event.mu] {
        let of = |pick: fn(Coefficient) -> f32| coefficient.map(pick);
        numbers.extend([of(|c| c.value), of(|c| c.std), of(|c| c.systematic_std)]);
    }
    let places = (event.index, event.onset.index, event.stop.index);
    let words = (event.slack, event.quality, event.reason);
    (numbers.iter().map(|n| n.map(f32::to_bits)).collect(), format!("{places:?} {words:?}"))
}
