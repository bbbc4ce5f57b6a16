//! What the samples of the slips scatter beyond the noise: a clock that jitters, a cell that
//! lags, a block that rocks, a winch that cogs, friction that varies along the way.
//!
//! All of these are errors in time or along the fall, so their variance goes with the squared rate
//! of the force, `g` over its largest. In units of the noise's variance
//! `E Σ g r² = Σ g f + λ Σ g R² g`, where `R` is the part of each sample's error that the fit leaves
//! in each residual and `f` its diagonal. Slips of two samples leave hardly a residual, but each
//! tells a swing, and neither cable nor mass changes from one slip to the next: the squared
//! difference of a swing and the last ones over its variance `v` by the noise is one more square, of
//! `1 + λ Σ g a² / v`, where `a` is by how much a sample's error moves the swing. The ratio of all
//! squares to all degrees of freedom is pooled as the residuals are, so that foul slips do no harm.

use crate::fit::residuals::Residuals;
use crate::num::math::{self, larger};
use crate::stats::prior::surely;

/// Standard errors beyond which the scatter counts, fully from twice as many on: it only widens.
const SIGNIFICANT: f32 = 2.0;

/// Squared rate of the force at the part `part` of a slip's time, over its largest, without the
/// winch's own rate: `(4 x (1 − x))²`, close to `sin² πx`; zero outside the slip.
#[must_use]
pub(crate) fn steepness(part: f32) -> f32 {
    let root = 4.0 * part * (1.0 - part);
    if root > 0.0 { root * root } else { 0.0 }
}

/// The samples of one slip at its fit: `Σ g r²` in units of the noise's variance, `Σ g f`, and
/// `Σ g R² g`.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SlipResiduals {
    squares: f32,
    free: f32,
    shown: f32,
    /// The swing of the slip alone.
    pub swing: OwnSwing,
}

impl SlipResiduals {
    /// Takes a sample with its squared residual, in units of the noise's variance, and the degree
    /// of freedom that is left of it.
    pub(crate) fn add(&mut self, steepness: f32, square: f32, left: f32) {
        self.squares += steepness * square;
        self.free += steepness * left;
        self.shown += steepness * steepness * left * left;
    }

    /// Takes how far the swing of this slip and the mean of those before are apart.
    fn add_swings(&mut self, before: &OwnSwing) {
        // Part of the differences, each of which shares slips with the next, that is independent.
        const INDEPENDENT: f32 = 2.0 / 3.0;
        let swing = self.swing;
        let off = swing.value - before.value;
        let part = INDEPENDENT / (swing.variance + before.variance);
        self.squares += part * off * off;
        self.free += INDEPENDENT;
        self.shown += INDEPENDENT * swing.by_scatter;
    }

    /// Takes two samples: the product of their steepnesses, and the part of either's error that
    /// the fit moves to the other's residual.
    pub(crate) fn add_pair(&mut self, steepness: f32, part: f32) {
        self.shown += 2.0 * steepness * part * part;
    }
}

/// The swing as the samples of one slip alone tell it, periods; all zero where they tell none.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct OwnSwing {
    /// `1/ω`.
    pub value: f32,
    /// Its variance by the noise.
    pub variance: f32,
    /// What a scatter of `λ` = 1 adds to that, over it.
    pub by_scatter: f32,
}

impl OwnSwing {
    /// Is it a number with a variance?
    fn is_told(&self) -> bool {
        self.variance > 0.0 && (self.value + self.variance + self.by_scatter).is_finite()
    }
}

/// What the slips so far scatter.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SlipScatter {
    pooled: Residuals,
    /// Mean of `Σ g R² g` over `Σ g f`.
    shown: f32,
    /// Mean of the last slips.
    swing: OwnSwing,
}

impl SlipScatter {
    /// Variance beyond the noise where the force is steepest, over that of the noise, as far as
    /// it is significant: `λ`.
    #[must_use]
    pub(crate) fn excess(&self) -> f32 {
        let more = self.pooled.variance_n2().map_or(0.0, |ratio| ratio - 1.0);
        if more <= 0.0 {
            return 0.0;
        }
        let limit = SIGNIFICANT * math::sqrt(2.0 / self.pooled.free());
        // With few degrees of freedom it may have come out far too small: about as Student's
        // variance is to the normal one.
        let few = 1.0 + 2.0 / self.pooled.free();
        if more > limit { few * more * surely(more, limit) / self.shown } else { 0.0 }
    }

    /// Takes a slip.
    pub(crate) fn learn(&mut self, mut slip: SlipResiduals) {
        // Fewest degrees of freedom of a slip that tell anything, and largest ratio that is
        // believed of the first slips.
        const LEAST: f32 = 0.2;
        const LARGEST: f32 = 1e4;
        // What the swings before the last one count for. Tuned: with half of it a cable that gets
        // shorter is taken for a scatter, with a quarter slips of two samples under jitter are surer
        // than they should be.
        const FADE: f32 = 0.4;
        if slip.swing.is_told() {
            // The first one is all.
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
            let part = slip.free / larger(self.pooled.free(), slip.free);
            self.shown += part * (slip.shown / slip.free - self.shown);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::Random;

    /// A slip whose samples' squares are `times` what they are without scatter.
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
        // A flat excess of 8, and of each error half is left in its own residual: 8 over
        // 1/2 Σ g² / Σ g.
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
