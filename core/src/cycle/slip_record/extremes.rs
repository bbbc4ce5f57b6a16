//! Estimates from the highest and the lowest sample of a slip, for slips with hardly a sample
//! between them.

use crate::cycle::slip_record::{PI, SHORTEST_FALL, SlipRecord};
use crate::detector::Stick;
use crate::fit::posterior::CLEAR;
use crate::num::math::{self, larger, smaller};
use crate::sample::{ForcePoint, since};
use crate::signal::window::Window;
use crate::stats::line::Line;
use crate::stats::prior::Prior;
use crate::stats::significance::SURE;

/// The highest or the lowest sample of a slip: time, periods from the event's origin, and force.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extreme {
    pub(crate) time: f32,
    pub(crate) force_n: f32,
}

/// Rough estimates: the loading rate, N per period, to within a factor of two, and the slip's
/// length.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Rough {
    pub(crate) rate: f32,
    /// Time from the onset to the highest force, periods.
    pub(super) rise: f32,
    /// Time of sliding and its standard deviation, periods.
    slide: f32,
    slide_std: f32,
    is_slack: bool,
    /// Time at which the force has fallen half-way, periods.
    pub(crate) middle: f32,
    /// Times, periods, of the last sample before `middle` that is still high and of the first one
    /// after it that is low: the highest and the lowest sample may lie anywhere on a slow line.
    pub(crate) edges: (f32, f32),
    /// Part of the drop within which a sample counts as still high or already low, beyond the
    /// noise.
    edge_part: f32,
    /// Angle at which half a cosine has fallen by `edge_part`.
    pub(crate) edge_angle: f32,
}

/// Relative standard deviation of the swing from winch and weight. Tuned: with .03 the intervals of
/// slips that begin smoothly or with jitter cover less than nine tenths, with .1 those of slips of
/// one sample are twice too wide. It allows for a winch speed that is off by a tenth.
const WINCH: f32 = 0.05;

/// A slip that ended on a slack cable.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slack {
    /// `Fp`, N.
    pub(super) centre_n: f32,
    /// Part of the half turn from the largest force to the smallest that the fall to `F = 0` takes.
    pub(super) part: f32,
}

impl Rough {
    /// The loading rate from the line before, else from the rise to the highest sample; the length
    /// of the slip from the number of samples in between.
    pub(super) fn new(
        stick: &Stick,
        window: &Window,
        (peak, low): (ForcePoint, ForcePoint),
        noise_n: f32,
    ) -> Self {
        let before = |back: u32| window.get(peak.index.checked_sub(back)?);
        let newest = before(1).map(|before_n| peak.force_n - before_n);
        let older =
            before(2).zip(newest).map(|(earlier_n, rise_n)| peak.force_n - rise_n - earlier_n);
        let climb = older.zip(newest).map_or(newest, |(older, newest)| Some(larger(older, newest)));
        let line = stick.line.slope().filter(|_| stick.line.count >= 4);
        let drop_n = peak.force_n - low.force_n;
        let least = 1e-4 * drop_n;
        let rate = larger(line.or(climb).unwrap_or(0.0), least);
        let fall = since(peak.index, low.index);
        // The force changes faster inside the slip: of the two samples around each end, the outer
        // one is the extreme more often. The standard deviation grows with the slow ends of long
        // slips.
        let (slide, slide_std) = (fall - 0.4, 0.3 + 0.25 * fall);
        // From the highest to the lowest force the phase advances by `π`, from onset to stop by
        // `π + 2 φ`.
        let turn = core::f32::consts::FRAC_2_PI * fall / drop_n;
        // `sin φ = q / a`. The rate is rough, so a rough root is enough for the angle.
        let sin = smaller(rate * turn, 1.0);
        let phase = math::atan2(sin, math::rough_sqrt(1.0 - sin * sin));
        let longer = 1.0 + core::f32::consts::FRAC_2_PI * phase;
        // A tenth of the drop and three standard deviations of the noise, three tenths at most.
        let edge_part = math::smaller(0.1 + 3.0 * noise_n / drop_n, 0.3);
        let (slide, slide_std) = (slide * longer, slide_std * longer);
        let rise = phase * fall / PI;
        let edge_angle = math::acos(1.0 - 2.0 * edge_part);
        Self { rate, rise, slide, slide_std, edge_part, edge_angle, ..Self::default() }
    }

    /// The swing `1/ω` and its standard deviation, periods: from the samples; or, where these
    /// hardly determine the length of the slip and do not contradict it, `by_winch`, the value from
    /// winch and weight (NaN where the speed of the winch is unknown).
    pub(crate) fn swing(&self, by_winch: f32) -> (f32, f32) {
        let (seen, std) = (self.slide / PI, self.slide_std / PI);
        let hides = self.is_slack || PI * by_winch < CLEAR;
        // False for NaN as well.
        let agrees = (by_winch - seen).abs() < std;
        if hides && agrees { (by_winch, WINCH * by_winch) } else { (seen, std) }
    }

    /// Prior of the onset: half the slide before `middle`, with the uncertainty that a single
    /// sample in between leaves.
    pub(crate) fn onset(&self, noise_n2: f32) -> Prior {
        let spread = 0.3 * larger(self.slide, 1.0);
        Prior { mean: self.middle - 0.5 * self.slide, weight: noise_n2 / (spread * spread) }
    }
}

impl SlipRecord {
    /// Times, periods, between which the samples of the steep fall lie: without the highest and the
    /// lowest one, and without plateaus.
    pub(crate) fn steep(&self) -> (f32, f32) {
        let (from, to) = self.rough.edges;
        (larger(self.peak.time + 0.5, from), smaller(self.low.time - 0.5, to))
    }

    /// Variance of the noise about the stick lines before and after, N²; the detector's where both
    /// lines are brief.
    pub(crate) fn line_noise_n2(&self, after: &Line) -> f32 {
        // With fewer degrees of freedom its relative standard error is above a half, `√(2/8)`.
        const BRIEF: f32 = 8.0;
        self.mean_n2(self.line_residuals(after), BRIEF)
    }

    /// Variance of the noise about the quieter of the two stick lines, N²; lines that are too brief
    /// do not count. Both lines rise at the same rate.
    pub(crate) fn quieter_n2(&self, after: &Line) -> f32 {
        // Tuned: with one degree of freedom the few samples of a brief line lie on it by chance.
        const BRIEF: f32 = 3.0;
        let own_n2 = |line: &Line| self.mean_n2(line.residuals(), BRIEF);
        smaller(own_n2(&self.before), own_n2(after))
    }

    /// Mean of squared residuals, N²; the detector's variance where their degrees of freedom are
    /// fewer than `least`.
    fn mean_n2(&self, (squares_n2, free): (f32, f32), least: f32) -> f32 {
        if free < least { self.noise_n2 } else { squares_n2 / free }
    }

    /// Squared residuals about the stick lines before and after, N², and their degrees of freedom.
    #[inline(never)]
    pub(crate) fn line_residuals(&self, after: &Line) -> (f32, f32) {
        let [before, after] = [&self.before, after].map(Line::residuals);
        (before.0 + after.0, before.1 + after.1)
    }

    /// The rough estimates; the length is that of a slack cable if the line after the slip shows
    /// one.
    pub(crate) fn rough(&self, after: &Line) -> Rough {
        let Some(Slack { part, .. }) = self.slack(after) else { return self.rough };
        // From the highest sample, less than one off the onset, to the first one at zero.
        let fall = self.fall();
        let (slide, slide_std) = ((fall - 0.5) / part, (0.6 + 0.15 * fall) / part);
        Rough { slide, slide_std, is_slack: true, ..self.rough }
    }

    /// Periods from the highest sample to the lowest.
    pub(crate) fn fall(&self) -> f32 {
        self.low.time - self.peak.time
    }

    /// The highest force less the lowest one, N.
    pub(crate) fn drop_n(&self) -> f32 {
        self.peak.force_n - self.low.force_n
    }

    /// Periods from the highest sample to that of a later slip.
    pub(crate) fn periods_to(&self, later: &Self) -> f32 {
        since(self.origin, later.origin) + later.peak.time - self.peak.time
    }

    /// The slack of the cable, if the stick line after the slip, continued back to the lowest
    /// sample, lies below zero there, by `x`: the block slid on by `x`, and the winch took that up.
    /// Without the winch's own work, the work of friction gives `Fp (Fs + x) = Fs² / 2`.
    pub(super) fn slack(&self, after: &Line) -> Option<Slack> {
        let slope = after.slope()?;
        let below_n = -after.at(self.low.time, slope);
        if below_n <= 0.0 || !self.reaches_zero(slope) {
            return None;
        }
        let peak_n = self.peak.force_n;
        let centre_n = 0.5 * peak_n * peak_n / (peak_n + below_n);
        let part = 1.0 - math::acos(centre_n / (peak_n - centre_n)) / PI;
        Some(Slack { centre_n, part })
    }

    /// Does the lowest sample show a slack cable? It, or its neighbour if it is missing, lies less
    /// than a period from where the cable began to load at `rate`, N per period; noise and zero
    /// error add to that.
    pub(crate) fn reaches_zero(&self, rate: f32) -> bool {
        const PERIODS: f32 = 2.0;
        // Part of the highest force, for a zero error of the cell: missing the slack would be its
        // worst effect.
        const ZERO: f32 = 0.03;
        let noise_n = SURE * math::sqrt(self.noise_n2);
        self.low.force_n < PERIODS * rate + noise_n + ZERO * self.peak.force_n
    }

    /// Are samples missing between the highest and the lowest one, and hardly any left? Then the
    /// slip may have begun, or ended, on either side of the missing ones. Where the earlier events
    /// determine the length of a slip, one sample suffices.
    pub(crate) fn hides_length(&self, length_known: bool) -> bool {
        let is_inside = |&(time, _): &(f32, f32)| time > self.peak.time && time < self.low.time;
        let inside = self.samples().good().filter(is_inside).count() as f32;
        let least = if length_known { 1.0 } else { SHORTEST_FALL };
        inside + 1.0 < self.fall() && inside < least
    }

    /// Times, periods, of the edges: the last high sample before the middle of the fall, and the
    /// first low one after it.
    pub(super) fn edges(&self) -> (f32, f32) {
        let part_n = self.rough.edge_part * self.drop_n();
        let (high_n, low_n) = (self.peak.force_n - part_n, self.low.force_n + part_n);
        let (peak, low, middle) = (self.peak.time, self.low.time, self.rough.middle);
        let mut from = peak;
        for (time, force_n) in self.samples().good() {
            if time > peak && time < middle && force_n > high_n {
                from = time;
            }
            if time > middle && time < low && force_n < low_n {
                return (from, time);
            }
        }
        (from, low)
    }

    /// Time, periods, at which the samples fall through half the drop.
    pub(super) fn crossing(&self) -> f32 {
        let half_n = 0.5 * (self.peak.force_n + self.low.force_n);
        let (peak, low) = (self.peak.time, self.low.time);
        let (mut earlier, mut from_n) = (peak, self.peak.force_n);
        for (time, force_n) in self.samples().good().filter(|&(time, _)| time > peak) {
            if force_n < half_n {
                return time - (time - earlier) * (half_n - force_n) / (from_n - force_n);
            }
            (earlier, from_n) = (time, force_n);
        }
        0.5 * (peak + low)
    }
}
