//! The force at the cell at any moment of a test, and its mean over an aperture.

use super::lag::Lagging;
use super::measurement::{Flop, Hum, Measurement};
use super::motion::{Method, Segment, Segments};
use super::quadrature;
use super::scene::Scene;
use super::state::{End, Phase};

/// Cursor over the segments of a test.
#[derive(Debug)]
pub(super) struct Signal {
    segments: Segments,
    /// The segments in use, in order.
    window: Vec<Segment>,
    flop: Option<Flop>,
    hum: Option<Hum>,
    aperture_s: f64,
    lag: Option<Lagging>,
    first_stop_s: f64,
}

impl Signal {
    pub(super) fn new(scene: &Scene, seed: u64, method: Method) -> Self {
        let Measurement { flop, hum, aperture_s, .. } = scene.measurement;
        Self {
            segments: Segments::new(scene, seed, method),
            window: Vec::new(),
            flop,
            hum,
            aperture_s,
            lag: scene.measurement.lag.map(Lagging::new),
            first_stop_s: f64::INFINITY,
        }
    }

    pub(super) fn failure(&self) -> Option<&str> {
        self.segments.failure()
    }

    /// Loads the segments from `start_s` to `end_s`, drops earlier ones, and passes each new one to
    /// `meet`.
    pub(super) fn cover(&mut self, start_s: f64, end_s: f64, meet: impl FnMut(&Segment)) {
        let start_s = self.lag.map_or(start_s, |lag| start_s.min(lag.at_s));
        let ends_before = |segment: Option<&Segment>, s| segment.is_none_or(|it| it.to.time_s < s);
        if ends_before(self.window.first(), start_s) || ends_before(self.window.last(), end_s) {
            self.load(start_s, end_s, meet);
        }
    }

    #[inline(never)]
    fn load(&mut self, start_s: f64, end_s: f64, mut meet: impl FnMut(&Segment)) {
        let past = self.window.iter().take_while(|s| s.to.time_s < start_s).count();
        if past > 0 {
            self.window.drain(..past);
        }
        while self.window.last().is_none_or(|s| s.to.time_s < end_s) {
            let Some(segment) = self.segments.next() else { return };
            meet(&segment);
            if segment.end == End::Stop {
                self.first_stop_s = self.first_stop_s.min(segment.to.time_s);
            }
            if segment.to.time_s >= start_s {
                self.window.push(segment);
            }
        }
    }

    fn at(&self, time_s: f64) -> Option<&Segment> {
        self.window.iter().find(|s| s.to.time_s >= time_s).or(self.window.last())
    }

    /// Force in the cable, N, and state of the block.
    pub(super) fn force_n(&self, time_s: f64) -> (f64, Phase) {
        self.at(time_s).map_or((0.0, Phase::Stick), |s| (s.force_n(time_s), s.phase))
    }

    /// Whether the converter sees just the force in the cable.
    pub(super) fn is_seen_as_it_is(&self) -> bool {
        self.flop.is_none() && self.hum.is_none() && self.lag.is_none() && self.aperture_s <= 0.0
    }

    /// Input of the converter at a time, N: mean over the aperture from that time on.
    pub(super) fn seen_n(&mut self, time_s: f64) -> f64 {
        let mechanical_n = if self.aperture_s > 0.0 {
            self.integral(time_s, time_s + self.aperture_s, &|_| 1.0) / self.aperture_s
        } else {
            self.lagging_n(time_s)
        };
        mechanical_n + self.hum_n(time_s)
    }

    /// Output of a cell with lag at a time, N; the times must be in order.
    fn lagging_n(&mut self, time_s: f64) -> f64 {
        let now_n = self.at(time_s).map_or(0.0, |s| self.mechanical_n(s, time_s));
        let Some(mut lag) = self.lag else { return now_n };
        let shown_n =
            lag.advance(time_s, now_n, |from_s, weight| self.integral(from_s, time_s, weight));
        self.lag = Some(lag);
        shown_n
    }

    fn mechanical_n(&self, segment: &Segment, time_s: f64) -> f64 {
        segment.force_n(time_s) + self.flop_n(segment, time_s)
    }

    /// The flop starts at the first stop: before it the force has not fallen.
    fn flop_n(&self, segment: &Segment, time_s: f64) -> f64 {
        let Some(flop) = self.flop else { return 0.0 };
        let since_s = time_s - segment.from.rest_since_s;
        if segment.phase != Phase::Stick || time_s < self.first_stop_s {
            return 0.0;
        }
        let swing = (std::f64::consts::TAU * flop.hz * since_s).sin();
        flop.amplitude_n * (-flop.decay_per_s * since_s).exp() * swing
    }

    /// Hum, averaged over the aperture in closed form.
    fn hum_n(&self, time_s: f64) -> f64 {
        let Some(hum) = self.hum else { return 0.0 };
        let half = std::f64::consts::PI * hum.hz * self.aperture_s;
        let passed = if half > 0.0 { half.sin() / half } else { 1.0 };
        hum.amplitude_n * passed * (std::f64::consts::TAU * hum.hz * time_s + half).sin()
    }

    fn integral(&self, start_s: f64, end_s: f64, weight: &dyn Fn(f64) -> f64) -> f64 {
        let mut sum = 0.0;
        for segment in &self.window {
            let from_s = start_s.max(segment.from.time_s);
            let to_s = end_s.min(segment.to.time_s);
            if from_s < to_s {
                let panel_s = self.panel_s(segment);
                let force = |t: f64| weight(t) * self.mechanical_n(segment, t);
                sum += quadrature::integral(force, from_s, to_s, panel_s);
            }
        }
        sum
    }

    /// Length of an integration panel, s: a fraction of a period of the ellipse and of the flop.
    fn panel_s(&self, segment: &Segment) -> f64 {
        let slip_s = if segment.phase == Phase::Slip {
            1.0 / segment.mechanics.omega_rad_per_s()
        } else {
            f64::INFINITY
        };
        let slip_s = self.flop.map_or(slip_s, |f| slip_s.min(0.1 / f.hz));
        self.lag.map_or(slip_s, |lag| slip_s.min(lag.law.time_s))
    }
}
