//! Estimates before the second stick line is complete: `mu_s` at the onset, and a first answer when
//! the block rests again.

use crate::cycle::cable::relax;
use crate::cycle::slip_record::SlipRecord;
use crate::cycle::{CycleTracker, Work};
use crate::detector::Detector;
use crate::event::Provisional;
use crate::fit::correction::UNSURE_OSCILLATION;
use crate::fit::posterior::Posterior;
use crate::fit::{Data, Fit, Priors};
use crate::stats::line::Line;

/// Most steps of the fit for a first answer; two usually suffice.
const FIRST_STEPS: usize = 5;
/// Most samples of a slip that has a first answer.
const MOST_SAMPLES: usize = 32;

impl CycleTracker {
    /// First estimate of `mu_s` when a slip begins, from the stick line, with the onset anywhere in
    /// the last two periods.
    pub(crate) fn onset(&self, detector: &Detector) -> Option<Provisional> {
        let (stick, now) = (&detector.stick, detector.last);
        let line = stick.line_from(now.index);
        let (slope, noise_n, time) = (line.slope()?, detector.noise_n()?, -1.0);
        // A uniform distribution over two periods has a standard deviation of 1/√3 of its
        // half-width.
        const SPREAD: f32 = 0.577;
        let onset_n = SPREAD * slope;
        let variance_n2 = onset_n * onset_n + noise_n * noise_n * line.leverage(time);
        let mu_s = self.site().coefficient(line.at(time, slope), variance_n2);
        Some(Provisional { mu_s, mu: None })
    }

    /// Begins the first answer on the pending slip, with the priors from the events so far.
    pub(super) fn begin_first(&mut self) {
        let Some(slip) = &self.pending else { return };
        let noise_n2 = self.learnt.fitted_noise_n2(slip);
        let priors = self.learnt.of(slip, &Line::NONE, noise_n2);
        let knows_omega = self.learnt.knows_omega();
        let fitting = slip.guess(&data(&priors, slip, knows_omega), knows_omega);
        let is_long = slip.samples().forces_n.len() > MOST_SAMPLES;
        let left = if is_long { 0 } else { FIRST_STEPS };
        self.work = Work::Answering { priors, fitting, left };
    }

    /// One step of the fit for the first answer.
    pub(super) fn step_first(&mut self) {
        let (Work::Answering { priors, fitting, left }, Some(slip)) =
            (&mut self.work, &self.pending)
        else {
            return;
        };
        let step = fitting.step(&data(priors, slip, self.learnt.knows_omega()));
        *left = left.saturating_sub(1);
        if step.is_break() || *left == 0 {
            self.work = Work::Answered(step.break_value().flatten());
        }
    }

    /// Has the fit converged to the pending slip?
    pub(super) fn shows_slip(&self, fit: &Fit) -> bool {
        fit.converged && self.pending.as_ref().is_some_and(|slip| slip.holds(&fit.shape))
    }

    /// The first answer from a fit, with the same priors and noise as the event itself will have;
    /// `None` before the events so far give the noise.
    pub(super) fn first_answer(&self, mut fit: Fit) -> Option<Provisional> {
        let slip = self.pending.as_ref().filter(|slip| slip.hidden.is_none())?;
        self.learnt.residuals.variance_n2()?;
        let noise_n2 = self.learnt.noise_n2(slip);
        fit.widen_forces(slip.wander.line_excess);
        // Half of an oscillation may be the cell's.
        let unsure = if slip.wander.is_disputed() { 0.5 } else { 1.0 };
        fit.widen(&UNSURE_OSCILLATION, unsure * self.learnt.unsure(slip, noise_n2));
        let mut at = Posterior::at(&fit, noise_n2);
        if slip.elongation.sags() {
            relax(&slip.elongation, &mut at);
        }
        if !at.is_resolved() {
            return None;
        }
        let (cycle, (static_n2, dynamic_n2)) = (&at.cycle, at.forces_n2());
        let (shift_n, shift_n2) = self.shift(slip, cycle);
        // The lowest sample has a weight of about a quarter in `Fp`, and the cable may flop there.
        let flop_n2 = (1.0 / slip.rest_weight - 1.0) * noise_n2 / 16.0;
        let mu = || {
            let variance_n2 = dynamic_n2 + shift_n2 + flop_n2;
            self.site().coefficient(cycle.dynamic_n() - shift_n, variance_n2)
        };
        let mu_s = self.site().coefficient(cycle.static_n, static_n2);
        // On a slack cable only the time at zero force determines `mu`.
        Some(Provisional { mu_s, mu: cycle.is_taut().then(mu) })
    }
}

/// Data of the first answer: all samples but the newest. The detector saw the end of the slip by
/// that sample, so it is more often too high than too low. While the swing is unknown every sample
/// is needed.
fn data<'a>(priors: &'a Priors, slip: &'a SlipRecord, knows_omega: bool) -> Data<'a> {
    let mut data = slip.data(priors, &Line::NONE);
    let before = data.samples.forces_n.split_last().filter(|_| knows_omega);
    data.samples.forces_n = before.map_or(data.samples.forces_n, |(_, before)| before);
    data
}
