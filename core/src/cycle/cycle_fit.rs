//! The last fit of an event whose lines are complete, spread over the samples that
//! follow: one iteration a step, so that no sample has to wait for a whole fit.

use core::ops::ControlFlow;

use crate::cycle::expectations::{Expectations, is_clear, is_strained, own_residuals};
use crate::cycle::refusal::SURE;
use crate::cycle::slip_record::SlipRecord;
use crate::effect::Kept;
use crate::effects::mass_change::Verdict;
use crate::event::Reason;
use crate::fit::over_onset::OverOnset;
use crate::fit::posterior::Posterior;
use crate::fit::residuals::excess_ratio;
use crate::fit::{Data, Fit, Fitting, Forces, Variances};
use crate::num::math::{self, larger};
use crate::stats::line::Line;

/// Samples' worth of iterations that are still made when the next event wants to be fitted.
const LEFT: usize = 5;

/// Periods from the highest to the lowest sample that tell when a slip began and how long it took:
/// a single sample in between could be anywhere in slips of many lengths.
const TELLING: f32 = 3.0;

/// An event being fitted.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CycleFit {
    pub(crate) pending: SlipRecord,
    after: Line,
    stage: Stage,
    /// Variance of the noise that the fit's weights are relative to, N².
    fitted_n2: f32,
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
    Places(OverOnset, Fit, Strain),
    /// Measured; what that tells the next events is still to be learnt.
    Telling(Fit, Posterior, Strain),
}

/// What the fit of an event tells.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Measured {
    pub(crate) posterior: Posterior,
    /// The forces without what other events told of the loading rate.
    pub(crate) alone: Option<Forces>,
    /// Variance of the noise, N².
    pub(crate) noise_n2: f32,
    /// Whether it is still the same block.
    pub(crate) verdict: Verdict,
}

/// What became of an event.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Outcome {
    /// Measured.
    Fitted(Measured),
    /// Only seen.
    Failed(Reason),
}

impl CycleFit {
    pub(crate) fn new(pending: SlipRecord, after: Line) -> Self {
        Self { pending, after, stage: Stage::New, fitted_n2: 0.0 }
    }

    /// Does the last sample show the stick line that starts at a time, clearly above its start? A
    /// fit without it ends where the last samples would begin to contradict.
    pub(crate) fn shows(&self, start: f32) -> bool {
        let risen_n = self.pending.rate() * (self.pending.samples().end() - start);
        self.after.count > 0 || risen_n > SURE * math::sqrt(self.pending.noise_n2)
    }

    /// One iteration.
    pub(crate) fn step(&mut self, learnt: &mut Expectations) -> ControlFlow<Outcome> {
        match &self.stage {
            Stage::New => self.start(learnt),
            Stage::Free(_) => self.free(learnt),
            Stage::Expected(_) => self.expected(learnt),
            Stage::Places(..) => self.place(learnt),
            Stage::Telling(fit, posterior, strain) => self.tell(learnt, fit, *posterior, *strain),
        }
    }

    /// Iterations a sample: as many as one has time for, two of a usual slip; of the places of an
    /// onset, which are many, more. With fewer, unresolved slips in quick succession have no
    /// place of their onset in time, and first events no fit.
    pub(crate) fn iterations(&self) -> usize {
        match self.stage {
            Stage::Places(..) => self.iterations_of(3, 8),
            Stage::New | Stage::Free(_) | Stage::Expected(_) | Stage::Telling(..) => {
                self.iterations_of(1, 4)
            }
        }
    }

    fn iterations_of(&self, times: usize, most: usize) -> usize {
        const TIME: usize = 52;
        iterations_within(times * TIME, self.pending.samples().forces_n.len()).clamp(1, most)
    }

    /// Is the next step as long as all that a sample has time for?
    pub(crate) fn is_long(&self) -> bool {
        matches!(self.stage, Stage::Telling(..))
    }

    /// What there is when no time is left: what was measured, or no fit. An onset whose places
    /// were not looked at as far as it is likely may be anywhere, unless samples enough lie in the
    /// slip.
    pub(crate) fn cut(&mut self, learnt: &mut Expectations) -> Outcome {
        for _ in 0..LEFT * self.iterations_of(1, 4) {
            if matches!(self.stage, Stage::Places(..) | Stage::Telling(..)) {
                break;
            }
            if let ControlFlow::Break(outcome) = self.step(learnt) {
                return outcome;
            }
        }
        let noise_n2 = learnt.noise_n2(&self.pending);
        let data = learnt.data(&self.pending, &self.after, noise_n2);
        let (fit, posterior, strain) = match &self.stage {
            Stage::Telling(fit, posterior, strain) => (fit, *posterior, *strain),
            Stage::Places(places, fit, strain) => {
                let anywhere = || {
                    let mut at = Posterior::at(fit, noise_n2);
                    if self.pending.fall() < TELLING {
                        at.begin_anywhere();
                    }
                    at
                };
                let so_far = places.so_far(fit, noise_n2).unwrap_or_else(anywhere);
                (fit, strain.around(so_far, fit, noise_n2), *strain)
            }
            Stage::New | Stage::Free(_) | Stage::Expected(_) => {
                return Outcome::Failed(Reason::TooShort);
            }
        };
        outcome(measured(learnt, &data, fit, posterior, strain, noise_n2), strain)
    }

    fn start(&mut self, learnt: &mut Expectations) -> ControlFlow<Outcome> {
        if let Some(reason) = self.pending.refused {
            return ControlFlow::Break(Outcome::Failed(reason));
        }
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
                let own_n2 = larger(self.pending.least_n2(squares_n2 / free), noise_n2);
                self.pending.noise_n2 = self.pending.noise_n2.min(own_n2);
            }
        }
        self.pending.expect(fit.map(|fit| fit.cycle));
        self.stage = Stage::Expected(self.begin(learnt, learnt.noise_n2(&self.pending)));
        ControlFlow::Continue(())
    }

    fn begin(&self, learnt: &Expectations, noise_n2: f32) -> Fitting {
        self.pending.begin_again(&self.after).unwrap_or_else(|| {
            let data = learnt.data(&self.pending, &self.after, noise_n2);
            self.pending.guess(&data, learnt.knows_omega())
        })
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
        let Some(mut fit) = fit.filter(holds) else {
            // Corners that are not there may be why.
            learnt.corner = Kept::default();
            learnt.contradict();
            return ControlFlow::Break(Outcome::Failed(Reason::NoFit));
        };
        if let Some(reason) = pending.hidden {
            return ControlFlow::Break(Outcome::Failed(reason));
        }
        let (squares_n2, free) = own_residuals(&data, &fit);
        // Without what is left around the line after it, which fits whatever the slip does.
        let (line_n2, points) = (self.after.residual(), (self.after.weight - 2.0).max(0.0));
        let around_n2 = squares_n2 - line_n2;
        let misfit = learnt.is_misfit(pending, around_n2, free - points);
        let counts = free >= 1.0 && !misfit;
        if counts {
            let squares_n2 = free * pending.least_n2(squares_n2 / free);
            learnt.residuals.add(squares_n2, free, pending.noise_n2);
        }
        let now_n2 = learnt.noise_n2(pending);
        fit.scale(excess_ratio(around_n2, free - points, now_n2));
        if counts {
            // Where the noise is not known yet, the lines have it.
            let (lines_n2, lines) = pending.line_residuals(&self.after);
            let quiet_n2 = larger(noise_n2, lines_n2 / larger(lines, 1.0));
            let (slip, wider) = data.slip_scatter(&fit, quiet_n2);
            // A force that wanders does so in the slip as well.
            if pending.wander.level <= 0.0 {
                learnt.slip.learn(&slip);
            }
            fit.widen(&wider, learnt.slip.excess());
            fit.widen(&Variances::UNSURE_SWING, learnt.unsure_swing(pending, now_n2));
        }
        let strained = is_strained(&data, around_n2, now_n2);
        let strain = match (misfit, strained) {
            (true, _) => Strain::Misfit,
            (_, true) => Strain::Strained,
            _ => Strain::None,
        };
        let places = OverOnset::new(&fit, learnt.knows_omega()).filter(|_| !misfit);
        self.stage = match places {
            Some(places) => Stage::Places(places, fit, strain),
            None => Stage::Telling(fit, Posterior::at(&fit, now_n2), strain),
        };
        self.fitted_n2 = noise_n2;
        ControlFlow::Continue(())
    }

    fn place(&mut self, learnt: &mut Expectations) -> ControlFlow<Outcome> {
        let Stage::Places(places, fit, strain) = &mut self.stage else {
            return ControlFlow::Continue(());
        };
        let noise_n2 = learnt.noise_n2(&self.pending);
        let data = learnt.data(&self.pending, &self.after, noise_n2);
        if let ControlFlow::Break(posterior) = places.step(&data, fit, noise_n2) {
            let posterior = strain.around(posterior, fit, noise_n2);
            self.stage = Stage::Telling(*fit, posterior, *strain);
            self.fitted_n2 = noise_n2;
        }
        ControlFlow::Continue(())
    }

    /// Carries what the event tells to the next ones.
    fn tell(
        &self,
        learnt: &mut Expectations,
        fit: &Fit,
        posterior: Posterior,
        strain: Strain,
    ) -> ControlFlow<Outcome> {
        let noise_n2 = learnt.noise_n2(&self.pending);
        let data = learnt.data(&self.pending, &self.after, self.fitted_n2);
        let mut measured = measured(learnt, &data, fit, posterior, strain, noise_n2);
        let posterior = &mut measured.posterior;
        let shows = posterior.is_resolved() && is_clear(posterior);
        // A slip of two samples shows nothing of its corners.
        if measured.verdict == Verdict::Same && strain == Strain::None && shows {
            let correction = learnt.learn_terms(&data, fit, noise_n2);
            posterior.take(&correction);
            if let Some(alone) = &mut measured.alone {
                alone.take(&correction, noise_n2);
            }
        }
        ControlFlow::Break(outcome(measured, strain))
    }
}

/// How far the samples around the slip are from the fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Strain {
    None,
    /// Too far to learn from.
    Strained,
    /// So far that the model does not describe them.
    Misfit,
}

impl Strain {
    /// What the places of an onset tell: that the event leaves far more than the noise they do not
    /// know.
    fn around(self, posterior: Posterior, fit: &Fit, noise_n2: f32) -> Posterior {
        match self {
            Self::None => posterior,
            Self::Strained | Self::Misfit => posterior.widened(&Posterior::at(fit, noise_n2)),
        }
    }
}

/// Iterations of a fit with so many samples around the slip in the time that this many samples
/// take; lines and factorisation take as long as some more.
pub(crate) fn iterations_within(time: usize, samples: usize) -> usize {
    const OTHER: usize = 6;
    time.checked_div(samples + OTHER).unwrap_or(1)
}

fn measured(
    learnt: &mut Expectations,
    data: &Data<'_>,
    fit: &Fit,
    mut posterior: Posterior,
    strain: Strain,
    noise_n2: f32,
) -> Measured {
    if data.wander.level <= 0.0 {
        posterior.common_n2 = fit.wider_n2(noise_n2);
    }
    let alone = fit.forces_alone(data.rate).filter(|_| posterior.is_resolved());
    let strained = posterior.is_resolved() && strain != Strain::None;
    let verdict = learnt.learn(data, &posterior, noise_n2, strained);
    Measured { posterior, alone, noise_n2, verdict }
}

/// A misfit counts only as a sign of another block.
fn outcome(measured: Measured, strain: Strain) -> Outcome {
    if strain == Strain::Misfit && measured.verdict != Verdict::Suspect {
        return Outcome::Failed(Reason::NoFit);
    }
    Outcome::Fitted(measured)
}
