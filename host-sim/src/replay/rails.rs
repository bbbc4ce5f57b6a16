//! Forces at the limit of a sensor or a converter, found where the log states no range.

/// Distinct largest forces that are counted.
const LEVELS: usize = 16;
/// The largest force is a limit if it occurs this many times as often as any other level: in a
/// record of coarse steps all levels occur often, the largest one less than the others.
const MORE_OFTEN: u64 = 4;
/// Fewest samples at a limit that the force leapt to.
const FEWEST: u64 = 8;
/// A lowest force below this share of the largest one is that of a cable without a load, no limit.
const UNLOADED: f32 = 0.1;

/// Search for a limit at either end of a record's forces.
#[derive(Clone, Debug, Default)]
pub struct Rails {
    highest: Highest,
    /// Of the negated forces.
    lowest: Highest,
}

/// The largest forces and their counts.
#[derive(Clone, Debug, Default)]
struct Highest {
    /// Levels in descending order of force.
    levels: Vec<Level>,
    /// The last two forces, the newer one first.
    last_n: [f32; 2],
    /// Whether the last rise was a leap (see [`Level::leapt`]).
    leapt: bool,
}

#[derive(Clone, Copy, Debug)]
struct Level {
    force_n: f32,
    samples: u64,
    /// Samples reached by a leap: from below the next level, or by rising for two samples. A force
    /// at rest between two steps of the converter only alternates with the next level.
    leapt: u64,
}

impl Rails {
    /// Takes the next force.
    pub fn push(&mut self, force_n: f32) {
        self.highest.push(force_n);
        self.lowest.push(-force_n);
    }

    /// One sentence for each end at a limit.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let ends = [(&self.highest, 1.0), (&self.lowest, -1.0)];
        let forces = ends.iter().filter_map(|(end, _)| end.levels.first());
        let largest_n = forces.map(|level| level.force_n.abs()).fold(0.0, f32::max);
        let reached = ends.iter().filter_map(|(end, sign)| Some((end.rail()?, *sign)));
        reached
            .filter(|(level, _)| level.force_n.abs() > UNLOADED * largest_n)
            .map(|(level, sign)| {
                let remedy = if level.force_n < largest_n {
                    "if so, what is lower is lost, and the coefficients of those slips with it".to_string()
                } else {
                    format!("if so, give --range-n {largest_n}, or '# range_n: {largest_n}' in the log")
                };
                format!(
                    "{} samples lie exactly at {} N, and none beyond: the sensor or the converter may \
                     have been at its limit; {remedy}",
                    level.samples,
                    sign * level.force_n
                )
            })
            .collect()
    }
}

impl Highest {
    fn push(&mut self, force_n: f32) {
        let [last_n, before_n] = self.last_n;
        self.last_n = [force_n, last_n];
        // Nearly every force lies below all levels that are kept.
        if self.levels.get(LEVELS - 1).is_some_and(|lowest| force_n < lowest.force_n) {
            return;
        }
        let place = self.levels.partition_point(|level| level.force_n > force_n);
        if self.levels.get(place).is_none_or(|level| level.force_n < force_n) {
            self.levels.insert(place, Level { force_n, samples: 0, leapt: 0 });
            self.levels.truncate(LEVELS);
        }
        if last_n < force_n {
            let from_below = self.levels.get(1).is_some_and(|next| last_n < next.force_n);
            self.leapt = from_below || before_n < last_n;
        }
        if let Some(level) = self.levels.get_mut(place) {
            level.samples += 1;
            level.leapt += u64::from(self.leapt);
        }
    }

    /// The highest level, if it is a limit.
    fn rail(&self) -> Option<Level> {
        let (highest, others) = self.levels.split_first()?;
        let usual = others.iter().map(|level| level.samples).max().unwrap_or(0);
        (highest.leapt >= (MORE_OFTEN * usual).max(FEWEST)).then_some(*highest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn warnings(forces_n: impl Iterator<Item = f32>) -> Vec<String> {
        let mut rails = Rails::default();
        forces_n.for_each(|force_n| rails.push(force_n));
        rails.warnings()
    }

    /// A sawtooth from 200 N up, quantized in steps, no two teeth equal.
    fn saw(step_n: f32) -> impl Iterator<Item = f32> {
        let tooth = |i: u16| (f32::from(i) * 22.5) % 571.3 + 200.0;
        (0..2000).map(move |i| (tooth(i) / step_n).round() * step_n)
    }

    #[test]
    fn a_force_that_stops_at_a_limit_is_told_from_coarse_steps() {
        assert!(warnings(saw(100.0)).is_empty());
        for step_n in [0.1, 1.0, 5.0, 20.0] {
            assert!(warnings(saw(step_n)).is_empty(), "{step_n} N");
            let cut = warnings(saw(step_n).map(|force_n| force_n.min(500.0)));
            assert!(matches!(&cut[..], [it] if it.contains("--range-n 500,")), "{cut:?}");
        }
        let turned = warnings(saw(0.1).map(|force_n| -force_n.min(650.0)));
        let words = ["exactly at -650 N", "--range-n 650,"];
        assert!(matches!(&turned[..], [it] if words.iter().all(|w| it.contains(w))), "{turned:?}");
        let below = warnings(saw(0.1).map(|force_n| force_n.max(260.0)));
        assert!(matches!(&below[..], [it] if it.contains("what is lower is lost")), "{below:?}");
    }

    #[test]
    fn a_force_that_rests_is_at_no_limit() {
        let between = |i: u16| if i % 7 == 3 { 630.0 } else { 640.0 };
        assert!(warnings((0..2000).map(between)).is_empty());
        let slack = |force_n: f32| if force_n < 400.0 { 5.0 } else { force_n };
        assert!(warnings(saw(5.0).map(slack)).is_empty());
        let held = |i: u16| if i < 29 { f32::from(i) * 140.0 } else { 4095.0 };
        assert_eq!(warnings((0..3840).map(held)).len(), 1);
    }
}
