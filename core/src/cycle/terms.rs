//! What an event's residuals tell of the force terms that its fit lacks.

use crate::cycle::expectations::Expectations;
use crate::effect::Effect;
use crate::effects::score::Score;
use crate::effects::{damping, onset};
use crate::fit::correction::Correction;
use crate::fit::{Alone, Data, Fit};

impl Expectations {
    /// Carries what the event's residuals tell of the corners to the next ones, and all that was
    /// learnt along with it; `onset_n2` as from [`Self::learn_scores`].
    pub(crate) fn learn_corner(
        &mut self,
        data: &Data<'_>,
        fit: &Fit,
        alone: &Alone,
        noise_n2: f32,
        onset_n2: f32,
    ) -> Correction {
        if !self.effects.has(Effect::Corner) {
            return Correction { static_n2: onset_n2, ..Correction::default() };
        }
        let other_n2 = self.onset.ask(|onset| onset.largest_n2(fit.cycle().half_drop_n));
        let mut effect =
            self.corner.tell(|corner| corner.learn(data, fit, alone, noise_n2, other_n2));
        effect.static_n2 += onset_n2;
        let [_, rate, _, _, inverse_omega, rate_change] = effect.moved;
        self.rate.translate(rate);
        self.mass.translate(inverse_omega);
        self.rate_change.translate(rate_change);
        effect
    }

    /// What the event tells of the terms that widen; gives the variance of `Fs` by them, N².
    pub(crate) fn learn_scores(
        &mut self,
        data: &Data<'_>,
        fit: &Fit,
        alone: &Alone,
        noise_n2: f32,
    ) -> f32 {
        let [asks_losses, asks_onset] =
            [Effect::Damping, Effect::Onset].map(|it| self.effects.has(it));
        if !asks_losses && !asks_onset {
            return 0.0;
        }
        let shape = &fit.shape;
        let losses_n = damping::term_n(shape);
        let [losses, even, odd] = Score::of(data, shape, alone, |since_onset, gradient| {
            let [even_n, odd_n] = onset::terms_n(shape, since_onset);
            [losses_n(since_onset, gradient), even_n, odd_n]
        });
        if asks_losses {
            self.damping.tell(|damping| damping.0.learn(&losses, noise_n2));
        }
        if !asks_onset {
            return 0.0;
        }
        self.onset.tell(|onset| onset.learn(&[even, odd], noise_n2))
    }
}
