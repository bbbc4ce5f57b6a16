//! Detection of a change of the block's mass or of its friction, from one event to the next.

use crate::coefficient::{Coefficient, Site};
use crate::cycle::expectations::{Expectations, is_clear};
use crate::cycle::refusal::{FAST, is_no_chance};
use crate::cycle::slip_record::SlipRecord;
use crate::cycle::{CycleTracker, Finished};
use crate::effect::{Effect, Kept};
use crate::effects::level_shift::{Cause, Change, Levels};
use crate::effects::mass_change::{Mass, Verdict};
use crate::event::{Event, Reason};
use crate::fit::posterior::Posterior;
use crate::fit::rounding_n2;
use crate::model::CycleParams;
use crate::stats::fading_trend::FadingTrend;

/// Number of consecutive events that contradict the expectations, after which these are dropped, the
/// same as for a single quantity (`stats/fading_trend.rs`).
const CHANGED: u8 = 3;
/// Ratio of a swing to that by winch and weight, above which the winch may have stood while the
/// cable hung slack: other troubles lower omega by up to an eighth.
const SLOWER: f32 = 1.15;

impl Expectations {
    /// Are the event's residuals an outlier among those of the other events? The winch paused or
    /// started, or the block hit something.
    pub(crate) fn is_misfit(&self, slip: &SlipRecord, squares_n2: f32, free: f32) -> bool {
        let least_n2 = (slip.noise_n2, rounding_n2(slip.peak.force_n));
        self.residuals.is_outlier(squares_n2, free, least_n2)
    }

    /// Did the winch stand while the cable hung slack? The fit takes the longer time without force
    /// for that of a slower block: its swing, with this variance, is far above that by winch and
    /// weight. Asked until the swing is known, for then [`Slackness`] knows the usual time. A cell
    /// that lags has the same effect, but on every event: the third in a row is believed. Slips
    /// that look slow and follow each other fast, the next at the time `next`, may be aliases.
    ///
    /// [`Slackness`]: crate::cycle::refusal::Slackness
    pub(crate) fn stood_slack(&mut self, cycle: &CycleParams, variance: f32, next: f32) -> bool {
        if self.knows_omega() || cycle.is_taut() || next - cycle.onset < FAST {
            return false;
        }
        let usual = SLOWER * self.swing_by_winch(cycle.rate);
        let stood = is_no_chance((cycle.inverse_omega() - usual, variance));
        self.stood = if stood { self.stood.saturating_add(1) } else { 0 };
        stood && self.stood < CHANGED
    }

    /// Counts the events in a row that contradict the expectations: misfits, and events whose rate
    /// is another, as after a winch that took long to come up to speed. From [`CHANGED`] of them on
    /// the expectations no longer hold and are reset.
    pub(crate) fn contradict(&mut self, contradicts: bool) {
        self.contradictions = if contradicts { self.contradictions + 1 } else { 0 };
        if self.contradictions == CHANGED {
            self.contradictions = 0;
            [self.rate, self.rate_change, self.inverse_omega] = [FadingTrend::default(); 3];
            self.mass.update(Mass::forget);
            self.corner = Kept::default();
            self.sag = Kept::default();
        }
    }
}

impl CycleTracker {
    /// Completes a measured event: adds the change that it shows and the common parts of its
    /// errors.
    pub(super) fn judged(
        &mut self,
        site: &Site,
        mut event: Event,
        alone: Option<(Coefficient, Coefficient)>,
        posterior: &Posterior,
        (shift_n, shift_n2): (f32, f32),
        verdict: Verdict,
    ) -> Finished {
        let change = self.change(verdict, &event, posterior);
        if verdict == Verdict::Suspect {
            (event.mu_s, event.mu, event.reason) = (None, None, Some(Reason::Suspect));
            return event.into();
        }
        // Only a sag that shifts `Fp` is common to all events; one that is only possible is not.
        let sag_n2 = if shift_n > 0.0 { shift_n2 } else { 0.0 };
        let (static_n2, dynamic_n2) = posterior.common_n2;
        let mut common = (site.std(static_n2), site.std(dynamic_n2 + sag_n2));
        if !posterior.is_resolved() && !self.learnt.knows_omega() {
            // The length of the slip is then a guess with the same error in all events.
            let (static_n2, dynamic_n2) = posterior.forces_n2();
            common = (site.std(static_n2), site.std(dynamic_n2));
        }
        Finished { event, alone, common, change }
    }

    /// The change that an event shows, or confirms, if any.
    fn change(&mut self, verdict: Verdict, event: &Event, posterior: &Posterior) -> Option<Change> {
        let here = (event.index, event.onset);
        let suspect = self.suspect.take();
        let (cause, (first, onset)) = match verdict {
            Verdict::Suspect => {
                self.suspect = suspect.or(Some(here));
                return None;
            }
            Verdict::Same => {
                let (static_n, dynamic_n) = (posterior.cycle.static_n, posterior.cycle.dynamic_n());
                let follows = self.learnt.effects.has(Effect::Level);
                let shift = follows.then(|| {
                    self.levels.update(|levels| levels.take(event.index, (static_n, dynamic_n)))
                })??;
                let first = (shift.event, event.onset);
                let Expectations { effects, mass, inverse_omega, .. } = &mut self.learnt;
                let before_n = shift.dynamic_before_n;
                if effects.has(Effect::Mass) {
                    let tries = |mass: &mut Mass| mass.try_weight(inverse_omega, before_n);
                    if is_clear(posterior) && mass.update(tries) {
                        self.suspect = Some(first);
                        return None;
                    }
                    mass.update(|mass| mass.leave_open(dynamic_n, before_n));
                }
                (Cause::Unknown, first)
            }
            Verdict::Mass => (Cause::Mass, suspect.unwrap_or(here)),
            Verdict::SameMass => (Cause::Friction, suspect.unwrap_or(here)),
            Verdict::Unknown => (Cause::Unknown, suspect.unwrap_or(here)),
        };
        self.levels.update(Levels::forget);
        let (weight_ratio, relative) = self.weight_ratio();
        let weight_ratio_std = relative * weight_ratio;
        Some(Change { event: first, onset, cause, weight_ratio, weight_ratio_std })
    }
}
