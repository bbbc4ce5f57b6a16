//! A slip between two stick lines, gathered sample by sample.

use crate::detector::{Extreme, Stick};
use crate::fit::{Data, Fit, Point, Prior};
use crate::line::Line;
use crate::math;
use crate::model::Cycle;
use crate::window::{WINDOW, Window};

/// Most samples between the two stick lines.
const CORE: usize = 96;

/// A slip whose stick line after it is still growing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pending {
    /// Index at time zero of the points and of `before`.
    pub(crate) origin: u64,
    pub(crate) before: Line,
    pub(crate) points: [Point; CORE],
    pub(crate) length: usize,
    pub(crate) peak: Extreme,
    pub(crate) low: Extreme,
    /// What the extremes alone tell, for a slip that the samples hardly resolve.
    pub(crate) rough: Rough,
    /// Rough variance of the noise, from the detector, N².
    pub(crate) noise_n2: f32,
    pub(crate) fit: Option<Fit>,
    /// A saturated sample, or too many missing ones, between the lines.
    pub(crate) hidden: bool,
}

/// Loading rate, N per period, to within a factor of two, and the time of the slip.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Rough {
    pub(crate) rate: f32,
    /// Time of sliding and its standard deviation, periods.
    pub(crate) slide: f32,
    pub(crate) slide_std: f32,
    /// Half-way down, periods from the event's origin.
    pub(crate) middle: f32,
}

impl Rough {
    /// The loading rate from the line, or from the rise to the highest sample; the
    /// time of the slip from the samples in between.
    fn new(stick: &Stick, window: &Window, (peak, low): (Extreme, Extreme)) -> Self {
        let rise = |back: u64| {
            let force_n = window.get(peak.index.checked_sub(back)?)?;
            Some((peak.force_n - force_n) / back as f32)
        };
        let climb = rise(2).into_iter().chain(rise(1)).reduce(f32::max);
        let line = stick.line.slope().filter(|_| stick.line.count >= 4);
        let least = 1e-4 * (peak.force_n - low.force_n);
        let rate = line.or(climb).unwrap_or(0.0).max(least);
        // The slip began after the last sample before it and ended before the first
        // one after it: a uniform distribution, wider for slow ends of long slips.
        let fall = (low.index - peak.index) as f32;
        let (slide, slide_std) =
            if fall < 1.5 { (0.5, 0.3 + 0.25) } else { (fall - 1.0, 0.6 + 0.25 * fall) };
        // From the highest to the lowest force the slide turns by π, in all by π + 2 φ.
        let turn = core::f32::consts::FRAC_2_PI * fall / (peak.force_n - low.force_n);
        let longer = 1.0 + core::f32::consts::FRAC_2_PI * math::atan2(rate * turn, 1.0);
        Self { rate, slide: slide * longer, slide_std: slide_std * longer, middle: 0.0 }
    }

    /// The slip lies around its middle: as much as one sample in between can tell,
    /// for the slips that have no more.
    pub(crate) fn onset(&self, noise_n2: f32) -> Prior {
        let spread = 0.3 * self.slide.max(1.0);
        Prior { mean: self.middle - 0.5 * self.slide, weight: noise_n2 / (spread * spread) }
    }
}

impl Pending {
    pub(crate) fn new(
        stick: &Stick,
        start: u64,
        window: &Window,
        now: u64,
        (peak, low): (Extreme, Extreme),
    ) -> Self {
        let first = stick.next;
        let mut pending = Self {
            origin: first,
            before: stick.line_from(first),
            points: [Point::default(); CORE],
            length: 0,
            peak,
            low,
            rough: Rough::new(stick, window, (peak, low)),
            noise_n2: 0.0,
            fit: None,
            hidden: false,
        };
        pending.take(window, start, now);
        pending.rough.middle = pending.crossing();
        let missing = (first..=now).filter(|&index| window.get(index).is_none()).count();
        pending.hidden = missing > 3 || pending.length == CORE;
        pending
    }

    /// Takes the samples `from` to `to`, as many as fit.
    fn take(&mut self, window: &Window, from: u64, to: u64) {
        for index in from.max(to.saturating_sub(WINDOW as u64))..=to {
            let Some(force_n) = window.get(index) else { continue };
            let Some(point) = self.points.get_mut(self.length) else { return };
            *point = Point { time: since(self.origin, index), force_n, weight: 1.0 };
            self.length += 1;
        }
    }

    /// Ends the event before the next one's peak; a stick too brief for a line
    /// gives its samples one by one.
    pub(crate) fn end_before(&mut self, stick: &Stick, window: &Window, next_peak: u64) {
        if stick.first_from(stick.origin).count == 0 {
            let last = self.points.get(..self.length).and_then(<[Point]>::last);
            let next =
                last.map_or(0, |point| self.origin.saturating_add_signed(point.time as i64) + 1);
            self.take(window, next, next_peak.saturating_sub(1));
        }
        let end = since(self.origin, next_peak) - self.fit.map_or(0.0, |fit| fit.cycle.peak_time());
        let points = self.points.get(..self.length).unwrap_or_default();
        self.length = points.iter().take_while(|point| point.time < end).count();
    }

    /// A first guess: the lines' level and slope, half-way down in time, and the
    /// slip's length that fits best of a few.
    pub(crate) fn guess(&self, data: &Data<'_>, known_swing: bool) -> Option<Cycle> {
        let drop = self.peak.force_n - self.low.force_n;
        let rate = data.rate.mean;
        let half_drop_n = 0.5 * drop;
        let middle = self.rough.middle;
        let with_slide = |slide: f32| {
            let phase = math::atan2(rate * slide, core::f32::consts::PI * half_drop_n);
            let onset = middle - 0.5 * slide;
            let static_n = if self.before.count >= 3 {
                self.before.at(onset, rate)
            } else {
                self.peak.force_n
            };
            let omega = (core::f32::consts::PI + 2.0 * phase) / slide;
            Cycle { onset, rate, static_n, half_drop_n, omega, bend: 0.0 }
        };
        if known_swing {
            let phase = math::atan2(rate * data.swing.mean, half_drop_n);
            return Some(with_slide((core::f32::consts::PI + 2.0 * phase) * data.swing.mean));
        }
        let fall = (self.low.index - self.peak.index) as f32;
        [0.6, 0.8, 1.0, 1.25, 1.6]
            .map(|part| with_slide((part * fall).max(0.5)))
            .into_iter()
            .min_by(|a, b| data.cost(a).total_cmp(&data.cost(b)))
    }

    /// Is a fitted cycle the slip that the samples show? Its ends lie within half the
    /// drop and the rise of two periods of the highest and the lowest sample.
    pub(crate) fn holds(&self, cycle: &Cycle) -> bool {
        let (peak_n, low_n) = (self.peak.force_n, self.low.force_n);
        let far_n = 0.5 * (peak_n - low_n) + 2.0 * cycle.rate;
        let is_near = |a: f32, b: f32| (a - b).abs() < far_n;
        is_near(cycle.static_n, peak_n) && is_near(cycle.restick_n(), low_n)
    }

    /// Time at which the samples fall through half the drop.
    pub(crate) fn crossing(&self) -> f32 {
        let half_n = 0.5 * (self.peak.force_n + self.low.force_n);
        let points = self.points.get(..self.length).unwrap_or_default();
        let peak_time = since(self.origin, self.peak.index);
        let falls =
            |pair: &&[Point]| pair.last().is_some_and(|p| p.time > peak_time && p.force_n < half_n);
        match points.windows(2).find(falls) {
            Some([a, b]) => {
                b.time - (b.time - a.time) * (half_n - b.force_n) / (a.force_n - b.force_n)
            }
            _ => 0.5 * (peak_time + since(self.origin, self.low.index)),
        }
    }
}

/// Periods from an origin to an index, which may lie before it.
pub(crate) fn since(origin: u64, index: u64) -> f32 {
    index.wrapping_sub(origin).cast_signed() as f32
}
