//! What sums over innovations show of a wandering force.

use crate::noise::ripple::{ColoredNoise, FAR, QUICK};
use crate::num::math;
use crate::stats::prior::surely;

/// Standard errors beyond which the force wanders; that of the noise's mean square is
/// about `2 / √count` of it.
const SIGNIFICANT: f32 = 4.0;
/// A swing of fewer than six samples changes too fast to be followed from one to the next:
/// the mean of the line is better. This is its variance of the slope over that of the level.
const FASTEST: f32 = 0.8;
/// Variance of noise whose neighbours are alike, over what of it is left about a line, which takes
/// all that is slower than itself. Tuned: with a correlation of .9 and rests of 20 samples (at 7
/// that of .7 is given twice as wide as it is).
pub(super) const HIDDEN: f32 = 6.0;
/// Least correlation of such noise: with less of it a line takes little. Tuned: at .5 noise with that
/// correlation is given twice as wide as it is, at .6 that of .9 is missed in first events.
const LEAST_RED: f32 = 0.55;
/// Fewest samples that show it.
const FEWEST: f32 = 24.0;
/// Standard errors from which on a swing counts, fully at 1.4 times as many. Tuned: a smaller number
/// widens white noise by chance (more than 1 % of snow's median), a larger one leaves the first
/// events of a swing too sure.
const LIKELY: f32 = 3.4;
/// The same of what a line hides of alike neighbours. Tuned likewise: 2.6 widens dff8-13 by 1 %.
const LIKELY_RED: f32 = 3.0;

/// Sums of squares of innovations and of their first two differences.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sums {
    pub(super) squares: f32,
    pub(super) steps: f32,
    pub(super) bends: f32,
    /// Sums of the products of neighbours, and of those two apart.
    pub(super) products: [f32; 2],
    /// Sum and number of the squares of the differences so many samples apart.
    pub(super) far_steps: f32,
    pub(super) far_count: f32,
    pub(super) count: f32,
}

impl Sums {
    /// Keeps a part, and takes those of a rest.
    pub(super) fn take(&mut self, part: f32, rest: &Self) {
        let fade = |sum: &mut f32, by: f32| *sum = part * *sum + by;
        fade(&mut self.squares, rest.squares);
        fade(&mut self.steps, rest.steps);
        fade(&mut self.bends, rest.bends);
        fade(&mut self.products[0], rest.products[0]);
        fade(&mut self.products[1], rest.products[1]);
        fade(&mut self.far_steps, rest.far_steps);
        fade(&mut self.far_count, rest.far_count);
        fade(&mut self.count, rest.count);
    }

    /// What they show; nothing unless it is clear.
    #[inline(never)]
    pub(super) fn wander(&self) -> ColoredNoise {
        let white = self.bends / 6.0;
        let slow = self.squares - white;
        let limit = 2.0 * SIGNIFICANT * white;
        let sure = self.count >= FEWEST && slow * slow * self.count > limit * limit;
        let swing_n2 = self.swing_n2();
        let is_red = self.is_red(swing_n2);
        let swing = self.swing(swing_n2, is_red);
        let unfollowed = ColoredNoise { unsure: swing, ..ColoredNoise::NONE };
        if white <= 0.0 || slow <= 0.0 || !sure {
            return unfollowed;
        }
        let (level, step) = (slow / white, self.steps / white - 2.0);
        if step > FASTEST * level {
            return unfollowed;
        }
        // A slow one's slope is lost in the noise of single steps.
        let sure = step * step * self.count > 4.0 * SIGNIFICANT * SIGNIFICANT;
        let far = self.far_steps / white * self.count / self.far_count - 2.0;
        let slope = (far / (FAR * FAR) as f32).max(if sure { step } else { 0.0 }).max(0.0);
        let white_share = white / self.squares;
        let unsure = if is_red || step > QUICK * level { swing } else { 0.0 };
        ColoredNoise { white_share, level, slope, unsure }
    }

    /// May what wanders be no swing, but noise whose neighbours are alike? Four samples apart
    /// a swing has `γ₄ = A cos 4ω`; where the correlation falls by the same part `γ₂/γ₁` from
    /// sample to sample it is `γ₁ (γ₂/γ₁)³`. The nearer of the two counts, and that part, as far as
    /// so few samples tell: to a standard error.
    fn is_red(&self, swing_n2: f32) -> bool {
        let [first, second] = self.products;
        // Also not for NaN.
        let is_alike = first > 0.0;
        if !is_alike {
            return false;
        }
        let ratio = second / first;
        let cos2 = (first / swing_n2) * (first / swing_n2);
        let swing = swing_n2 * (1.0 - 8.0 * cos2 * (1.0 - cos2));
        let red = first * ratio * ratio * ratio;
        let seen = self.squares - 0.5 * self.far_steps * self.count / self.far_count;
        let unsure = self.squares / math::sqrt(self.count);
        second + unsure > LEAST_RED * first && 2.0 * (seen + unsure) > swing + red
    }

    /// Part of the innovations' variance that is a swing, of any length, as far as that is likely;
    /// of noise whose neighbours are alike with what a line hides of it.
    fn swing(&self, swing_n2: f32, is_red: bool) -> f32 {
        let part = swing_n2 / self.squares;
        // Without any squares it is no number.
        if self.count < FEWEST || part.is_nan() {
            return 0.0;
        }
        let errors = part * part * self.count;
        let hidden =
            if is_red { (HIDDEN - 1.0) * surely(errors, LIKELY_RED * LIKELY_RED) } else { 0.0 };
        part * (surely(errors, LIKELY * LIKELY) + hidden)
    }

    /// Sum of the squares of a swing.
    ///
    /// White noise and a swing of the variance `A` have the autocovariances `γ₁ = A c` and
    /// `γ₂ = A (2 c² − 1)`, `c = cos ω`, so `4 c = γ₂/γ₁ ± √((γ₂/γ₁)² + 8)`, with the sign of `γ₁`.
    fn swing_n2(&self) -> f32 {
        let [first, second] = self.products;
        let root = math::sqrt(second * second + 8.0 * first * first);
        if second < 0.0 {
            // The same without the difference of near equals.
            0.5 * (root - second)
        } else {
            let cosine = 0.25 * (second + root) / first.abs();
            first.abs() / math::smaller(cosine, 1.0)
        }
    }
}
