//! A running quantile: each number moves it up or down by a constant factor, whatever the scale.

use crate::num::math::{larger, smaller};

/// A running quantile of positive numbers, of the same probability at each: a half or more.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Quantile {
    value: f32,
    count: u32,
    /// The largest half of the first numbers, in descending order: the quantile, of a probability
    /// of a half or more, is among them.
    largest: [f32; FEWEST as usize / 2],
}

/// Final relative step of a quantile: it settles to 8 % within a hundred samples.
const SMALLEST_GAIN: f32 = 0.08;
/// Number of values after which the step is final: the step `4/n` before has nearly fallen to it.
const SETTLED: u32 = 40;
/// Least number that an estimate of zero grows to, in the unit of the numbers: far below any noise.
const LEAST: f32 = 1e-6;
/// Fewest numbers for an estimate: two of eight are above the upper quartile.
const FEWEST: u32 = 8;

impl Quantile {
    /// Takes a number at or above zero; `part` is the probability of the quantile.
    pub(crate) fn add(&mut self, size: f32, part: f32) {
        let gain = if self.count >= SETTLED {
            SMALLEST_GAIN
        } else if self.count >= FEWEST {
            self.count += 1;
            4.0 / self.count as f32
        } else {
            return self.start(size, part);
        };
        // Factors that balance when the part `part` of the numbers lies below the value.
        self.value = if size > self.value {
            // A value of zero (a noiseless start) cannot grow by a factor: it grows to a thousandth
            // of the number. But at most it doubles, for a knock is no noise.
            let least = smaller(1e-3 * size, 2.0 * self.value + LEAST);
            larger(self.value * (1.0 + gain * part), least)
        } else {
            self.value / (1.0 + gain * (1.0 - part))
        };
    }

    /// Sorts the first eight numbers, whose quantile is the initial estimate.
    fn start(&mut self, mut size: f32, part: f32) {
        for entry in &mut self.largest {
            if size > *entry {
                core::mem::swap(entry, &mut size);
            }
        }
        self.count += 1;
        // Meaningful once there are all eight.
        let smaller_ones = (part * (FEWEST - 1) as f32 + 0.5) as u32;
        let place = (FEWEST - 1).saturating_sub(smaller_ones);
        self.value = self.largest.get(place as usize).copied().unwrap_or(size);
    }

    /// The quantile over a number, times a factor of caution; infinite until eight numbers were
    /// seen. An estimate from few numbers may be far too small: the factor is 2 at the eighth and
    /// falls to 1 at the fortieth.
    #[inline(always)]
    pub(crate) fn over(&self, number: f32) -> f32 {
        if self.count >= SETTLED { self.value / number } else { self.early_over(number) }
    }

    #[inline(never)]
    fn early_over(&self, number: f32) -> f32 {
        if self.count < FEWEST {
            return f32::INFINITY;
        }
        let caution = 1.0 + (SETTLED - self.count) as f32 / (SETTLED - FEWEST) as f32;
        caution * (self.value / number)
    }

    /// The quantile so far; `None` until eight numbers were seen.
    pub(crate) fn value(&self) -> Option<f32> {
        (self.count >= FEWEST).then_some(self.value)
    }
}
