//! What the effects learn from an event: the score tests of its residuals for force terms that its
//! fit lacks, oscillations and creep; and its noise beyond the white one.

use core::ops::Range;

use crate::cycle::expectations::Expectations;
use crate::cycle::slip_record::SlipRecord;
use crate::effect::Effect;
use crate::effects::corner::CornerEstimator;
use crate::effects::damping::{self, Damping};
use crate::effects::onset;
use crate::effects::score::Asked;
use crate::fit::correction::Correction;
use crate::fit::posterior::Posterior;
use crate::fit::residuals::Residuals;
use crate::fit::{Data, Fit};
use crate::model::Shape;
use crate::model::corner::Corner;
use crate::noise::ripple::ColoredNoise;
use crate::noise::sinusoid::Sinusoid;
use crate::num::math;

impl Expectations {
    /// Are there force terms to test for? False at compile time where none is compiled in.
    #[inline(always)]
    pub(crate) fn asks(&self) -> bool {
        let terms = [Effect::Damping, Effect::Onset, Effect::Corner];
        terms.into_iter().any(|effect| self.effects.has(effect))
    }

    /// Is the event due for a test of its corners? Counts the event.
    pub(crate) fn asks_corner(&mut self, used: &Corner) -> bool {
        self.effects.has(Effect::Corner) && self.corner.update(|corner| corner.is_due(used))
    }

    /// Learns the corners from the score test of an event, and moves the estimates of rate, swing
    /// and rate change accordingly. Returns the correction of the event itself.
    pub(crate) fn learn_corner(
        &mut self,
        used: Corner,
        fit: &Fit,
        score: &Asked,
        noise_n2: f32,
    ) -> Correction {
        let other_n2 = self.onset.read(|onset| onset.largest_n2(fit.cycle().half_drop_n));
        let effect =
            self.corner.update(|corner| corner.learn(used, fit, score, noise_n2, other_n2));
        let [_, rate, _, _, inverse_omega, rate_change] = effect.moved;
        self.rate.translate(rate);
        self.inverse_omega.translate(inverse_omega);
        self.rate_change.translate(rate_change);
        effect
    }

    /// Time before an onset, periods, in which creep lowers the force by more than a fifth of the
    /// noise's standard deviation.
    pub(crate) fn creep_periods(&self) -> f32 {
        const PART: f32 = 0.2;
        if self.corner.read(CornerEstimator::missing_n) <= 0.0 {
            return 0.0;
        }
        let known = self.rate.mean().zip(self.residuals.variance_n2());
        let creep = |(rate, noise_n2)| {
            let least_n = PART * math::sqrt(noise_n2);
            self.corner.read(|corner| corner.creep_n(least_n)) / rate
        };
        known.map_or(0.0, creep)
    }

    /// Variance due to a bend of an event's lines, or an oscillation about them, that may be the
    /// cable's or the cell's, in units of the noise variance.
    pub(crate) fn unsure(&self, slip: &SlipRecord, noise_n2: f32) -> f32 {
        let all_n2 = self.residuals.variance_n2().unwrap_or(slip.noise_n2);
        slip.wander.unsure * all_n2 / noise_n2
    }

    /// Drops the residuals from before samples had weights, once some have: they are not
    /// comparable.
    pub(crate) fn weigh(&mut self, slip: &SlipRecord) {
        if slip.rest_weight < 1.0 && !self.weighted {
            self.weighted = true;
            self.residuals = Residuals::default();
        }
    }

    /// Learns from an event, if it `teaches`, whether the oscillation about its two lines is the
    /// cable's or the cell's. Returns the correction of the event's forces.
    pub(crate) fn learn_oscillation(
        &mut self,
        wander: &ColoredNoise,
        lines: (&Sinusoid, &Sinusoid),
        (fit, posterior): (&Fit, &Posterior),
        noise_n2: f32,
        teaches: bool,
    ) -> Correction {
        self.oscillation.update(|oscillation| {
            oscillation.follow(wander.angle, lines);
            let event = oscillation.event((wander, noise_n2), lines, &fit.shape, posterior);
            if teaches {
                oscillation.learn(&event, noise_n2);
            }
            oscillation.correction(&event)
        })
    }

    /// Adds levels to the score test of the terms that only widen: losses, and the two of the
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

    /// Learns these terms when all levels are in. Returns the variance that they add to `Fs`, N².
    pub(crate) fn learn_scores(&mut self, asked: &Asked, noise_n2: f32) -> f32 {
        if self.effects.has(Effect::Damping) {
            // The slip of a sagging cable is no ellipse, which looks like a damping ratio of a
            // tenth or more.
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
