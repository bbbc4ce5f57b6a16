//! The last fit of an event, made when both its lines are complete, and the steps that learn from
//! it. One step follows another over the next samples, so that no sample has to wait for a whole
//! fit.
//!
//! ```text
//!        iterations                                  a step each
//! New ──► Free ──► Expected ──► Converged ──► Fitted ──► Learning ──► Alone ──► Asked ──► Done
//!  │                  │             │            └► Places ┘  hardly resolved: averaged over the onset
//!  └──────────────────┴─────────────┴─► Failed    without a fit
//! ```

mod after_fit;
mod score_test;

use core::ops::ControlFlow;

use crate::cycle::LATE;
use crate::cycle::cycle_fit::after_fit::Strain;
use crate::cycle::cycle_fit::score_test::LEVELS_A_STEP;
use crate::cycle::expectations::{Expectations, own_residuals};
use crate::cycle::refusal;
use crate::cycle::slip_record::{GUESSED, SHORTEST_FALL, SlipRecord};
use crate::detector::{MOST_PUT_OFF, Stick};
use crate::effect::{Effect, Kept};
use crate::effects::mass_change::Verdict;
use crate::effects::score::Asked;
use crate::event::Reason;
use crate::fit::levenberg_marquardt::Pass;
use crate::fit::over_onset::OverOnset;
use crate::fit::posterior::Posterior;
use crate::fit::{Alone, Fit, Fitting, Forces, Priors};
use crate::noise::sinusoid::{self, Sinusoid};
use crate::num::math::{larger, smaller};
use crate::signal::window::Window;
use crate::stats::line::Line;
use crate::stats::prior::Prior;
use crate::stats::significance::SURE;

/// Recurrence, periods, below which an onset whose places are all as likely is undetermined: a cycle
/// with as many samples as unknowns fits any oscillation, such as hum of 60 Hz sampled at 16 Hz. A
/// choice: with 4.5 or 6 nothing changes.
const FEW: f32 = 5.0;

/// Number of waiting samples above which an event is not fitted any more: a fit that was begun
/// before still has the time of 32 samples.
const TOO_LATE: u32 = MOST_PUT_OFF - 32;

/// An event being fitted.
// In this order: the record is copied straight into its place, as words.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(crate) struct CycleFit {
    pub(crate) slip: SlipRecord,
    pub(crate) after: Line,
    /// The oscillation about `after`, if the noise is an oscillation.
    oscillation: Kept<Sinusoid, { Effect::Ripple.room() }>,
    /// The event's priors: loosened where its fit contradicts them, and adapted to the noise by then
    /// where the onset is averaged. Their noise is that of the fit until its residuals are judged,
    /// then the one that is known with these.
    priors: Priors,
    /// The fit, once it has converged, and the prior of the rate in its normal equations.
    fit: Fit,
    rate: Prior,
    /// Misfit of the samples around the slip, and the factor by which it multiplied the variances.
    strain: Strain,
    excess: f32,
    /// The fit contradicts the prior of the loading rate; and those of the winch were loosened.
    is_other: bool,
    is_loosened: bool,
    /// Estimates of the event so far.
    pub(crate) measured: Measured,
}

// The data begin on a word, so that they are copied by words.
#[derive(Clone, Copy, Debug)]
#[repr(u32)]
#[allow(clippy::large_enum_variant, reason = "there is one, and no heap to put it on")]
pub(super) enum FitStage {
    /// Nothing done yet.
    New,
    /// Being fitted with almost no weight on the priors.
    ///
    /// Where the block never rests the detector's noise is only an upper bound, far too large, and
    /// would give weak priors too much weight. So this fit comes first: its residuals estimate the
    /// noise.
    Free(Fitting),
    /// Being fitted with the priors.
    Expected(Fitting),
    /// Fitted; the samples are still to be compared with straight lines.
    Converged,
    /// The misfit of the samples is still to be judged.
    Fitted,
    /// Being averaged over places of the onset.
    Places(OverOnset),
    /// The unknowns are estimated; the expectations have still to be updated.
    Learning,
    /// The expectations are updated; the normal equations without priors are being set up.
    Alone(Pass),
    /// Being tested for other force terms (score test), from the level with the last number on.
    Asked(Terms, Alone, Asked, usize),
    /// All steps are done.
    Done,
    /// It has no fit.
    Failed(Reason),
}

/// The force terms of a score test.
#[derive(Clone, Copy, Debug)]
pub(super) enum Terms {
    /// Terms that widen the intervals and shift nothing.
    Widen,
    /// Rounded corners, which shift the forces.
    Corner,
}

/// Estimates from the fit of an event.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Measured {
    pub(crate) posterior: Posterior,
    /// The forces without the prior of the loading rate.
    pub(crate) alone: Option<Forces>,
    /// Result of the test for a change of mass.
    pub(crate) verdict: Kept<Verdict, { Effect::Mass.room() }>,
}

impl CycleFit {
    /// A new fit of a slip whose following line is not known yet.
    // Constructed in place.
    #[inline(always)]
    pub(crate) fn new(slip: &SlipRecord) -> Self {
        Self {
            slip: *slip,
            after: Line::default(),
            oscillation: Kept::default(),
            priors: Priors::default(),
            fit: Fit::default(),
            rate: Prior::default(),
            strain: Strain::None,
            excess: 1.0,
            is_other: false,
            is_loosened: false,
            measured: Measured::default(),
        }
    }

    /// Sets the stick line after the slip. It ends at the next slip's highest sample, or at `last`,
    /// the last index before that slip's onset, if known.
    pub(crate) fn give_lines(
        &mut self,
        stick: &Stick,
        window: &Window,
        next_peak: u32,
        last: Option<u32>,
    ) {
        self.slip.end_before(stick, window, next_peak, last);
        self.after = self.slip.line_after(stick, window, last);
        if self.slip.wander.is_disputed() {
            let range = stick.origin..(stick.origin + sinusoid::MOST).min(stick.next);
            self.oscillation = self.slip.oscillation_about(&self.after, window, range).into();
        }
    }

    /// One step: an iteration of the fit, or one that follows it. `waiting` is the number of
    /// samples that wait for it. Above [`LATE`] no step is done that the coefficients do not need,
    /// and above [`TOO_LATE`] slips recur faster than they can be fitted. Breaks after the last one,
    /// with the reason why the event has no coefficients, if there is one.
    #[inline(never)]
    pub(super) fn step(
        &mut self,
        stage: &mut FitStage,
        learnt: &mut Expectations,
        waiting: u32,
    ) -> ControlFlow<Option<Reason>> {
        let late = waiting > LATE;
        match stage {
            FitStage::New | FitStage::Free(_) | FitStage::Expected(_) if waiting > TOO_LATE => {
                *stage = FitStage::Failed(Reason::TooShort);
            }
            FitStage::New => self.start(stage, learnt),
            FitStage::Free(_) => self.free(stage, learnt),
            FitStage::Expected(_) => self.expected(stage, learnt),
            FitStage::Converged => {
                let wound_back = refusal::is_angular(&self.slip, &self.fit.shape, &self.after);
                let failed = FitStage::Failed(Reason::WoundBack);
                *stage = if wound_back { failed } else { FitStage::Fitted };
            }
            FitStage::Fitted => self.judge(stage, learnt),
            FitStage::Places(_) => self.place(stage, late),
            FitStage::Learning => self.learn(stage, learnt),
            // Never reached without force terms to test: their code is then left out of the image.
            FitStage::Alone(_) if learnt.asks() && !late => self.alone(stage),
            FitStage::Asked(..) if learnt.asks() && !late => self.asked(stage, learnt),
            FitStage::Alone(_) | FitStage::Asked(..) | FitStage::Done => {
                return ControlFlow::Break(self.refused());
            }
            FitStage::Failed(reason) => return ControlFlow::Break(Some(*reason)),
        }
        ControlFlow::Continue(())
    }

    /// Time that the next step takes, in units of 160 instructions on the board. Without the swing
    /// from earlier events several guesses may have to be compared.
    pub(super) fn next_takes(&self, stage: &FitStage, knows_omega: bool, waiting: u32) -> usize {
        let samples = self.slip.samples().forces_n.len();
        match stage {
            FitStage::New if waiting > TOO_LATE => 1,
            FitStage::Places(_) if waiting > LATE => 3,
            FitStage::New if self.slip.begins_again(&self.after) => 12,
            FitStage::New if knows_omega => 18,
            FitStage::New => 40 + samples.min(GUESSED) * 5 / 2,
            FitStage::Free(_) => 34 + self.slip.pass(&self.priors),
            FitStage::Expected(_) => 4 + self.slip.pass(&self.priors),
            FitStage::Places(_) => 10 + self.slip.pass(&self.priors),
            FitStage::Converged => 34,
            FitStage::Fitted => 27 + 5 * (self.slip.fall() as usize).min(8),
            // More with an oscillation about the lines, whose source is then estimated, or with a
            // cable that sags, whose elongation is converted back.
            FitStage::Learning => {
                let SlipRecord { wander, elongation, .. } = &self.slip;
                22 + if wander.is_disputed() || elongation.sags() { 6 } else { 0 }
            }
            FitStage::Alone(_) => 4 + self.slip.pass(&self.priors),
            FitStage::Asked(Terms::Widen, .., next) => {
                12 + (samples + 2 - next).min(LEVELS_A_STEP) * 3 / 2
            }
            FitStage::Asked(Terms::Corner, .., next) => {
                24 + 3 * (samples + 2 - next).min(LEVELS_A_STEP)
            }
            FitStage::Done => 46,
            FitStage::Failed(_) => 20,
        }
    }

    fn start(&mut self, stage: &mut FitStage, learnt: &mut Expectations) {
        if let Some(reason) = self.slip.refused {
            *stage = FitStage::Failed(reason);
            return;
        }
        learnt.weigh(&self.slip);
        let known = learnt.residuals.variance_n2().is_some();
        let noise_n2 = learnt.fitted_noise_n2(&self.slip);
        let fitting = self.begin(learnt, noise_n2);
        *stage = if known { FitStage::Expected(fitting) } else { FitStage::Free(fitting) };
    }

    fn free(&mut self, stage: &mut FitStage, learnt: &Expectations) {
        let FitStage::Free(fitting) = stage else { return };
        let noise_n2 = self.priors.noise_n2;
        let data = self.slip.data(&self.priors, &self.after);
        let ControlFlow::Break(fit) = fitting.step(&data) else {
            return;
        };
        if let Some(fit) = &fit {
            let (squares_n2, free) = own_residuals(&data, fit);
            if free >= 1.0 {
                // At least the variance of a converter's steps.
                let own_n2 = squares_n2 / free;
                let own_n2 = larger(larger(own_n2, self.slip.step_n2(own_n2)), noise_n2);
                self.slip.noise_n2 = smaller(self.slip.noise_n2, own_n2);
            }
        }
        self.slip.begin_from(fit.as_ref());
        let noise_n2 = learnt.noise_n2(&self.slip);
        *stage = FitStage::Expected(self.begin(learnt, noise_n2));
    }

    fn begin(&mut self, learnt: &Expectations, noise_n2: f32) -> Fitting {
        self.priors = learnt.of(&self.slip, &self.after, noise_n2);
        self.slip.begin_again(&self.after).unwrap_or_else(|| {
            let data = self.slip.data(&self.priors, &self.after);
            self.slip.guess(&data, learnt.knows_omega())
        })
    }

    fn expected(&mut self, stage: &mut FitStage, learnt: &mut Expectations) {
        let FitStage::Expected(fitting) = stage else { return };
        let slip = &self.slip;
        let data = slip.data(&self.priors, &self.after);
        let ControlFlow::Break(fit) = fitting.step(&data) else {
            return;
        };
        let holds = |fit: &&Fit| fit.converged && slip.holds(&fit.shape);
        let Some(fit) = fit.as_ref().filter(holds) else {
            learnt.contradict(true);
            *stage = FitStage::Failed(Reason::NoFit);
            return;
        };
        let by_rate_n2 = fit.by_rate_n2(self.priors.rate);
        self.is_other |= by_rate_n2 > SURE * SURE * self.priors.noise_n2;
        // Without a line only the prior determines the rate, and that of a cable that sags depends on
        // what is known of the sag.
        let is_own = slip.before.count > 0 && !slip.elongation.sags();
        if is_own && !self.is_loosened {
            self.is_loosened = self.priors.loosen(fit);
            if self.is_loosened {
                *stage = FitStage::Expected(Fitting::new(fit.cycle()));
                return;
            }
        }
        (self.fit, self.rate) = (*fit, self.priors.rate);
        let shapely = refusal::is_shapely(slip);
        let next = if shapely { FitStage::Converged } else { FitStage::Fitted };
        *stage = slip.hidden.map_or(next, FitStage::Failed);
    }

    /// Fits the next place of the onset; ends if it is `late`. The onset is then undetermined within
    /// a period to either side, as it is where all places are likely and slips recur fast, unless
    /// enough samples lie in the slip and the cable is taut.
    fn place(&mut self, stage: &mut FitStage, late: bool) {
        let FitStage::Places(places) = stage else { return };
        let mut posterior = if late {
            Posterior::at(&self.fit, self.priors.noise_n2)
        } else {
            let data = self.slip.data(&self.priors, &self.after);
            let ControlFlow::Break(average) = places.step(&data, &self.fit) else { return };
            average
        };
        let is_open = late || (places.is_open() && self.slip.limit < FEW);
        if is_open && (self.slip.fall() < SHORTEST_FALL || !self.fit.cycle().is_taut()) {
            posterior.begin_anywhere();
        }
        self.measured.posterior = posterior;
        self.excess = 1.0;
        *stage = FitStage::Learning;
    }
}
