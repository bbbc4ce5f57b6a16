//! Estimates that other modules read: noise, rate, omega, effects, weight.

use crate::coefficient::Site;
use crate::cycle::CycleTracker;
use crate::cycle::expectations::Expectations;
use crate::effect::{Effect, Effects, Parameter};
use crate::effects::damping::Damping;
use crate::effects::mass_change::Mass;
use crate::effects::onset::Onset;
use crate::effects::oscillation::Oscillation;
use crate::effects::sag::Sag;
use crate::effects::scatter::SlipScatter;
use crate::effects::stiffening;
use crate::num::math;
use crate::stats::quantity::Quantity;

impl CycleTracker {
    /// Standard deviation of the noise, N, from the residuals of all fits.
    #[must_use]
    pub(crate) fn noise_n(&self) -> Option<f32> {
        self.learnt.residuals.variance_n2().map(math::sqrt)
    }

    /// Periods before the onset in which creep bends the stick line.
    #[must_use]
    pub(crate) fn creep_periods(&self) -> f32 {
        self.learnt.creep_periods()
    }

    /// Loading rate, N/s, and omega, rad/s, expected for the next event, each with its standard
    /// deviation. Omega is `None` where its standard deviation is a third of it or more.
    #[must_use]
    pub(crate) fn shared(&self) -> (Option<Quantity>, Option<Quantity>) {
        let hz = self.site.rate_hz;
        let omega = |inverse: Quantity| {
            let value = hz / inverse.value;
            Quantity { value, std: value * inverse.std / inverse.value }
        };
        let usual = self.learnt.usual_swing();
        let omega = usual.known().filter(|_| self.determines_omega()).map(omega);
        (self.learnt.rate.known().map(|rate| rate.times(hz)), omega)
    }

    /// Is the standard deviation of omega less than a third of it?
    fn determines_omega(&self) -> bool {
        let (swing, variance) = self.learnt.usual_swing().now();
        9.0 * variance < swing * swing
    }

    /// Loading rate over omega, N; zero while one of them is unknown.
    #[must_use]
    pub(crate) fn overshoot_n(&self) -> f32 {
        let swing = self.learnt.usual_swing().mean().filter(|_| self.determines_omega());
        self.learnt.rate.mean().zip(swing).map_or(0.0, |(rate, swing)| rate * swing)
    }

    /// The effects found in the events, except changes of level and drifts.
    #[must_use]
    pub(crate) fn found(&self) -> Effects {
        let Expectations { corner, damping, onset, scatter, rate, rate_change, .. } = &self.learnt;
        let sags = self.learnt.sags();
        Effects::NONE
            .with(Effect::Corner, corner.get().is_some_and(|corner| !corner.is_sharp()))
            .with(Effect::Sag, sags)
            // A sagging cable changes the rate as well: that is attributed to the sag.
            .with(Effect::Stiffening, !sags && stiffening::is_found(rate, rate_change))
            .with(Effect::Mass, self.weight_ratio().1 > 0.0)
            .with(Effect::Damping, damping.read(Damping::is_found))
            .with(Effect::Onset, onset.read(Onset::is_found))
            .with(Effect::Scatter, scatter.read(SlipScatter::excess) > 0.0)
    }

    /// The parameters of an effect that was found, as the events determine them.
    #[must_use]
    pub(crate) fn parameters(&self, effect: Effect) -> [Option<Parameter>; 2] {
        match effect {
            Effect::Corner => {
                self.learnt.corner.read(|corner| corner.parameters(self.site.rate_hz))
            }
            Effect::Damping => [self.learnt.damping.read(Damping::parameter), None],
            Effect::Onset => [self.learnt.onset.read(Onset::parameter), None],
            Effect::Scatter => {
                let noise_n2 = self.learnt.residuals.variance_n2();
                let parameter = |noise_n2| self.learnt.scatter.get()?.parameter(noise_n2);
                [noise_n2.and_then(parameter), None]
            }
            Effect::Sag => [self.learnt.sag.read(Sag::parameter), None],
            Effect::Stiffening => {
                [stiffening::parameter(&self.learnt.rate, &self.learnt.rate_change), None]
            }
            Effect::Mass => {
                let (value, relative) = self.weight_ratio();
                [Some(Parameter { name: "weight_ratio", value, std: relative * value }), None]
            }
            Effect::Ripple => [self.learnt.oscillation.read(Oscillation::parameter), None],
            Effect::Level | Effect::Drift | Effect::Flop => [None; 2],
        }
    }

    /// The site, with the weight that is now in use.
    pub(super) fn site(&self) -> Site {
        let ratio = self.learnt.weight_ratio();
        let Site { weight_n, momentum, .. } = self.site;
        Site { weight_n: ratio * weight_n, momentum: ratio * momentum, ..self.site }
    }

    /// Sine and cosine of the slope.
    #[must_use]
    pub(crate) fn slope(&self) -> (f32, f32) {
        self.site.slope
    }

    /// Normal force of the block, N, with the weight in use: the force of a coefficient of one.
    #[must_use]
    pub(crate) fn normal_n(&self) -> f32 {
        let site = self.site();
        site.weight_n * site.slope.1
    }

    /// Standard deviation of the damping ratio: the stated one, widened by what the events show.
    #[must_use]
    pub(crate) fn damping_std(&self, stated: f32) -> f32 {
        self.learnt.damping.get().map_or(stated, |damping| damping.std(stated))
    }

    /// Weight in use over the given one, and its relative standard deviation.
    #[must_use]
    pub(crate) fn weight_ratio(&self) -> (f32, f32) {
        self.learnt.mass.get().map_or((1.0, 0.0), Mass::weight_ratio_and_std)
    }
}
