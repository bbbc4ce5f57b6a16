//! A display that is read more often than it changes, and samples that come too often.

use floe_core::Reading;

use crate::rounding::{counted, significant};

/// Longest run of equal readings that is told apart.
const LONGEST: usize = 256;
/// Runs from which on they say something.
const ENOUGH: u64 = 40;

/// Counts how long readings stay the same, and those that have no sample of their own.
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
    /// The next reading; a row that is there twice, and has the index of the one before, is none.
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

    /// Samples after which the force changes, where nearly all runs are as long: a coarse converter
    /// changes faster the faster the force does.
    fn samples(&self) -> Option<usize> {
        const SHORTEST: usize = 2;
        let all = self.runs.iter().sum::<u64>();
        let (usual, _) = self.runs.iter().enumerate().max_by_key(|(_, runs)| **runs)?;
        // Beside two samples one is no longer held, and three are half as many again.
        let beside = usize::from(usual > SHORTEST);
        let near =
            self.runs.get(usual.saturating_sub(beside)..=usual + beside)?.iter().sum::<u64>();
        (usual >= SHORTEST && all >= ENOUGH && near * 10 >= all * 9).then_some(usual)
    }

    /// What to say of it.
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
        // One step in a sample or two.
        assert_eq!(samples((0..900_u16).map(|i| f32::from(i * 10 / 16))), None);
        // Up slowly in steps of four samples, down at once.
        let saw = |i: u16| if i % 100 < 80 { (i % 100) / 4 } else { 100 - i % 100 };
        assert_eq!(samples((0..9000).map(|i| f32::from(saw(i)))), None);
        assert_eq!(samples((0..900).map(|_| 0.0)), None);
    }
}
