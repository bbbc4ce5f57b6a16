//! Loops of the slips in the phase plane, and the methods that read them.
//!
//! `F'` is the central difference. The stick line is the mean `F'` at rest. A point clearly below
//! it belongs to the ellipse. The crossing of the line is interpolated between such a point and its
//! neighbour on the line.

use std::marker::PhantomData;

use super::cutter::{Cut, Cutter};
use super::history::{History, Point};
use super::method::{Found, Method, Sample, Setup, Tick};

/// Largest number of events over which the level of the stick line is averaged.
const MEMORY: f64 = 10.0;
/// Samples from the rise that shows the rest to the end of the loop.
const CLOSING: u32 = 2;
/// Depth below the stick line, as a fraction of the loop's depth, from which a point is off the
/// line.
const CLEARLY: f64 = 0.15;
/// Periods by which a loop may extend beyond its turning points.
const MARGIN: u32 = 4;

/// A loop that is not complete yet.
#[derive(Clone, Copy, Debug)]
struct Open {
    peak: Sample,
    low: Sample,
    /// Index at which the loop is read.
    until: u32,
}

/// A complete loop in the phase plane.
#[derive(Clone, Debug)]
pub struct Loop {
    /// Points from before the slip to after it.
    pub points: Vec<Point>,
    /// Index of the point with the smallest `F'`.
    pub bottom: usize,
    /// `F'` of the stick line, N per period.
    pub level_n: f64,
}

/// Collects loops.
#[derive(Clone, Copy, Debug)]
struct Loops {
    cutter: Cutter,
    history: History,
    open: Option<Open>,
    rest_from: u32,
    level_n: f64,
    levels: f64,
}

impl Loops {
    fn new(setup: &Setup) -> Self {
        Self {
            cutter: Cutter::new(setup),
            history: History::default(),
            open: None,
            rest_from: 0,
            level_n: 0.0,
            levels: 0.0,
        }
    }

    /// Takes a sample; returns a loop that is complete now.
    fn step(&mut self, sample: Sample) -> Option<Loop> {
        if !self.cutter.accepts(sample) {
            return None;
        }
        self.history.push(sample);
        if let Some(Cut::Rest { peak, low }) = self.cutter.step(sample) {
            self.see_level(peak);
            self.rest_from = sample.index + 1;
            self.open = Some(Open { peak, low, until: sample.index + CLOSING });
        }
        let open = self.open.filter(|open| sample.index >= open.until)?;
        self.open = None;
        self.read(&open)
    }

    fn see_level(&mut self, peak: Sample) {
        let Some(level_n) = self.history.level(self.rest_from, peak.index.saturating_sub(1)) else {
            return;
        };
        self.levels = (self.levels + 1.0).min(MEMORY);
        self.level_n += (level_n - self.level_n) / self.levels;
    }

    fn read(&self, open: &Open) -> Option<Loop> {
        let from = open.peak.index.saturating_sub(MARGIN);
        let points: Vec<Point> = self.history.points(from).collect();
        let falls = |p: &Point| (open.peak.index..=open.low.index).contains(&p.index);
        let lowest = points.iter().enumerate().filter(|(_, p)| falls(p));
        let bottom = lowest.min_by(|a, b| a.1.rate_n.total_cmp(&b.1.rate_n))?.0;
        Some(Loop { points, bottom, level_n: self.level_n })
    }
}

/// Intersection of the trajectory with the stick line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Force at the intersection, N.
    pub force_n: f64,
    /// Time from the start of the record, periods.
    pub time: f64,
}

impl Loop {
    /// Intersection between an outer point near the stick line and an inner one clearly below it.
    fn crossing(&self, outer: &Point, inner: &Point) -> Crossing {
        let part = ((self.level_n - inner.rate_n) / (outer.rate_n - inner.rate_n)).min(1.0);
        let between = |inner: f64, outer: f64| inner + part * (outer - inner);
        Crossing {
            force_n: between(inner.force_n, outer.force_n),
            time: between(inner.index as f64, outer.index as f64),
        }
    }

    /// Indices of the first and last point clearly below the stick line.
    fn inside(&self) -> Option<(usize, usize)> {
        let lowest_n = self.points.get(self.bottom)?.rate_n;
        let clearly_n = self.level_n - CLEARLY * (self.level_n - lowest_n);
        let above = |p: &Point| p.rate_n >= clearly_n;
        let first = self.points.get(..self.bottom)?.iter().rposition(above)? + 1;
        let last = self.bottom + self.points.get(self.bottom..)?.iter().position(above)?;
        (first < last).then_some((first, last - 1))
    }

    /// Points clearly below the stick line.
    #[must_use]
    pub fn ellipse(&self) -> &[Point] {
        let inside = self.inside().and_then(|(first, last)| self.points.get(first..=last));
        inside.unwrap_or_default()
    }

    /// Intersections where the trajectory leaves the stick line and where it returns.
    #[must_use]
    pub fn ends(&self) -> Option<(Crossing, Crossing)> {
        let (first, last) = self.inside()?;
        let point = |place: usize| self.points.get(place);
        Some((
            self.crossing(point(first.checked_sub(1)?)?, point(first)?),
            self.crossing(point(last + 1)?, point(last)?),
        ))
    }

    /// Time at which the trajectory leaves the stick line, or else of the steepest fall, periods.
    #[must_use]
    pub fn onset(&self) -> f64 {
        let bottom = self.points.get(self.bottom).map_or(0.0, |p| p.index as f64);
        self.ends().map_or(bottom, |(start, _)| start.time)
    }
}

/// A method for reading a loop.
pub trait LoopReading {
    /// Name in the tables.
    const NAME: &'static str;

    /// `Fs` and `Fp`, N, if the loop shows them.
    fn forces_n(found: &Loop) -> Option<(f64, f64)>;
}

/// A method that applies one reading to every loop.
#[derive(Clone, Copy, Debug)]
pub struct OfLoops<R> {
    setup: Setup,
    loops: Loops,
    reading: PhantomData<R>,
}

impl<R: LoopReading> Method for OfLoops<R> {
    const NAME: &'static str = R::NAME;

    fn new(setup: &Setup) -> Self {
        Self { setup: *setup, loops: Loops::new(setup), reading: PhantomData }
    }

    fn step(&mut self, sample: Sample) -> Tick {
        let event = self.loops.step(sample).map(|found| self.read(&found));
        Tick { slips: self.loops.cutter.slips(), event }
    }

    fn state_bytes(&self) -> usize {
        size_of::<Self>()
    }
}

impl<R: LoopReading> OfLoops<R> {
    fn read(&self, found: &Loop) -> Found {
        let forces_n = R::forces_n(found);
        let coefficient = |force_n: f64| self.setup.value(force_n, None);
        Found {
            onset_s: found.onset() / self.setup.rate_hz,
            mu_s: forces_n.and_then(|(static_n, _)| coefficient(static_n)),
            mu: forces_n.and_then(|(_, dynamic_n)| coefficient(dynamic_n)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crossings_are_interpolated() {
        let point = |index, force_n, rate_n| Point { index, force_n, rate_n };
        let found = Loop {
            points: vec![
                point(0, 700.0, 20.0),
                point(1, 720.0, 20.0),
                point(2, 700.0, -60.0),
                point(3, 500.0, -200.0),
                point(4, 300.0, -60.0),
                point(5, 280.0, 30.0),
            ],
            bottom: 3,
            level_n: 20.0,
        };
        assert_eq!(found.ellipse().len(), 3);
        let (start, end) = found.ends().unwrap();
        assert!((start.force_n - 720.0).abs() < 1e-9 && (start.time - 1.0).abs() < 1e-9);
        assert!((end.force_n - (300.0 - 20.0 * 80.0 / 90.0)).abs() < 1e-9);
    }
}
