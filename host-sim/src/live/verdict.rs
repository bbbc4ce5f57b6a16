//! The current problem, or the next step, in one plain line.

use std::time::Duration;

use floe_core::{Quality, SampleFlag};

use super::band::{IN_A_ROW, is_weighing};
use super::state::State;
use crate::replay::result::zero_sentence;
use crate::rounding::counted;

/// Severity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// The measurement is at risk.
    Bad,
    /// An action or information for the user.
    Note,
    /// No problem.
    Good,
}

/// A verdict.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Verdict {
    /// Severity.
    pub level: Level,
    /// Text for the user.
    pub text: String,
}

/// Time without a line after which the board counts as off; it is polled every few seconds.
const SILENCE: Duration = Duration::from_secs(8);
/// Likely causes of silence.
pub(super) const SILENT_IF: &str = "off, or another program has it";
/// Time without a sample in a test that is a fault; samples come 16 times a second.
const NO_SAMPLES: Duration = Duration::from_secs(3);
/// Time for which a past event stays visible.
const READING_TIME: Duration = Duration::from_secs(15);
/// Number of samples that count as recent.
const LATELY: usize = 80;

/// The most severe current verdict.
#[must_use]
pub fn verdict(state: &State, now: Duration) -> Verdict {
    let bad = |text| Verdict { level: Level::Bad, text };
    let note = |text| Verdict { level: Level::Note, text };
    let found = line(state, now)
        .or_else(|| force(state, now))
        .or_else(|| keeping(state, now))
        .map(bad)
        .or_else(|| said(state.complaint.as_ref(), now).map(bad))
        .or_else(|| said(state.answer.as_ref(), now).map(note))
        .or_else(|| incident(state, now).map(note))
        .or_else(|| weighing(state, now).map(note))
        .or_else(|| to_do(state).map(note))
        .or_else(|| zero(state).map(note));
    found.unwrap_or_else(|| Verdict { level: Level::Good, text: well(state) })
}

fn within(at: Option<Duration>, time: Duration, now: Duration) -> bool {
    at.is_some_and(|at| now.saturating_sub(at) < time)
}

/// Problems of the connection to the board.
fn line(state: &State, now: Duration) -> Option<String> {
    if let Some(reason) = &state.away {
        return Some(format!("NO PORT ({reason}): check cable and power; trying again"));
    }
    silence(state, now).map(|seconds| format!("THE BOARD IS SILENT for {seconds} s: {SILENT_IF}"))
}

/// Seconds of silence of an open port, once they are too many.
pub(super) fn silence(state: &State, now: Duration) -> Option<u64> {
    let silence = now.saturating_sub(state.heard);
    (state.away.is_none() && silence > SILENCE).then_some(silence.as_secs())
}

/// Problems of the load cell and its converter.
fn force(state: &State, now: Duration) -> Option<String> {
    if state.testing == Some(true) && !within(state.sampled, NO_SAMPLES, now) {
        return state.sampled.map(|_| "NO SAMPLES come any more (live off?)".to_string());
    }
    let mut last = state.trace.iter().rev().map(|sample| sample.flag);
    if state.testing != Some(true) || state.trace.len() < IN_A_ROW {
        return None;
    }
    let flag = last.next()?;
    if !last.take(IN_A_ROW - 1).all(|other| other == flag) {
        return None;
    }
    let converter = state.complaint.as_ref().filter(|(text, _)| text.starts_with("converter"));
    match flag {
        SampleFlag::Saturated => {
            Some("FORCE OUT OF RANGE: a broken wire, or too much load".to_string())
        }
        SampleFlag::Rejected => Some(match converter {
            Some((text, _)) => format!("NO FORCE: {text}"),
            None => "NO FORCE: the converter gives no readings".to_string(),
        }),
        SampleFlag::Good | SampleFlag::Spike | SampleFlag::Duplicate => None,
    }
}

/// Loss of samples on the board or on the card.
fn keeping(state: &State, now: Duration) -> Option<String> {
    let health = state.health.as_ref()?;
    if within(state.lost, READING_TIME, now) {
        return Some(format!("SAMPLES LOST by the board: {} since power-up", health.overruns));
    }
    if within(state.unkept, READING_TIME, now) {
        let failures = health.store_failures;
        return Some(format!("NOT KEPT: card missing, full or broken ({failures} sectors)"));
    }
    None
}

fn said(words: Option<&(String, Duration)>, now: Duration) -> Option<String> {
    let (text, at) = words?;
    within(Some(*at), READING_TIME, now).then(|| format!("the board says: {text}"))
}

/// Problems of the last seconds that are over.
fn incident(state: &State, now: Duration) -> Option<String> {
    if within(state.flood, READING_TIME, now) {
        let dropped = state.dropped;
        return Some(format!("{dropped} bytes came too fast and were left out: no logger's port?"));
    }
    if within(state.damage, READING_TIME, now) {
        let damaged = state.damaged;
        return Some(format!(
            "{}: bad cable, or another program reads this port",
            counted(damaged, "damaged line")
        ));
    }
    if state.testing != Some(true) {
        return None;
    }
    let lately = || state.trace.iter().rev().take(LATELY);
    let missing: u64 = lately().map(|sample| u64::from(sample.gap)).sum();
    let count = |flag| lately().filter(|sample| sample.flag == flag).count();
    let parts = [
        (missing as usize, "missing"),
        (count(SampleFlag::Rejected), "without a reading"),
        (count(SampleFlag::Saturated), "out of range"),
        (count(SampleFlag::Spike), "spikes"),
    ];
    let parts: Vec<String> = parts
        .iter()
        .filter(|(count, _)| *count > 0)
        .map(|(count, what)| format!("{count} {what}"))
        .collect();
    (!parts.is_empty()).then(|| format!("in the last 5 s: samples {}", parts.join(", ")))
}

/// State of a weighing.
fn weighing(state: &State, now: Duration) -> Option<String> {
    let (weighed, _) = state.weighed.filter(|_| is_weighing(state, now))?;
    Some(match weighed.load {
        Ok(_) => "weighing: y accepts, z aborts".to_string(),
        Err(hindrance) => format!("weighing: {}", hindrance.words()),
    })
}

fn to_do(state: &State) -> Option<String> {
    if state.testing != Some(false) {
        return None;
    }
    let (_, settings) = state.test.as_ref()?;
    Some(if settings.config.weight_n > 0.0 {
        "no test is running: s starts one".to_string()
    } else {
        "no test is running: w sets the block's weight, then s starts".to_string()
    })
}

/// Drift of the load cell's zero.
fn zero(state: &State) -> Option<String> {
    state.report.and_then(|report| report.zero_n).map(|zero_n| zero_sentence(zero_n.into()))
}

fn well(state: &State) -> String {
    match (state.testing, &state.event) {
        (None, _) => "asking the board".to_string(),
        (Some(true), None) => "measuring; waiting for the first slip".to_string(),
        (Some(_), Some(event)) if event.quality == Quality::Slack => {
            "measuring; the cable went slack in the last slip".to_string()
        }
        (Some(_), _) => "measuring; all is well".to_string(),
    }
}
