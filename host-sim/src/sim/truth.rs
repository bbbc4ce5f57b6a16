//! True values of every event.

use serde::Serialize;

use super::motion::Segment;
use super::state::{End, Phase};

/// One stick-slip event with its true values. The names are those of a replay's result.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TrueEvent {
    /// Number of the event, from 0.
    pub index: u32,
    /// Start of the slip, s.
    pub onset_s: f64,
    /// End of the slip, when the block is at rest again, s.
    pub stop_s: f64,
    /// `Fs`, N; the peak where friction falls smoothly.
    pub static_force_n: f64,
    /// `Fp`, N.
    pub dynamic_force_n: f64,
    /// Largest force, N.
    pub peak_force_n: f64,
    /// `Fe`, N; zero when the block stopped on a slack cable.
    pub restick_force_n: f64,
    /// Static coefficient, from the force at which the slip begins, or from the peak of the force
    /// where friction falls smoothly.
    pub mu_s: f64,
    /// Dynamic coefficient: the average over the distance slid.
    pub mu: f64,
    /// Time of rest before the onset, s.
    pub stick_s: f64,
    /// Time of motion, s.
    pub slip_s: f64,
    /// `k w` at the onset, N/s.
    pub loading_rate_n_per_s: f64,
    /// `omega` at the onset, rad/s.
    pub omega_rad_per_s: f64,
    /// Weight of the block, N.
    pub weight_n: f64,
    /// Whether the cable went slack.
    pub slack: bool,
    /// Slack left when the block stopped, m.
    pub slack_m: f64,
    /// Whether only a part of the contact slipped.
    pub partial: bool,
    /// Smallest standard deviation of `mu_s` that any estimate from this event's
    /// samples can have (Cramér-Rao), see `bound`.
    pub mu_s_bound: Option<f64>,
    /// Smallest standard deviation of `mu` that any estimate from this event's samples can have
    /// (Cramér-Rao), see `bound`.
    pub mu_bound: Option<f64>,
}

/// Builds events from segments, one segment at a time.
#[derive(Clone, Debug)]
pub struct EventBuilder {
    clock: f64,
    next_index: u32,
    pending: Option<Pending>,
}

/// An event whose block is still moving.
#[derive(Clone, Debug)]
struct Pending {
    event: TrueEvent,
    way_m: f64,
    resistance_j: f64,
    friction_m: f64,
    /// Slope, rad, of an event with a smooth onset.
    smooth_slope_rad: Option<f64>,
}

impl EventBuilder {
    /// A builder for a test that starts with the block at rest. `clock` is the number of true
    /// seconds in one second of the log.
    #[must_use]
    pub fn new(clock: f64) -> Self {
        Self { clock, next_index: 0, pending: None }
    }

    /// Takes the next segment; returns an event when its block stops here.
    pub fn push(&mut self, segment: &Segment) -> Option<TrueEvent> {
        if segment.end == End::Onset {
            let event = self.open(segment);
            let smooth_slope_rad = segment.smooth_onset.then_some(segment.mechanics.slope_rad);
            self.pending = Some(Pending {
                event,
                way_m: 0.0,
                resistance_j: 0.0,
                friction_m: 0.0,
                smooth_slope_rad,
            });
        }
        let pending = self.pending.as_mut()?;
        if segment.phase.is_moving() {
            pending.follow(segment);
        }
        if segment.end != End::Stop {
            return None;
        }
        let mut event = self.pending.take()?.close(segment);
        event.stop_s /= self.clock;
        event.slip_s = event.stop_s - event.onset_s;
        self.next_index += 1;
        Some(event)
    }

    fn open(&self, stick: &Segment) -> TrueEvent {
        let (mechanics, onset) = (&stick.mechanics, &stick.to);
        let (sin, cos) = mechanics.slope_rad.sin_cos();
        TrueEvent {
            index: self.next_index,
            onset_s: onset.time_s / self.clock,
            stop_s: f64::NAN,
            static_force_n: onset.force_n,
            dynamic_force_n: f64::NAN,
            peak_force_n: onset.force_n,
            restick_force_n: f64::NAN,
            mu_s: (onset.force_n / mechanics.weight_n - sin) / cos,
            mu: f64::NAN,
            stick_s: (onset.time_s - onset.rest_since_s) / self.clock,
            slip_s: f64::NAN,
            loading_rate_n_per_s: mechanics.loading_rate_n_per_s(),
            omega_rad_per_s: mechanics.omega_rad_per_s(),
            weight_n: mechanics.weight_n,
            slack: false,
            slack_m: 0.0,
            partial: stick.partial,
            mu_s_bound: None,
            mu_bound: None,
        }
    }
}

impl Pending {
    fn follow(&mut self, moving: &Segment) {
        let way_m = moving.to.position_m - moving.from.position_m;
        self.way_m += way_m;
        self.resistance_j += moving.mean_resistance_n * way_m;
        self.friction_m += moving.mean_mu * way_m;
        self.event.peak_force_n = self.event.peak_force_n.max(moving.peak_force_n());
        self.event.slack |= moving.phase == Phase::SlackSliding;
    }

    fn close(mut self, last: &Segment) -> TrueEvent {
        if let Some(slope_rad) = self.smooth_slope_rad {
            let (sin, cos) = slope_rad.sin_cos();
            self.event.static_force_n = self.event.peak_force_n;
            self.event.mu_s = (self.event.peak_force_n / self.event.weight_n - sin) / cos;
        }
        // A slip without distance (equal coefficients) has the values of its end.
        let average = |sum: f64, end: f64| if self.way_m > 0.0 { sum / self.way_m } else { end };
        TrueEvent {
            stop_s: last.to.time_s,
            dynamic_force_n: average(self.resistance_j, last.mechanics.dynamic_force_n),
            mu: average(self.friction_m, last.mechanics.mu),
            restick_force_n: last.to.force_n,
            slack_m: last.to.slack_m,
            ..self.event
        }
    }
}
