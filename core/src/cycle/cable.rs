//! A cable that sags or stiffens: its lines in elongation, its forces, and its shift of `Fp`, which
//! the rests determine.

use core::ops::Range;

use crate::cycle::CycleTracker;
use crate::cycle::ended::{By, Ended};
use crate::cycle::expectations::Expectations;
use crate::cycle::slip_record::{SHORTEST_FALL, SeenSlip, SlipRecord};
use crate::detector::{Detector, Stick};
use crate::effect::Effect;
use crate::effects::corner::CornerEstimator;
use crate::effects::sag::{Rest, Sag};
use crate::effects::stiffening;
use crate::fit::posterior::Posterior;
use crate::model::CycleParams;
use crate::model::elongation::Elongation;
use crate::sample::{SampleTime, since};
use crate::signal::window::Window;
use crate::stats::line::Line;

/// Fewest samples of a rest that determine how its rate changes.
const FEWEST: u32 = 8;

/// Most samples of a line in elongation: two such lines take a third of a step's time.
const MOST_OF_LINE: u32 = 24;

impl Ended {
    /// Can the rest determine the sag of the cable? It has a line of enough samples, and either an
    /// earlier rest was used, or the slip after it is long enough and all rests bend the same way.
    pub(super) fn may_sag(&self, learnt: &Expectations, detector: &Detector) -> bool {
        let is_line = !self.stick.broken && self.stick.line.count >= FEWEST;
        let asks = || self.fall() >= SHORTEST_FALL && detector.bends();
        learnt.effects.has(Effect::Sag) && is_line && (learnt.sag.read(Sag::has_begun) || asks())
    }

    /// Periods from the highest to the lowest sample of the slip; zero if no slip ended the line.
    fn fall(&self) -> f32 {
        match self.by {
            By::Slip(SeenSlip { peak, low, .. }) => since(peak.index, low.index),
            By::Loss(_) => 0.0,
        }
    }
}

impl Expectations {
    /// Is the cable known to sag?
    pub(crate) fn sags(&self) -> bool {
        self.sag.read(Sag::parameter).is_some()
    }
}

impl SlipRecord {
    /// Sets `late`, the line of the later half of the rest before the slip. Its rate and the
    /// duration of the rest determine the sag. Of a cable known to sag the line before the slip is
    /// refitted to the whole rest in elongation, where it is straight, so no slope variance is
    /// left.
    pub(crate) fn take_late(&mut self, window: &Window, stick: &Stick) {
        let half = (stick.next - stick.origin) / 2;
        self.late = self.line_of(window, stick.next - half..stick.next).into();
        if self.elongation.sags() {
            self.before = self.line_of(window, stick.origin..stick.next);
            self.wander.update(|wander| wander.slope = 0.0);
        }
    }

    /// The line of a part of a rest; of a long part, through samples evenly spread over it.
    pub(super) fn line_of(&self, window: &Window, rest: Range<u32>) -> Line {
        let mut line = Line::default();
        let each = (rest.end - rest.start) / MOST_OF_LINE + 1;
        for index in rest.step_by(each as usize) {
            if let Some(force_n) = window.get(index) {
                line.add(since(self.origin, index), self.elongation.of(force_n), 1.0, 1.0);
            }
        }
        line
    }
}

/// Converts a fit in elongation back to forces. Returns the derivative of the force by the
/// elongation, at the onset and as a mean over the slip.
pub(super) fn relax(cable: &Elongation, posterior: &mut Posterior) -> (f32, f32) {
    let cycle = &mut posterior.cycle;
    let (static_n, restick_n) = (cable.force_n(cycle.static_n), cable.force_n(cycle.restick_n()));
    let at_onset = cable.stiffness(static_n);
    let half_drop_n = 0.5 * (static_n - restick_n);
    let mean = half_drop_n / cycle.half_drop_n;
    (cycle.static_n, cycle.half_drop_n) = (static_n, half_drop_n);
    cycle.rate *= at_onset;
    let (of_static, of_drop) = (at_onset * at_onset, mean * mean);
    let [_, rate, static_n2, half_drop_n2, _, _, dynamic_n2] = &mut posterior.variances;
    let (common_static_n2, common_dynamic_n2) = &mut posterior.common_n2;
    for variance in [rate, static_n2, common_static_n2] {
        *variance *= of_static;
    }
    for variance in [half_drop_n2, dynamic_n2, common_dynamic_n2] {
        *variance *= of_drop;
    }
    (at_onset, mean)
}

/// `Fp` of a fit as a force, N, also where it was made in elongation: midpoint of `Fs` and `Fe`.
pub(super) fn dynamic_n(cable: &Elongation, posterior: &Posterior) -> f32 {
    let mut posterior = *posterior;
    if cable.sags() {
        relax(cable, &mut posterior);
    }
    posterior.cycle.dynamic_n()
}

impl CycleTracker {
    /// Updates the estimate of the sag with the rest before this slip; keeps the start of the next
    /// rest.
    pub(super) fn learn_sag(&mut self, slip: &SlipRecord, posterior: &Posterior, stop: f32) {
        let (cycle, (static_n2, dynamic_n2)) = (&posterior.cycle, posterior.forces_n2());
        let rested = self.rested.update(Option::take);
        if !self.learnt.effects.has(Effect::Sag) || !cycle.is_taut() || !posterior.is_resolved() {
            return;
        }
        let restick_n2 = static_n2 + 4.0 * dynamic_n2;
        let stopped = SampleTime::after(slip.origin, stop);
        self.rested = Some((stopped, cycle.restick_n(), restick_n2)).into();
        let (cable, Some(late)) = (&slip.elongation, slip.late.get()) else { return };
        let Some(((from, from_n, from_n2), rate)) = rested.zip(late.slope()) else { return };
        let rest = Rest {
            time: SampleTime::after(slip.origin, cycle.onset).periods_since(from),
            from_n,
            from_n2,
            // The force where the stick line ends: the force lost to creep is no effect of the
            // cable.
            to_n: cycle.static_n + self.learnt.corner.read(CornerEstimator::missing_n),
            rate,
            rate_variance: late.residual_n2 / ((late.count as f32 - 2.0) * late.slope_weight),
            rate_at_n: cable.force_n(late.level_n),
        };
        self.learnt.sag.update(|sag| sag.learn(&rest, cable));
    }

    /// Distance of `Fp` below the midpoint of `Fs` and `Fe` due to the cable, N, and its variance,
    /// N². Where the lines are not straight, a cable that stiffens as the block slides cannot be
    /// identified.
    pub(super) fn shift(&self, slip: &SlipRecord, cycle: &CycleParams) -> (f32, f32) {
        let sags = slip.elongation.sags();
        let shift = || self.learnt.sag.read(|sag| sag.shift(cycle, sags));
        // A straight line through a rest goes through its mean force over time, `∫ F dy / ∫ dy`:
        // the midpoint of such lines is `Fp`, whatever the sag.
        let (sag_n, sag_n2) = if sags || slip.wander.bends { shift() } else { (0.0, 0.0) };
        let stiffens = self.learnt.effects.has(Effect::Stiffening);
        let is_straight = slip.wander.level <= 0.0 && cycle.is_taut();
        if !is_straight {
            return (sag_n, sag_n2);
        }
        let stiffening_n =
            if stiffens { stiffening::shift_n(&self.learnt.rate_change, cycle) } else { 0.0 };
        (sag_n - stiffening_n, sag_n2)
    }
}
