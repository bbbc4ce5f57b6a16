//! What really happened, event by event.

use serde::Serialize;

use super::motion::Segment;
use super::scene::Scene;
use super::state::{End, Phase};

/// One stick-slip event as it was computed. Names as in a replay's result.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TrueEvent {
    /// From 0.
    pub index: u32,
    /// The slip begins, s.
    pub onset_s: f64,
    /// The block rests again, s.
    pub stop_s: f64,
    /// `Fs`, N.
    pub static_force_n: f64,
    /// `Fp`, N.
    pub dynamic_force_n: f64,
    /// Largest force, N.
    pub peak_force_n: f64,
    /// `Fe`, N; zero when the block stopped on a slack cable.
    pub restick_force_n: f64,
    /// Static coefficient.
    pub mu_s: f64,
    /// Dynamic coefficient.
    pub mu: f64,
    /// Time of rest before the onset, s.
    pub stick_s: f64,
    /// Time of motion, s.
    pub slip_s: f64,
    /// `k w` at the onset, N/s.
    pub loading_rate_n_per_s: f64,
    /// `omega` at the onset, rad/s.
    pub omega_rad_per_s: f64,
    /// Whether the cable went slack.
    pub slack: bool,
    /// Slack left when the block stopped, m.
    pub slack_m: f64,
}

/// Builds events from segments, one segment at a time.
#[derive(Clone, Debug)]
pub struct EventBuilder {
    weight_n: f64,
    sin_slope: f64,
    cos_slope: f64,
    next_index: u32,
    rest_since_s: f64,
    pending: Option<TrueEvent>,
}

impl EventBuilder {
    /// Starts with the block at rest.
    #[must_use]
    pub fn new(scene: &Scene) -> Self {
        let (sin_slope, cos_slope) = scene.slope_rad().sin_cos();
        Self {
            weight_n: scene.weight_n,
            sin_slope,
            cos_slope,
            next_index: 0,
            rest_since_s: 0.0,
            pending: None,
        }
    }

    /// Takes the next segment; returns an event when its block stops here.
    pub fn push(&mut self, segment: &Segment) -> Option<TrueEvent> {
        if segment.end == End::Onset {
            self.pending = Some(self.open(segment));
        }
        if segment.phase.is_moving() {
            self.follow(segment);
        }
        if segment.end == End::Stop { self.close(segment) } else { None }
    }

    fn open(&self, stick: &Segment) -> TrueEvent {
        let (static_n, dynamic_n) = (stick.to.force_n, stick.mechanics.dynamic_force_n);
        let coefficient =
            |force_n: f64| (force_n / self.weight_n - self.sin_slope) / self.cos_slope;
        TrueEvent {
            index: self.next_index,
            onset_s: stick.to.time_s,
            stop_s: f64::NAN,
            static_force_n: static_n,
            dynamic_force_n: dynamic_n,
            peak_force_n: static_n,
            restick_force_n: f64::NAN,
            mu_s: coefficient(static_n),
            mu: coefficient(dynamic_n),
            stick_s: stick.to.time_s - self.rest_since_s,
            slip_s: f64::NAN,
            loading_rate_n_per_s: stick.mechanics.loading_rate_n_per_s(),
            omega_rad_per_s: stick.mechanics.omega_rad_per_s(),
            slack: false,
            slack_m: 0.0,
        }
    }

    fn follow(&mut self, moving: &Segment) {
        if let Some(event) = &mut self.pending {
            event.peak_force_n = event.peak_force_n.max(moving.peak_force_n());
            event.slack |= moving.phase == Phase::SlackSliding;
        }
    }

    fn close(&mut self, last: &Segment) -> Option<TrueEvent> {
        let mut event = self.pending.take()?;
        event.stop_s = last.to.time_s;
        event.slip_s = event.stop_s - event.onset_s;
        event.restick_force_n = last.to.force_n;
        event.slack_m = last.to.slack_m;
        self.rest_since_s = event.stop_s;
        self.next_index += 1;
        Some(event)
    }
}
