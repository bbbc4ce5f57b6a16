//! The last samples as points of the phase plane (F, F').

use super::method::Sample;

/// Number of samples kept, enough for a slip and its surroundings.
const KEPT: usize = 64;

/// A point of the phase plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Index of the sample.
    pub index: u32,
    /// `F`, N.
    pub force_n: f64,
    /// `F'` by central difference, N per period.
    pub rate_n: f64,
}

/// The last samples, newest last.
#[derive(Clone, Copy, Debug)]
pub struct History {
    samples: [Sample; KEPT],
    /// Number of samples seen, at most `KEPT`.
    length: usize,
    /// Index at which the next sample is stored.
    next: usize,
}

impl Default for History {
    fn default() -> Self {
        Self { samples: [Sample::default(); KEPT], length: 0, next: 0 }
    }
}

impl History {
    /// Takes a sample.
    pub fn push(&mut self, sample: Sample) {
        if let Some(place) = self.samples.get_mut(self.next) {
            *place = sample;
        }
        self.next = (self.next + 1) % KEPT;
        self.length = (self.length + 1).min(KEPT);
    }

    /// The samples from oldest to newest.
    fn iter(&self) -> impl Iterator<Item = Sample> + Clone + '_ {
        let first = (self.next + KEPT - self.length) % KEPT;
        self.samples.iter().cycle().skip(first).take(self.length).copied()
    }

    /// The points with index `from` or later, oldest first; the newest sample has no point yet.
    pub fn points(&self, from: u32) -> impl Iterator<Item = Point> + '_ {
        let triples = self.iter().zip(self.iter().skip(1)).zip(self.iter().skip(2));
        let point = |((a, b), c): ((Sample, Sample), Sample)| Point {
            index: b.index,
            force_n: f64::from(b.force_n),
            rate_n: f64::from(c.force_n - a.force_n) / f64::from(c.index - a.index),
        };
        triples.map(point).filter(move |point| point.index >= from)
    }

    /// Mean `F'` between two indices, N per period: the level of the stick line in the phase plane.
    #[must_use]
    pub fn level(&self, from: u32, to: u32) -> Option<f64> {
        let mut rest = self.iter().filter(|s| (from..=to).contains(&s.index));
        let first = rest.next()?;
        let last = rest.last()?;
        Some(f64::from(last.force_n - first.force_n) / f64::from(last.index - first.index))
    }
}
