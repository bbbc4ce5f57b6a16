//! What a cable that sags, or gets stiffer, does to `Fp`: learnt from the rests.

use crate::cycle::CycleTracker;
use crate::cycle::ended::Ended;
use crate::cycle::expectations::Expectations;
use crate::cycle::slip_record::{SlipRecord, TELLING};
use crate::detector::Detector;
use crate::effect::Effect;
use crate::effects::corner::CornerEstimator;
use crate::effects::sag::{Rest, Sag};
use crate::effects::stiffening;
use crate::fit::posterior::Posterior;
use crate::model::CycleParams;
use crate::model::elongation::Elongation;
use crate::sample::SampleTime;

/// Fewest samples of a rest that tell how its rate changes.
const FEWEST: u32 = 8;

impl Ended {
    /// Can the rest tell of a cable that sags: are the rests bent as it bends them, and is the slip
    /// that ended this one long enough, or was another one asked already?
    pub(super) fn may_sag(&self, learnt: &Expectations, detector: &Detector) -> bool {
        let is_line = !self.stick.broken && self.stick.line.count >= FEWEST;
        let asks = || self.fall() >= TELLING && detector.wander().bends;
        learnt.effects.has(Effect::Sag) && is_line && (learnt.sag.read(Sag::has_begun) || asks())
    }
}

/// Takes what was fitted in elongation back to forces. Gives by how much the force grows with the
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
    posterior.static_n2 *= of_static;
    posterior.dynamic_n2 *= of_drop;
    posterior.common_n2.0 *= of_static;
    posterior.common_n2.1 *= of_drop;
    posterior.unknowns[1] *= of_static;
    posterior.unknowns[2] *= of_static;
    posterior.unknowns[3] *= of_drop;
    (at_onset, mean)
}

impl CycleTracker {
    /// Learns from the rest before this slip how soft a sagging cable is; keeps where the next rest
    /// begins.
    pub(super) fn learn_sag(&mut self, slip: &SlipRecord, posterior: &Posterior, stop: f32) {
        let Posterior { cycle, static_n2, dynamic_n2, .. } = posterior;
        let rested = self.rested.take();
        if !self.site.effects.has(Effect::Sag) || !cycle.is_taut() || !posterior.is_resolved() {
            return;
        }
        let restick_n2 = static_n2 + 4.0 * dynamic_n2;
        self.rested = Some((SampleTime::after(slip.origin, stop), cycle.restick_n(), restick_n2));
        let (cable, late) = (&slip.elongation, &slip.late);
        let Some(((from, from_n, from_n2), rate)) = rested.zip(late.slope()) else { return };
        let rest = Rest {
            time: SampleTime::after(slip.origin, cycle.onset).periods_since(from),
            from_n,
            from_n2,
            // The force that the line goes on to: what creep takes of it is not the cable's.
            to_n: cycle.static_n + self.learnt.corner.read(CornerEstimator::missing_n),
            rate,
            rate_variance: late.residual() / ((late.count as f32 - 2.0) * late.slope_weight()),
            rate_at_n: cable.force_n(late.level_n),
        };
        self.learnt.sag.update(|sag| sag.learn(&rest, cable));
    }

    /// How far the cable takes `Fp` below the middle of `Fs` and `Fe`, N, and its variance, N². On
    /// lines that are not straight no cable that stiffens as the block slides can be told.
    pub(super) fn shift(&self, slip: &SlipRecord, cycle: &CycleParams) -> (f32, f32) {
        let (mut sag_n, mut sag_n2) = self.learnt.sag.read(|sag| sag.shift(cycle));
        if sag_n <= 0.0 && !slip.wander.bends {
            // A sag that is only possible widens nothing where no rest is bent.
            (sag_n, sag_n2) = (0.0, 0.0);
        }
        let stiffens = self.site.effects.has(Effect::Stiffening);
        let is_straight = slip.wander.level <= 0.0 && sag_n2 <= 0.0 && cycle.is_taut();
        if !is_straight {
            return (sag_n, sag_n2);
        }
        let stiffening_n =
            if stiffens { stiffening::shift_n(&self.learnt.rate_change, cycle) } else { 0.0 };
        (sag_n - stiffening_n, sag_n2)
    }
}
