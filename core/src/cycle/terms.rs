//! What an event's residuals tell of the force terms and the oscillations that its fit lacks.

use core::ops::Range;

use crate::cycle::expectations::Expectations;
use crate::cycle::slip_record::SlipRecord;
use crate::effect::Effect;
use crate::effects::damping::{self, Damping};
use crate::effects::onset;
use crate::effects::oscillation::TwoFits;
use crate::effects::score::Asked;
use crate::fit::correction::Correction;
use crate::fit::posterior::Posterior;
use crate::fit::{Alone, Data, Fit};
use crate::model::Shape;
use crate::model::corner::Corner;

impl Expectations {
    /// Are there force terms to ask events for? Where none is compiled in that is known at compile
    /// time.
    #[inline(always)]
    pub(crate) fn asks(&self) -> bool {
        let terms = [Effect::Damping, Effect::Onset, Effect::Corner];
        terms.into_iter().any(|effect| self.effects.has(effect))
    }

    /// Is the event to be asked for its corners? Counts it.
    pub(crate) fn asks_corner(&mut self, used: &Corner) -> bool {
        self.effects.has(Effect::Corner) && self.corner.update(|corner| corner.is_due(used))
    }

    /// Learns the corners from what the event's levels told, and moves what was learnt of rate,
    /// swing and rate change along with them. Gives the correction of the event itself.
    pub(crate) fn learn_corner(
        &mut self,
        used: Corner,
        fit: &Fit,
        asked: (&Alone, &Asked),
        noise_n2: f32,
    ) -> Correction {
        let other_n2 = self.onset.read(|onset| onset.largest_n2(fit.cycle().half_drop_n));
        let effect =
            self.corner.update(|corner| corner.learn(used, fit, asked, noise_n2, other_n2));
        let [_, rate, _, _, inverse_omega, rate_change] = effect.moved;
        self.rate.translate(rate);
        self.mass.translate(inverse_omega);
        self.rate_change.translate(rate_change);
        effect
    }

    /// Learns from an event, if it `teaches`, whether an oscillation about its lines is the cable's
    /// or the cell's; gives the correction of its forces that follows. The fit is one that does not
    /// follow the oscillation.
    pub(crate) fn learn_oscillation(
        &mut self,
        slip: &SlipRecord,
        data: Data<'_>,
        (fit, posterior): (&Fit, &Posterior),
        noise_n2: f32,
        teaches: bool,
    ) -> Correction {
        let wander = slip.wander;
        let rate = data.rate.loosened(wander.slope);
        let rate_change = data.rate_change.loosened(4.0 * wander.slope);
        let local = Data { wander, rate, rate_change, ..data };
        let resolved = Some(fit).filter(|_| posterior.is_resolved());
        let Some(followed) = resolved.and_then(|fit| fit.forces_with(&local)) else {
            // Unsure by all of the oscillation, whosever it is.
            let static_n2 = (1.0 - wander.white_share()) * noise_n2;
            return Correction { static_n2, dynamic_n2: 0.5 * static_n2, ..Correction::default() };
        };
        let (cycle, white_n2) = (&posterior.cycle, wander.white_share() * noise_n2);
        let swing2 = cycle.inverse_omega() * cycle.inverse_omega();
        let event = TwoFits {
            forces_n: [cycle.static_n, cycle.dynamic_n()],
            plain_n2: [posterior.static_n2, posterior.dynamic_n2],
            by_n: [
                followed.static_n - fit.cycle().static_n,
                followed.dynamic_n - fit.cycle().dynamic_n(),
            ],
            followed_n2: [followed.static_variance, followed.dynamic_variance]
                .map(|it| white_n2 * it),
            white_share: wander.white_share(),
            turn_n2: white_n2 * wander.slope * swing2,
        };
        self.oscillation.update(|oscillation| {
            if teaches {
                oscillation.learn(&event, noise_n2);
            }
            oscillation.correction(&event)
        })
    }

    /// Asks levels of the event for the force terms that only widen: losses, and the two of the
    /// onset.
    pub(crate) fn ask_scores(
        &self,
        asked: &mut Asked,
        levels: (&Data<'_>, Range<usize>),
        shape: &Shape,
    ) {
        if self.effects.has(Effect::Damping) || self.effects.has(Effect::Onset) {
            let losses_n = damping::term_n(shape);
            asked.take(levels, shape, |since_onset, gradient| {
                let [even_n, odd_n] = onset::terms_n(shape, since_onset);
                [losses_n(since_onset, gradient), even_n, odd_n]
            });
        }
    }

    /// Learns what all levels told of these terms; gives the variance of `Fs` by them, N².
    pub(crate) fn learn_scores(&mut self, asked: &mut Asked, alone: &Alone, noise_n2: f32) -> f32 {
        asked.free(alone);
        if self.effects.has(Effect::Damping) {
            // The slip of a cable that sags is no ellipse, which looks like losses of a tenth and more.
            let sags = self.sags();
            self.damping.update(|damping| {
                if sags {
                    *damping = Damping::default();
                } else {
                    damping.0.learn(&asked.score(0), noise_n2);
                }
            });
        }
        if !self.effects.has(Effect::Onset) {
            return 0.0;
        }
        self.onset.update(|onset| onset.learn(&[asked.score(1), asked.score(2)], noise_n2))
    }
}
