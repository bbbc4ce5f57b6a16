//! What the samples of the slips scatter beyond the noise: a clock that jitters, a cell that
//! lags, a block that rocks, a winch that cogs, friction that varies along the way.
//!
//! All of these are errors in time or along the fall, so their variance goes with the squared rate
//! of the force, `g` over its largest. In units of the noise's variance
//! `E Σ g r² = Σ g f + λ Σ g R² g`, where `R` is the part of each sample's error that the fit leaves
//! in each residual and `f` its diagonal. The ratio `Σ g r² / Σ g f` is pooled as the residuals
//! are, so that foul slips do no harm.

use crate::fit::residuals::Residuals;
use crate::num::math::{self, larger};
use crate::stats::prior::surely;

/// Standard errors beyond which the scatter counts.
const SIGNIFICANT: f32 = 2.0;

/// Squared rate of the force at the part `part` of a slip's time, over its largest, without the
/// winch's own rate: `(4 x (1 − x))²`, close to `sin² πx`; zero outside the slip.
#[must_use]
pub fn steepness(part: f32) -> f32 {
    let root = 4.0 * part * (1.0 - part);
    if root > 0.0 { root * root } else { 0.0 }
}

/// The samples of one slip at its fit: `Σ g r²` in units of the noise's variance, `Σ g f`, and
/// `Σ g R² g`.
#[derive(Clone, Copy, Debug, Default)]
pub struct SlipResiduals {
    squares: f32,
    free: f32,
    shown: f32,
}

impl SlipResiduals {
    /// Takes a sample with its squared residual, in units of the noise's variance, and the degree
    /// of freedom that is left of it.
    pub fn add(&mut self, steepness: f32, square: f32, left: f32) {
        self.squares += steepness * square;
        self.free += steepness * left;
        self.shown += steepness * steepness * left * left;
    }

    /// Takes two samples: the product of their steepnesses, and the part of either's error that
    /// the fit moves to the other's residual.
    pub fn add_pair(&mut self, steepness: f32, part: f32) {
        self.shown += 2.0 * steepness * part * part;
    }
}

/// What the slips so far scatter.
#[derive(Clone, Copy, Debug, Default)]
pub struct SlipScatter {
    pooled: Residuals,
    /// Mean of `Σ g R² g` over `Σ g f`.
    shown: f32,
}

impl SlipScatter {
    /// Variance beyond the noise where the force is steepest, over that of the noise, as far as
    /// it is significant: `λ`.
    #[must_use]
    pub fn excess(&self) -> f32 {
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
    pub fn learn(&mut self, slip: &SlipResiduals) {
        // Fewest degrees of freedom of a slip that tell anything, and largest ratio that is
        // believed of the first slips.
        const LEAST: f32 = 0.2;
        const LARGEST: f32 = 1e4;
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
            none.learn(&slip(1.0));
            some.learn(&slip(1.0 + 8.0));
        }
        assert_eq!(none.excess().to_bits(), 0.0_f32.to_bits());
        // A flat excess of 8, and of each error half is left in its own residual: 8 over
        // 1/2 Σ g² / Σ g.
        assert!((19.0..22.0).contains(&some.excess()), "{}", some.excess());
    }

    #[test]
    fn one_foul_slip_in_four_does_no_harm() {
        let mut scatter = SlipScatter::default();
        for event in 0..200 {
            scatter.learn(&slip(if event % 4 == 3 { 1e6 } else { 1.0 }));
        }
        assert_eq!(scatter.excess().to_bits(), 0.0_f32.to_bits());
    }

    #[test]
    fn no_information_is_no_excess() {
        let mut scatter = SlipScatter::default();
        scatter.learn(&SlipResiduals::default());
        scatter.learn(&SlipResiduals { squares: f32::NAN, free: 1.0, shown: 1.0 });
        assert_eq!(scatter.excess().to_bits(), 0.0_f32.to_bits());
    }
}
