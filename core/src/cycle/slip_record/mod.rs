//! A slip between two stick lines, gathered sample by sample.

mod data;
mod extremes;
mod initial_guess;
mod oscillation;
mod shorten;

use crate::cycle::slip_record::extremes::{Extreme, Rough};
pub(crate) use crate::cycle::slip_record::initial_guess::GUESSED;
use crate::detector::{Detector, Stick};
use crate::effect::{Effect, Kept};
use crate::event::Reason;
use crate::fit::{Fit, Samples};
use crate::model::elongation::Elongation;
use crate::model::{CycleParams, Shape};
use crate::noise::ripple::Wander;
use crate::noise::sinusoid::Sinusoid;
use crate::num::math;
use crate::sample::{ForcePoint, SampleTime, since};
use crate::signal::window::Window;
use crate::stats::lattice::spacing;
use crate::stats::line::Line;
use crate::stats::significance::SURE;

const PI: f32 = core::f32::consts::PI;

/// Most samples between the two stick lines, 384 bytes: at 16 Hz a slip may take six seconds.
const CORE: usize = 96;

/// Uncertainty of onset and stop, periods, of a slip that is hardly resolved, before its last fit.
pub(crate) const UNSURE: f32 = 0.25;

/// Fewest periods from the highest to the lowest sample that determine onset and length of a slip:
/// with a single sample in between, slips of many lengths fit.
pub(crate) const SHORTEST_FALL: f32 = 3.0;

/// A slip as the detector found it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SeenSlip {
    /// Highest sample before the slip.
    pub(crate) peak: ForcePoint,
    /// Lowest sample.
    pub(crate) low: ForcePoint,
    /// Index of the newest sample when the re-stick was detected.
    pub(crate) last: u32,
    /// Weight of the samples since the lowest one.
    pub(crate) rest_weight: f32,
    /// The newest saturated index.
    pub(crate) last_hidden: Option<u32>,
}

/// A slip, gathered while the stick line after it still grows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SlipRecord {
    /// Index of time zero: for the samples, `before` and all other times.
    pub(crate) origin: u32,
    pub(crate) before: Line,
    /// Elongation of the cable as a function of the force. The forces here, and those of the lines,
    /// are kept in elongation where the cable sags.
    pub(crate) elongation: Elongation,
    /// Line of the later half of the rest before the slip, where that rest can determine the sag.
    pub(crate) late: Kept<Line, { Effect::Sag.room() }>,
    /// The samples between the lines, N, the first `length` of them; NaN where one is missing.
    forces_n: [f32; CORE],
    /// Time of the first sample, periods, and the number of samples.
    start: f32,
    length: usize,
    pub(crate) peak: Extreme,
    pub(crate) low: Extreme,
    /// Estimates from the extremes alone, for a slip that the samples hardly resolve.
    pub(crate) rough: Rough,
    /// Rough variance of the noise, from the detector, N².
    pub(crate) noise_n2: f32,
    /// Correlated noise about the stick lines.
    pub(crate) wander: Wander,
    /// The oscillation about the line before the slip.
    pub(crate) oscillation: Kept<Sinusoid, { Effect::Ripple.room() }>,
    /// Weight of the samples after the stop, and the time, periods, from which it applies.
    pub(crate) rest_weight: f32,
    rest_from: f32,
    /// Why samples between the lines are missing: a gap, saturation, or no room.
    pub(crate) hidden: Option<Reason>,
    /// The cycle from which the last fit begins: of the first answer, or of the fit without priors.
    pub(crate) early: Option<CycleParams>,
    /// Stop, periods: of the cycle `early`, or else the time of the lowest sample.
    stop: f32,
    /// Latest time that the event may reach, periods: the highest sample before the next slip.
    pub(crate) limit: f32,
    /// Why the event is refused without a fit.
    pub(crate) refused: Option<Reason>,
}

impl SlipRecord {
    /// The record of a slip whose samples, from the index `start` on, have yet to be gathered.
    // Constructed in place.
    #[inline(always)]
    pub(crate) fn new(
        detector: &Detector,
        stick: &Stick,
        start: u32,
        &SeenSlip { peak, low, rest_weight, .. }: &SeenSlip,
        elongation: Elongation,
    ) -> Self {
        let (first, window) = (stick.next, &detector.window);
        let noise_n = detector.noise_n().unwrap_or(1.0);
        let rough = Rough::new(stick, window, (peak, low), noise_n);
        let [peak, low] = [peak, low].map(|ForcePoint { index, force_n }| Extreme {
            time: since(first, index),
            force_n: elongation.of(force_n),
        });
        Self {
            origin: first,
            before: stick.line_from(first),
            elongation,
            late: Kept::default(),
            forces_n: [0.0; CORE],
            start: since(first, start),
            length: 0,
            peak,
            low,
            rough,
            noise_n2: noise_n * noise_n,
            wander: detector.wander().into(),
            oscillation: Kept::default(),
            rest_weight,
            rest_from: low.time,
            hidden: None,
            early: None,
            stop: low.time,
            limit: f32::MAX,
            refused: None,
        }
    }

    /// Gathers the samples up to the last one that the detector has looked at.
    pub(crate) fn gather(&mut self, window: &Window, slip: &SeenSlip) {
        self.take(window, slip.last);
        self.rough.middle = self.crossing();
        self.rough.edges = self.edges();
        let left = self.samples().count();
        let missing = self.length - left;
        let too_long = (self.length == CORE).then_some(Reason::TooLong);
        // While samples wait, the newest saturated one may lie past this slip: then one that is
        // missing here may have been saturated too.
        let hides = |index| index + 4 >= self.origin && (index <= slip.last || missing > 0);
        let hides = slip.last_hidden.is_some_and(hides) || (missing > 3 && missing > left);
        self.hidden = if hides { Some(Reason::Hidden) } else { too_long };
    }

    /// Sets the cycle of the first answer, if there is one.
    pub(crate) fn take_first_answer(&mut self, first: Option<&Fit>) {
        self.begin_from(first);
        if self.rest_weight < 1.0 && first.is_some() {
            self.rest_from = self.stop - UNSURE;
        }
    }

    /// Sets the cycle from which the last fit begins, that of an earlier fit, if there is one.
    #[inline(never)]
    pub(crate) fn begin_from(&mut self, earlier: Option<&Fit>) {
        self.early = earlier.map(|fit| *fit.cycle());
        self.stop = earlier.map_or(self.low.time, |fit| fit.shape.stop());
    }

    /// Onset and stop, periods: of the cycle `early`, or else the times of the extremes.
    pub(crate) fn ends(&self) -> (f32, f32) {
        (self.early.map_or(self.peak.time, |early| early.onset), self.stop)
    }

    /// Appends the samples that follow the last one taken, up to the index `to`, as room allows.
    fn take(&mut self, window: &Window, to: u32) {
        let start = self.origin.saturating_add_signed(self.start as i32);
        let from = start + self.length as u32;
        let cable = self.elongation;
        let room = self.forces_n.get_mut(self.length..).unwrap_or_default();
        for (entry, index) in room.iter_mut().zip(from..to + 1) {
            *entry = window.get(index).map_or(f32::NAN, |force_n| cable.of(force_n));
            self.length += 1;
        }
    }

    /// The samples between the lines.
    pub(crate) fn samples(&self) -> Samples<'_> {
        let forces_n = self.forces_n.get(..self.length).unwrap_or_default();
        let (rest_weight, rest_from) = (self.rest_weight, self.rest_from);
        Samples { rest_weight, rest_from, ..Samples::new(self.start, forces_n) }
    }

    /// Variance of a converter's rounding, a twelfth of the squared step, N². Zero unless the
    /// residual variance `own_n2` is far below the detector's: then the samples may lie on their
    /// lines by chance.
    pub(crate) fn step_n2(&self, own_n2: f32) -> f32 {
        const FAR_LESS: f32 = 0.2;
        const PART: f32 = 1.0 / 12.0;
        // Tolerance, relative to the force: three decimals of some hundreds of newtons are more
        // exact.
        const EXACT: f32 = 4e-5;
        if own_n2 > FAR_LESS * self.noise_n2 {
            return 0.0;
        }
        let forces_n = self.samples().good().map(|(_, force_n)| force_n);
        let step_n = spacing(forces_n, EXACT * self.peak.force_n.abs());
        PART * step_n * step_n
    }

    /// Ends the event before the next slip: at `last`, the last index before its onset, or else a
    /// little before its highest sample. After a rest too brief for a line its samples are appended
    /// one by one.
    pub(crate) fn end_before(
        &mut self,
        stick: &Stick,
        window: &Window,
        next_peak: u32,
        last: Option<u32>,
    ) {
        if stick.first_count() == 0 {
            self.take(window, next_peak.saturating_sub(1));
        }
        self.limit = since(self.origin, next_peak);
        let rise = || self.early.map_or(self.rough.rise, |cycle| cycle.shape().peak_time());
        let end = last.map_or_else(|| self.limit - rise(), |last| since(self.origin, last) + 1.0);
        let most = -math::floor(self.start - end) as usize;
        self.length = self.length.min(most);
    }

    /// The last index that is surely before the onset of the first answer, and before its creep.
    pub(crate) fn last_before(&self, creep_periods: f32) -> Option<u32> {
        let begins = |cycle: CycleParams| cycle.onset - creep_periods - UNSURE;
        self.early.map(|cycle| SampleTime::after(self.origin, begins(cycle)).index)
    }

    /// The stick line after the slip, extended to `last`, the last index before the next onset,
    /// where that is known: the detector's own line lags some samples behind.
    pub(crate) fn line_after(&self, stick: &Stick, window: &Window, last: Option<u32>) -> Line {
        if self.elongation.sags() {
            let end = last.map_or(stick.next, |last| last + 1);
            return self.line_of(window, stick.origin..end.max(stick.origin));
        }
        let mut line = stick.first_from(self.origin);
        // On a slack cable the first answer is too rough.
        let is_straight = self.has_straight(stick, &line) && self.slack(&line).is_none();
        if let Some(last) = last.filter(|_| is_straight) {
            for index in window.first_from(stick.next)..last + 1 {
                if let Some(force_n) = window.get(index) {
                    line.add(since(self.origin, index), force_n, 1.0, 1.0);
                }
            }
        }
        line
    }

    /// Do the samples show the stick line from the time `start` on, significantly above its start?
    /// Without that the fit ends the slack where the last samples would begin to contradict it.
    pub(crate) fn shows(&self, after: &Line, start: f32) -> bool {
        let risen_n = self.rough.rate * (self.samples().end() - start);
        after.count > 0 || risen_n > SURE * math::sqrt(self.noise_n2)
    }

    /// Adds the samples between the stop of the previous slip and its re-stick to the line before
    /// this slip: the detector's line begins at the re-stick. Not where the cable flops or was
    /// slack, since these samples are then off the line.
    pub(crate) fn lengthen_line(&mut self, previous: &Self, stick: &Stick) {
        let was_slack = previous.slack(&stick.first_from(previous.origin)).is_some();
        let is_steady = self.rest_weight >= 1.0
            && !self.elongation.sags()
            && self.has_straight(stick, &self.before);
        if previous.early.is_none() || !is_steady || was_slack {
            return;
        }
        let (stop, end) = (previous.stop + UNSURE, since(previous.origin, stick.origin));
        let later = since(self.origin, previous.origin);
        for (time, force_n) in previous.samples().good() {
            if time > stop && time < end {
                self.before.add(time + later, force_n, 1.0, 1.0);
            }
        }
    }

    /// Is there a line about which the samples scatter by white noise alone?
    fn has_straight(&self, stick: &Stick, line: &Line) -> bool {
        stick.is_straight() && line.count > 0 && self.wander.level <= 0.0
    }

    /// Is a fitted cycle the slip in the samples? Its ends have to lie near the highest and the
    /// lowest sample, within half the drop plus the rise of the line in two periods. Its fall has
    /// to begin and end near the edges of the samples' fall, within two periods plus half the fall;
    /// on a slack cable the samples have to fall to zero.
    pub(crate) fn holds(&self, shape: &Shape) -> bool {
        let cycle = shape.cycle();
        let (from, to) = self.rough.edges;
        let most = 2.0 + 0.5 * (to - from);
        let lead = self.lead(shape);
        let begins = (cycle.onset + lead - from).abs() < most;
        let ends = if cycle.is_taut() {
            (shape.stop() - lead - to).abs() < most
        } else {
            self.reaches_zero(cycle.rate)
        };
        begins && ends && self.is_spanned(cycle, 0.5, 2.0)
    }

    /// Do the ends of a cycle lie near the highest and the lowest sample, within `part` of the drop
    /// plus the rise of the line in `periods`?
    pub(crate) fn is_spanned(&self, cycle: &CycleParams, part: f32, periods: f32) -> bool {
        let (peak_n, low_n) = (self.peak.force_n, self.low.force_n);
        let far_n = part * (peak_n - low_n) + periods * cycle.rate;
        let is_near = |a: f32, b: f32| (a - b).abs() < far_n;
        is_near(cycle.static_n, peak_n) && (!cycle.is_taut() || is_near(cycle.restick_n(), low_n))
    }

    /// Time from the onset of a cycle to the beginning of its fall, with the fall defined as in
    /// `edges`; by symmetry also the time from the end of the fall to the stop.
    fn lead(&self, shape: &Shape) -> f32 {
        shape.peak_time() + self.rough.edge_angle / shape.cycle().omega
    }
}
