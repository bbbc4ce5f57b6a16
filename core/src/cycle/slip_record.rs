//! A slip between two stick lines, gathered sample by sample.

use crate::detector::Stick;
use crate::event::Reason;
use crate::fit::{Data, Fitting, Samples};
use crate::model::CycleParams;
use crate::noise::ripple::ColoredNoise;
use crate::num::math;
use crate::sample::{ForcePoint, since};
use crate::signal::window::Window;
use crate::stats::line::Line;
use crate::stats::prior::Prior;

const PI: f32 = core::f32::consts::PI;

/// Most sampling periods between the two stick lines.
const CORE: usize = 96;

/// What is not known, periods, of onset and stop before the last fit of a slip that is hardly
/// resolved.
pub(crate) const UNSURE: f32 = 0.25;

/// A slip whose stick line after it is still growing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SlipRecord {
    /// Index at time zero of the samples and of `before`.
    pub(crate) origin: u64,
    pub(crate) before: Line,
    /// The samples between the lines; NaN: missing.
    forces_n: [f32; CORE],
    /// Time of the first of them, and how many there are.
    start: f32,
    length: usize,
    pub(crate) peak: ForcePoint,
    pub(crate) low: ForcePoint,
    /// What the extremes alone tell, for a slip that the samples hardly resolve.
    rough: Rough,
    /// Rough variance of the noise, from the detector, N².
    pub(crate) noise_n2: f32,
    /// How far the force wanders about its stick lines.
    pub(crate) wander: ColoredNoise,
    /// Weight of the samples after the stop, and from when on they have it.
    pub(crate) rest_weight: f32,
    rest_from: f32,
    /// The rate of the rest before it broke off.
    pub(crate) broken: bool,
    /// A saturated sample, or too many missing ones, between the lines.
    pub(crate) hidden: bool,
    /// The cycle as far as it was known before the stick line after it.
    pub(crate) early: Option<CycleParams>,
    /// Where the event ends at the latest, periods: the next slip's highest sample.
    pub(crate) limit: f32,
    /// Why it is not even fitted.
    pub(crate) refused: Option<Reason>,
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
    /// The last sample before that which is still high, and the first one after it which is
    /// low: the highest and the lowest sample may lie anywhere on a slow line.
    edges: (f32, f32),
}

/// A slip that ended on a slack cable.
#[derive(Clone, Copy, Debug)]
struct Slack {
    /// `Fp`, N.
    centre_n: f32,
    /// Part of the half turn from the largest force to the smallest up to `F = 0`.
    part: f32,
}

impl Rough {
    /// The loading rate from the line, or from the rise to the highest sample; the
    /// time of the slip from the samples in between.
    fn new(stick: &Stick, window: &Window, (peak, low): (ForcePoint, ForcePoint)) -> Self {
        let rise = |back: u64| {
            let force_n = window.get(peak.index.checked_sub(back)?)?;
            Some((peak.force_n - force_n) / back as f32)
        };
        let climb = rise(2).into_iter().chain(rise(1)).reduce(f32::max);
        let line = stick.line.slope().filter(|_| stick.line.count >= 4);
        let least = 1e-4 * (peak.force_n - low.force_n);
        let rate = line.or(climb).unwrap_or(0.0).max(least);
        // The force turns faster on the slip's side: of the two samples around each end of the
        // slip the outer one is the highest, or the lowest, more often. Wider for slow ends of
        // long slips.
        let fall = since(peak.index, low.index);
        let (slide, slide_std) = (fall - 0.4, 0.3 + 0.25 * fall);
        // From the highest to the lowest force the slide turns by π, in all by π + 2 φ.
        let turn = core::f32::consts::FRAC_2_PI * fall / (peak.force_n - low.force_n);
        let longer = 1.0 + core::f32::consts::FRAC_2_PI * math::atan2(rate * turn, 1.0);
        Self { rate, slide: slide * longer, slide_std: slide_std * longer, ..Self::default() }
    }

    /// The slip lies around its middle: as much as one sample in between can tell,
    /// for the slips that have no more.
    pub(crate) fn onset(&self, noise_n2: f32) -> Prior {
        let spread = 0.3 * self.slide.max(1.0);
        Prior { mean: self.middle - 0.5 * self.slide, weight: noise_n2 / (spread * spread) }
    }
}

impl SlipRecord {
    pub(crate) fn new(
        stick: &Stick,
        start: u64,
        window: &Window,
        now: u64,
        (peak, low): (ForcePoint, ForcePoint),
        noise_n: f32,
    ) -> Self {
        let first = stick.next;
        let mut pending = Self {
            origin: first,
            before: stick.line_from(first),
            forces_n: [f32::NAN; CORE],
            start: since(first, start),
            length: 0,
            peak,
            low,
            rough: Rough::new(stick, window, (peak, low)),
            noise_n2: noise_n * noise_n,
            wander: ColoredNoise::NONE,
            rest_weight: 1.0,
            rest_from: since(first, low.index),
            broken: stick.broken,
            hidden: false,
            early: None,
            limit: f32::MAX,
            refused: None,
        };
        pending.take(window, start, now);
        pending.rough.middle = pending.crossing();
        pending.rough.edges = pending.edges();
        let missing = (first..=now).filter(|&index| window.get(index).is_none()).count();
        pending.hidden = missing > 3 || pending.length == CORE;
        pending
    }

    /// Takes the cycle of the first answer.
    pub(crate) fn know(&mut self, cycle: CycleParams) {
        if self.rest_weight < 1.0 {
            self.rest_from = cycle.shape().stop() - UNSURE;
        }
        self.early = Some(cycle);
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
        let (rest_weight, rest_from) = (self.rest_weight, self.rest_from);
        let extremes = || (since(self.origin, self.peak.index), since(self.origin, self.low.index));
        let slip = self.early.map_or_else(extremes, |cycle| (cycle.onset, cycle.shape().stop()));
        Samples { rest_weight, rest_from, slip, ..Samples::new(self.start, forces_n) }
    }

    /// Ends the event before the next one's slip begins, a little before its highest
    /// sample; a stick too brief for a line gives its samples one by one.
    pub(crate) fn end_before(&mut self, stick: &Stick, window: &Window, next_peak: u64) {
        let periods = |time: f32| time as i64;
        if stick.first_from(stick.origin).count == 0 {
            let next = self.origin.saturating_add_signed(periods(self.start)) + self.length as u64;
            self.take(window, next, next_peak.saturating_sub(1));
        }
        let peak_time = self.early.map_or(0.0, |cycle| cycle.peak_time());
        self.limit = since(self.origin, next_peak);
        let end = self.limit - peak_time - self.start;
        self.length = self.length.min(libm::ceilf(end).max(0.0) as usize);
    }

    /// The stick line after the slip, up to the last index before the next onset: the
    /// detector's stays behind.
    pub(crate) fn line_after(&self, stick: &Stick, window: &Window, last: Option<u64>) -> Line {
        let mut line = stick.first_from(self.origin);
        // Of slips on a slack cable the first answers are rough.
        let is_straight = self.has_straight(stick, &line) && self.slack(&line).is_none();
        if let Some(last) = last.filter(|_| is_straight) {
            for index in window.first_from(stick.next)..=last {
                if let Some(force_n) = window.get(index) {
                    line.add(since(self.origin, index), force_n, 1.0, 1.0);
                }
            }
        }
        line
    }

    /// Begins the stick line before the slip with the samples from the stop of the slip before
    /// up to the re-stick, which the detector sees later. Where the cable flops, or was
    /// slack, they are not on the line.
    pub(crate) fn lengthen_line(&mut self, previous: &Self, stick: &Stick) {
        let was_slack = previous.slack(&stick.first_from(previous.origin)).is_some();
        let is_steady = self.rest_weight >= 1.0 && self.has_straight(stick, &self.before);
        let Some(early) = previous.early.filter(|_| is_steady && !was_slack) else { return };
        let (stop, end) = (early.shape().stop() + UNSURE, since(previous.origin, stick.origin));
        let later = since(self.origin, previous.origin);
        for (time, force_n) in previous.samples().good() {
            if time > stop && time < end {
                self.before.add(time + later, force_n, 1.0, 1.0);
            }
        }
    }

    /// Is there a line, of samples that differ from it by noise alone?
    fn has_straight(&self, stick: &Stick, line: &Line) -> bool {
        stick.straight && line.count > 0 && self.wander.level <= 0.0
    }

    /// Begins a fit where an earlier one ended, else at a guess.
    pub(crate) fn begin(&self, data: &Data<'_>, known_swing: bool) -> Fitting {
        // Without the line after it a slip on a slack cable is hardly determined.
        let early = self.early.filter(|_| self.slack(data.after).is_none());
        early.map_or_else(|| self.guess(data, known_swing), |early| Fitting::new(&early))
    }

    /// Begins at a guess: the lines' level and slope, half-way down in time, and the
    /// slip's length that fits best of a few.
    fn guess(&self, data: &Data<'_>, known_swing: bool) -> Fitting {
        let (peak_n, low_n) = (self.peak.force_n, self.low.force_n);
        let slack = self.slack(data.after);
        let centre_n = slack.map_or(0.5 * (peak_n + low_n), |slack| slack.centre_n);
        let half_drop_n = peak_n - centre_n;
        let rate = data.rate.mean;
        let with_swing = |inverse_omega: f32| {
            let phase = math::atan2(rate * inverse_omega, half_drop_n);
            let amplitude_n = half_drop_n / math::sin_cos(phase).1;
            let half_way = phase + math::acos((0.5 * (peak_n + low_n) - centre_n) / amplitude_n);
            let onset = self.rough.middle - half_way * inverse_omega;
            let static_n =
                if self.before.count >= 3 { self.before.at(onset, rate) } else { peak_n };
            CycleParams {
                onset,
                rate,
                static_n,
                half_drop_n,
                omega: 1.0 / inverse_omega,
                rate_change: 0.0,
            }
        };
        if known_swing {
            return Fitting::new(&self.through_samples(with_swing(data.inverse_omega.mean)));
        }
        let fall = self.fall() / slack.map_or(1.0, |slack| slack.part);
        let with_part = |part: f32| {
            let slide = (part * fall).max(0.5);
            let phase = math::atan2(rate * slide, PI * half_drop_n);
            with_swing(slide / (PI + 2.0 * phase))
        };
        Fitting::among([1.0, 0.6, 0.8, 1.25, 1.6].map(with_part))
    }

    /// Moves the onset, along the stick line, and the drop of a guess so that it goes through
    /// the lowest sample and the one nearest to half-way down.
    fn through_samples(&self, mut cycle: CycleParams) -> CycleParams {
        let shape = cycle.shape();
        let low = since(self.origin, self.low.index);
        let middle = libm::floorf(self.rough.middle + 0.5);
        let middle_n = self.forces_n.get((middle - self.start) as usize);
        // What a sample lies above the guess, and what onset and drop add to that.
        let seen = |time: f32, force_n: f32| {
            let (guess_n, [by_onset, _, by_static, by_drop, ..]) = shape.force(time);
            (force_n - guess_n, by_onset + cycle.rate * by_static, by_drop)
        };
        let (low_n, low_by_onset, low_by_drop) = seen(low, self.low.force_n);
        let (above_n, by_onset, by_drop) = seen(middle, *middle_n.unwrap_or(&f32::NAN));
        let determinant = by_onset * low_by_drop - low_by_onset * by_drop;
        let later = (above_n * low_by_drop - low_n * by_drop) / determinant;
        let drop_n = (low_n * by_onset - above_n * low_by_onset) / determinant;
        // Also not for NaN.
        if later.abs() < 0.5 && drop_n.abs() < 0.5 * cycle.half_drop_n && self.before.count >= 3 {
            cycle.onset += later;
            cycle.static_n += cycle.rate * later;
            cycle.half_drop_n += drop_n;
        }
        cycle
    }

    /// Loading rate, N per period, to within a factor of two.
    pub(crate) fn rate(&self) -> f32 {
        self.rough.rate
    }

    /// Where the fall begins and ends as the samples have it, periods.
    pub(crate) fn fall_edges(&self) -> (f32, f32) {
        self.rough.edges
    }

    /// What the extremes tell together with the stick line after the slip.
    pub(crate) fn rough(&self, after: &Line) -> Rough {
        let Some(Slack { part, .. }) = self.slack(after) else { return self.rough };
        // From the highest sample, less than one off the onset, to the first at zero.
        let fall = self.fall();
        let (slide, slide_std) = ((fall - 0.5) / part, (0.6 + 0.15 * fall) / part);
        Rough { slide, slide_std, ..self.rough }
    }

    /// Periods from the highest sample to the lowest.
    fn fall(&self) -> f32 {
        since(self.peak.index, self.low.index)
    }

    /// The slip ended on a slack cable if the stick line after it, continued back to
    /// the lowest sample, is below zero there by `x`: the block slid on and the winch
    /// took that up. The work of friction is `Fp (Fs + x) = Fs² / 2`, but for the
    /// winch's own.
    fn slack(&self, after: &Line) -> Option<Slack> {
        let slope = after.slope()?;
        let below_n = -after.at(since(self.origin, self.low.index), slope);
        if below_n <= 0.0 {
            return None;
        }
        let peak_n = self.peak.force_n;
        let centre_n = 0.5 * peak_n * peak_n / (peak_n + below_n);
        let part = 1.0 - math::acos(centre_n / (peak_n - centre_n)) / PI;
        Some(Slack { centre_n, part })
    }

    /// The noise's part of the mean square of all residuals: only the line's contain what
    /// the force wanders.
    pub(crate) fn white_share(&self) -> f32 {
        let line = self.before.count as f32;
        let part = line / (line + self.length as f32);
        1.0 - part * (1.0 - self.wander.white_share)
    }

    /// Is a fitted cycle the slip that the samples show? Its ends lie within half the
    /// drop and the rise of two periods of the highest and the lowest sample, and within
    /// two periods and half the fall of where that begins and ends.
    pub(crate) fn holds(&self, cycle: &CycleParams) -> bool {
        let (peak_n, low_n) = (self.peak.force_n, self.low.force_n);
        let far_n = 0.5 * (peak_n - low_n) + 2.0 * cycle.rate;
        let is_near = |a: f32, b: f32| (a - b).abs() < far_n;
        let (from, to) = self.rough.edges;
        let most = 2.0 + 0.5 * (to - from);
        let begins = (cycle.onset - from).abs() < most;
        let ends = !cycle.is_taut() || (cycle.shape().stop() - to).abs() < most;
        begins && ends && is_near(cycle.static_n, peak_n) && is_near(cycle.restick_n(), low_n)
    }

    /// Part of the drop that begins and ends the fall: beyond what the noise does.
    pub(crate) fn edge_part(&self) -> f32 {
        let drop_n = self.peak.force_n - self.low.force_n;
        (0.1 + 3.0 * math::sqrt(self.noise_n2) / drop_n).min(0.3)
    }

    fn edges(&self) -> (f32, f32) {
        let part_n = self.edge_part() * (self.peak.force_n - self.low.force_n);
        let (high_n, low_n) = (self.peak.force_n - part_n, self.low.force_n + part_n);
        let times = (since(self.origin, self.peak.index), since(self.origin, self.low.index));
        let record = self.samples();
        let before = record.good().filter(|&(time, force_n)| {
            time > times.0 && time < self.rough.middle && force_n > high_n
        });
        let mut after = record.good().filter(|&(time, force_n)| {
            time > self.rough.middle && time < times.1 && force_n < low_n
        });
        let from = before.last().map_or(times.0, |(time, _)| time);
        (from, after.next().map_or(times.1, |(time, _)| time))
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
