//! Residuals of one slip's samples, as the estimator of their scatter takes them
//! (`effects/scatter.rs`).

use crate::fit::{Data, Fit, SWING, Variances, Without};
use crate::num::math::larger;
use crate::stats::normal_equations::{Gradient, dot, scaled};

/// Squared rate of the force at the part `part` of a slip's time, relative to its largest value and
/// without the winch's own rate: `(4 x (1 − x))²`, close to `sin² πx`; zero outside the slip.
pub(crate) fn steepness(part: f32) -> f32 {
    let root = 4.0 * part * (1.0 - part);
    if root > 0.0 { root * root } else { 0.0 }
}

/// Sums over the samples of one slip at its fit: `Σ g r²` in units of the noise variance, `Σ g f`,
/// and `Σ g R² g`.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SlipResiduals {
    pub squares: f32,
    pub free: f32,
    pub shown: f32,
    /// The swing from this slip alone.
    pub swing: OwnSwing,
}

impl SlipResiduals {
    /// Adds a sample: its steepness, its squared residual in units of the noise variance, and its
    /// remaining degree of freedom.
    pub(crate) fn add(&mut self, steepness: f32, square: f32, left: f32) {
        self.squares += steepness * square;
        self.free += steepness * left;
        self.shown += steepness * steepness * left * left;
    }

    /// Adds the squared difference of this slip's swing from the mean of those before.
    pub(crate) fn add_swings(&mut self, before: &OwnSwing) {
        // Independent part of the differences: each shares slips with the next one.
        const INDEPENDENT: f32 = 2.0 / 3.0;
        let swing = self.swing;
        let off = swing.value - before.value;
        let part = INDEPENDENT / (swing.variance + before.variance);
        self.squares += part * off * off;
        self.free += INDEPENDENT;
        self.shown += INDEPENDENT * swing.by_scatter;
    }

    /// Adds a pair of samples: the product of their steepnesses, and the part of either's error
    /// that the fit moves to the other's residual.
    pub(crate) fn add_pair(&mut self, steepness: f32, part: f32) {
        self.shown += 2.0 * steepness * part * part;
    }
}

/// The swing from the samples of one slip alone, periods; all zero where they do not determine it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct OwnSwing {
    /// `1/ω`.
    pub value: f32,
    /// Its variance by the noise.
    pub variance: f32,
    /// Variance that a scatter of `λ` = 1 adds, relative to `variance`.
    pub by_scatter: f32,
}

impl OwnSwing {
    /// Is it a finite value with a variance?
    pub(crate) fn is_determined(&self) -> bool {
        self.variance > 0.0 && (self.value + self.variance + self.by_scatter).is_finite()
    }
}

impl Data<'_> {
    /// The residuals of the slip's samples at a fit, in units of the noise variance, and the
    /// variances that a scatter beyond the noise of `λ` = 1 adds. Of a long slip at most eight
    /// samples, evenly spread, are used.
    ///
    /// The fit is made without that scatter, `x = A⁻¹ Σ w u r`, so its covariance grows by
    /// `λ Σ g w² (A⁻¹ u)(A⁻¹ u)ᵀ`. The scatter may be the same in every slip. The prior of the
    /// swing then has the same error and does not reduce it, so for the forces `A` is the matrix
    /// without that prior. The slip lasts from the time `from` to `to`, periods.
    pub(crate) fn slip_residuals(
        &self,
        fit: &Fit,
        (from, to): (f32, f32),
        knows_swing: bool,
        noise_n2: f32,
    ) -> (SlipResiduals, Variances) {
        // The number of their pairs, 28, grows with the square.
        const MOST: usize = 8;
        let (mut slip, mut wider) = (SlipResiduals::default(), Variances::default());
        let without = fit.without(&SWING, self.priors.inverse_omega);
        let Without { tied: [_, _, by_static, by_drop, own, _], gain } =
            without.unwrap_or_default();
        // At least 1, also for a slip whose ends are NaN.
        let stride = ((1.0 + (to - from) / MOST as f32) as usize).max(1);
        let inside = self.samples.good().filter(|&(time, _)| time > from && time < to).enumerate();
        let used = inside.filter(|(number, _)| number.is_multiple_of(stride)).take(MOST);
        let model = self.model(&fit.shape);
        // Of each sample used so far: its steepness, and the shift of the unknowns by its error.
        let mut others = [(0.0, Gradient::default()); MOST];
        let mut swing_by_scatter = 0.0;
        for (place, (_, (time, measured_n))) in used.enumerate() {
            let steepness = steepness((time - from) / (to - from));
            let (off_n, gradient) = model.residual(time, measured_n);
            let weighted = scaled(&gradient, self.samples.weight(time));
            let moved = fit.factor.solve(&weighted);
            let left = larger(1.0 - dot(&gradient, &moved), 0.0);
            slip.add(steepness, off_n * off_n / noise_n2, left);
            for (of_other, by_other) in others.iter().take(place) {
                slip.add_pair(steepness * of_other, dot(&gradient, by_other));
            }
            if let Some(own) = others.get_mut(place) {
                *own = (steepness, moved);
            }
            let weight = steepness * stride as f32;
            let [onset, rate, static_n, drop_n, swing, rate_change] = moved;
            let apart = gain * swing;
            let (static_n, swing) = (static_n + apart * by_static, swing + apart * own);
            let dynamic_n = static_n - drop_n - apart * by_drop;
            swing_by_scatter += weight * swing * swing;
            // The scatter of the swings is estimated with the trend of the swings.
            let by = [onset, rate, static_n, drop_n, 0.0, rate_change, dynamic_n];
            wider.iter_mut().zip(by).for_each(|(sum, by)| *sum += weight * by * by);
        }
        // While the swing is unknown, the estimate of one slip may have any size.
        if knows_swing && without.is_some() {
            let (value, variance) = (fit.cycle().inverse_omega(), own + gain * own * own);
            slip.swing = OwnSwing {
                value: value + gain * own * (value - self.priors.inverse_omega.mean),
                variance: noise_n2 * variance,
                by_scatter: swing_by_scatter / variance,
            };
        }
        (slip, wider)
    }
}
