//! A complete event, counted into the means.

use crate::cycle::Finished;
use crate::effect::{Effect, Effects};
use crate::effects::level_shift::Change;
use crate::estimator::Common;
use crate::event::Quality;
use crate::num::math;
use crate::pipeline::{Pipeline, Step};
use crate::sample::SampleTime;

impl Pipeline {
    /// Counts an event, and puts it into the step; does neither if nothing slipped.
    pub(super) fn count(&mut self, finished: Finished, step: &mut Step) {
        if let Some(reason) = finished.event.reason.filter(|reason| reason.is_no_slip()) {
            self.stretches.refuse(finished.event.onset, finished.event.stop, reason);
            return;
        }
        self.stretches.end_before(finished.event.onset);
        let Some((onset, stop)) = self.stretches.outside(&finished.event) else {
            // The event was found late, within a constant force that has been returned already.
            self.cycles.withdraw();
            return;
        };
        let Finished { mut event, alone, common, change } = finished;
        event.onset = self.decimator.moment(onset);
        event.stop = self.decimator.moment(stop);
        if let Some(noise_n) = self.cycles.noise_n() {
            self.detector.fitted_noise(noise_n, event.mu_s.is_some());
            self.detector.creeps(self.cycles.creep_periods());
        }
        self.take_onset(onset, event.stick_s.is_some());
        if let Some(change) = change {
            let onset = self.decimator.moment(change.onset);
            self.change = Some(Change { onset, ..change });
            step.change = self.change;
        }
        let (mu_s, mu) = alone.map_or((event.mu_s, event.mu), |(mu_s, mu)| (Some(mu_s), Some(mu)));
        let drifts = self.config.effects.has(Effect::Drift);
        if let Some((mu_s, mu)) = event.mu_s.zip(event.mu).filter(|_| drifts) {
            self.drift.update(|drift| drift.take(mu_s, mu));
        }
        let rate_hz = self.config.rate_hz / self.decimator.factor();
        let rest = event.stick_s.map_or(f32::MAX, |rest_s| rest_s * rate_hz);
        let granted = granted(event.quality, rest);
        let moved = event.quality == Quality::Unresolved || self.cycles.found() != Effects::NONE;
        let means = [(&mut self.mu_s, mu_s), (&mut self.mu, mu)];
        let parts = [(common.0, granted.0), (common.1, granted.1)];
        for ((mean, it), (shared, granted)) in means.into_iter().zip(parts) {
            if let Some(it) = it {
                mean.add_with_common(it, Common { shared, granted: granted * it.std, moved });
            }
        }
        if mu_s.or(mu).is_some() {
            self.largest_n = math::larger(self.largest_n, event.peak_force_n.abs());
            let events = self.mu_s.count().max(self.mu.count()).max(1) as f32;
            let (_, newest) = self.cycles.weight_ratio();
            self.weight_std.update(|mean| *mean += (newest - *mean) / events);
        }
        self.add_systematic(event.mu_s.as_mut(), event.mu.as_mut());
        step.event = Some(event);
    }

    /// Takes the onset of an event. The interval to the event before counts unless a gap or a
    /// stretch without an event may hide slips in it; `rests` if no gap does.
    fn take_onset(&mut self, onset: SampleTime, rests: bool) {
        let (from, to) = self.stretches.newest();
        let before = self.last_onset.filter(|it| !(it.precedes(to) && from.precedes(onset)));
        if let Some(before) = before.filter(|_| rests) {
            self.intervals = self.intervals.saturating_add(1);
            let interval = onset.periods_since(before);
            self.recurrence += (interval - self.recurrence) / self.intervals as f32;
        }
        // By now there may be a stretch between this event and the next.
        self.last_onset = Some(onset).filter(|it| !it.precedes(to));
    }
}

/// Parts of the standard deviations of an event's `mu_s` and `mu` that are common to all events.
/// Where the slip is too short for the sampling, or hidden by a slack cable, all events rest on the
/// same assumptions: a third is common, so that no number of such events makes a mean more precise.
/// After a rest with few samples `mu_s` depends on the rate and the swing of other events; `mu`, the
/// middle of the swing, does not.
fn granted(quality: Quality, rest: f32) -> (f32, f32) {
    /// Samples of a rest that determine its line: two for the rate, and as many at either end that
    /// the noise may hide. Fewer determine one combination of an event's rate and swing.
    const LINE_SAMPLES: f32 = 6.0;
    /// Common part of `mu_s` without any rest. Tuned: with rests of less than two samples the means of
    /// `mu_s` scatter by .36 of an event's standard deviation.
    const WITHOUT_REST: f32 = 0.5;
    let least = match quality {
        Quality::Good | Quality::Clipped => 0.0,
        Quality::Unresolved | Quality::Slack => 1.0 / 3.0,
    };
    (math::larger(least, WITHOUT_REST * (1.0 - rest / LINE_SAMPLES)), least)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_mu_s_depends_on_other_events_after_a_brief_rest() {
        let (of_mu_s, of_mu) = granted(Quality::Good, 1.5);
        assert!(of_mu_s > 0.36 && of_mu <= 0.0, "{of_mu_s} {of_mu}");
        assert!(granted(Quality::Good, 6.0).0 <= 0.0);
        let (of_mu_s, of_mu) = granted(Quality::Slack, 1.5);
        assert!(of_mu_s > of_mu && of_mu > 0.3, "{of_mu_s} {of_mu}");
    }
}
