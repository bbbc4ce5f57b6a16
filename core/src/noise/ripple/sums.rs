//! What sums over innovations show of a wandering force.

use crate::noise::ripple::{ColoredNoise, FAR};
use crate::num::math::{self, larger, smaller};
use crate::stats::prior::surely;

/// Standard errors beyond which the force wanders; that of the noise's mean square is
/// about `2 / √count` of it.
const SIGNIFICANT: f32 = 4.0;
/// A swing of fewer than six samples changes too fast to be followed from one to the next:
/// the mean of the line is better. This is its variance of the slope over that of the level.
const FASTEST: f32 = 0.8;
/// One of more than 14 samples is followed as a bend: the mean of a line is off by it, whosever it is.
const QUICK: f32 = 0.2;
/// Noise whose neighbours are alike makes a line so many times less sure than what is left about it
/// shows, since the line takes all that is slower than itself. Tuned with correlations of .5 and .9 and
/// rests of 20 samples: a smaller number makes the second too sure, a larger one the first twice too wide.
const HIDDEN: f32 = 1.75;
/// Least and most correlation of the next neighbour but one over that of the next in such noise. Less
/// is white enough, more is not told from a trend.
const RED: (f32, f32) = (0.2, 0.8);
/// Slow noise: its correlation must fall at least so fast from sample to sample, or a slow swing looks
/// alike.
const SLOWEST: f32 = 0.91;
/// By how much more it may be alike four samples apart than it is if its correlation falls evenly, in parts
/// of the whole: a line that is off is alike at any distance. Tuned with correlations of .9 and rests of 40
/// samples (coverage of `mu_s` .54 without any slow noise) against cables that sag.
const NEAR: f32 = 0.08;
/// Fewest samples that show it.
const FEWEST: f32 = 24.0;
/// All rests are bent alike where the square of the mean innovation is more than this part of their
/// mean square (cables that sag: .14 to .43; swings, hum and noise whose neighbours are alike: below
/// .015), and more than so many of its variances in white noise.
const BENT: f32 = 1.0 / 50.0;
const NO_CHANCE: f32 = 2.0;
/// Before so many samples a bend is not told from noise whose neighbours are alike: it may be one.
const TELLS_BEND: f32 = 200.0;
/// Variance of what such a bend leaves unsure, over that of the innovations. Tuned with cables that
/// sag: without it `all` covers .62 of its `mu_s`.
const UNSURE_BEND: f32 = 6.0;
/// Standard errors from which on a swing counts, fully at 1.4 times as many. Tuned: a smaller number
/// widens white noise by chance (more than 1 % of snow's median), a larger one leaves the first
/// events of a swing too sure.
const LIKELY: f32 = 3.4;
/// The same of alike neighbours. Tuned likewise: 2.6 widens dff8-13 by 1 %.
const LIKELY_RED: f32 = 3.0;

/// Sums over innovations.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sums {
    /// Their number and their sum: of a bend it is not zero.
    pub(super) count: f32,
    pub(super) sum: f32,
    /// Of their squares, and of those of their first two differences.
    pub(super) squares: f32,
    pub(super) steps: f32,
    pub(super) bends: f32,
    /// Of the products of neighbours, and of those two apart.
    pub(super) products: [f32; 2],
    /// Sum and number of the squares of the differences [`FAR`] samples apart.
    pub(super) far_steps: f32,
    pub(super) far_count: f32,
}

impl Sums {
    /// Keeps a part, and takes those of a rest.
    pub(super) fn take(&mut self, part: f32, rest: &Self) {
        let fade = |sum: &mut f32, by: f32| *sum = part * *sum + by;
        fade(&mut self.count, rest.count);
        fade(&mut self.sum, rest.sum);
        fade(&mut self.squares, rest.squares);
        fade(&mut self.steps, rest.steps);
        fade(&mut self.bends, rest.bends);
        self.products.iter_mut().zip(rest.products).for_each(|(sum, by)| fade(sum, by));
        fade(&mut self.far_steps, rest.far_steps);
        fade(&mut self.far_count, rest.far_count);
    }

    /// What they show; nothing unless it is clear.
    #[inline(never)]
    pub(super) fn wander(&self) -> ColoredNoise {
        let swing_n2 = self.swing_n2();
        let part = swing_n2 / self.squares;
        let errors = part * part * self.count;
        // Without any squares it is no number.
        if self.count < FEWEST || errors.is_nan() {
            return ColoredNoise::NONE;
        }
        let limit = larger(BENT * self.count, NO_CHANCE);
        let is_red = self.is_red(swing_n2);
        let bends = self.sum * self.sum > limit * self.squares;
        let likely_red = surely(errors, LIKELY_RED * LIKELY_RED);
        // What alternates is no bend.
        if self.products[0] > 0.0 && (bends || (is_red && self.count < TELLS_BEND)) {
            let bent = self.followed(UNSURE_BEND * part * likely_red, true);
            // A slow swing bends whole rests, creep their last samples.
            let is_brief = self.products[1] < RED.1 * self.products[0];
            return ColoredNoise { creeps: bends && self.sum < 0.0 && is_brief, ..bent };
        }
        if is_red {
            return ColoredNoise { alike: self.alike() * likely_red, ..ColoredNoise::NONE };
        }
        self.followed(part * surely(errors, LIKELY * LIKELY), false)
    }

    /// How far a swing or a bend that can be followed goes; of another one what it leaves `unsure`.
    fn followed(&self, unsure: f32, bends: bool) -> ColoredNoise {
        let white = self.bends / 6.0;
        let slow = self.squares - white;
        let limit = 2.0 * SIGNIFICANT * white;
        let sure = slow * slow * self.count > limit * limit;
        let (level, step) = (slow / white, self.steps / white - 2.0);
        // Also not for a noise of zero.
        if !(slow > 0.0 && sure && step < FASTEST * level) {
            return ColoredNoise { unsure, ..ColoredNoise::NONE };
        }
        // The events tell what a quick swing leaves unsure, a slow one leaves nothing.
        let unsure = if bends { unsure } else { 0.0 };
        let bends = bends || step < QUICK * level;
        // A slow bend's slope is lost in the noise of single steps.
        let sure = !bends || step * step * self.count > 4.0 * SIGNIFICANT * SIGNIFICANT;
        let far = (self.far_steps_n2() / white - 2.0) / (FAR * FAR) as f32;
        let slope = larger(larger(far, if sure { step } else { 0.0 }), 0.0);
        ColoredNoise { level, slope, unsure, bends, ..ColoredNoise::NONE }
    }

    /// Is what wanders no swing, but noise whose neighbours are alike? Four samples apart a swing has
    /// `γ₄ = A cos 4ω`; where the correlation falls by the same part `γ₂/γ₁` from sample to sample it
    /// is `γ₁ (γ₂/γ₁)³`. The nearer of the two counts, as far as so few samples tell: to a standard
    /// error. Noise that alternates is told likewise.
    fn is_red(&self, swing_n2: f32) -> bool {
        let [first, second] = self.products;
        let seen = self.squares - 0.5 * self.far_steps_n2();
        let ratio = second / first;
        let cos2 = (first / swing_n2) * (first / swing_n2);
        let swing = swing_n2 * (1.0 - 8.0 * cos2 * (1.0 - cos2));
        let red = first * ratio * ratio * ratio;
        let unsure = self.unsure();
        let is_nearer =
            swing < 0.0 && (first > 0.0 || red > swing) && 2.0 * (seen + unsure) > swing + red;
        second + unsure > RED.0 * first.abs()
            && (is_nearer || self.falls_evenly(ratio, seen - red, unsure))
    }

    /// The same of slow ones, where a swing may have `cos 4ω > 0` as well: does the correlation go on to
    /// fall by the part `ratio` from sample to sample? A swing's falls faster and faster. What is seen four
    /// samples apart is by so much `over` what such noise has there, known to a standard error `unsure`.
    fn falls_evenly(&self, ratio: f32, over: f32, unsure: f32) -> bool {
        let is_above = over > -0.5 * unsure;
        ratio < SLOWEST && is_above && over < 0.5 * unsure + NEAR * self.squares
    }

    /// Standard error of a sum of products.
    fn unsure(&self) -> f32 {
        self.squares / math::sqrt(self.count)
    }

    /// As if there were as many as samples.
    fn far_steps_n2(&self) -> f32 {
        self.far_steps * self.count / self.far_count
    }

    /// Variance of the mean of samples whose correlation falls by the part `r = γ₂/γ₁` from each to
    /// the next, over that of independent ones, less one: `2 γ₁/γ₀ / (1 − r)`; by another `1 − r`, as
    /// far as a line hides it. `r` is taken a standard error higher: a line hides the more of it the higher
    /// it is, and white noise beside it leaves little to be seen. None for noise that alternates.
    fn alike(&self) -> f32 {
        let [first, second] = self.products;
        let most = second + self.unsure();
        let left = 1.0 - smaller(larger(most / first, 0.0), RED.1);
        HIDDEN * 2.0 * larger(first, 0.0) / self.squares / (left * left)
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
            first.abs() / smaller(cosine, 1.0)
        }
    }
}
