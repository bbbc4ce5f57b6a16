//! The effects that the events show, and their parameters.

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

impl CycleTracker {
    /// The effects found in the events, except changes of level and drifts.
    pub(crate) fn found(&self) -> Effects {
        let Expectations { corner, damping, onset, scatter, rate, rate_change, .. } = &self.learnt;
        let sags = self.learnt.sags();
        Effects::NONE
            .with(Effect::Corner, corner.get().is_some_and(|corner| !corner.is_sharp()))
            .with(Effect::Sag, sags)
            // A sagging cable changes the rate as well: that is attributed to the sag.
            .with(Effect::Stiffening, !sags && stiffening::is_found(rate, rate_change))
            .with(Effect::Mass, self.weight_ratio().1 > 0.0)
            .with(Effect::Damping, damping.read(Damping::parameter).is_some())
            .with(Effect::Onset, onset.read(Onset::parameter).is_some())
            .with(Effect::Scatter, scatter.read(SlipScatter::excess) > 0.0)
    }

    /// The parameters of an effect that was found, as the events determine them.
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

    /// Periods before the onset in which creep bends the stick line.
    pub(crate) fn creep_periods(&self) -> f32 {
        self.learnt.creep_periods()
    }

    /// Standard deviation of the damping ratio: the stated one, widened by what the events show.
    pub(crate) fn damping_std(&self, stated: f32) -> f32 {
        self.learnt.damping.get().map_or(stated, |damping| damping.std(stated))
    }

    /// Weight in use over the given one, and its relative standard deviation.
    pub(crate) fn weight_ratio(&self) -> (f32, f32) {
        self.learnt.mass.get().map_or((1.0, 0.0), Mass::weight_ratio_and_std)
    }
}
