//! How much more the first samples after a re-stick scatter than later ones.
//!
//! After a slip the cable flops: the force swings while the block rests, and the swing
//! dies away. What a straight line through the whole stick leaves then has the variance
//! `sigma² (1 + excess e^(−decay age))`. Excess and decay are found from two moments of
//! the squares over the age, with a weight that dies away as they do; what is not beyond
//! chance is none. Samples count for `1 / (1 + excess e^(−decay age))`.

use crate::line::Line;
use crate::math;
use crate::shared::surely;

/// Sticks after which the past has faded.
const MEMORY: f32 = 16.0;
/// Fewest samples of a stick, and fewest sticks, that tell anything.
const FEWEST: u32 = 8;
const FEWEST_STICKS: f32 = 2.5;
/// Standard errors beyond which early samples scatter more.
const SIGNIFICANT: f32 = 4.0;
/// A square counts for no more than so many of the usual ones.
const LARGEST: f32 = 10.0;

/// Scatter by age since the re-stick.
#[derive(Clone, Copy, Debug, Default)]
pub struct Profile {
    /// Variance of the first sample over that of late ones, less one; zero: all alike.
    excess: f32,
    /// Part by which the excess falls in a period.
    decay: f32,
    /// The same of the moments' weight.
    taper: f32,
    /// Σ v r² and Σ v age r² with v = e^(−taper age), N², and the same without r².
    squares_n2: [f32; 2],
    sums: [f32; 2],
    /// Weighted squares, N², and weights of all samples.
    late_n2: f32,
    late: f32,
    sticks: f32,
}

impl Profile {
    /// Weight of a sample so many periods after the re-stick, 1 for a late one.
    #[must_use]
    pub fn weight(&self, age: f32) -> f32 {
        if let Some((a, l)) = oracle() { return 1.0/(1.0+a*crate::math::exp(-l*age as f32)); }
        if self.is_flat() {
            return 1.0;
        }
        1.0 / (1.0 + self.excess * math::exp(-self.decay * age))
    }

    /// Do all samples scatter alike?
    #[must_use]
    pub fn is_flat(&self) -> bool {
        self.excess <= 0.0
    }

    /// Takes the samples of a stick, with their ages.
    pub fn learn(&mut self, samples: impl Iterator<Item = (f32, f32)> + Clone) {
        let mut line = Line::default();
        for (age, force_n) in samples.clone() {
            let weight = self.weight(age);
            line.add(age, force_n, weight, weight);
        }
        let Some(slope) = line.slope().filter(|_| line.count >= FEWEST) else { return };
        const FADE: f32 = 1.0 - 1.0 / MEMORY;
        for sum in self.squares_n2.iter_mut().chain(&mut self.sums) {
            *sum *= FADE;
        }
        self.late_n2 *= FADE;
        self.late *= FADE;
        self.sticks = FADE * self.sticks + 1.0;
        let usual_n2 = if self.late > 0.0 { self.late_n2 / self.late } else { f32::INFINITY };
        let half = 0.5 * line.count as f32;
        self.taper = self.sticks / (self.late + half);
        for (age, force_n) in samples {
            let weight = self.weight(age);
            let off_n = force_n - line.at(age, slope);
            let free = (1.0 - weight * line.leverage(age)).max(0.1);
            let square_n2 = (off_n * off_n / free).min(LARGEST * usual_n2 / weight);
            if age > half {
                self.late_n2 += square_n2;
                self.late += 1.0;
                continue;
            }
            let taper = math::exp(-self.taper * age);
            for (sum, by) in [(0, taper), (1, taper * age)] {
                self.squares_n2[sum] += by * square_n2;
                self.sums[sum] += by;
            }
        }
        self.solve();
    }

    /// Excess and decay from the moments.
    fn solve(&mut self) {
        let usual_n2 = self.late_n2 / self.late;
        let [all, by_age] = [0, 1].map(|i| self.squares_n2[i] / usual_n2 - self.sums[i]);
        // Its variance by chance; Σ v² is half of Σ v.
        let chance = self.sums[0] + 2.0 * self.sums[0] * self.sums[0] / self.late;
        let limit = SIGNIFICANT * math::sqrt(chance);
        self.excess = 0.0;
        if !(all > limit && self.sticks > FEWEST_STICKS) {
            return;
        }
        // The mean age R is that of two falls at once: their sum is ln(1 + 1/R).
        let inverse = all / (2.0 * by_age.max(0.0) + all);
        let both = 2.0 * inverse * (1.0 + inverse * inverse / 3.0);
        self.decay = (both - self.taper).max(0.25 * self.taper);
        let [both, taper] = [self.decay + self.taper, self.taper].map(|fall| 1.0 - math::exp(-fall));
        let excess = all / self.sums[0] * both / taper;
        self.excess = surely(all, limit) * surely(excess, 1.0) * excess;
        
    }
}

fn oracle() -> Option<(f32, f32)> {
    static O: std::sync::OnceLock<Option<(f32,f32)>> = std::sync::OnceLock::new();
    *O.get_or_init(|| { let v = std::env::var("FLOP").ok()?; let mut i = v.split(',').map(|x| x.parse().unwrap()); Some((i.next()?, i.next()?)) })
}
