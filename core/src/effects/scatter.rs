//! Scatter of the slips' samples beyond the noise, from a clock that jitters, a cell that lags, a
//! block that rocks, a winch that cogs, or friction that varies along the way.
//!
//! All of these are errors in time or along the fall, so their variance is proportional to `g`, the
//! squared rate of the force over its largest. In units of the noise variance,
//! `E Σ g r² = Σ g f + λ Σ g R² g`, where `R` is the part of each sample's error that the fit
//! leaves in each residual and `f` its diagonal. Slips of two samples have almost no residual, but
//! each determines a swing, and neither cable nor mass changes between slips. So the squared
//! difference of a swing from the mean of the last ones, over its variance `v` by the noise, is one
//! more square, with expectation `1 + λ Σ g a² / v`, where `a` is the shift of the swing by a
//! sample's error. The ratio of all squares to all degrees of freedom is pooled with outliers left
//! out (`fit/residuals.rs`).

use crate::effect::Parameter;
use crate::fit::residuals::Residuals;
use crate::fit::slip_residuals::{OwnSwing, SlipResiduals};
use crate::num::math::{self, larger};
use crate::stats::significance::surely;

/// Standard errors beyond which the scatter counts, in full from twice as many on: it only widens.
const SIGNIFICANT: f32 = 2.0;

/// Estimator of the scatter.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SlipScatter {
    pooled: Residuals,
    /// Mean of `Σ g R² g` over `Σ g f`.
    shown: f32,
    /// Running mean over the last slips.
    swing: OwnSwing,
}

impl SlipScatter {
    /// The scatter `λ`: variance beyond the noise where the force is steepest, over that of the
    /// noise, as far as it is significant.
    pub(crate) fn excess(&self) -> f32 {
        let more = self.pooled.variance_n2().map_or(0.0, |ratio| ratio - 1.0);
        if more <= 0.0 {
            return 0.0;
        }
        let limit = SIGNIFICANT * math::sqrt(2.0 / self.pooled.free);
        // With few degrees of freedom the estimate may be far too small: corrected by about the
        // ratio of Student's variance to the normal one.
        let few = 1.0 + 2.0 / self.pooled.free;
        if more > limit { few * more * surely(more, limit) / self.shown } else { 0.0 }
    }

    /// Standard deviation of the scatter where the force is steepest, N, if it is significant.
    pub(crate) fn parameter(&self, noise_n2: f32) -> Option<Parameter> {
        let (ratio, excess) = (self.pooled.variance_n2()?, self.excess());
        let value = math::sqrt(excess * noise_n2);
        let relative = ratio / (ratio - 1.0) * math::sqrt(0.5 / self.pooled.free);
        (excess > 0.0).then_some(Parameter { name: "scatter_n", value, std: relative * value })
    }

    /// Adds a slip.
    pub(crate) fn learn(&mut self, mut slip: SlipResiduals) {
        // Fewest degrees of freedom of a slip that is used, and largest ratio accepted from the
        // first slips.
        const LEAST: f32 = 0.2;
        const LARGEST: f32 = 1e4;
        // Weight of the earlier swings in the mean, over that of the last one. Tuned: with half of
        // it a shortening cable is taken for a scatter, with a quarter the intervals of slips of
        // two samples under jitter are too narrow.
        const FADE: f32 = 0.4;
        if slip.swing.is_determined() {
            // The first swing is the mean.
            let mut part = 1.0;
            let (before, next) = (&mut self.swing, slip.swing);
            if before.variance > 0.0 {
                slip.add_swings(before);
                part = before.variance / (before.variance + FADE * next.variance);
            }
            before.value += part * (next.value - before.value);
            before.variance =
                part * part * next.variance + (1.0 - part) * (1.0 - part) * before.variance;
        }
        if slip.squares.is_finite() && slip.free > LEAST {
            self.pooled.add(slip.squares, slip.free, LARGEST);
            let part = slip.free / larger(self.pooled.free, slip.free);
            self.shown += part * (slip.shown / slip.free - self.shown);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::slip_residuals::steepness;
    use crate::tests::Random;

    /// A slip with squares `times` as large as without scatter.
    fn slip(times: f32) -> SlipResiduals {
        let mut slip = SlipResiduals::default();
        for part in [0.2, 0.4, 0.6, 0.8] {
            slip.add(steepness(part), 0.5 * times, 0.5);
        }
        slip
    }

    #[test]
    fn the_excess_of_equal_slips_is_found_and_none_is_none() {
        let (mut none, mut some) = (SlipScatter::default(), SlipScatter::default());
        for _ in 0..200 {
            none.learn(slip(1.0));
            some.learn(slip(1.0 + 8.0));
        }
        assert_eq!(none.excess().to_bits(), 0.0_f32.to_bits());
        // A uniform excess of 8, and half of each error is left in its own residual: 8 over
        // `1/2 Σ g² / Σ g`.
        assert!((19.0..22.0).contains(&some.excess()), "{}", some.excess());
    }

    #[test]
    fn slips_that_leave_no_residual_tell_it_by_their_swings() {
        let (mut scatter, mut random) = (SlipScatter::default(), Random(1));
        for _ in 0..1000 {
            // A scatter of 16 adds half as much as it is to the variance of the swing.
            let value = math::sqrt(2.0 + 16.0) * random.normal();
            let swing = OwnSwing { value, variance: 2.0, by_scatter: 0.5 };
            scatter.learn(SlipResiduals { swing, ..SlipResiduals::default() });
        }
        assert!((14.0..18.0).contains(&scatter.excess()), "{}", scatter.excess());
    }

    #[test]
    fn one_foul_slip_in_four_does_no_harm() {
        let mut scatter = SlipScatter::default();
        for event in 0..200 {
            scatter.learn(slip(if event % 4 == 3 { 1e6 } else { 1.0 }));
        }
        assert_eq!(scatter.excess().to_bits(), 0.0_f32.to_bits());
    }

    #[test]
    fn no_information_is_no_excess() {
        let mut scatter = SlipScatter::default();
        scatter.learn(SlipResiduals::default());
        scatter.learn(SlipResiduals { squares: f32::NAN, free: 1.0, ..Default::default() });
        for value in [f32::NAN, 1.0, f32::INFINITY, 1.0] {
            let swing = OwnSwing { value, variance: 1.0, by_scatter: 1.0 };
            scatter.learn(SlipResiduals { swing, ..SlipResiduals::default() });
        }
        assert_eq!(scatter.excess().to_bits(), 0.0_f32.to_bits());
    }
}
