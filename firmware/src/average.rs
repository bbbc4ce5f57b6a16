//! The mean of a few readings, for the self test.

use heapless::Vec;

use crate::adc::Input;
use crate::line::Mean;
use crate::sample::Sample;

/// Largest number of averaged readings: two seconds.
pub const MOST: usize = 32;

/// Collects readings of one input.
#[derive(Clone, Debug)]
pub struct Average {
    input: Input,
    wanted: usize,
    codes: Vec<i32, MOST>,
    failed: u32,
}

impl Average {
    /// Averages `wanted` readings, at most [`MOST`].
    #[must_use]
    pub fn new(input: Input, wanted: usize) -> Self {
        Self { input, wanted: wanted.min(MOST), codes: Vec::new(), failed: 0 }
    }

    /// Takes a sample; returns the mean after enough readings or too many failures.
    pub fn add(&mut self, sample: &Sample) -> Option<Mean> {
        if sample.input != self.input {
            return None;
        }
        match sample.reading {
            Ok(code) => drop(self.codes.push(code.0)),
            Err(_) => self.failed += 1,
        }
        let enough = self.codes.len() >= self.wanted || self.failed as usize > self.wanted;
        enough.then(|| self.mean())
    }

    fn mean(&self) -> Mean {
        let first = self.codes.first().copied().unwrap_or(0);
        let count = self.codes.len().max(1) as f32;
        let offsets = self.codes.iter().map(|&code| code.wrapping_sub(first) as f32);
        let mean = offsets.clone().sum::<f32>() / count;
        let square = offsets.map(|x| (x - mean) * (x - mean)).sum::<f32>() / count;
        let new = |(i, code): &(usize, &i32)| !self.codes.iter().take(*i).any(|c| c == *code);
        let different = self.codes.iter().enumerate().filter(new).count() as u32;
        Mean {
            input: self.input,
            count: self.codes.len() as u32,
            failed: self.failed,
            mean: first as f32 + mean,
            deviation: floe_core::num::math::sqrt(square),
            different,
        }
    }
}
