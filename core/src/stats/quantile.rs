//! A quantile, online: moved by a constant factor up or down, no threshold.

use crate::num::math::{larger, smaller};

/// A running quantile of positive numbers; its probability in percent.
// In this order: what every number touches first.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Quantile<const PERCENT: u8> {
    value: f32,
    count: u32,
    /// The first numbers, in order of size.
    first: [f32; FEWEST as usize],
}

/// Half of the numbers are smaller.
pub type Median = Quantile<50>;
/// Three quarters of them are.
pub type UpperQuartile = Quantile<75>;

/// Final step of a quantile: settles to 8 % within a hundred samples.
const SMALLEST_GAIN: f32 = 0.08;
/// Numbers after which the step is final.
const SETTLED: u32 = 40;
/// Fewest numbers that tell a quantile.
const FEWEST: u32 = 8;

impl<const PERCENT: u8> Quantile<PERCENT> {
    /// Part of the numbers that are smaller.
    const PART: f32 = PERCENT as f32 / 100.0;

    /// Before the first number.
    #[must_use]
    pub const fn new() -> Self {
        Self { value: 0.0, count: 0, first: [f32::MAX; FEWEST as usize] }
    }

    /// Takes a number at or above zero.
    pub fn add(&mut self, size: f32) {
        if self.count < SETTLED {
            return self.start(size);
        }
        self.follow(size, SMALLEST_GAIN);
    }

    /// With factors that balance when a part of the numbers lies below the quantile.
    fn follow(&mut self, size: f32, gain: f32) {
        let factor = if size > self.value {
            1.0 + gain * Self::PART
        } else {
            1.0 / (1.0 + gain * (1.0 - Self::PART))
        };
        // Zero (a noiseless start) could not grow by a factor alone.
        self.value = larger(self.value * factor, 1e-3 * size);
    }

    /// Sorts the first numbers in: their quantile is where to start from. Larger steps at
    /// first.
    #[inline(never)]
    fn start(&mut self, mut size: f32) {
        if self.count >= FEWEST {
            self.count += 1;
            let gain = larger(4.0 / self.count as f32, SMALLEST_GAIN);
            return self.follow(size, gain);
        }
        for entry in &mut self.first {
            (*entry, size) = (smaller(*entry, size), larger(*entry, size));
        }
        self.count += 1;
        let place = Self::PART * (self.count - 1) as f32 + 0.5;
        self.value = self.first.get(place as usize).copied().unwrap_or(size);
    }

    /// The quantile over a number, with caution; infinite until eight numbers were seen. What few
    /// tell may be far too small: the caution is 2 at the first value, and none when settled.
    #[must_use]
    pub fn over(&self, number: f32) -> f32 {
        let Some(missing) = SETTLED.checked_sub(self.count) else { return self.value / number };
        if self.count < FEWEST {
            return f32::INFINITY;
        }
        let caution = 1.0 + missing as f32 / (SETTLED - FEWEST) as f32;
        caution * (self.value / number)
    }

    /// The quantile so far; `None` until eight numbers were seen.
    #[must_use]
    pub fn value(&self) -> Option<f32> {
        (self.count >= FEWEST).then_some(self.value)
    }
}
