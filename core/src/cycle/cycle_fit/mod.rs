//! The last fit of an event whose lines are complete, and what is made of it, spread over the
//! samples that follow, so that none has to wait for a whole fit.
//!
//! ```text
//!        iterations                                 a step each
//! New ──► Free ──► Expected ──► Fitted ──► Telling ──► Terms ──► Corner ──► Told
//!                                  └► Places ┘  hardly resolved: averaged over the onset
//! ```

mod after_fit;

use core::ops::ControlFlow;

use crate::cycle::cycle_fit::after_fit::Strain;
use crate::cycle::expectations::{Expectations, Expected, own_residuals};
use crate::cycle::refusal::SURE;
use crate::cycle::slip_record::SlipRecord;
use crate::effect::Kept;
use crate::effects::mass_change::Verdict;
use crate::event::Reason;
use crate::fit::over_onset::OverOnset;
use crate::fit::posterior::Posterior;
use crate::fit::{Alone, Fit, Fitting, Forces};
use crate::num::math::{self, larger};
use crate::stats::line::Line;

/// Iterations that are still made when the next event wants to be fitted.
const LEFT: usize = 8;

/// Periods from the highest to the lowest sample that tell when a slip began and how long it took:
/// a single sample in between could be anywhere in slips of many lengths.
const TELLING: f32 = 3.0;

/// An event being fitted.
// In this order: the record is copied straight into its place, as words.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct CycleFit {
    pub(crate) pending: SlipRecord,
    after: Line,
    stage: Stage,
    /// What the fit expects: the same from its beginning to its end.
    expected: Expected,
    /// The fit, once there is one.
    fit: Fit,
    /// Whether the samples around the slip are far from it.
    strain: Strain,
    /// What it tells, as far as the stage has come.
    pub(crate) measured: Measured,
}

// What it holds begins on a word, so that it is copied by words.
#[derive(Clone, Copy, Debug)]
#[repr(u32)]
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
    /// Fitted; how far the samples are from that is still to be seen.
    Fitted,
    /// Averaged over the onset.
    Places(OverOnset),
    /// Its unknowns are known; what they tell the next events is still to be learnt.
    Telling,
    /// Measured; what the slip's samples tell of other force terms is still to be learnt.
    Terms,
    /// The same of its corners; with the variance of `Fs` by the other terms, N².
    Corner(Alone, f32),
    /// All is known.
    Told,
}

/// What the fit of an event tells.
#[derive(Clone, Copy, Debug, Default)]
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
    Fitted,
    /// Only seen.
    Failed(Reason),
}

impl CycleFit {
    // Made where it is kept.
    #[inline(always)]
    pub(crate) fn new(pending: &SlipRecord, after: Line) -> Self {
        Self {
            pending: *pending,
            after,
            stage: Stage::New,
            expected: Expected::default(),
            fit: Fit::default(),
            strain: Strain::None,
            measured: Measured::default(),
        }
    }

    /// Does the last sample show the stick line that starts at a time, clearly above its start? A
    /// fit without it ends where the last samples would begin to contradict.
    pub(crate) fn shows(&self, start: f32) -> bool {
        let risen_n = self.pending.rate() * (self.pending.samples().end() - start);
        self.after.count > 0 || risen_n > SURE * math::sqrt(self.pending.noise_n2)
    }

    /// One step: an iteration, or what comes after the fit.
    pub(crate) fn step(&mut self, learnt: &mut Expectations) -> ControlFlow<Outcome> {
        match &self.stage {
            Stage::New => self.start(learnt),
            Stage::Free(_) => self.free(learnt),
            Stage::Expected(_) => self.expected(learnt),
            Stage::Fitted => self.judge(learnt),
            Stage::Places(_) => self.place(),
            Stage::Telling => self.tell(learnt),
            Stage::Terms => self.terms(learnt),
            Stage::Corner(..) => self.corner(learnt),
            Stage::Told => ControlFlow::Break(self.outcome()),
        }
    }

    /// Steps a sample, as many as one has time for. With fewer passes over the samples first events
    /// in quick succession have no fit in time.
    pub(crate) fn iterations(&self) -> usize {
        const TIME: usize = 52;
        let most = match &self.stage {
            Stage::New | Stage::Free(_) | Stage::Expected(_) => 3,
            Stage::Places(places) => places.steps_a_sample(self.pending.limit),
            Stage::Fitted | Stage::Telling | Stage::Terms | Stage::Corner(..) | Stage::Told => {
                return 1;
            }
        };
        iterations_within(TIME, self.pending.samples().forces_n.len()).clamp(1, most)
    }

    /// Is the next step as long as all that a sample has time for?
    pub(crate) fn is_long(&self) -> bool {
        self.is_known() || matches!(self.stage, Stage::Fitted)
    }

    /// Are its unknowns known?
    fn is_known(&self) -> bool {
        matches!(self.stage, Stage::Telling | Stage::Terms | Stage::Corner(..) | Stage::Told)
    }

    /// What there is when no time is left: what was measured, with all that follows from it, or no
    /// fit. An onset whose places were not looked at as far as it is likely may be anywhere, unless
    /// samples enough lie in the slip.
    pub(crate) fn cut(&mut self, learnt: &mut Expectations) -> Outcome {
        for _ in 0..LEFT {
            if self.is_known() || matches!(self.stage, Stage::Places(_)) {
                break;
            }
            if let ControlFlow::Break(outcome) = self.step(learnt) {
                return outcome;
            }
        }
        if let Stage::Places(places) = &self.stage {
            let (fit, noise_n2) = (&self.fit, self.expected.noise_n2);
            let anywhere = || {
                let mut at = Posterior::at(fit, noise_n2);
                if self.pending.fall() < TELLING {
                    at.begin_anywhere();
                }
                at
            };
            let so_far = places.so_far(fit, noise_n2).unwrap_or_else(anywhere);
            self.measured.posterior = self.strain.around(so_far, fit, noise_n2);
            self.stage = Stage::Telling;
        }
        while self.is_known() {
            if let ControlFlow::Break(outcome) = self.step(learnt) {
                return outcome;
            }
        }
        Outcome::Failed(Reason::TooShort)
    }

    fn start(&mut self, learnt: &mut Expectations) -> ControlFlow<Outcome> {
        if let Some(reason) = self.pending.refused {
            return ControlFlow::Break(Outcome::Failed(reason));
        }
        learnt.weigh(&self.pending);
        let known = learnt.residuals.variance_n2().is_some();
        let noise_n2 = learnt.fitted_noise_n2(&self.pending);
        let fitting = self.begin(learnt, noise_n2);
        self.stage = if known { Stage::Expected(fitting) } else { Stage::Free(fitting) };
        ControlFlow::Continue(())
    }

    fn free(&mut self, learnt: &Expectations) -> ControlFlow<Outcome> {
        let Stage::Free(fitting) = &mut self.stage else { return ControlFlow::Continue(()) };
        let noise_n2 = self.expected.noise_n2;
        let data = self.expected.data(&self.pending, &self.after);
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
        self.pending.expect(fit.map(|fit| *fit.cycle()));
        let noise_n2 = learnt.noise_n2(&self.pending);
        self.stage = Stage::Expected(self.begin(learnt, noise_n2));
        ControlFlow::Continue(())
    }

    fn begin(&mut self, learnt: &Expectations, noise_n2: f32) -> Fitting {
        self.expected = learnt.of(&self.pending, &self.after, noise_n2);
        self.pending.begin_again(&self.after).unwrap_or_else(|| {
            let data = self.expected.data(&self.pending, &self.after);
            self.pending.guess(&data, learnt.knows_omega())
        })
    }

    fn expected(&mut self, learnt: &mut Expectations) -> ControlFlow<Outcome> {
        let Stage::Expected(fitting) = &mut self.stage else { return ControlFlow::Continue(()) };
        let pending = &self.pending;
        let data = self.expected.data(pending, &self.after);
        let ControlFlow::Break(fit) = fitting.step(&data, self.expected.noise_n2) else {
            return ControlFlow::Continue(());
        };
        let holds = |fit: &&Fit| fit.converged && pending.holds(&fit.shape);
        let Some(fit) = fit.as_ref().filter(holds) else {
            // Corners that are not there may be why.
            learnt.corner = Kept::default();
            learnt.contradict();
            return ControlFlow::Break(Outcome::Failed(Reason::NoFit));
        };
        if let Some(reason) = pending.hidden {
            return ControlFlow::Break(Outcome::Failed(reason));
        }
        (self.fit, self.stage) = (*fit, Stage::Fitted);
        ControlFlow::Continue(())
    }

    fn place(&mut self) -> ControlFlow<Outcome> {
        let Stage::Places(places) = &mut self.stage else { return ControlFlow::Continue(()) };
        let (fit, noise_n2) = (&self.fit, self.expected.noise_n2);
        let data = self.expected.data(&self.pending, &self.after);
        if let ControlFlow::Break(posterior) = places.step(&data, fit, noise_n2) {
            self.measured.posterior = self.strain.around(posterior, fit, noise_n2);
            self.stage = Stage::Telling;
        }
        ControlFlow::Continue(())
    }
}

/// Iterations of a fit with so many samples around the slip in the time that this many samples
/// take; lines and factorisation take as long as some more.
pub(crate) fn iterations_within(time: usize, samples: usize) -> usize {
    const OTHER: usize = 6;
    time.checked_div(samples + OTHER).unwrap_or(1)
}
