//! Readings repeated because a display is read faster than it changes, rows without a reading because
//! something else is read more often, and samples left out because they come too fast.

use floe_core::Reading;

use crate::rounding::{counted, significant};

/// Longest run of equal readings that is distinguished.
const LONGEST: usize = 256;
/// Smallest number of runs for a conclusion.
const ENOUGH: u64 = 40;

/// Number of runs by their length in samples.
#[derive(Clone, Debug)]
struct Runs([u64; LONGEST]);

impl Default for Runs {
    fn default() -> Self {
        Self([0; LONGEST])
    }
}

impl Runs {
    fn push(&mut self, length: usize) {
        if let Some(runs) = self.0.get_mut(length) {
            *runs += u64::from(length > 0);
        }
    }

    /// The length of nearly all runs, if it is more than one sample.
    fn usual(&self) -> Option<usize> {
        const SHORTEST: usize = 2;
        let all = self.0.iter().sum::<u64>();
        let (usual, _) = self.0.iter().enumerate().max_by_key(|(_, runs)| **runs)?;
        // With runs of two samples, one and three differ too much to be counted as equal.
        let beside = usize::from(usual > SHORTEST);
        let near = self.0.get(usual.saturating_sub(beside)..=usual + beside)?.iter().sum::<u64>();
        (usual >= SHORTEST && all >= ENOUGH && near * 10 >= all * 9).then_some(usual)
    }
}

/// Counts runs of equal readings, samples from one reading to the next, and readings without a
/// sample of their own.
#[derive(Clone, Debug, Default)]
pub struct Held {
    last: Option<Reading>,
    index: Option<u32>,
    length: usize,
    equal: Runs,
    read: Option<u32>,
    apart: Runs,
    left_out: u64,
}

impl Held {
    /// Takes a reading; a repeated row with the index of the previous one is skipped.
    pub fn push(&mut self, index: u32, reading: Reading) {
        if self.index.replace(index) == Some(index) {
            self.left_out += u64::from(self.last != Some(reading));
            return;
        }
        if !matches!(reading, Reading::Bad(_)) {
            let last = self.read.replace(index);
            self.apart.push(last.map_or(0, |last| index.saturating_sub(last) as usize));
        }
        if self.last == Some(reading) {
            self.length += 1;
            return;
        }
        self.equal.push(self.length);
        (self.last, self.length) = (Some(reading), 1);
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
        // With a coarse converter the runs become shorter the faster the force changes.
        let held = self.equal.usual().map(|samples| {
            format!(
                "the force stays the same over {samples} samples each time: what gives it is slower \
                 than the log, and the coefficients are doubtful; give the log thinned to {:.3} Hz",
                rate_hz / samples as f64
            )
        });
        let apart = self.apart.usual().map(|samples| {
            format!(
                "one sample in {samples} has a force: if the rows between are of another sensor, \
                 leave them out; then there are {:.3} samples per second",
                rate_hz / samples as f64
            )
        });
        left_out.into_iter().chain(held).chain(apart)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use floe_core::{Fault, Newtons};

    fn samples(forces: impl Iterator<Item = f32>) -> Option<usize> {
        let mut held = Held::default();
        let readings = (0..).zip(forces.map(|force| Reading::Force(Newtons(force))));
        readings.for_each(|(index, reading)| {
            held.push(index, reading);
            held.push(index, reading);
        });
        held.equal.usual()
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
    fn rows_without_a_force_between_those_with_one_are_said() {
        let said = |is_force: fn(u16) -> bool| {
            let mut held = Held::default();
            for index in 0..900 {
                let reading = Reading::Force(Newtons(f32::from(index)));
                let bad = Reading::Bad(Fault::Sentinel);
                held.push(index.into(), if is_force(index) { reading } else { bad });
            }
            held.warnings(160.0).collect::<Vec<_>>().concat()
        };
        let said_10 = said(|index| index % 10 == 0);
        assert!(said_10.starts_with("one sample in 10 has a force: if the rows"), "{said_10}");
        assert!(said_10.ends_with("then there are 16.000 samples per second"), "{said_10}");
        assert!(said(|index| index % 2 == 1).starts_with("one sample in 2"));
        for is_force in [|_| true, |index| index % 2 == 0 || index % 5 == 0, |index| index % 5 > 0]
        {
            assert_eq!(said(is_force), "");
        }
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
