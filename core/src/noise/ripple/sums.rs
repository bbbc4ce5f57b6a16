//! Sums over innovations, and the colored noise that they show.

use crate::noise::ripple::{ColoredNoise, FAR};
use crate::num::math::{self, larger, smaller};
use crate::stats::significance::{SURE, surely};

/// Largest variance of the slope over that of the level with which a bend is followed. An
/// oscillation of `ω` a sample has `2 (1 − cos ω)`: one of fewer than seven samples changes too
/// fast to be followed from one to the next, and the mean of the line is better.
const FASTEST: f32 = 0.8;
/// Largest such ratio, at more than 20 samples, with which an oscillation is followed as a bend is:
/// a line has too little of it to distinguish the two.
const QUICK: f32 = 0.1;
/// Most correlation of neighbours for which a line's variance is computed: with more it grows
/// beyond what so short a rest tells.
const MOST_ALIKE: f32 = 0.9;
/// Least and most `γ₂/γ₁` of correlated noise, with the autocovariance `γ_k` at lag `k`. With less
/// it is white enough, with more it cannot be distinguished from a trend.
const RED: (f32, f32) = (0.2, 0.8);
/// Most `γ₂/γ₁` of slow noise: one that decays more slowly may be a slow oscillation.
const SLOWEST: f32 = 0.91;
/// Most by which the autocovariance at lag 4 may exceed that of noise with a geometric decay, parts
/// of the variance: an error of the line itself is the same at any lag. Tuned with correlations of
/// .9 and rests of 40 samples (coverage of `mu_s` .54 without slow noise) against cables that sag.
const NEAR: f32 = 0.08;
/// Fewest samples that show colored noise.
const FEWEST: f32 = 24.0;
/// All rests have the same bend where the squared mean innovation exceeds this part of the mean
/// square. Cables that sag have .14 to .43, oscillations, hum and correlated noise less than .015.
const BENT: f32 = 1.0 / 50.0;
/// Fewest samples of a line that show a bend of all rests: the flop of a cable that lasts as long as
/// brief rests bends them all alike, and would pass for a sag.
const SHORTEST_BEND: f32 = 12.0;
/// The squared mean also has to exceed its variance under white noise by this factor.
const NO_CHANCE: f32 = 2.0;
/// Number of samples below which a bend and correlated noise cannot be distinguished: either is
/// then treated as a bend.
const ENOUGH_FOR_BEND: f32 = 240.0;
/// Variance that such a bend leaves open, over the correlated part of the innovations'. Tuned with
/// cables that sag: without it the scene `all` covers .62 of its `mu_s`, with 6 the intervals of
/// `sag_flop` are a tenth wider.
const UNSURE_BEND: f32 = 5.0;
/// Standard errors from which on an oscillation counts, fully from 1.4 times as many on. Tuned: a
/// smaller number widens intervals under white noise by chance (more than 1 % of snow's median), a
/// larger one makes those of the first events of an oscillation too narrow.
const LIKELY: f32 = 3.4;
/// Standard errors from which on an oscillation is certain: its cause is tested, and it is removed
/// or followed. White noise shows this in one look of 50 000: the standard errors are up to 1.5
/// times those of its two autocovariances together.
const CLEAR: f32 = 7.0;
/// Standard errors from which on correlated neighbours count. Tuned: with 3 the intervals of `heavy`
/// widen by more than 3 % at the median, with 3.5 coloured noise is found later.
const LIKELY_RED: f32 = 3.2;

/// Sums over innovations.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sums {
    /// Σ of the weights, and of the weighted innovations: not zero where the lines are bent.
    pub(super) count: f32,
    pub(super) sum: f32,
    /// Σ of the squares, and of the squared first and second differences.
    pub(super) squares: f32,
    pub(super) first_differences: f32,
    pub(super) second_differences: f32,
    /// Σ of the products at the lags 1 and 2.
    pub(super) products: [f32; 2],
    /// Sum and number of the squared differences at the lag [`FAR`].
    pub(super) far_differences: f32,
    pub(super) far_count: f32,
}

impl Sums {
    /// Multiplies the sums by `part` and adds those of a rest.
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

    /// The colored noise that the sums show; none unless it is significant.
    pub(super) fn wander(&self) -> ColoredNoise {
        let (oscillation_n2, cosine) = self.oscillation();
        let part = oscillation_n2 / self.squares;
        let errors = part * part * self.count;
        // NaN where there are no squares, more than all of them where single samples decide.
        if self.count < FEWEST || errors.is_nan() || part > 1.0 {
            return ColoredNoise::NONE;
        }
        let limit = larger(BENT * self.count, NO_CHANCE);
        let is_red = self.is_red(oscillation_n2, cosine);
        let is_long = self.line_length() >= SHORTEST_BEND;
        // A cable that flops alike after every slip bends the rests alike, but to and fro.
        let swings = self.products[1] + self.unsure() < 0.0;
        let bends = is_long && !swings && self.sum * self.sum > limit * self.squares;
        let likely_red = surely(errors, LIKELY_RED * LIKELY_RED);
        // Innovations that alternate are no bend.
        if self.products[0] > 0.0 && (bends || (is_red && self.count < ENOUGH_FOR_BEND)) {
            let bent = self.followed(UNSURE_BEND * part * likely_red, FASTEST);
            // A slow oscillation bends whole rests, creep only their last samples.
            let is_brief = self.products[1] < RED.1 * self.products[0];
            return ColoredNoise { creeps: bends && self.sum < 0.0 && is_brief, ..bent };
        }
        if is_red {
            return ColoredNoise {
                line_excess: self.line_excess() * likely_red,
                ..ColoredNoise::NONE
            };
        }
        let slow = self.followed(0.0, QUICK);
        if slow.bends {
            return slow;
        }
        let unsure = part * surely(errors, LIKELY * LIKELY);
        let angle = if errors > CLEAR * CLEAR { math::acos(cosine) } else { 0.0 };
        ColoredNoise { unsure, angle, ..ColoredNoise::NONE }
    }

    /// Standard deviation of the departures from the lines beyond white noise, N, and its standard
    /// error; `None` if there are none.
    ///
    /// Their part of the mean square `V` is the one that [`Self::wander`] gives for an oscillation
    /// or a bend, and `γ₁²/γ₂` for noise with a geometric decay. The standard error of `V` is at
    /// most `V / √count`.
    pub(super) fn stray_n(&self) -> Option<(f32, f32)> {
        let ColoredNoise { level, unsure, line_excess, .. } = self.wander();
        let [first, second] = self.products;
        let part = match (level > 0.0, line_excess > 0.0) {
            (true, _) => level / (1.0 + level),
            (_, true) => smaller(first * first / (second * self.squares), 1.0),
            _ => smaller(unsure, 1.0),
        };
        let mean_n2 = self.squares / self.count;
        let std_n = math::sqrt(part * mean_n2);
        let error_n = 0.5 * mean_n2 / math::sqrt(self.count) / std_n;
        (part > 0.0).then_some((std_n, error_n))
    }

    /// Variances of level and slope of a bend, or of a slow oscillation, with a ratio below
    /// `fastest`, so that it can be followed; of any other only the variance that it leaves
    /// `unsure`.
    fn followed(&self, unsure: f32, fastest: f32) -> ColoredNoise {
        let white = self.second_differences / 6.0;
        let slow = self.squares - white;
        // The standard error of the noise's mean square is about `2 / √count` of it.
        // With few samples white noise scatters by chance, and is looked at anew after every rest.
        let limit = 2.0 * SURE / math::sqrt(self.count);
        let sure = slow > limit * (1.0 + 0.5 * limit) * white;
        let (level, step) = (slow / white, self.first_differences / white - 2.0);
        // False for a noise of zero as well.
        if !(slow > 0.0 && sure && step < fastest * level) {
            return ColoredNoise { unsure, ..ColoredNoise::NONE };
        }
        // A slow bend's slope is lost in the noise of single steps.
        let sure = step * step.abs() * self.count > 4.0 * SURE * SURE;
        let far = (self.far_differences_n2() / white - 2.0) / (FAR * FAR) as f32;
        let slope = larger(far, if sure { step } else { 0.0 });
        ColoredNoise { level, slope, unsure, bends: true, ..ColoredNoise::NONE }
    }

    /// Is it correlated noise, and no oscillation? At the lag 4 an oscillation of variance `A` has
    /// the autocovariance `γ₄ = A cos 4ω`, noise whose correlation decays by the factor `γ₂/γ₁` per
    /// sample has `γ₁ (γ₂/γ₁)³`. The one nearer to the observed value decides, with a margin of a
    /// standard error, which matters where samples are few. Alternating noise is found in the same
    /// way.
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

    /// Is it slow noise, whose correlation goes on to decay by the factor `ratio`? An oscillation
    /// may have `cos 4ω > 0` as well, but decays faster and faster. `over` is the observed
    /// autocovariance at the lag 4 beyond that of such noise, `unsure` its standard error.
    fn falls_evenly(&self, ratio: f32, over: f32, unsure: f32) -> bool {
        let is_above = over > -0.5 * unsure;
        ratio < SLOWEST && is_above && over < 0.5 * unsure + NEAR * self.squares
    }

    /// Standard error of a sum of products.
    fn unsure(&self) -> f32 {
        self.squares / math::sqrt(self.count)
    }

    /// Σ of the squared differences at the lag [`FAR`], scaled to the number of all samples.
    fn far_differences_n2(&self) -> f32 {
        self.far_differences * self.count / self.far_count
    }

    /// Usual number of samples on a line: two determine it, and of the innovations of the others the
    /// last does not count, nor do the first two, which have no two before them. Those with four
    /// before them are two fewer again.
    fn line_length(&self) -> f32 {
        5.0 + 2.0 * self.count / larger(self.count - self.far_count, 1.0)
    }

    /// Relative increase of a line's variance under noise whose correlation decays by the factor `r`
    /// per sample.
    ///
    /// That of a mean is `2 ρ/(1 − r)` with the correlation `ρ` of neighbours. A line through `n`
    /// samples takes part of the noise: the innovations show `γ₂/γ₁ = r − (6 r + 0.4)/n`, and
    /// `1 − (4 r + 1.5)/n` of `ρ`; and where other events tell its slope, the error of the end is larger by
    /// `1 + 1/(n (1 − r))`. All three are fits to the covariances of such noise, for `n` of 10 to 40
    /// and `r` of .3 to .9 (test below). `γ₂` is taken half a standard error higher, since little can
    /// be seen beside white noise. Zero for noise that alternates.
    fn line_excess(&self) -> f32 {
        let ([first, second], n) = (self.products, self.line_length());
        let seen = (second + 0.5 * self.unsure()) / first;
        let decay = (seen + 0.4 / n) / larger(1.0 - 6.0 / n, 0.1);
        let decay = smaller(larger(decay, 0.0), MOST_ALIKE);
        let alike = larger(first, 0.0) / self.squares / larger(1.0 - (4.0 * decay + 1.5) / n, 0.3);
        let left = 1.0 - decay;
        2.0 * alike / left * (1.0 + 1.0 / (n * left))
    }

    /// Σ of the squares of an oscillation, and the cosine of its angle per sample.
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

#[cfg(test)]
mod tests {
    use super::*;

    const MOST: usize = 40;
    type Weights = [f64; MOST];

    /// Covariance of two weighted sums of noise whose correlation decays by `r` per sample.
    fn covariance(a: &Weights, b: &Weights, r: f64) -> f64 {
        let row = |i: usize| (0..MOST).map(move |j| b[j] * r.powi(i.abs_diff(j) as i32));
        (0..MOST).map(|i| a[i] * row(i).sum::<f64>()).sum()
    }

    /// Weights of the first `n` samples in their line's value at a time.
    fn line(n: usize, time: f64) -> Weights {
        let middle = (n as f64 - 1.0) / 2.0;
        let tt: f64 = (0..n).map(|i| (i as f64 - middle).powi(2)).sum();
        let weight = |i: usize| 1.0 / n as f64 + (time - middle) * (i as f64 - middle) / tt;
        core::array::from_fn(|i| if i < n { weight(i) } else { 0.0 })
    }

    fn square(a: &Weights) -> f64 {
        a.iter().map(|x| x * x).sum()
    }

    /// Weights of the samples in the innovation of sample `k`.
    fn innovation(k: usize) -> Weights {
        let before = line(k, k as f64);
        let spread = (1.0 + square(&before)).sqrt();
        core::array::from_fn(|i| (f64::from(u8::from(i == k)) - before[i]) / spread)
    }

    /// What very many rests of `n` samples show on average.
    fn shown(n: usize, r: f64) -> Sums {
        const RESTS: f32 = 1e6;
        // The first innovation is that of sample 2, the last one does not count.
        let number = n - 3;
        let of = |j: usize, lag: usize| covariance(&innovation(j + 2), &innovation(j + 2 - lag), r);
        let sum = |lag: usize| RESTS * (2..number).map(|j| of(j, lag)).sum::<f64>() as f32;
        let far = |j: usize| of(j, 0) + of(j - 4, 0) - 2.0 * of(j, 4);
        Sums {
            count: RESTS * (number - 2) as f32,
            squares: sum(0),
            products: [sum(1), sum(2)],
            far_differences: RESTS * (4..number).map(far).sum::<f64>() as f32,
            far_count: RESTS * (number - 4) as f32,
            ..Sums::default()
        }
    }

    /// True relative increase of the variance of a line's end, half a sample beyond its last one, and
    /// of its mean, which the end is where other events tell the slope.
    fn true_excess(n: usize, r: f64) -> [f64; 2] {
        let left = |i: usize| {
            let line = line(n, i as f64);
            let off: Weights = core::array::from_fn(|j| f64::from(u8::from(i == j)) - line[j]);
            covariance(&off, &off, r)
        };
        let own = (0..n).map(left).sum::<f64>() / (n as f64 - 2.0);
        let excess = |of: Weights| covariance(&of, &of, r) / (own * square(&of)) - 1.0;
        [n as f64 - 0.5, (n as f64 - 1.0) / 2.0].map(|time| excess(line(n, time)))
    }

    #[test]
    fn a_lines_end_is_as_uncertain_as_its_innovations_tell() {
        for n in [10, 14, 20, 28, 40] {
            for r in [0.3, 0.5, 0.7, 0.8, 0.9] {
                let shown = shown(n, r);
                assert!((shown.line_length() - n as f32).abs() < 1e-3);
                let [least, most] = true_excess(n, r);
                let told = f64::from(shown.line_excess());
                assert!(
                    (0.8 * least..1.4 * most).contains(&told),
                    "{n} {r}: {told} {least} {most}"
                );
            }
        }
    }
}
