//! The detector's results for other modules, and what the events set in it.

use crate::detector::{Detector, Stick};
use crate::effect::{Effect, Effects, Parameter};
use crate::noise::flop::FlopProfile;
use crate::noise::ripple::{ColoredNoise, Ripple};
use crate::num::math::{larger, smaller};
use crate::sample::{ForcePoint, Phase, since};
use crate::signal::window::Window;

impl Detector {
    /// Work of the newest step beyond that of one at rest, in units of 160 instructions on the
    /// board.
    #[must_use]
    pub(crate) fn spent(&self) -> usize {
        self.spent
    }

    /// What the block is doing.
    #[must_use]
    pub fn phase(&self) -> Phase {
        self.phase
    }

    /// The newest sample looked at.
    #[must_use]
    pub(crate) fn last(&self) -> ForcePoint {
        self.last
    }

    /// The last samples.
    #[must_use]
    pub(crate) fn window(&self) -> &Window {
        &self.window
    }

    /// The stick line since the last re-stick.
    #[must_use]
    pub(crate) fn stick(&self) -> &Stick {
        &self.stick
    }

    /// The stick line before the last slip, or before the last long gap.
    #[must_use]
    pub(crate) fn ended(&self) -> &Stick {
        &self.ended
    }

    /// The first index after the rest that a long gap, or a fall without end, has ended.
    pub(crate) fn lost(&self) -> u32 {
        self.ended.next + self.line_delay
    }

    /// Standard deviation of the noise, N, to about 10 %; infinite before it is known.
    pub(crate) fn std_n(&self) -> f32 {
        self.std_n
    }

    /// Standard deviation of the noise, N, to about 10 %; `None` before it is known.
    #[must_use]
    pub(crate) fn noise_n(&self) -> Option<f32> {
        (self.std_n < f32::INFINITY).then_some(self.std_n)
    }

    /// Colored noise: how the force departs from a straight stick line beyond white noise.
    #[must_use]
    pub(crate) fn wander(&self) -> ColoredNoise {
        if self.effects.has(Effect::Ripple) { self.colored() } else { ColoredNoise::NONE }
    }

    /// Do all rests bend the same way?
    #[must_use]
    pub(crate) fn bends(&self) -> bool {
        self.colored().bends
    }

    fn colored(&self) -> ColoredNoise {
        self.ripple.get().map_or(ColoredNoise::NONE, Ripple::wander)
    }

    /// Common weight of all samples from the lowest one to the newest: the flop profile's at the
    /// age of their middle, which is negative, before the re-stick.
    #[must_use]
    pub(crate) fn rest_weight(&self) -> f32 {
        let age = -0.5 * since(self.lowest.index, self.last.index);
        self.profile.get().map_or(1.0, |profile| 1.0 / profile.variance(age))
    }

    /// Usual drop of a slip, N; zero before the first.
    #[must_use]
    pub(crate) fn usual_drop_n(&self) -> f32 {
        self.usual_drop_n
    }

    /// Which of the two noise effects, flop and ripple, the recent rests show.
    #[must_use]
    pub(crate) fn found(&self) -> Effects {
        Effects::NONE
            .with(Effect::Flop, self.flops())
            .with(Effect::Ripple, !self.wander().is_none())
    }

    /// Estimate of the flop from the recent rests.
    #[must_use]
    pub(crate) fn flop(&self) -> Option<Parameter> {
        self.profile.get().map(FlopProfile::parameter)
    }

    /// Estimate of the ripple from the recent rests.
    #[must_use]
    pub(crate) fn ripple(&self) -> Option<Parameter> {
        self.ripple.read(Ripple::parameter)
    }

    /// Takes the noise, N, estimated from the residuals of all events so far; `believed` if the
    /// newest event has coefficients.
    pub(crate) fn fitted_noise(&mut self, noise_n: f32, believed: bool) {
        self.noise.add_fit(noise_n, believed);
    }

    /// Keeps the samples of the last `periods` before an onset, which creep bends, out of the line.
    pub(crate) fn creeps(&mut self, periods: f32) {
        // Limit, periods: the fit takes those samples one by one, and its record has no more room.
        const ROOM: f32 = 48.0;
        // Half a sample: a smaller change does not move the end of a line.
        const LONGER: f32 = 0.5;
        let before = self.creep_periods;
        self.creep_periods = larger(smaller(periods, ROOM - self.usual_fall), 0.0);
        if self.creep_periods > before + LONGER {
            // The innovations so far contain the creep.
            self.forget_ripple();
        }
        self.update_delay();
    }

    /// Sets the force, N, that a constant force has to rise above before a slip; `None`: no limit.
    pub(crate) fn stays_below(&mut self, ceiling_n: Option<f32>) {
        self.ceiling_n = ceiling_n.unwrap_or(f32::NEG_INFINITY);
    }
}
