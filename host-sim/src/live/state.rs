//! State built from the board's output.

use std::collections::VecDeque;
use std::time::Duration;

use floe_core::{Cause, Change, Event, Report, SampleFlag, SampleTime};
use floe_firmware::line::{About, Health, Line, LineError, LiveSample, Mean, Weighed};
use floe_firmware::notebook::{Winch, word};
use floe_firmware::settings::Settings;

use super::lines::Received;
use crate::log::start::Start;
use crate::replay::quantities::Quantities;
use crate::replay::result::EventSummary;

/// Samples that the trace holds: 30 s of the board's 16 Hz.
pub const TRACE_LEN: usize = 480;

/// All values for a display. Times are relative to the start of the display.
#[derive(Clone, Debug, Default)]
pub struct State {
    /// Reason why the port is away; `None` while it is open.
    pub away: Option<String>,
    /// Time of the last complete line, or of opening the port.
    pub heard: Duration,
    /// Number and settings of the test.
    pub test: Option<(u32, Settings)>,
    /// Whether a test is running, once known.
    pub testing: Option<bool>,
    /// The last samples.
    pub trace: VecDeque<LiveSample>,
    /// Time of the last sample.
    pub sampled: Option<Duration>,
    /// The last event.
    pub event: Option<Event>,
    /// First answer on a slip whose event is not complete yet.
    pub about: Option<About>,
    /// The result so far.
    pub report: Option<Report>,
    /// The state of the board.
    pub health: Option<Health>,
    /// The weight so far, and the time of its message.
    pub weighed: Option<(Weighed, Duration)>,
    /// Temperature of the converter, °C.
    pub temperature_c: Option<f32>,
    /// Start of the test, once the board has sent a time of day in it.
    pub began: Option<Start>,
    /// Time of the last loss of samples by the board or of sectors by the card.
    pub lost: Option<Duration>,
    /// Time of the last failed write of a sector.
    pub unkept: Option<Duration>,
    /// The user's last command.
    pub said: Option<(String, Duration)>,
    /// Time at which the board last printed settings or the end of a test, which confirms a
    /// command.
    pub taken: Option<Duration>,
    /// The board's last answer.
    pub answer: Option<(String, Duration)>,
    /// The board's last complaint.
    pub complaint: Option<(String, Duration)>,
    /// Number of lines with a wrong checksum or bad fields.
    pub damaged: u64,
    /// Time of the last damaged line.
    pub damage: Option<Duration>,
    /// Number of bytes that arrived too fast.
    pub dropped: u64,
    /// Time of the last dropped bytes.
    pub flood: Option<Duration>,
    /// Number of complete lines of a kind unknown to this version.
    pub unknown: u64,
    /// Whether the previous line was the settings, so that the next one shows whether a test is
    /// running.
    after_settings: bool,
}

impl State {
    /// Handles the opening of the port: the test known before may be over.
    pub fn up(&mut self, now: Duration) {
        self.away = None;
        self.heard = now;
        self.testing = None;
    }

    /// Handles the loss of the port.
    pub fn down(&mut self, reason: String) {
        self.away = Some(reason);
        self.testing = None;
    }

    /// Counts dropped bytes.
    pub fn drop(&mut self, bytes: u64, now: Duration) {
        self.dropped = self.dropped.saturating_add(bytes);
        self.flood = Some(now);
        self.after_settings = false;
    }

    /// Processes a line; returns the event if it is one.
    pub fn take(&mut self, received: &Received, now: Duration) -> Option<Event> {
        match Line::parse(&received.text) {
            Ok(line) => self.take_line(line, now),
            Err(LineError::UnknownKind) => {
                self.unknown += 1;
                None
            }
            Err(LineError::NoChecksum | LineError::Checksum | LineError::Field) => {
                self.after_settings = false;
                if !received.cut {
                    self.damaged += 1;
                    self.damage = Some(now);
                }
                None
            }
        }
    }

    /// The user's recent command, and the board's reply.
    #[must_use]
    pub fn reply(&self, now: Duration) -> Option<String> {
        const READING_TIME: Duration = Duration::from_secs(8);
        let (command, at) = self.said.as_ref()?;
        if now.saturating_sub(*at) > READING_TIME {
            return None;
        }
        let later = |words: &&(String, Duration)| words.1 >= *at;
        let words = self.complaint.as_ref().filter(later).or(self.answer.as_ref().filter(later));
        let taken = self.taken.is_some_and(|taken| taken >= *at);
        let reply = match words {
            _ if self.away.is_some() => "not said, there is no port",
            Some((words, _)) => words,
            None if taken => "done",
            None => "said",
        };
        Some(format!("{command}: {reply}"))
    }

    /// A time in seconds from the start of the test.
    #[must_use]
    pub fn seconds(&self, moment: SampleTime) -> f64 {
        (moment.index as f64 + f64::from(moment.fraction)) / self.rate_hz()
    }

    /// An event with all values of a replay known so far; `k` is from the event's own rate and the
    /// winch speed in the settings.
    #[must_use]
    pub fn summary(&self, event: &Event) -> EventSummary {
        let (onset_s, stop_s) = (self.seconds(event.onset), self.seconds(event.stop));
        let mut summary = EventSummary::new(event, onset_s, stop_s);
        if let Some((_, settings)) = &self.test {
            Quantities::of_event(&summary, &settings.config).slide(&mut summary);
        }
        summary.onset_time = self.began.and_then(|began| began.after(onset_s));
        summary
    }

    /// Samples per second; until the board sends it, the rate of all boards.
    #[must_use]
    pub fn rate_hz(&self) -> f64 {
        let said = self.test.as_ref().map(|(_, settings)| settings.config.rate_hz);
        f64::from(said.filter(|&rate| rate > 0.0).unwrap_or(floe_firmware::sample::RATE_HZ))
    }

    fn take_line(&mut self, line: Line<'_>, now: Duration) -> Option<Event> {
        self.heard = now;
        let after_settings = std::mem::take(&mut self.after_settings);
        let mut answered = |text: String| self.answer = Some((text, now));
        match line {
            Line::Start { run, settings } => self.start(run, settings, now),
            Line::Sample(sample) => self.sample(sample, now),
            Line::Spike(index) => self.spike(index),
            Line::About(about) => self.about = Some(about),
            Line::Event(event) => {
                self.event = Some(event);
                self.about = self.about.filter(|about| !about.is_followed_by(&event));
                return Some(event);
            }
            Line::Report(report) => (self.report, self.testing) = (Some(report), Some(true)),
            Line::Health(health) => {
                if after_settings {
                    self.testing = Some(false);
                }
                self.health(health, now);
            }
            Line::End { .. } => (self.testing, self.taken) = (Some(false), Some(now)),
            Line::Weighed(weighed) => self.weighed = Some((weighed, now)),
            Line::Climate { temperature_c, .. } => self.temperature_c = temperature_c,
            Line::Sync { index, unix_ms } => self.date(index, unix_ms),
            Line::Trouble(text) => self.complaint = Some((text.to_string(), now)),
            Line::Stretch(stretch) => answered(crate::replay::stretches::told(&stretch)),
            Line::Change(change) => answered(told(&change)),
            Line::Mean(mean) => answered(mean_code(&mean)),
            Line::Note(text) => answered(format!("noted: {text}")),
            Line::Mark { winch, .. } => {
                answered(format!("the winch from now on: {}", word(Winch::ALL, &winch)));
            }
            Line::Info(text) => answered(text.to_string()),
        }
        None
    }

    /// Handles settings, which come at every change and request; a new number means a new test.
    fn start(&mut self, run: u32, settings: Settings, now: Duration) {
        if self.test.as_ref().is_some_and(|(known, _)| *known != run) {
            self.forget_test();
        }
        self.test = Some((run, settings));
        (self.after_settings, self.taken) = (true, Some(now));
    }

    /// Dates the test by the first time of day in it, as on the card. A test with a date begins with
    /// that of its first sample: without a card, a board whose power was off gives its next test the
    /// number of the one before.
    fn date(&mut self, index: u32, unix_ms: u64) {
        if index == 0 {
            self.began = None;
        }
        let unix_s = unix_ms as f64 / 1e3 - index as f64 / self.rate_hz();
        self.began.get_or_insert(Start { unix_s, is_utc: true });
    }

    fn forget_test(&mut self) {
        self.began = None;
        self.trace.clear();
        (self.sampled, self.event, self.about, self.report) = (None, None, None, None);
    }

    fn sample(&mut self, sample: LiveSample, now: Duration) {
        if self.trace.back().is_some_and(|last| last.index > sample.index) {
            // The first line of a new test was missed.
            self.forget_test();
        }
        if self.trace.len() == TRACE_LEN {
            self.trace.pop_front();
        }
        self.trace.push_back(sample);
        self.sampled = Some(now);
        self.testing = Some(true);
    }

    fn spike(&mut self, index: u32) {
        if let Some(sample) = self.trace.iter_mut().find(|sample| sample.index == index) {
            sample.flag = SampleFlag::Spike;
        }
    }

    fn health(&mut self, health: Health, now: Duration) {
        let before = self.health.unwrap_or_default();
        if health.overruns > before.overruns {
            self.lost = Some(now);
        }
        if health.store_failures > before.store_failures {
            self.unkept = Some(now);
        }
        self.health = Some(health);
    }
}

/// Text of a mean of readings.
fn mean_code(Mean { mean, count, failed, .. }: &Mean) -> String {
    format!("mean code {mean:.0} of {count} readings, {failed} failed")
}

/// Text of a change.
fn told(change: &Change) -> String {
    let Change { event, weight_ratio: ratio, weight_ratio_std: std, .. } = change;
    match change.cause {
        Cause::Mass => {
            format!("from event {event} on the block weighs {ratio:.3} ± {std:.3} of it")
        }
        Cause::Friction => format!("from event {event} on the friction is another"),
        Cause::Unknown => format!("from event {event} on the forces are others: weigh the block"),
    }
}
