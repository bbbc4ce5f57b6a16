//! The steps after an event's fit, one per call: judge the misfit of its samples, and update the
//! expectations of the next events. The score test that may follow is in `score_test`.

use crate::cycle::cable::{dynamic_n, relax};
use crate::cycle::cycle_fit::{CycleFit, FitStage, Measured};
use crate::cycle::expectations::{Expectations, is_strained, own_residuals};
use crate::cycle::slip_record::UNSURE;
use crate::effect::Effect;
use crate::effects::corner::CornerEstimator;
use crate::effects::mass_change::Verdict;
use crate::effects::scatter::SlipScatter;
use crate::event::Reason;
use crate::fit::correction::UNSURE_OSCILLATION;
use crate::fit::levenberg_marquardt::Pass;
use crate::fit::over_onset::OverOnset;
use crate::fit::posterior::{CLEAR, Posterior};
use crate::fit::residuals::excess_ratio;
use crate::fit::{Priors, rounding_n2};
use crate::model::elongation::Elongation;
use crate::num::math::{larger, smaller};
use crate::stats::prior::Prior;

/// Part of the drop by which the ends of a strained fit may differ from the highest and the lowest
/// sample, besides what the line rises in a period. Tuned with the pauses of heavy blocks.
const SPANNED: f32 = 0.03;

impl CycleFit {
    /// Judges the misfit of the samples: noise, scatter in the slip, strain.
    pub(super) fn judge(&mut self, stage: &mut FitStage, learnt: &mut Expectations) {
        let (fit, slip, noise_n2) = (&mut self.fit, &self.slip, self.priors.noise_n2);
        let data = slip.data(&self.priors, &self.after);
        let (squares_n2, free) = own_residuals(&data, fit);
        // Without the residuals of the line after the slip: that line fits whatever the slip does.
        let (line_n2, points) = self.after.residuals();
        let around_n2 = squares_n2 - line_n2;
        let usual_n2 = (slip.noise_n2, rounding_n2(slip.peak.force_n));
        let misfit = learnt.residuals.is_outlier(around_n2, free - points, usual_n2);
        learnt.contradict(misfit || self.is_other);
        let counts = free >= 1.0 && !misfit;
        let own_n2 = squares_n2 / larger(free, 1.0);
        let quieter_n2 = slip.quieter_n2(&self.after);
        let step_n2 = slip.step_n2(smaller(own_n2, quieter_n2));
        if free >= 1.0 {
            learnt.residuals.add(free * larger(own_n2, step_n2), free, slip.noise_n2);
        }
        let (now_n2, knows_swing) = (learnt.noise_n2(slip), learnt.knows_omega());
        self.excess = excess_ratio(around_n2, free - points, now_n2);
        fit.scale(self.excess);
        fit.widen_forces(slip.wander.line_excess);
        if counts {
            // While the noise is unknown, the residuals about the lines estimate it.
            let (lines_n2, lines) = slip.line_residuals(&self.after);
            let line_n2 = lines_n2 / larger(lines, 1.0);
            let quiet_n2 = larger(noise_n2, line_n2);
            // Where the residuals about one line are less than the converter's steps leave, the
            // samples on that line all have the same rounding error, as far as the noise (the
            // excess of all residuals over the steps) does not smear it.
            let hidden_n2 = larger(2.0 * step_n2 - now_n2 - quieter_n2, 0.0);
            if learnt.effects.has(Effect::Scatter) {
                let (own, wider) = data.slip_residuals(fit, slip.ends(), knows_swing, quiet_n2);
                // Residuals of a force that wanders are no scatter of the slip's own.
                if !slip.wanders() {
                    learnt.scatter.update(|scatter| scatter.learn(own));
                }
                fit.widen(&wider, learnt.scatter.read(SlipScatter::excess));
            }
            // The error by an oscillation is estimated after the fit.
            let is_disputed = slip.wander.is_disputed();
            let unsure = if is_disputed { 0.0 } else { learnt.unsure(slip, now_n2) };
            fit.widen(&UNSURE_OSCILLATION, unsure + hidden_n2 / now_n2);
        }
        let strained = is_strained(&data, around_n2, now_n2);
        self.strain = match (misfit, strained) {
            (true, _) => Strain::Misfit,
            (_, true) => Strain::Strained,
            _ => Strain::None,
        };
        let places = OverOnset::new(fit, knows_swing, now_n2, slip.limit);
        if let Some(places) = places.filter(|_| !misfit) {
            self.priors = learnt.of(slip, &self.after, now_n2);
            *stage = FitStage::Places(places);
            self.shorten();
        } else {
            self.priors.noise_n2 = now_n2;
            self.measured.posterior = Posterior::at(fit, now_n2);
            *stage = FitStage::Learning;
        }
    }

    /// Moves the samples that lie on a stick line for every place of the onset into that line. The
    /// places reach one period to either side of the fit; onset and stop are uncertain by
    /// [`UNSURE`] besides.
    fn shorten(&mut self) {
        const FAR: f32 = 1.0 + UNSURE;
        let (fit, slip) = (&mut self.fit, &mut self.slip);
        if self.priors.corner.is_sharp() && fit.cycle().is_taut() && slip.wander.level <= 0.0 {
            let (onset, stop) = (fit.cycle().onset, fit.shape.stop());
            // The squared residuals of samples that became part of a line.
            let left_n2 = slip.shorten(&mut self.after, (onset - FAR, stop + FAR));
            fit.cost -= left_n2;
        }
    }

    /// Updates the expectations of the next events.
    pub(super) fn learn(&mut self, stage: &mut FitStage, learnt: &mut Expectations) {
        let (fit, noise_n2) = (&self.fit, self.priors.noise_n2);
        let (slip, data) = (&self.slip, self.slip.data(&self.priors, &self.after));
        let Measured { posterior, alone, .. } = &mut self.measured;
        if slip.wander.level + slip.wander.line_excess <= 0.0 {
            posterior.common_n2 = fit.wider_n2(noise_n2);
        }
        let is_resolved = posterior.is_resolved();
        if slip.hides_length(learnt.knows_omega()) {
            *stage = FitStage::Failed(Reason::Hidden);
            return;
        }
        if learnt.stood_slack(fit.cycle(), posterior.swing_variance(), slip.limit) {
            *stage = FitStage::Failed(Reason::LetGo);
            return;
        }
        *alone = fit.forces_alone(self.rate, noise_n2).filter(|_| is_resolved);
        let strained = is_resolved && self.strain != Strain::None;
        let dynamic_n = dynamic_n(&slip.elongation, posterior);
        let verdict = learnt.learn(&data, posterior, dynamic_n, noise_n2, (strained, self.excess));
        let is_same = verdict == Verdict::Same;
        let lines = slip.oscillation.get().zip(self.oscillation.get());
        if let Some(lines) = lines.filter(|_| slip.wander.is_disputed()) {
            let teaches = is_same && is_resolved && !strained;
            let correction =
                learnt.learn_oscillation(&slip.wander, lines, (fit, posterior), noise_n2, teaches);
            self.measured.apply(&correction);
        }
        self.measured.verdict = verdict.into();
        let posterior = &self.measured.posterior;
        // A slip of two samples holds no information on its corners.
        let shows = posterior.is_resolved() && fit.shape.slide_time() > CLEAR;
        if !shows {
            learnt.corner.update(CornerEstimator::pass_over);
        }
        let asked = is_same && self.strain == Strain::None && shows && learnt.asks();
        *stage = if asked { FitStage::Alone(Pass::at(*fit.cycle())) } else { FitStage::Done };
        // The tests use the event alone; the prior of the rate change stays.
        let free = Prior::default();
        self.priors = Priors { onset: free, rate: free, inverse_omega: free, ..self.priors };
    }

    /// A misfit has coefficients only if a change of mass is suspected; a strained fit only if it
    /// ends near the highest and the lowest sample, since a winch that stood during the slip bends
    /// the fit away from them.
    pub(super) fn refused(&self) -> Option<Reason> {
        let fits = match self.strain {
            Strain::None => true,
            Strain::Strained => self.slip.is_spanned(&self.measured.posterior.cycle, SPANNED, 1.0),
            Strain::Misfit => self.measured.verdict.value() == Verdict::Suspect,
        };
        (!fits).then_some(Reason::NoFit)
    }
}

impl Measured {
    /// Converts the estimates back to forces, if the fit was made in the elongation of a sagging
    /// cable.
    pub(crate) fn relax(&mut self, cable: &Elongation) {
        if !cable.sags() {
            return;
        }
        let middle_n = self.posterior.cycle.dynamic_n();
        let (at_onset, mean) = relax(cable, &mut self.posterior);
        if let Some(forces) = &mut self.alone {
            let off_n = mean * (forces.dynamic_n - middle_n);
            forces.static_n = cable.force_n(forces.static_n);
            forces.dynamic_n = self.posterior.cycle.dynamic_n() + off_n;
            forces.static_n2 *= at_onset * at_onset;
            forces.dynamic_n2 *= mean * mean;
        }
    }
}

/// Misfit of the samples around the slip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Strain {
    None,
    /// Too large for the event to update the expectations.
    Strained,
    /// So large that the model does not describe the samples.
    Misfit,
}
