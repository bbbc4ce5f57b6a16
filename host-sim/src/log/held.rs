//! Readings repeated because a display is read faster than it changes, and samples left out because
//! they come too fast.

use floe_core::Reading;

use crate::rounding::{counted, significant};

/// Longest run of equal readings that is distinguished.
const LONGEST: usize = 256;
/// Smallest number of runs for a conclusion.
const ENOUGH: u64 = 40;

/// Counts runs of equal readings, and readings without a sample of their own.
#[derive(Clone, Debug)]
pub struct Held {
    last: Option<Reading>,
    index: Option<u32>,
    length: usize,
    runs: [u64; LONGEST],
    left_out: u64,
}

impl Default for Held {
    fn default() -> Self {
        Self { last: None, index: None, length: 0, runs: [0; LONGEST], left_out: 0 }
    }
}

impl Held {
    /// Takes a reading; a repeated row with the index of the previous one is skipped.
    pub fn push(&mut self, index: u32, reading: Reading) {
        if self.index.replace(index) == Some(index) {
            self.left_out += u64::from(self.last != Some(reading));
            return;
        }
        if self.last == Some(reading) {
            self.length += 1;
            return;
        }
        if let Some(runs) = self.runs.get_mut(self.length) {
            *runs += u64::from(self.length > 0);
        }
        (self.last, self.length) = (Some(reading), 1);
    }

    /// Samples between changes of the force if nearly all runs are equally long; with a coarse
    /// converter the runs become shorter the faster the force changes.
    fn samples(&self) -> Option<usize> {
        const SHORTEST: usize = 2;
        let all = self.runs.iter().sum::<u64>();
        let (usual, _) = self.runs.iter().enumerate().max_by_key(|(_, runs)| **runs)?;
        // With runs of two samples, one and three differ too much to be counted as equal.
        let beside = usize::from(usual > SHORTEST);
        let near =
            self.runs.get(usual.saturating_sub(beside)..=usual + beside)?.iter().sum::<u64>();
        (usual >= SHORTEST && all >= ENOUGH && near * 10 >= all * 9).then_some(usual)
    }

    /// Warnings about held readings.
    pub fn warnings(&self, rate_hz: f64) -> impl Iterator<Item = String> {
        let left_out = (self.left_out > 0).then(|| {
            format!(
                "{} left out, with another force but the sample of the row before: are there more \
                 than {} samples per second? then give --rate-hz R",
                counted(self.left_out, "row"),
                significant(rate_hz)
            )
        });
        let held = self.samples().map(|samples| {
            format!(
                "the force stays the same over {samples} samples each time: what gives it is slower \
                 than the log, and the coefficients are doubtful; give the log thinned to {:.3} Hz",
                rate_hz / samples as f64
            )
        });
        left_out.into_iter().chain(held)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floe_core::Newtons;

    fn samples(forces: impl Iterator<Item = f32>) -> Option<usize> {
        let mut held = Held::default();
        let readings = (0..).zip(forces.map(|force| Reading::Force(Newtons(force))));
        readings.for_each(|(index, reading)| {
            held.push(index, reading);
            held.push(index, reading);
        });
        held.samples()
    }

    #[test]
    fn a_row_without_a_sample_of_its_own_is_said_if_its_force_is() {
        let mut held = Held::default();
        for (index, force_n) in [(0, 1.0), (0, 1.0), (1, 2.0), (1, 3.0), (1, 2.0)] {
            held.push(index, Reading::Force(Newtons(force_n)));
        }
        let said = held.warnings(16.0).collect::<Vec<_>>().concat();
        assert!(said.starts_with("1 row left out, with another force"), "{said}");
    }

    #[test]
    fn a_display_that_holds_is_told_from_a_coarse_converter() {
        assert_eq!(samples((0..900_u16).map(|i| f32::from(i / 10))), Some(10));
        assert_eq!(samples((0..900_u16).map(|i| f32::from(i / 2))), Some(2));
        assert_eq!(samples((0..900_u16).map(f32::from)), None);
        // One step per sample or two.
        assert_eq!(samples((0..900_u16).map(|i| f32::from(i * 10 / 16))), None);
        // Slowly up in steps of four samples, then down at once.
        let saw = |i: u16| if i % 100 < 80 { (i % 100) / 4 } else { 100 - i % 100 };
        assert_eq!(samples((0..9000).map(|i| f32::from(saw(i)))), None);
        assert_eq!(samples((0..900).map(|_| 0.0)), None);
    }
}
