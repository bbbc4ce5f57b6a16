//! What a cable that sags, or gets stiffer, does to `Fp`: learnt from the rests.

use crate::cycle::CycleTracker;
use crate::cycle::slip_record::SlipRecord;
use crate::effect::Effect;
use crate::effects::corner::CornerEstimator;
use crate::effects::sag::Rest;
use crate::fit::posterior::Posterior;
use crate::model::{CycleParams, Shape};
use crate::sample::SampleTime;

impl CycleTracker {
    /// Learns from the rest before this slip how soft a sagging cable is, if the force strays from
    /// its line at all; keeps where the next rest begins.
    pub(super) fn learn_sag(&mut self, slip: &SlipRecord, posterior: &Posterior, shape: &Shape) {
        let cycle = &posterior.cycle;
        let rested = self.rested.take();
        if !self.site.effects.has(Effect::Sag) || shape.is_slack() || !posterior.is_resolved() {
            return;
        }
        self.rested = Some((SampleTime::after(slip.origin, shape.stop()), cycle.restick_n()));
        let rested = rested.filter(|_| slip.wander.bends && !slip.broken);
        let Some(((from, from_n), (rate, rate_variance))) = rested.zip(self.learnt.own_rate) else {
            return;
        };
        let to = SampleTime::after(slip.origin, cycle.onset);
        let rest = Rest {
            time: to.periods_since(from),
            from_n,
            // The force that the line goes on to: what creep takes of it is not the cable's.
            to_n: cycle.static_n + self.learnt.corner.read(CornerEstimator::missing_n),
            rate,
            rate_variance,
            rate_at_n: slip.before.level_n,
        };
        self.learnt.sag.update(|sag| sag.learn(&rest));
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
        let stiffening_n = if stiffens { self.learnt.stiffening_n(cycle) } else { 0.0 };
        (sag_n - stiffening_n, sag_n2)
    }
}
