//! A slip between two stick lines, gathered sample by sample.

use crate::detector::{Extreme, Stick};
use crate::fit::{Data, Fitting, Prior, Samples};
use crate::line::Line;
use crate::math;
use crate::model::Cycle;
use crate::window::Window;

/// Most sampling periods between the two stick lines.
const CORE: usize = 96;

/// A slip whose stick line after it is still growing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pending {
    /// Index at time zero of the samples and of `before`.
    pub(crate) origin: u64,
    pub(crate) before: Line,
    /// The samples between the lines; NaN: missing.
    forces_n: [f32; CORE],
    /// Time of the first of them, and how many there are.
    start: f32,
    length: usize,
    pub(crate) peak: Extreme,
    pub(crate) low: Extreme,
    /// What the extremes alone tell, for a slip that the samples hardly resolve.
    pub(crate) rough: Rough,
    /// Rough variance of the noise, from the detector, N².
    pub(crate) noise_n2: f32,
    /// Samples that tell as much as one with an error of its own.
    pub(crate) inflation: f32,
    /// A saturated sample, or too many missing ones, between the lines.
    pub(crate) hidden: bool,
    /// The cycle as far as it was known before the stick line after it.
    pub(crate) early: Option<Cycle>,
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
        let mut before = stick.line;
        before.shift(since(stick.origin, first));
        let mut pending = Self {
            origin: first,
            before,
            forces_n: [f32::NAN; CORE],
            start: since(first, start),
            length: 0,
            peak,
            low,
            rough: Rough::new(stick, window, (peak, low)),
            noise_n2: 0.0,
            inflation: 1.0,
            hidden: false,
            early: None,
        };
        pending.take(window, start, now);
        pending.rough.middle = pending.crossing();
        let missing = (first..=now).filter(|&index| window.get(index).is_none()).count();
        pending.hidden = missing > 3 || pending.length == CORE;
        pending
    }

    /// Takes the samples `from`, right after those that were taken, to `to`, as many as fit.
    fn take(&mut self, window: &Window, from: u64, to: u64) {
        for index in from..=to {
            let Some(entry) = self.forces_n.get_mut(self.length) else { return };
            *entry = window.get(index).unwrap_or(f32::NAN);
            self.length += 1;
        }
    }

    /// The samples between the lines.
    pub(crate) fn samples(&self) -> Samples<'_> {
        let forces_n = self.forces_n.get(..self.length).unwrap_or_default();
        Samples { start: self.start, forces_n }
    }

    /// Ends the event before the next one's slip begins, a little before its highest
    /// sample; a stick too brief for a line gives its samples one by one.
    pub(crate) fn end_before(&mut self, stick: &Stick, window: &Window, next_peak: u64) {
        let periods = |time: f32| time as i64;
        if stick.first().count == 0 {
            let next = self.origin.saturating_add_signed(periods(self.start)) + self.length as u64;
            self.take(window, next, next_peak.saturating_sub(1));
        }
        let peak_time = self.early.map_or(0.0, |cycle| cycle.peak_time());
        let end = since(self.origin, next_peak) - peak_time - self.start;
        self.length = self.length.min(libm::ceilf(end).max(0.0) as usize);
    }

    /// Begins a fit where an earlier one ended, else at a guess.
    pub(crate) fn begin(&self, data: &Data<'_>, known_swing: bool) -> Fitting {
        Fitting::new(data, &self.early.unwrap_or_else(|| self.guess(data, known_swing)))
    }

    /// A first guess: the lines' level and slope, half-way down in time, and the
    /// slip's length that fits best of a few.
    fn guess(&self, data: &Data<'_>, known_swing: bool) -> Cycle {
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
            return with_slide((core::f32::consts::PI + 2.0 * phase) * data.swing.mean);
        }
        let fall = (self.low.index - self.peak.index) as f32;
        let with_part = |part: f32| with_slide((part * fall).max(0.5));
        [0.6, 0.8, 1.25, 1.6].map(with_part).into_iter().fold(with_part(1.0), |best, other| {
            if data.cost(&other) < data.cost(&best) { other } else { best }
        })
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
    fn crossing(&self) -> f32 {
        let half_n = 0.5 * (self.peak.force_n + self.low.force_n);
        let peak_time = since(self.origin, self.peak.index);
        let mut before = None;
        for (time, force_n) in self.samples().good() {
            match before {
                Some((earlier, from_n)) if time > peak_time && force_n < half_n => {
                    return time - (time - earlier) * (half_n - force_n) / (from_n - force_n);
                }
                _ => before = Some((time, force_n)),
            }
        }
        0.5 * (peak_time + since(self.origin, self.low.index))
    }
}

/// Periods from an origin to an index, which may lie before it.
pub(crate) fn since(origin: u64, index: u64) -> f32 {
    index.wrapping_sub(origin).cast_signed() as f32
}
