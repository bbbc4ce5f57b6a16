//! Input shared by all figures, and the event in focus.

use super::fit::neighbours;
use super::number::Unit;
use super::recorder::Recorder;
use super::svg::escape;
use crate::replay::result::{EventSummary, ReplayResult};

/// The result, the samples, and the units they are shown in.
#[derive(Clone, Debug)]
pub(super) struct Context<'a> {
    pub result: &'a ReplayResult,
    pub recorder: &'a Recorder,
    /// Unit of forces.
    pub force: Unit,
    /// Subtracted from every time in a figure, s: 0, or the start of a log whose times are too
    /// large for tick labels.
    pub zero_s: f64,
}

/// The event shown in the close-ups.
#[derive(Clone, Copy, Debug)]
pub(super) struct Focus<'a> {
    pub event: &'a EventSummary,
    /// Approximate time from one onset to the next, s.
    pub period_s: f64,
}

/// Start time, s, from which on the times of a log are counted from its start.
const LONG_TIME_S: f64 = 1e5;

impl Focus<'_> {
    /// Sentence for an event without a coefficient.
    pub fn refused(&self) -> String {
        let reason = self.event.reason.as_deref().map(escape);
        reason.map_or_else(String::new, |reason| {
            format!(" This event is refused, and no curve of it is a result: {reason}.")
        })
    }
}

impl<'a> Context<'a> {
    pub fn new(result: &'a ReplayResult, recorder: &'a Recorder) -> Self {
        let peaks = result.events.iter().map(|e| e.peak_force_n.abs());
        let recorded = recorder.range_n().map_or(0.0, |(low, high)| low.abs().max(high.abs()));
        let force = Unit::suited(peaks.fold(recorded, f64::max), "N");
        let start_s = recorder.span_s().map_or(0.0, |span| span.0);
        let zero_s = if start_s.abs() >= LONG_TIME_S { start_s.floor() } else { 0.0 };
        Self { result, recorder, force, zero_s }
    }

    /// Label of a time axis in this unit.
    pub fn time_label(&self, unit: &str) -> String {
        if self.zero_s == 0.0 {
            return format!("time ({unit})");
        }
        format!("time after {:.0} s ({unit})", self.zero_s)
    }

    /// Label of a force axis.
    pub fn force_label(&self) -> String {
        format!("force <tspan class=\"sym\">F</tspan> ({})", self.force.name)
    }

    /// A sample or a point of a curve in the displayed units.
    pub fn shown(&self, (time_s, force_n): (f64, f64)) -> (f64, f64) {
        (time_s - self.zero_s, force_n * self.force.factor)
    }

    /// The most typical event among those whose surroundings are kept at full resolution.
    pub fn focus(&self) -> Option<Focus<'a>> {
        let events = &self.result.events;
        let best = (0..events.len())
            .filter_map(|position| self.candidate(position))
            .min_by(|a, b| a.1.total_cmp(&b.1));
        best.map(|(focus, _)| focus)
    }

    fn candidate(&self, position: usize) -> Option<(Focus<'a>, f64)> {
        let event = self.result.events.get(position)?;
        let period_s = self.period_s(position)?;
        let (start_s, end_s) = self.recorder.span_s()?;
        let from_s = (event.onset_s - period_s).max(start_s);
        let to_s = (event.stop_s + period_s).min(end_s - 2.0 * self.recorder.period_s());
        let kept = from_s < to_s && self.recorder.clips.covers(from_s, to_s);
        let focus = Focus { event, period_s };
        kept.then(|| (focus, self.oddness(position, event)))
    }

    /// Period around an event: from its neighbours; for a single event from the forces and the
    /// rate.
    fn period_s(&self, position: usize) -> Option<f64> {
        let events = &self.result.events;
        let event = events.get(position)?;
        let (before, next) = neighbours(events, position);
        let next = next.map(|next| next.onset_s - event.onset_s);
        let since = before.map(|before| event.onset_s - before.onset_s);
        let drop_n = event.static_force_n - event.restick_force_n;
        let alone = event.slip_s + drop_n / event.loading_rate_n_per_s;
        let period_s = next.or(since).unwrap_or(alone);
        let usable = period_s.is_finite() && period_s > event.slip_s;
        Some(if usable { period_s } else { 4.0 * event.slip_s.max(self.recorder.period_s()) })
    }

    /// Distance of an event from the mean of all: 0 for a typical one.
    fn oddness(&self, position: usize, event: &EventSummary) -> f64 {
        let estimate = &self.result.estimate;
        let off = |value: Option<f64>, mean: Option<f64>| match (value, mean) {
            (Some(value), Some(mean)) => ((value - mean) / mean).abs().min(1.0),
            _ => 1.0,
        };
        let at_end = position == 0 || position + 1 == self.result.events.len();
        let penalty = |bad: bool, cost: f64| if bad { cost } else { 0.0 };
        off(event.mu_s, estimate.mu_s.mean)
            + off(event.mu, estimate.mu.mean)
            + penalty(event.is_odd(), 4.0)
            + penalty(event.omega_rad_per_s.is_none(), 8.0)
            + penalty(at_end, 2.0)
    }
}

#[cfg(test)]
mod tests {
    use super::super::sample_log::SampleLog;
    use super::*;

    #[test]
    fn the_focus_is_a_good_event_in_the_middle() {
        let log = SampleLog::troubled(60.0);
        let recorder = log.recorder();
        let focus = Context::new(&log.result, &recorder).focus().unwrap();
        assert_eq!(focus.event.quality, "good");
        assert!((0.5..3.0).contains(&focus.period_s));
        assert_ne!(focus.event.index, 0);
    }

    #[test]
    fn large_times_are_counted_from_the_start() {
        let log = SampleLog::dff8_13(10.0);
        let mut recorder = Recorder::new(16.0);
        recorder.push(1_712_345_678.25, &log.steps[0]);
        let context = Context::new(&log.result, &recorder);
        assert_eq!(context.time_label("s"), "time after 1712345678 s (s)");
        assert!((context.shown((1_712_345_679.0, 2.0)).0 - 1.0).abs() < 1e-9);
    }
}
