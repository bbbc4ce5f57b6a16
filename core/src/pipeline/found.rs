//! The finding of each effect.

use crate::effect::{Effect, Effects, Finding, Parameter};
use crate::effects::level_shift::Cause;
use crate::effects::zero_drift::Drift;
use crate::pipeline::Pipeline;

impl Pipeline {
    /// The finding of each effect, in the order of [`Effect::ALL`].
    #[must_use]
    pub fn findings(&self) -> [Finding; Effect::ALL.len()] {
        let all = self.found();
        Effect::ALL.map(|effect| {
            let (enabled, found) = (self.config.effects.has(effect), all.has(effect));
            let parameters = if found { self.parameters(effect) } else { [None; 2] };
            Finding { effect, enabled, found, parameters }
        })
    }

    /// The effects that the data show, among those that were looked for.
    pub(super) fn found(&self) -> Effects {
        let of_level = self.change.is_some_and(|change| change.cause != Cause::Mass);
        let (of_rests, of_events) = (self.detector.found(), self.cycles.found());
        let found = Effects::from_mask(of_rests.mask() | of_events.mask())
            .with(Effect::Level, of_level)
            .with(Effect::Drift, self.zero_n().is_some());
        Effects::from_mask(found.mask() & self.config.effects.mask())
    }

    /// The estimated parameters of an effect. A change of level has none: its size follows from the
    /// events after it.
    fn parameters(&self, effect: Effect) -> [Option<Parameter>; 2] {
        let [first, second] = self.cycles.parameters(effect);
        match effect {
            Effect::Flop => [self.detector.flop(), first],
            Effect::Ripple => [self.detector.ripple(), first],
            // A drift widens the intervals and shifts nothing.
            Effect::Drift => {
                let zero = |std| Parameter { name: "zero_n", value: 0.0, std };
                [self.zero_n().map(zero), None]
            }
            Effect::Corner
            | Effect::Sag
            | Effect::Stiffening
            | Effect::Mass
            | Effect::Level
            | Effect::Damping
            | Effect::Onset
            | Effect::Scatter => [first, second],
        }
    }

    /// Standard deviation of the zero's drift, N, if it exceeds the noise.
    pub(super) fn zero_n(&self) -> Option<f32> {
        let zero_n = self.cycles.normal_n() * self.drift.read(Drift::std);
        self.noise_n().filter(|&noise_n| zero_n > noise_n).map(|_| zero_n)
    }
}
