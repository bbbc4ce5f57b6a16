//! How much more the first samples after a re-stick scatter than later ones.
//!
//! After a slip the cable flops: the force swings while the block rests, and the swing
//! dies away. What a straight line through a stick leaves has the variance
//! `sigma² (1 + excess e^(−decay age))`. `sigma²` is that of the second halves of the
//! sticks; excess and decay come from two moments of the first halves, the sum of
//! `r² − sigma²` and its mean age, tapered over the length of a stick. What is within
//! chance, or no more than `sigma²` itself, is none: then every sample counts alike.

use crate::line::Line;
use crate::math;
use crate::shared::surely;

/// Sticks after which the past has faded.
const MEMORY: f32 = 16.0;
/// Fewest samples of a stick, and fewest sticks, that tell anything.
const FEWEST: u32 = 8;
const FEWEST_STICKS: f32 = 2.5;
/// Standard errors that count, and the least excess that does.
const SIGNIFICANT: f32 = 4.0;
const LEAST: f32 = 1.0;
/// A square counts for no more than so many usual ones.
const LARGEST: f32 = 10.0;

/// Scatter of a resting block's samples by their age since the re-stick, periods.
#[derive(Clone, Copy, Debug, Default)]
pub struct Profile {
    /// Variance at age zero over that of late samples, less one; zero: all alike.
    excess: f32,
    /// Rate at which the excess dies away, per period.
    decay: f32,
    early: Early,
    /// Σ r² of the second halves, N², and their number of samples.
    late_n2: f32,
    late: f32,
    sticks: f32,
}

/// Sums over the first halves: `v`, `v age`, `v r²` and `v age r²` with a taper `v`.
#[derive(Clone, Copy, Debug, Default)]
struct Early {
    sums: [f32; 2],
    squares_n2: [f32; 2],
}

impl Profile {
    /// Do all samples scatter alike?
    #[must_use]
    pub fn is_flat(&self) -> bool {
        self.excess <= 0.0
    }

    /// Variance of a sample over that of a late one.
    #[must_use]
    pub fn variance(&self, age: f32) -> f32 {
        if self.is_flat() { 1.0 } else { 1.0 + self.excess * math::exp(-self.decay * age) }
    }

    /// Takes a stick: its forces, N, one a period; `None` is missing.
    pub fn learn(&mut self, forces_n: impl Iterator<Item = Option<f32>> + Clone) {
        let samples = || (0_u16..).map(f32::from).zip(forces_n.clone());
        let mut line = Line::default();
        for (age, force_n) in samples() {
            let weight = 1.0 / self.variance(age);
            if let Some(force_n) = force_n {
                line.add(age, force_n, weight, weight);
            }
        }
        let Some(slope) = line.slope().filter(|_| line.count >= FEWEST) else { return };
        let usual_n2 = if self.late > 0.0 { self.late_n2 / self.late } else { f32::INFINITY };
        self.fade();
        let half = 0.5 * line.count as f32;
        let taper = self.taper(half);
        let (mut v, step) = (1.0, math::exp(-taper));
        for (age, force_n) in samples() {
            if let Some(force_n) = force_n {
                let variance = self.variance(age);
                let off_n = force_n - line.at(age, slope);
                let free = (1.0 - line.leverage(age) / variance).max(0.1);
                let square_n2 = (off_n * off_n / free).min(LARGEST * usual_n2 * variance);
                if age > half {
                    self.late_n2 += square_n2;
                    self.late += 1.0;
                } else {
                    self.early.add(v, age, square_n2);
                }
            }
            v *= step;
        }
        self.solve(taper);
    }

    fn fade(&mut self) {
        const FADE: f32 = 1.0 - 1.0 / MEMORY;
        let Early { sums: [a, b], squares_n2: [c, d] } = &mut self.early;
        for sum in [a, b, c, d, &mut self.late_n2, &mut self.late, &mut self.sticks] {
            *sum *= FADE;
        }
        self.sticks += 1.0;
    }

    /// One over half the usual length of a stick, when the newest one has this half.
    fn taper(&self, half: f32) -> f32 {
        self.sticks / (self.late + half)
    }

    /// Excess and decay from the moments.
    fn solve(&mut self, taper: f32) {
        let usual_n2 = self.late_n2 / self.late;
        let Early { sums, squares_n2 } = self.early;
        let [all, by_age] = [0, 1].map(|i| squares_n2[i] / usual_n2 - sums[i]);
        // Variance of `all` by chance; Σ v² is about half of Σ v.
        let chance = sums[0] + 2.0 * sums[0] * sums[0] / self.late;
        let limit = SIGNIFICANT * math::sqrt(chance);
        let is_new = self.is_flat() && self.sticks < FEWEST_STICKS;
        self.excess = 0.0;
        // Also false for NaN.
        if !(all > limit) || is_new {
            return;
        }
        // Decay and taper together make the mean age R: their sum is ln(1 + 1/R), as the
        // first two terms of 2 artanh(1/(2 R + 1)).
        let inverse = all / (2.0 * by_age.max(0.0) + all);
        let both = 2.0 * inverse * (1.0 + inverse * inverse / 3.0);
        self.decay = (both - taper).max(0.25 * taper);
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
