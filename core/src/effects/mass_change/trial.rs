//! Trials, where single events hardly determine the swing: a change of the forces' level starts
//! one, and the mean swings before and after it decide. Also the weight ratio that follows from the
//! swings.

use crate::effects::mass_change::swings::{LEAST, Ratio, Swings, is_nearer};
use crate::effects::mass_change::{FAR_MEAN, FEWEST, MOST, Mass, State, Verdict};
use crate::num::math;
use crate::stats::fading_trend::FadingTrend;
use crate::stats::prior::Prior;

impl Mass {
    /// Starts a trial after a change of the forces; `dynamic_before_n` is `Fp` before it. Returns
    /// `false` if the swing is known too badly for a trial to decide.
    pub(crate) fn try_weight(&mut self, swing: &mut FadingTrend, dynamic_before_n: f32) -> bool {
        let before = swing.prior(1.0);
        let known = before.weight * before.mean * before.mean * LEAST * LEAST > 1.0;
        if known && matches!(self.state, State::Steady) {
            self.start(Some(before));
            self.dynamic_n.mean = dynamic_before_n;
            *swing = FadingTrend::default();
            self.state = State::Trial(0);
        }
        known
    }

    /// The force has changed for an unknown reason: the weight may have changed by as much.
    pub(crate) fn leave_open(&mut self, dynamic_n: f32, before_n: f32) {
        let off = dynamic_n / before_n - 1.0;
        self.base.variance += off * off;
        (self.dynamic_n.mean, self.doubt) = (dynamic_n, 0.0);
    }

    /// Is a trial under way?
    pub(crate) fn is_on_trial(&self) -> bool {
        matches!(self.state, State::Trial(_))
    }

    /// The weight in use over the given one.
    pub(crate) fn weight_ratio(&self) -> f32 {
        self.weight().value
    }

    /// The weight in use over the given one, and the relative standard deviation of the ratio.
    pub(crate) fn weight_ratio_and_std(&self) -> (f32, f32) {
        let Ratio { value, variance } = self.weight();
        (value, math::sqrt(variance + self.doubt * self.doubt))
    }

    fn weight(&self) -> Ratio {
        if self.is_on_trial() { self.base } else { self.ratio() }
    }

    /// The verdict of the trial; `None` while it goes on.
    pub(super) fn tried(&mut self, events: u32) -> Option<Verdict> {
        let Ratio { value, variance } = self.ratio();
        let (value, variance) = (value / self.base.value, variance - self.base.variance);
        let (off, forces) = (value - 1.0, self.since.dynamic_n / self.dynamic_n.mean);
        let is_seen = self.since.count > 1;
        let least = FAR_MEAN * FAR_MEAN * variance * value * value;
        let excludes = |ratio: f32| is_seen && (value - ratio) * (value - ratio) > least;
        let is_off = excludes(1.0);
        // The mass stayed: its ratio is known to be near one, or cannot be that of the forces.
        let is_sharp = is_seen && variance < 0.25 * LEAST * LEAST && off.abs() < LEAST;
        let verdict = if is_off && off.abs() > LEAST && is_nearer(forces, value) {
            Verdict::Mass
        } else if is_sharp || (!is_off && excludes(forces)) {
            Verdict::SameMass
        } else if is_off || events >= MOST {
            Verdict::Unknown
        } else {
            return None;
        };
        if verdict != Verdict::Mass {
            self.before = None;
        }
        self.state = State::Steady;
        // Decided, or from now on in the weight's own variance.
        self.doubt = 0.0;
        Some(verdict)
    }

    /// Weight in use over the given one, if the mass is the cause of the change in the swings.
    fn ratio(&self) -> Ratio {
        let Some(before) = self.before.filter(|_| self.since.count > 0) else { return self.base };
        let inverse_omega = self.since.mean / before.mean;
        let since = 1.0 / (self.since.weight * self.since.mean * self.since.mean);
        let variance = since + 1.0 / (before.weight * before.mean * before.mean);
        Ratio {
            value: self.base.value * inverse_omega * inverse_omega,
            variance: self.base.variance + 4.0 * variance,
        }
    }

    /// Starts new sums of the swings; their result so far stays in the weight ratio. Without a swing
    /// `before` the past is of no use.
    pub(super) fn start(&mut self, before: Option<Prior>) {
        self.base = self.weight();
        (self.before, self.since) = (before, Swings::default());
        self.seen = if before.is_some() { self.seen } else { 0 };
    }

    /// Takes another mass, with which an event has this `Fp` and before which the swing was
    /// `before`. Soon after another change that one still counts as before: of the mass between,
    /// known by a few swings, the ratio is then independent.
    pub(super) fn change_mass(&mut self, before: Prior, dynamic_n: f32) {
        if self.is_young() {
            self.since = Swings::default();
        } else {
            self.start(Some(before));
        }
        // Friction goes with the weight, and so does its scatter.
        let forces = dynamic_n / self.dynamic_n.mean;
        self.dynamic_n.variance *= forces * forces;
        // The mass explains the force.
        (self.dynamic_n.mean, self.doubt) = (dynamic_n, 0.0);
    }

    /// Has the mass changed so lately that a few swings have been seen since?
    fn is_young(&self) -> bool {
        self.before.is_some() && self.since.count < FEWEST
    }

    /// Prior of the next swing by the trend of the swings. Soon after a change of the mass it is
    /// their mean, and they vary as those before it did.
    pub(super) fn expected(&self, trend: &FadingTrend) -> Prior {
        match self.before.filter(|_| self.is_young()) {
            Some(before) => {
                let Swings { mean, weight, .. } = self.since;
                Prior { mean, weight }.loosened(1.0 / before.weight)
            }
            None => trend.prior(1.0),
        }
    }
}
