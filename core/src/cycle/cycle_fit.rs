//! The last fit of an event whose lines are complete, spread over the samples that
//! follow: one iteration a step, so that no sample has to wait for a whole fit.

use core::ops::ControlFlow;

use crate::cycle::expectations::{Expectations, is_clear, is_strained, own_residuals};
use crate::cycle::slip_record::SlipRecord;
use crate::effects::corner::CornerEstimator;
use crate::effects::mass_change::Verdict;
use crate::event::Reason;
use crate::fit::posterior::{OverOnset, Posterior};
use crate::fit::{Data, Fit, Fitting, Forces};
use crate::stats::line::Line;

/// An event being fitted.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CycleFit {
    pub(crate) pending: SlipRecord,
    after: Line,
    stage: Stage,
}

#[derive(Clone, Copy, Debug)]
#[allow(clippy::large_enum_variant, reason = "there is one, and no heap to put it on")]
enum Stage {
    /// Nothing done yet.
    New,
    /// Fitted with hardly any expectation.
    ///
    /// Where the block never rests the detector's noise is only a bound, far too
    /// large, and would make rough expectations look precise: there the event's own
    /// residuals come first.
    Free(Fitting),
    /// Fitted with what is expected.
    Expected(Fitting),
    /// Averaged over the onset; and whether the samples around the slip are far from the fit.
    Places(OverOnset, Fit, bool),
}

/// What became of an event.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Outcome {
    /// Measured.
    Fitted {
        posterior: Posterior,
        /// The forces without what other events told of the loading rate.
        alone: Option<Forces>,
        /// Variance of the noise, N².
        noise_n2: f32,
        /// Whether it is still the same block.
        verdict: Verdict,
    },
    /// Only seen.
    Failed(Reason),
}

impl Outcome {
    fn is_suspect(&self) -> bool {
        matches!(self, Self::Fitted { verdict: Verdict::Suspect, .. })
    }
}

impl CycleFit {
    pub(crate) fn new(pending: SlipRecord, after: Line) -> Self {
        Self { pending, after, stage: Stage::New }
    }

    /// Does enough of the stick line that starts at a time show to tell when it did? A
    /// fit without it ends where the last samples would begin to contradict.
    pub(crate) fn shows(&self, start: f32) -> bool {
        self.after.count > 0 || self.pending.samples().end() > start + 2.0
    }

    /// One iteration.
    pub(crate) fn step(&mut self, learnt: &mut Expectations) -> ControlFlow<Outcome> {
        match self.stage {
            Stage::New => self.start(learnt),
            Stage::Free(_) => self.free(learnt),
            Stage::Expected(_) => self.expected(learnt),
            Stage::Places(..) => self.place(learnt),
        }
    }

    fn start(&mut self, learnt: &mut Expectations) -> ControlFlow<Outcome> {
        learnt.weigh(&self.pending);
        let known = learnt.residuals.variance_n2().is_some();
        let fitting = self.begin(learnt, learnt.fitted_noise_n2(&self.pending));
        self.stage = if known { Stage::Expected(fitting) } else { Stage::Free(fitting) };
        ControlFlow::Continue(())
    }

    fn free(&mut self, learnt: &Expectations) -> ControlFlow<Outcome> {
        let Stage::Free(fitting) = &mut self.stage else { return ControlFlow::Continue(()) };
        let noise_n2 = learnt.fitted_noise_n2(&self.pending);
        let data = learnt.data(&self.pending, &self.after, noise_n2);
        let ControlFlow::Break(fit) = fitting.step(&data, noise_n2) else {
            return ControlFlow::Continue(());
        };
        if let Some(fit) = fit {
            let (squares_n2, free) = own_residuals(&data, &fit);
            if free >= 1.0 {
                let own_n2 = (squares_n2 / free).max(noise_n2);
                self.pending.noise_n2 = self.pending.noise_n2.min(own_n2);
            }
        }
        self.pending.early = fit.map(|fit| fit.cycle);
        self.stage = Stage::Expected(self.begin(learnt, learnt.noise_n2(&self.pending)));
        ControlFlow::Continue(())
    }

    fn begin(&self, learnt: &Expectations, noise_n2: f32) -> Fitting {
        let data = learnt.data(&self.pending, &self.after, noise_n2);
        self.pending.begin(&data, learnt.knows_omega())
    }

    fn expected(&mut self, learnt: &mut Expectations) -> ControlFlow<Outcome> {
        let Stage::Expected(fitting) = &mut self.stage else { return ControlFlow::Continue(()) };
        let pending = &self.pending;
        let noise_n2 = learnt.noise_n2(pending);
        let data = learnt.data(pending, &self.after, noise_n2);
        let ControlFlow::Break(fit) = fitting.step(&data, noise_n2) else {
            return ControlFlow::Continue(());
        };
        let holds = |fit: &Fit| fit.converged && pending.holds(&fit.cycle);
        let Some(fit) = fit.filter(holds) else {
            // Corners that are not there may be why.
            learnt.corner = CornerEstimator::default();
            return ControlFlow::Break(Outcome::Failed(Reason::NoFit));
        };
        if pending.hidden {
            return ControlFlow::Break(Outcome::Failed(Reason::Hidden));
        }
        let (squares_n2, free) = own_residuals(&data, &fit);
        // Without what is left around the line after it, which fits whatever the slip does.
        let (line_n2, points) = (self.after.residual(), (self.after.weight - 2.0).max(0.0));
        let around_n2 = squares_n2 - line_n2;
        let misfit = learnt.is_misfit(pending, around_n2, free - points);
        if free >= 1.0 && !misfit {
            learnt.residuals.add(squares_n2, free, pending.noise_n2);
        }
        let now_n2 = learnt.noise_n2(pending);
        let strained = is_strained(&data, around_n2, now_n2);
        if let Some(places) = OverOnset::new(&fit, learnt.knows_omega()).filter(|_| !misfit) {
            self.stage = Stage::Places(places, fit, strained);
            return ControlFlow::Continue(());
        }
        let outcome = fitted(learnt, &data, &fit, strained, Posterior::at(&fit, now_n2), now_n2);
        let nothing = misfit && !outcome.is_suspect();
        ControlFlow::Break(if nothing { Outcome::Failed(Reason::NoFit) } else { outcome })
    }

    fn place(&mut self, learnt: &mut Expectations) -> ControlFlow<Outcome> {
        let Stage::Places(places, fit, strained) = &mut self.stage else {
            return ControlFlow::Continue(());
        };
        let noise_n2 = learnt.noise_n2(&self.pending);
        let data = learnt.data(&self.pending, &self.after, noise_n2);
        let ControlFlow::Break(posterior) = places.step(&data, fit, noise_n2) else {
            return ControlFlow::Continue(());
        };
        ControlFlow::Break(fitted(learnt, &data, fit, *strained, posterior, noise_n2))
    }
}

fn fitted(
    learnt: &mut Expectations,
    data: &Data<'_>,
    fit: &Fit,
    strained: bool,
    mut posterior: Posterior,
    noise_n2: f32,
) -> Outcome {
    let mut alone = fit.forces_alone(data.rate).filter(|_| posterior.is_resolved());
    let strained = posterior.is_resolved() && strained;
    let verdict = learnt.learn(data, &posterior, noise_n2, strained);
    // A slip of two samples shows nothing of its corners.
    if verdict == Verdict::Same && !strained && posterior.is_resolved() && is_clear(&posterior) {
        let effect = learnt.learn_corner(data, fit, noise_n2);
        posterior.take(&effect);
        if let Some(alone) = &mut alone {
            alone.take(&effect, noise_n2);
        }
    }
    Outcome::Fitted { posterior, alone, noise_n2, verdict }
}
