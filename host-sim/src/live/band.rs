//! The state of the block as one word and one colour.

use std::time::Duration;

use floe_core::{Phase, SampleFlag};
use ratatui::style::Color;

use super::state::State;
use super::verdict::silence;

/// Time after a weighing's message (sent every second) until weighing counts as ended.
const WEIGHING: Duration = Duration::from_secs(3);
/// Consecutive unusable samples that count as a fault: a quarter of a second.
pub const IN_A_ROW: usize = 4;

/// The word and its background colour.
#[must_use]
pub fn band(state: &State, now: Duration) -> (&'static str, Color) {
    if state.away.is_some() {
        return ("NO PORT", Color::Red);
    }
    if silence(state, now).is_some() {
        return ("SILENT", Color::Red);
    }
    match state.testing {
        _ if is_weighing(state, now) => ("WEIGHING", Color::Cyan),
        None => ("ASKING", Color::Gray),
        Some(false) => ("IDLE", Color::Gray),
        Some(true) if is_faulty(state) => ("FAULT", Color::Red),
        Some(true) => match state.trace.back().map(|sample| sample.phase) {
            Some(Phase::Slip) => ("SLIPS", Color::LightYellow),
            Some(Phase::Stick) => ("STICKS", Color::LightBlue),
            Some(Phase::Unknown) | None => ("LEARNING", Color::Gray),
        },
    }
}

/// Whether the shown values are not current.
#[must_use]
pub fn is_stale(state: &State, now: Duration) -> bool {
    state.away.is_some() || silence(state, now).is_some()
}

/// Whether the board is weighing.
#[must_use]
pub fn is_weighing(state: &State, now: Duration) -> bool {
    let lately = |at: Duration| now.saturating_sub(at) < WEIGHING;
    state.testing != Some(true) && state.weighed.is_some_and(|(_, at)| lately(at))
}

fn is_faulty(state: &State) -> bool {
    let unusable = |flag| matches!(flag, SampleFlag::Rejected | SampleFlag::Saturated);
    let last = state.trace.iter().rev().take(IN_A_ROW);
    state.trace.len() >= IN_A_ROW && last.map(|sample| sample.flag).all(unusable)
}
