//! Detection of a change of the block's mass or of its friction, from one event to the next.

use crate::cycle::CycleTracker;
use crate::cycle::expectations::{Expectations, is_clear};
use crate::effect::Effect;
use crate::effects::level_shift::{Cause, Change, Levels};
use crate::effects::mass_change::{Mass, Verdict};
use crate::event::Event;
use crate::fit::posterior::Posterior;

impl CycleTracker {
    /// The change that an event shows, or confirms, if any.
    pub(super) fn change(
        &mut self,
        verdict: Verdict,
        event: &Event,
        posterior: &Posterior,
    ) -> Option<Change> {
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
