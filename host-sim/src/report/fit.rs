//! The model of one event as curves: stick line, ellipse, stick line.

use std::f64::consts::PI;

use crate::replay::result::EventSummary;

/// The motion during a slip, `F = Fp + a cos(omega (t - t0))` (7).
#[derive(Clone, Copy, Debug)]
pub(super) struct Ellipse {
    /// `Fp`, N.
    pub centre_n: f64,
    /// Semi-axis along F, N (10).
    pub a_n: f64,
    /// Angular frequency, rad/s.
    pub omega: f64,
    /// `omega (t - t0)` at the onset, rad, within -pi to 0.
    pub onset_phase: f64,
    /// `omega (t - t0)` at the re-stick, rad.
    pub stop_phase: f64,
}

impl Ellipse {
    /// The ellipse of an event; `None` if its frequency is not known.
    pub fn of(event: &EventSummary) -> Option<Self> {
        let omega = event.omega_rad_per_s.filter(|&omega| omega > 0.0)?;
        let above_n = event.static_force_n - event.dynamic_force_n;
        let beside_n = event.loading_rate_n_per_s / omega;
        let a_n = above_n.hypot(beside_n);
        let onset_phase = -beside_n.atan2(above_n);
        // Fe = 2 Fp - Fs at the same rate (16, 18): the phase of the re-stick is the mirror image
        // of that of the onset plus half a turn.
        let ellipse = Self {
            centre_n: event.dynamic_force_n,
            a_n,
            omega,
            onset_phase,
            stop_phase: PI - onset_phase,
        };
        (a_n > 0.0).then_some(ellipse)
    }

    /// Force, N, and its rate, N/s, at a phase.
    pub fn at(&self, phase: f64) -> (f64, f64) {
        let (sin, cos) = phase.sin_cos();
        (self.centre_n + self.a_n * cos, -self.a_n * self.omega * sin)
    }

    /// The phase at which the force is zero.
    fn free_phase(&self) -> f64 {
        (-self.centre_n / self.a_n).clamp(-1.0, 1.0).acos()
    }

    /// Attenuation of the rate by a central difference over ± one sampling period, 0 to 1.
    pub fn attenuation(&self, period_s: f64) -> f64 {
        let angle = self.omega * period_s;
        angle.sin() / angle
    }

    /// Phases from `from` to `to`, dense enough for a smooth curve.
    pub fn phases(from: f64, to: f64) -> impl Iterator<Item = f64> {
        let steps = 48;
        (0..=steps).map(move |i| from + (to - from) * f64::from(i) / f64::from(steps))
    }
}

/// Time, s, and force, N, from the onset to the re-stick. A straight line when
/// the slip is too short for the sampling to show its shape.
pub(super) fn slip_curve(event: &EventSummary) -> Vec<(f64, f64)> {
    let Some(ellipse) = Ellipse::of(event) else {
        return vec![(event.onset_s, event.static_force_n), (event.stop_s, event.restick_force_n)];
    };
    if event.slack {
        return slack_curve(event, &ellipse);
    }
    let (first, last) = (ellipse.onset_phase, ellipse.stop_phase);
    let per_phase_s = (event.stop_s - event.onset_s) / (last - first);
    let point = |phase: f64| (event.onset_s + (phase - first) * per_phase_s, ellipse.at(phase).0);
    Ellipse::phases(first, last).map(point).collect()
}

/// The arc down to zero force, then zero force until the block rests.
fn slack_curve(event: &EventSummary, ellipse: &Ellipse) -> Vec<(f64, f64)> {
    let free_phase = ellipse.free_phase();
    let time_s = |phase: f64| event.onset_s + (phase - ellipse.onset_phase) / ellipse.omega;
    let arc = Ellipse::phases(ellipse.onset_phase, free_phase);
    let mut curve: Vec<_> = arc.map(|phase| (time_s(phase), ellipse.at(phase).0)).collect();
    curve.push((event.stop_s.max(time_s(free_phase)), ellipse.at(free_phase).0));
    curve
}

/// Time of rest before an event, s: observed, else from its forces, else the length of the slip.
pub(super) fn rest_s(event: &EventSummary) -> f64 {
    let rise_n = event.static_force_n - event.restick_force_n;
    let from_forces = || Some(rise_n / event.loading_rate_n_per_s);
    let rest_s = event.stick_s.or_else(from_forces);
    rest_s.filter(|rest_s| rest_s.is_finite() && *rest_s > 0.0).unwrap_or(event.slip_s)
}

/// The stick line for `before_s` up to the onset.
pub(super) fn line_before(event: &EventSummary, before_s: f64) -> Vec<(f64, f64)> {
    let rise_n = event.loading_rate_n_per_s * before_s;
    let start = (event.onset_s - before_s, event.static_force_n - rise_n);
    vec![start, (event.onset_s, event.static_force_n)]
}

/// The stick line for `after_s` from the re-stick on; none after a slack cable,
/// which has to be taken up first.
pub(super) fn line_after(event: &EventSummary, after_s: f64) -> Vec<(f64, f64)> {
    if event.slack {
        return Vec::new();
    }
    let end_n = event.restick_force_n + event.loading_rate_n_per_s * after_s;
    vec![(event.stop_s, event.restick_force_n), (event.stop_s + after_s, end_n)]
}

/// The events before and after an event, where they are kept.
pub(super) fn neighbours(
    events: &[EventSummary],
    position: usize,
) -> (Option<&EventSummary>, Option<&EventSummary>) {
    let is_next = |(a, b): (&EventSummary, &EventSummary)| a.index + 1 == b.index;
    let event = events.get(position);
    let before = position.checked_sub(1).and_then(|i| events.get(i));
    let after = events.get(position + 1);
    let before = before.filter(|&before| event.is_some_and(|event| is_next((before, event))));
    (before, after.filter(|&after| event.is_some_and(|event| is_next((event, after)))))
}

/// Times before the onset and after the re-stick for which an event's fit is used, s: half-way to
/// its neighbours, or the time of its own rest; no longer than the force takes from zero to `Fs`, since
/// over a gap or a pause of the winch no line holds.
pub(super) fn reach_s(events: &[EventSummary], position: usize) -> (f64, f64) {
    let Some(event) = events.get(position) else { return (0.0, 0.0) };
    let (before, after) = neighbours(events, position);
    let since_s = before.map(|before| (event.onset_s - before.stop_s) / 2.0);
    let until_s = after.map(|after| (after.onset_s - event.stop_s) / 2.0);
    let alone_s = rest_s(event);
    let rise_n = event.static_force_n.max(event.static_force_n - event.restick_force_n);
    let longest_s = Some(rise_n / event.loading_rate_n_per_s).filter(|longest_s| *longest_s > 0.0);
    let within = |time_s: f64| time_s.min(longest_s.unwrap_or(alone_s)).max(0.0);
    (within(since_s.unwrap_or(alone_s)), within(until_s.unwrap_or(alone_s)))
}

/// The model's force at a moment, N; NaN where the model gives none: after a slack cable.
pub(super) fn model_n(event: &EventSummary, time_s: f64) -> f64 {
    if time_s <= event.onset_s {
        return event.static_force_n - event.loading_rate_n_per_s * (event.onset_s - time_s);
    }
    if time_s > event.stop_s {
        let since_n = event.loading_rate_n_per_s * (time_s - event.stop_s);
        return if event.slack { f64::NAN } else { event.restick_force_n + since_n };
    }
    let Some(ellipse) = Ellipse::of(event) else { return f64::NAN };
    let into_s = time_s - event.onset_s;
    if event.slack {
        let phase = (ellipse.onset_phase + ellipse.omega * into_s).min(ellipse.free_phase());
        return ellipse.at(phase).0;
    }
    let turn = (ellipse.stop_phase - ellipse.onset_phase) / (event.stop_s - event.onset_s);
    ellipse.at(ellipse.onset_phase + turn * into_s).0
}

/// Where the force passes `Fp` on its way down.
pub(super) fn centre_time_s(event: &EventSummary) -> f64 {
    let half_way = (event.onset_s + event.stop_s) / 2.0;
    let Some(ellipse) = Ellipse::of(event) else { return half_way };
    let passes_s = event.onset_s + (PI / 2.0 - ellipse.onset_phase) / ellipse.omega;
    if passes_s < event.stop_s { passes_s } else { half_way }
}

#[cfg(test)]
mod tests {
    use super::super::sample_log::SampleLog;
    use super::*;

    #[test]
    fn the_curve_begins_at_fs_and_ends_at_fe() {
        let log = SampleLog::dff8_13(30.0);
        let event = &log.result.events[1];
        let curve = slip_curve(event);
        let (first, last) = (curve[0], curve[curve.len() - 1]);
        assert!((first.1 - event.static_force_n).abs() < 1e-9);
        assert!((last.1 - event.restick_force_n).abs() < 1e-6, "{last:?}");
        assert!((last.0 - event.stop_s).abs() < 1e-9);
        let ellipse = Ellipse::of(event).unwrap();
        let turn_s = (ellipse.stop_phase - ellipse.onset_phase) / ellipse.omega;
        assert!((turn_s - event.slip_s).abs() < 1e-9, "T_slide (25)");
        let (_, rate) = ellipse.at(ellipse.onset_phase);
        assert!((rate - event.loading_rate_n_per_s).abs() < 1e-6, "F' = k w at the onset");
        let peak = curve.iter().map(|p| p.1).fold(0.0, f64::max);
        assert!((peak - event.peak_force_n).abs() < 0.1);
        assert!((ellipse.attenuation(1.0 / 16.0) - 0.78).abs() < 0.005);
    }

    #[test]
    fn the_model_at_a_moment_is_the_curve() {
        let log = SampleLog::dff8_13(30.0);
        let event = &log.result.events[1];
        for (time_s, force_n) in slip_curve(event) {
            assert!((model_n(event, time_s) - force_n).abs() < 1e-6);
        }
        let (before_s, after_s) = reach_s(&log.result.events, 1);
        let [start, _] = line_before(event, before_s)[..] else { panic!("a line has two ends") };
        let [_, end] = line_after(event, after_s)[..] else { panic!("a line has two ends") };
        assert!((model_n(event, start.0) - start.1).abs() < 1e-9);
        assert!((model_n(event, end.0) - end.1).abs() < 1e-9);
    }

    #[test]
    fn over_a_gap_a_line_goes_no_further_than_to_zero_force() {
        let mut events = SampleLog::dff8_13(30.0).result.events.kept;
        for event in events.iter_mut().skip(3) {
            (event.onset_s, event.stop_s) = (event.onset_s + 3000.0, event.stop_s + 3000.0);
        }
        let start = line_before(&events[3], reach_s(&events, 3).0)[0];
        assert!(start.1 > -1.0 && start.0 > 3000.0, "{start:?}");
        let end = line_after(&events[2], reach_s(&events, 2).1)[1];
        assert!(end.1 < 2.0 * events[2].static_force_n && end.0 < 30.0, "{end:?}");
    }

    #[test]
    fn a_slip_of_unknown_shape_is_a_straight_line() {
        let mut event = SampleLog::dff8_13(30.0).result.events.kept.remove(1);
        event.omega_rad_per_s = None;
        assert_eq!(slip_curve(&event).len(), 2);
        let middle = (event.onset_s + event.stop_s) / 2.0;
        assert!((centre_time_s(&event) - middle).abs() < 1e-12);
    }
}
