//! What sums over innovations show of a wandering force.

use crate::noise::ripple::{ColoredNoise, FAR};
use crate::num::math::{self, larger, smaller};
use crate::stats::prior::surely;

/// Standard errors beyond which the force wanders; that of the noise's mean square is
/// about `2 / √count` of it.
const SIGNIFICANT: f32 = 4.0;
/// Variance of the slope over that of the level beyond which a bend is not followed. An oscillation
/// of `ω` a sample has `2 (1 − cos ω)`: one of fewer than seven samples changes too fast to be followed
/// from one to the next, and the mean of the line is better.
const FASTEST: f32 = 0.8;
/// Such a ratio below which, at more than 20 samples, an oscillation is followed as a bend is: a line has
/// too little of it to tell one from the other.
const QUICK: f32 = 0.1;
/// Noise with correlated neighbours makes a line so many times less sure than the residuals about
/// it show, for the line takes all that is slower than itself. Tuned with correlations of .5 and .9
/// and rests of 20 samples: a smaller number makes those of .9 too sure, a larger one those of .5
/// twice too wide.
const HIDDEN: f32 = 1.75;
/// Least and most `γ₂/γ₁` of such noise, `γ_k` the autocovariance `k` samples apart. With less it
/// is white enough, with more it cannot be told from a trend.
const RED: (f32, f32) = (0.2, 0.8);
/// Most `γ₂/γ₁` of slow noise: one that falls more slowly may be a slow oscillation.
const SLOWEST: f32 = 0.91;
/// By how much the autocovariance four samples apart may exceed that of noise whose correlation
/// falls evenly, parts of the variance: an error of the line itself is the same at any distance.
/// Tuned with correlations of .9 and rests of 40 samples (coverage of `mu_s` .54 without slow
/// noise) against cables that sag.
const NEAR: f32 = 0.08;
/// Fewest samples that show it.
const FEWEST: f32 = 24.0;
/// All rests are bent alike where the square of the mean innovation is more than this part of their
/// mean square. Cables that sag have .14 to .43, oscillations, hum and correlated noise less than .015.
const BENT: f32 = 1.0 / 50.0;
/// And the square of that mean is more than so many times the variance that white noise gives it.
const NO_CHANCE: f32 = 2.0;
/// Samples before which a bend cannot be told from correlated noise: what looks like that may be a
/// bend.
const TELLS_BEND: f32 = 200.0;
/// Variance that such a bend leaves unsure, over that of the innovations. Tuned with cables that
/// sag: without it the scene `all` covers .62 of its `mu_s`.
const UNSURE_BEND: f32 = 6.0;
/// Standard errors from which on an oscillation counts, fully from 1.4 times as many on. Tuned: a
/// smaller number widens white noise by chance (more than 1 % of snow's median), a larger one
/// leaves the first events of an oscillation too sure.
const LIKELY: f32 = 3.4;
/// The same from which on it is no chance: whose it is is asked, and it is taken off or followed.
/// White noise shows so much in one look of 50 000: the standard errors are up to 1.5 times those of its
/// two autocovariances together.
const CLEAR: f32 = 7.0;
/// The same for correlated neighbours. Tuned likewise: 2.6 widens dff8-13 by 1 %.
const LIKELY_RED: f32 = 3.0;

/// Sums over innovations.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sums {
    /// Σ of their weights, and of the innovations themselves: not zero where the lines are bent.
    pub(super) count: f32,
    pub(super) sum: f32,
    /// Σ of their squares, and of the squares of their first and of their second differences.
    pub(super) squares: f32,
    pub(super) first_differences: f32,
    pub(super) second_differences: f32,
    /// Of the products of neighbours, and of those two apart.
    pub(super) products: [f32; 2],
    /// Sum and number of the squares of the differences [`FAR`] samples apart.
    pub(super) far_differences: f32,
    pub(super) far_count: f32,
}

impl Sums {
    /// Keeps the part `part` of the sums and adds those of a rest.
    pub(super) fn take(&mut self, part: f32, rest: &Self) {
        let fade = |sum: &mut f32, by: f32| *sum = part * *sum + by;
        fade(&mut self.count, rest.count);
        fade(&mut self.sum, rest.sum);
        fade(&mut self.squares, rest.squares);
        fade(&mut self.first_differences, rest.first_differences);
        fade(&mut self.second_differences, rest.second_differences);
        self.products.iter_mut().zip(rest.products).for_each(|(sum, by)| fade(sum, by));
        fade(&mut self.far_differences, rest.far_differences);
        fade(&mut self.far_count, rest.far_count);
    }

    /// What they show; nothing unless it is clear.
    #[inline(never)]
    pub(super) fn wander(&self) -> ColoredNoise {
        let (oscillation_n2, cosine) = self.oscillation();
        let part = oscillation_n2 / self.squares;
        let errors = part * part * self.count;
        // NaN where there are no squares.
        if self.count < FEWEST || errors.is_nan() {
            return ColoredNoise::NONE;
        }
        let limit = larger(BENT * self.count, NO_CHANCE);
        let is_red = self.is_red(oscillation_n2, cosine);
        let bends = self.sum * self.sum > limit * self.squares;
        let likely_red = surely(errors, LIKELY_RED * LIKELY_RED);
        // Innovations that alternate are no bend.
        if self.products[0] > 0.0 && (bends || (is_red && self.count < TELLS_BEND)) {
            let bent = self.followed(UNSURE_BEND * part * likely_red, FASTEST);
            // A slow oscillation bends whole rests, creep their last samples.
            let is_brief = self.products[1] < RED.1 * self.products[0];
            return ColoredNoise { creeps: bends && self.sum < 0.0 && is_brief, ..bent };
        }
        if is_red {
            return ColoredNoise { alike: self.alike() * likely_red, ..ColoredNoise::NONE };
        }
        let slow = self.followed(0.0, QUICK);
        if slow.bends {
            return slow;
        }
        let unsure = part * surely(errors, LIKELY * LIKELY);
        let angle = if errors > CLEAR * CLEAR { math::acos(cosine) } else { 0.0 };
        ColoredNoise { unsure, angle, ..ColoredNoise::NONE }
    }

    /// Standard deviation of what strays from the lines beside the white noise, N, and its standard
    /// error; `None` where nothing does.
    ///
    /// Of the mean square `V` an oscillation or a bend has a part that [`Self::wander`] gives, noise
    /// whose correlation falls evenly `γ₁²/γ₂`. The standard error of `V` is at most `V / √count`.
    pub(super) fn stray_n(&self) -> Option<(f32, f32)> {
        let ColoredNoise { level, unsure, alike, .. } = self.wander();
        let [first, second] = self.products;
        let part = match (level > 0.0, alike > 0.0) {
            (true, _) => level / (1.0 + level),
            (_, true) => smaller(first * first / (second * self.squares), 1.0),
            _ => smaller(unsure, 1.0),
        };
        let mean_n2 = self.squares / self.count;
        let std_n = math::sqrt(part * mean_n2);
        let error_n = 0.5 * mean_n2 / math::sqrt(self.count) / std_n;
        (part > 0.0).then_some((std_n, error_n))
    }

    /// What a bend is, or an oscillation as slow as one, that can be followed, as one that changes faster
    /// than `fastest` cannot; of another one what it leaves `unsure`.
    fn followed(&self, unsure: f32, fastest: f32) -> ColoredNoise {
        let white = self.second_differences / 6.0;
        let slow = self.squares - white;
        let limit = 2.0 * SIGNIFICANT * white;
        let sure = slow * slow * self.count > limit * limit;
        let (level, step) = (slow / white, self.first_differences / white - 2.0);
        // False for a noise of zero as well.
        if !(slow > 0.0 && sure && step < fastest * level) {
            return ColoredNoise { unsure, ..ColoredNoise::NONE };
        }
        // A slow bend's slope is lost in the noise of single steps.
        let sure = step * step.abs() * self.count > 4.0 * SIGNIFICANT * SIGNIFICANT;
        let far = (self.far_differences_n2() / white - 2.0) / (FAR * FAR) as f32;
        let slope = larger(far, if sure { step } else { 0.0 });
        ColoredNoise { level, slope, unsure, bends: true, ..ColoredNoise::NONE }
    }

    /// Is it correlated noise, and no oscillation? Four samples apart an oscillation of variance
    /// `A` has the autocovariance `γ₄ = A cos 4ω`, noise whose correlation falls by the same factor
    /// `γ₂/γ₁` from sample to sample `γ₁ (γ₂/γ₁)³`. The one that is nearer to what is seen counts,
    /// with a standard error of room for noise where samples are few. Noise that alternates is told
    /// likewise.
    fn is_red(&self, oscillation_n2: f32, cosine: f32) -> bool {
        let [first, second] = self.products;
        let seen = self.squares - 0.5 * self.far_differences_n2();
        let ratio = second / first;
        let cos2 = cosine * cosine;
        let oscillation = oscillation_n2 * (1.0 - 8.0 * cos2 * (1.0 - cos2));
        let red = first * ratio * ratio * ratio;
        let unsure = self.unsure();
        let is_nearer = oscillation < 0.0
            && (first > 0.0 || red > oscillation)
            && 2.0 * (seen + unsure) > oscillation + red;
        second + unsure > RED.0 * first.abs()
            && (is_nearer || self.falls_evenly(ratio, seen - red, unsure))
    }

    /// The same for slow noise, where an oscillation may have `cos 4ω > 0` as well: does the
    /// correlation go on to fall by the factor `ratio`? That of an oscillation falls faster and
    /// faster. `over` is what is seen four samples apart beyond what such noise has there, `unsure`
    /// its standard error.
    fn falls_evenly(&self, ratio: f32, over: f32, unsure: f32) -> bool {
        let is_above = over > -0.5 * unsure;
        ratio < SLOWEST && is_above && over < 0.5 * unsure + NEAR * self.squares
    }

    /// Standard error of a sum of products.
    fn unsure(&self) -> f32 {
        self.squares / math::sqrt(self.count)
    }

    /// Σ of the squared differences [`FAR`] samples apart, scaled to the number of all samples.
    fn far_differences_n2(&self) -> f32 {
        self.far_differences * self.count / self.far_count
    }

    /// Variance of the mean of samples whose correlation falls by the factor `r = γ₂/γ₁`, over that
    /// of independent ones, less one: `2 γ₁/γ₀ / (1 − r)`. By another `1 − r` and [`HIDDEN`] times,
    /// for what a line hides of it. `r` is taken a standard error higher: a line hides the more of
    /// it the higher it is, and white noise beside it leaves little to be seen. Zero for noise that
    /// alternates.
    fn alike(&self) -> f32 {
        let [first, second] = self.products;
        let most = second + self.unsure();
        let left = 1.0 - smaller(larger(most / first, 0.0), RED.1);
        HIDDEN * 2.0 * larger(first, 0.0) / self.squares / (left * left)
    }

    /// Σ of the squares of an oscillation, and the cosine of its angle.
    ///
    /// White noise and an oscillation of the variance `A` have the autocovariances `γ₁ = A c` and
    /// `γ₂ = A (2 c² − 1)`, `c = cos ω`, so `2 A = √(γ₂² + 8 γ₁²) − γ₂`.
    fn oscillation(&self) -> (f32, f32) {
        let [first, second] = self.products;
        let root = math::sqrt(second * second + 8.0 * first * first);
        // No cosine is larger than one.
        let oscillation_n2 = larger(0.5 * (root - second), first.abs());
        (oscillation_n2, first / oscillation_n2)
    }
}
