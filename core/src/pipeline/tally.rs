//! A complete event, counted into the means.

use crate::coefficient::Coefficient;
use crate::cycle::Finished;
use crate::effect::Effect;
use crate::effects::level_shift::Change;
use crate::event::{Event, Quality};
use crate::num::math;
use crate::pipeline::Pipeline;

impl Pipeline {
    /// Counts an event, unless nothing slipped.
    pub(super) fn count(&mut self, finished: Finished) -> Option<Event> {
        if let Some(reason) = finished.event.reason.filter(|reason| reason.is_no_slip()) {
            self.stretches.refuse(finished.event.onset, finished.event.stop, reason);
            return None;
        }
        self.stretches.end_before(finished.event.onset);
        let Some((onset, stop)) = self.stretches.outside(&finished.event) else {
            // Found late, in a force that was told as it is.
            self.cycles.withdraw();
            return None;
        };
        let Finished { mut event, alone, common, change } = finished;
        event.onset = self.decimator.moment(onset);
        event.stop = self.decimator.moment(stop);
        if let Some(noise_n) = self.cycles.noise_n() {
            self.detector.fitted_noise(noise_n);
            self.detector.creeps(self.cycles.creep_periods());
        }
        if self.events == 0 {
            self.first_onset = event.onset;
        }
        self.since_first = event.onset.periods_since(self.first_onset);
        self.events = self.events.saturating_add(1);
        if let Some(change) = change {
            let onset = self.decimator.moment(change.onset);
            self.change = Some(Change { onset, ..change });
            self.told = false;
        }
        let (mu_s, mu) = alone.map_or((event.mu_s, event.mu), |(mu_s, mu)| (Some(mu_s), Some(mu)));
        let drifts = self.config.effects.has(Effect::Drift);
        if let Some((mu_s, mu)) = event.mu_s.zip(event.mu).filter(|_| drifts) {
            self.drift.take(mu_s, mu);
        }
        if let Some(mu_s) = mu_s {
            self.mu_s.add_with_common(mu_s, in_common(event.quality, mu_s, common.0));
        }
        if let Some(mu) = mu {
            self.mu.add_with_common(mu, in_common(event.quality, mu, common.1));
        }
        self.largest_n = math::larger(self.largest_n, event.peak_force_n.abs());
        if mu_s.or(mu).is_some() {
            let events = self.mu_s.count().max(self.mu.count()) as f32;
            self.weight_std += (self.cycles.weight_ratio().1 - self.weight_std) / events;
        }
        self.add_systematic(event.mu_s.as_mut(), event.mu.as_mut());
        Some(event)
    }
}

/// Part of an event's standard deviation that is the same in all of them. Where the slip is
/// too short for the sampling, or hidden by a slack cable, all take the same things for
/// granted: a third of it, so that no number of such events makes a mean sharper than that.
fn in_common(quality: Quality, event: Coefficient, common_std: f32) -> f32 {
    const TAKEN_FOR_GRANTED: f32 = 1.0 / 3.0;
    match quality {
        Quality::Good | Quality::Clipped => common_std,
        Quality::Unresolved | Quality::Slack => {
            math::hypotenuse(common_std, TAKEN_FOR_GRANTED * event.std)
        }
    }
}
