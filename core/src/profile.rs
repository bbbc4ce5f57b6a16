//! How much more the samples after a re-stick scatter than later ones.
//!
//! After a slip the cable flops: the force swings while the block rests, and the swing
//! dies away. The mean square of what a straight line through the whole stick leaves is
//! kept by age, in bins that double. Where it is more than that of the late ones,
//! beyond chance, samples count for less: `late variance / their variance`.

use crate::line::Line;
use crate::math;

/// Bins: ages below 2, 4, 8, ..., 256 periods.
const BINS: usize = 16;
/// Events after which the past has faded.
const MEMORY: f32 = 32.0;
/// Standard errors beyond which early samples scatter more.
const SIGNIFICANT: f32 = 5.0;
/// Fewest samples that tell the late ones' variance.
const FEWEST: f32 = 24.0;
/// A square counts for no more than so many of the usual ones.
const LARGEST: f32 = 10.0;

/// Mean squares of the residuals by age since the re-stick.
#[derive(Clone, Copy, Debug)]
pub struct Profile {
    squares_n2: [f32; BINS],
    counts: [f32; BINS],
    weights: [f32; BINS],
}

impl Profile {
    /// All alike.
    #[must_use]
    pub const fn new() -> Self {
        Self { squares_n2: [0.0; BINS], counts: [0.0; BINS], weights: [1.0; BINS] }
    }

    /// Weight of a sample so many periods after the re-stick, 1 for a late one.
    #[must_use]
    pub fn weight(&self, age: u64) -> f32 {
        self.weights.get(bin(age)).copied().unwrap_or(1.0)
    }

    /// Is any weight less than one?
    #[must_use]
    pub fn is_flat(&self) -> bool {
        self.weights[0] >= 1.0
    }

    /// Takes the samples of a stick, by age.
    pub fn learn(&mut self, samples: impl Iterator<Item = (u64, f32)> + Clone) {
        let mut line = Line::default();
        for (age, force_n) in samples.clone() {
            line.add(age as f32, force_n, self.weight(age), 1.0);
        }
        if line.count < 8 {
            return;
        }
        let Some(slope) = line.slope() else { return };
        let fade = 1.0 - 1.0 / MEMORY;
        for (s, c) in self.squares_n2.iter_mut().zip(&mut self.counts) {
            *s *= fade;
            *c *= fade;
        }
        for (age, force_n) in samples {
            let time = age as f32;
            let off_n = force_n - line.at(time, slope);
            let free = (1.0 - self.weight(age) * line.leverage(time)).max(0.1);
            let b = bin(age);
            let (s, c) = (&mut self.squares_n2[b], &mut self.counts[b]);
            let mut square = off_n * off_n / free;
            if *c > 4.0 {
                square = square.min(LARGEST * *s / *c);
            }
            *s += square;
            *c += 1.0;
        }
        self.weigh();
    }

    fn weigh(&mut self) {
        let (mut late_n2, mut late) = (0.0, 0.0);
        let mut weight = 1.0_f32;
        for b in (0..BINS).rev() {
            let (square, count) = (self.squares_n2[b], self.counts[b]);
            if count > 0.0 {
                let ratio = square / count * late / late_n2;
                let chance = SIGNIFICANT * math::sqrt(2.0 / count + 2.0 / late);
                if weight >= 1.0 && (late < FEWEST || !(ratio > 1.0 + chance)) {
                    late += count;
                    late_n2 += square;
                } else {
                    weight = weight.min(1.0 / ratio);
                }
            }
            self.weights[b] = weight;
        }
    }
}

fn bin(age: u64) -> usize {
    if age < 2 { return age as usize; }
    let octave = u64::BITS - (age >> 1).leading_zeros(); // 1 for 2,3
    let half = (age >> (octave - 1)) & 1;
    ((2 * octave + half as u32) as usize).min(BINS - 1)
}
