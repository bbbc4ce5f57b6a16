//! What a force that never rests leaves when its swing is taken off.
//!
//! A swing of any length is told by its neighbours: its second differences `u` obey
//! `u'' + p u' + u = 0` with `p = −2 cos ω` for `ω` a sample. `p` is what leaves least, by
//! least squares over the past of late; of white noise that remainder has
//! `2 + 2 (p − 2)² + 4 (1 − p)²` times its variance, the squares of the weights of five samples.
//! (At `p = −2`, a slow swing, it is the fourth difference.) No remainder is less than the noise.

use crate::num::math::larger;

/// Samples over which the past is forgotten.
const MEMORY: f32 = 64.0;
/// Samples that tell it.
const FEWEST: f32 = 30.0;
/// Least part of the squares that single precision leaves.
const ROUNDING: f32 = 4e-6;

/// Running sums over the second differences of late.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Swing {
    /// Σ u'²: of the one in the middle.
    middle_n2: f32,
    /// Σ (u + u'') u'.
    product_n2: f32,
    /// Σ (u + u'')².
    outer_n2: f32,
    count: f32,
}

impl Swing {
    pub(crate) const fn new() -> Self {
        Self { middle_n2: 0.0, product_n2: 0.0, outer_n2: 0.0, count: 0.0 }
    }

    /// Takes the sum of two second differences, N, and the one between them.
    pub(crate) fn add(&mut self, outer_n: f32, middle_n: f32) {
        const FADE: f32 = 1.0 - 1.0 / MEMORY;
        self.middle_n2 = FADE * self.middle_n2 + middle_n * middle_n;
        self.product_n2 = FADE * self.product_n2 + outer_n * middle_n;
        self.outer_n2 = FADE * self.outer_n2 + outer_n * outer_n;
        self.count = FADE * self.count + 1.0;
    }

    /// Variance of white noise that would leave as much, N²; `None` before enough was seen.
    pub(crate) fn noise_n2(&self) -> Option<f32> {
        let p = -self.product_n2 / self.middle_n2;
        let left_n2 = larger(self.outer_n2 + p * self.product_n2, ROUNDING * self.outer_n2);
        let gain = 2.0 + 2.0 * (p - 2.0) * (p - 2.0) + 4.0 * (1.0 - p) * (1.0 - p);
        (self.count >= FEWEST && self.middle_n2 > 0.0).then(|| left_n2 / (gain * self.count))
    }
}
