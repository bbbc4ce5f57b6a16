//! Extra scatter of the first samples after a re-stick.
//!
//! After a slip the cable flops: the force oscillates while the block rests, and the oscillation
//! decays. The residuals `r` of a straight line through a stick have the variance
//! `sigma² (1 + excess e^(−decay age))`. `sigma²` is estimated from the second halves of the
//! sticks, excess and decay from two moments of the first halves: the sum of `r² − sigma²` and its
//! mean age, tapered over the length of a stick. An excess that is not significant, or no more than
//! 1, is set to zero: then all samples have the same weight.

use crate::effect::Parameter;
use crate::num::math::{self, larger, smaller};
use crate::stats::line::Line;
use crate::stats::significance::{SURE, surely};

/// Time constant of the forgetting, sticks. A choice: more sticks resolve a smaller excess, fewer
/// follow a cable that changes.
const MEMORY: f32 = 16.0;
/// Fewest samples of a stick that is used: four in either half.
const FEWEST: u32 = 8;
/// Least effective number of sticks (with forgetting) for a first excess: three sticks.
const FEWEST_STICKS: f32 = 2.5;
/// Least excess that is used: with less a first sample weighs more than half of a late one.
const LEAST: f32 = 1.0;
/// Effective number of sticks without an excess after which only one of [`SELDOM`] is used.
const SETTLED: f32 = 8.0;
const SELDOM: u8 = 8;
/// Limit of a squared residual, in units of its variance: no outlier decides alone. Of normal
/// residuals one in 600 is larger.
const LARGEST: f32 = 10.0;

/// Scatter of a resting block's samples by their age since the re-stick, periods.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct FlopProfile {
    /// Variance at age zero over that of late samples, less one; zero: all variances are equal.
    excess: f32,
    /// Decay rate of the excess, per period.
    decay: f32,
    early: Early,
    /// Σ r² of the second halves, N², and their number of samples.
    late_n2: f32,
    late: f32,
    sticks: f32,
    /// Sticks in all, used or not.
    seen: u8,
    /// Line through the stick in use.
    line: Line,
}

/// Sums over the first halves: `v`, `v age`, `v r²` and `v age r²` with a taper `v`, which decays
/// exponentially with the age.
#[derive(Clone, Copy, Debug, Default)]
struct Early {
    sums: [f32; 2],
    squares_n2: [f32; 2],
}

impl FlopProfile {
    /// Have all samples the same variance?
    pub(crate) fn is_flat(&self) -> bool {
        self.excess <= 0.0
    }

    /// Variance of a sample of this age, periods, over that of a late one.
    #[inline(always)]
    pub(crate) fn variance(&self, age: f32) -> f32 {
        if self.is_flat() { 1.0 } else { self.early_variance(age) }
    }

    fn early_variance(&self, age: f32) -> f32 {
        1.0 + self.excess * math::exp(-self.decay * age)
    }

    /// Standard deviation of the first samples of a stick over that of late ones. The excess has
    /// the relative standard error of its moment, whose terms scatter by their mean square.
    pub(crate) fn parameter(&self) -> Parameter {
        let (all, chance) = self.moment();
        let scatter = math::sqrt(chance) * (1.0 + all / self.early.sums[0]);
        let value = math::sqrt(1.0 + self.excess);
        let std = 0.5 * self.excess / value * scatter / all;
        Parameter { name: "early_noise_ratio", value, std }
    }

    /// Counts a stick that has ended; is it to be used?
    fn is_due(&mut self) -> bool {
        self.seen = self.seen.wrapping_add(1);
        !self.is_flat() || self.sticks < SETTLED || self.seen.is_multiple_of(SELDOM)
    }

    /// Begins with a stick that has ended: keeps the line through all its samples, or fits one
    /// where the detector followed none. The forces, N, are one a period, in two parts; NaN is
    /// missing.
    pub(crate) fn begin(&mut self, line: Option<Line>, forces_n: [&[f32]; 2]) {
        let is_due = self.is_due();
        let line = || line.unwrap_or_else(|| self.line_through(forces_n));
        self.line = if is_due { line() } else { Line::default() };
    }

    /// Adds the residuals of the stick that [`Self::begin`] was given, and solves for the excess.
    pub(crate) fn learn(&mut self, forces_n: [&[f32]; 2]) {
        let line = self.line;
        let Some(slope) = line.slope().filter(|_| line.count >= FEWEST) else { return };
        let usual_n2 = if self.late > 0.0 { self.late_n2 / self.late } else { f32::INFINITY };
        self.fade();
        let half = 0.5 * line.count as f32;
        let taper = self.taper(half);
        let (mut v, step) = (1.0, math::exp(-taper));
        // Variances of the line's level at its mean time and of its slope, units of a late
        // sample's.
        let (level, turn) = (1.0 / line.weight, 1.0 / line.slope_weight);
        let (mut early, mut late_n2, mut late) = (self.early, 0.0, 0.0);
        self.each(forces_n, |age, force_n, variance| {
            if !force_n.is_nan() {
                let time = age - line.time;
                let off_n = force_n - line.level_n - slope * time;
                // The fitted line leaves this part of a residual's variance; a tenth at least.
                let free = larger(1.0 - (level + turn * time * time) / variance, 0.1);
                let square_n2 = smaller(off_n * off_n / free, LARGEST * usual_n2 * variance);
                if age > half {
                    late_n2 += square_n2;
                    late += 1.0;
                } else {
                    early.add(v, age, square_n2);
                }
            }
            v *= step;
        });
        self.early = early;
        self.late_n2 += late_n2;
        self.late += late;
        self.solve(taper);
    }

    /// The line through a stick, each sample weighted by one over its variance.
    fn line_through(&self, forces_n: [&[f32]; 2]) -> Line {
        let mut line = Line::default();
        self.each(forces_n, |age, force_n, variance| {
            if !force_n.is_nan() {
                let weight = 1.0 / variance;
                line.add(age, force_n, weight, weight);
            }
        });
        line
    }

    /// Gives age, periods, force, N, and relative variance of each sample, missing ones too.
    #[inline(always)]
    fn each(&self, [first, second]: [&[f32]; 2], mut take: impl FnMut(f32, f32, f32)) {
        let (mut excess, step) = (self.excess, math::exp(-self.decay));
        let mut age = 0.0;
        for &force_n in first.iter().chain(second) {
            take(age, force_n, 1.0 + excess);
            excess *= step;
            age += 1.0;
        }
    }

    fn fade(&mut self) {
        const FADE: f32 = 1.0 - 1.0 / MEMORY;
        let Early { sums: [a, b], squares_n2: [c, d] } = &mut self.early;
        for sum in [a, b, c, d, &mut self.late_n2, &mut self.late, &mut self.sticks] {
            *sum *= FADE;
        }
        self.sticks += 1.0;
    }

    /// Decay rate of the taper, per period: one over half the mean length of a stick; `half` is
    /// half the length of the newest one.
    fn taper(&self, half: f32) -> f32 {
        self.sticks / (self.late + half)
    }

    /// `Σ v (r²/sigma² − 1)` over the first halves, and its variance if there is no excess.
    fn moment(&self) -> (f32, f32) {
        let usual_n2 = self.late_n2 / self.late;
        let Early { sums: [sum, _], squares_n2: [square_n2, _] } = self.early;
        // Σ v² is about half of Σ v.
        (square_n2 / usual_n2 - sum, sum + 2.0 * sum * sum / self.late)
    }

    /// Estimates excess and decay from the moments.
    fn solve(&mut self, taper: f32) {
        let (all, chance) = self.moment();
        let usual_n2 = self.late_n2 / self.late;
        let Early { sums, squares_n2: [_, square_by_age_n2] } = self.early;
        let by_age = square_by_age_n2 / usual_n2 - sums[1];
        let limit = SURE * math::sqrt(chance);
        let is_new = self.is_flat() && self.sticks < FEWEST_STICKS;
        self.excess = 0.0;
        // False for NaN as well.
        let is_sure = all > limit;
        if !is_sure || is_new {
            return;
        }
        // Decay and taper together give the mean age R of the excess: their sum is ln(1 + 1/R), by
        // the first two terms of 2 artanh(1/(2 R + 1)).
        let inverse = all / (2.0 * larger(by_age, 0.0) + all);
        let both = 2.0 * inverse * (1.0 + inverse * inverse / 3.0);
        self.decay = larger(both - taper, 0.25 * taper);
        let [both, taper] = [self.decay + taper, taper].map(|rate| 1.0 - math::exp(-rate));
        let excess = all / sums[0] * both / taper;
        self.excess = surely(all, limit) * surely(excess, LEAST) * excess;
    }
}

impl Early {
    fn add(&mut self, v: f32, age: f32, square_n2: f32) {
        for (i, by) in [v, v * age].into_iter().enumerate() {
            self.sums[i] += by;
            self.squares_n2[i] += by * square_n2;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::Random;

    /// After sticks of white noise and an oscillation that dies away.
    fn seen(amplitude_n: f32, decay: f32, length: usize, sticks: u32) -> FlopProfile {
        let (mut profile, mut random) = (FlopProfile::default(), Random(1));
        for _ in 0..sticks {
            let forces_n: [f32; 192] = core::array::from_fn(|i| {
                let age = i as f32;
                let oscillation = (-decay * age).exp() * (1.3 * age + 3.0).sin();
                let force_n = 200.0 + 22.0 * age + amplitude_n * oscillation + random.normal();
                if i % 11 == 5 { f32::NAN } else { force_n }
            });
            let forces_n = [forces_n.get(..length).unwrap(), &[]];
            profile.begin(None, forces_n);
            profile.learn(forces_n);
        }
        profile
    }

    #[test]
    fn white_noise_counts_alike() {
        for sticks in 1..200 {
            assert!(seen(0.0, 1.0, 25, sticks).is_flat(), "{sticks}");
        }
        assert!((FlopProfile::default().variance(0.0) - 1.0).abs() < f32::EPSILON);
    }

    #[test]
    fn a_dying_oscillation_counts_for_little_at_first_and_in_full_at_last() {
        for (amplitude_n, decay, length) in [(8.0, 0.2, 26), (30.0, 0.1, 100), (20.0, 0.05, 192)] {
            let profile = seen(amplitude_n, decay, length, 30);
            for age in [0.0, 4.0, 8.0, 12.0] {
                let truth = 1.0 + 0.5 * amplitude_n * amplitude_n * (-2.0 * decay * age).exp();
                let ratio = profile.variance(age) / truth;
                assert!((0.4..2.5).contains(&ratio), "{age} {ratio} {profile:?}");
            }
            assert!(profile.variance(length as f32) < 1.2, "{profile:?}");
            // An oscillation has the same size in every stick, and scatters less than noise.
            let ratio = profile.parameter();
            let truth = (1.0 + 0.5 * amplitude_n * amplitude_n).sqrt();
            assert!(
                (ratio.value / truth - 1.0).abs() < 0.6 && ratio.std < 0.2 * truth,
                "{ratio:?}"
            );
        }
        assert!(seen(0.0, 1.0, 25, 50).is_flat());
    }

    #[test]
    fn one_odd_stick_and_short_ones_tell_nothing() {
        assert!(seen(30.0, 0.2, 26, 1).is_flat());
        assert!(seen(30.0, 0.2, 7, 50).is_flat());
        let mut profile = FlopProfile::default();
        for _ in 0..20 {
            profile.begin(None, [&[5.0; 20], &[]]);
            profile.learn([&[5.0; 20], &[]]);
        }
        assert!(profile.is_flat(), "a force without noise");
    }
}
