//! From transitions to events: the lines and samples around a slip, fitted.
//!
//! ```text
//!  onset ──► re-stick ──► a sample later ──► next re-stick ───► some samples later
//!  mu_s      pending      first answer       finishing: fit     outcome: the event
//! ```
//!
//! While the stick line after a slip still grows, the slip is *pending*. When the next slip has
//! ended that line, the event is *finishing*: its fit is made. Fits and first answers take longer
//! than one sample period, so they are made in steps, as many per sample as there is time for
//! ([`CycleTracker::follow`]). A slip that ends before the current fit waits in `ended`.

mod cable;
mod change;
mod contradictions;
mod cycle_fit;
mod ended;
mod expectations;
mod first_answer;
mod follow_up;
mod found;
mod outcome;
mod readings;
mod refusal;
mod slip_record;
mod terms;

use core::ops::ControlFlow;

use crate::coefficient::{Coefficient, Site};
use crate::cycle::cycle_fit::{CycleFit, FitStage};
use crate::cycle::ended::Ended;
use crate::cycle::expectations::Expectations;
use crate::cycle::refusal::{Recurrence, Slackness};
use crate::cycle::slip_record::SlipRecord;
use crate::detector::{Detector, Transition};
use crate::effect::{Effect, Effects, Kept};
use crate::effects::level_shift::{Change, Levels};
use crate::event::{Event, Provisional};
use crate::fit::{Fit, Fitting, Priors};
use crate::sample::SampleTime;

/// A complete event.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Finished {
    /// The event, with all corrections applied.
    pub event: Event,
    /// `mu_s` and `mu` estimated without the prior of the loading rate, for means over events: the
    /// error of that prior is the same in all events and does not average out.
    pub alone: Option<(Coefficient, Coefficient)>,
    /// Part of the standard deviations of `mu_s` and `mu` that is common to all events.
    pub common: (f32, f32),
    /// A change that this event showed.
    pub change: Option<Change>,
}

impl From<Event> for Finished {
    #[inline(never)]
    fn from(event: Event) -> Self {
        Self { event, alone: None, common: (0.0, 0.0), change: None }
    }
}

/// The one computation under way: the fit of an event, or, when that is done, what follows the end
/// of the next stick line. With nothing to do it is a fit that has not begun.
#[derive(Clone, Debug)]
#[allow(clippy::large_enum_variant, reason = "there is one, and no heap to put it on")]
enum Work {
    Fit(FitStage),
    /// The slip that ended the line is the pending one, its samples gathered.
    Gathered,
    /// The first answer on the pending slip is being computed.
    Answering {
        priors: Priors,
        fitting: Fitting,
        /// Steps of the fit that are still allowed.
        left: usize,
    },
    /// The first answer is done (`None` without a fit); the event before does not have its lines
    /// yet.
    Answered(Option<Fit>),
}

impl Default for Work {
    fn default() -> Self {
        Self::Fit(FitStage::New)
    }
}

/// Builds events.
#[derive(Clone, Debug, Default)]
pub(crate) struct CycleTracker {
    site: Site,
    learnt: Expectations,
    /// The last slip, whose second stick line still grows.
    pending: Option<SlipRecord>,
    /// The slip before it, being fitted.
    finishing: Option<CycleFit>,
    /// The end of the stick line after `pending`, kept until the next slip has its first answer.
    ended: Option<Ended>,
    work: Work,
    levels: Kept<Levels, { Effect::Level.room() }>,
    /// The first event after what may be a change: its number and its onset.
    suspect: Option<(u32, SampleTime)>,
    /// Stop of the last event, and the last index before its cable began to load again.
    last_stop: Option<SampleTime>,
    last_load: Option<u32>,
    /// Stop of the last event, the force there, N, and its variance, N², where the following rest
    /// can determine the sag of the cable.
    rested: Kept<Option<(SampleTime, f32, f32)>, { Effect::Sag.room() }>,
    count: u32,
    /// At least one slip of this test has a sample on its fall. A hand that lets the cable go shows
    /// none.
    slides: bool,
    recurrence: Recurrence,
    slackness: Slackness,
}

impl CycleTracker {
    /// Before the first event.
    // In one piece: field by field, where it is called, it takes some hundred bytes of flash more.
    #[inline(never)]
    pub(crate) fn new(site: Site, effects: Effects) -> Self {
        let learnt = Expectations::new(effects, site.momentum);
        Self { site, learnt, ..Self::default() }
    }

    /// Decrements the event count: the last event turned out to be no slip.
    pub(crate) fn withdraw(&mut self) {
        self.count = self.count.saturating_sub(1);
    }

    /// Takes the detector's transition; `last_hidden` is the newest saturated index. If an earlier
    /// end of a stick line still waits as another comes, for the window has no room for more samples,
    /// its remaining steps are done at once. Then does as many steps as the time of a sample allows,
    /// and at least one.
    pub(crate) fn follow(
        &mut self,
        detector: &Detector,
        transition: Option<Transition>,
        last_hidden: Option<u32>,
        answers: &mut Answers,
    ) {
        let mut spent = detector.spent;
        let ended = match transition {
            Some(Transition::Restick { peak, low }) => {
                Some(Ended::by_slip(detector, (peak, low), last_hidden))
            }
            // The stick line that a long gap ends also ends the pending event.
            Some(Transition::Lost) => Some(Ended::by_loss(&detector.ended, detector.lost())),
            None | Some(Transition::Onset | Transition::Cancelled) => None,
        };
        if ended.is_some() {
            while self.ended.is_some() {
                spent += self.next_takes(detector);
                self.advance(detector, answers);
            }
            self.ended = ended;
        }
        let time = if detector.waiting() > 0 { MOST_TIME } else { TIME };
        let mut left = time.saturating_sub(spent);
        while answers.finished.is_none() {
            let takes = self.next_takes(detector);
            if takes == 0 || (takes > left && left < TIME) {
                break;
            }
            left = left.saturating_sub(takes);
            self.advance(detector, answers);
        }
    }

    /// Is no step left to do?
    pub(crate) fn is_idle(&self) -> bool {
        self.finishing.is_none() && self.ended.is_none()
    }

    /// Is there no room for the end of another stick line?
    pub(crate) fn is_full(&self) -> bool {
        self.ended.is_some()
    }

    /// Does the next step.
    fn advance(&mut self, detector: &Detector, answers: &mut Answers) {
        let (Work::Fit(stage), Some(fit)) = (&mut self.work, &mut self.finishing) else {
            return self.follow_up(detector, &mut answers.first);
        };
        if let ControlFlow::Break(failed) = fit.step(stage, &mut self.learnt, detector.waiting()) {
            answers.finished = self.end(failed);
        }
    }

    /// Time of the next step, in the units of [`TIME`]; zero if no step is left.
    fn next_takes(&self, detector: &Detector) -> usize {
        if let (Work::Fit(stage), Some(fit)) = (&self.work, &self.finishing) {
            return fit.next_takes(stage, self.learnt.knows_omega(), detector.waiting());
        }
        self.ended.as_ref().map_or(0, |ended| self.takes(ended, detector))
    }

    /// Ends the test: completes the remaining events, one per call, until `None`.
    pub(crate) fn finish(&mut self, detector: &Detector) -> Option<Finished> {
        let mut answers = Answers::default();
        while answers.finished.is_none() {
            if self.is_idle() {
                self.pending.as_ref()?;
                let end = detector.last.index + 1;
                self.ended = Some(Ended::by_loss(&detector.stick, end));
            }
            self.advance(detector, &mut answers);
        }
        answers.finished
    }
}

/// What a step of the work led to.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Answers {
    /// A first answer on the last slip.
    pub first: Option<Provisional>,
    /// An event that is complete.
    pub finished: Option<Finished>,
}

/// Time of a sample, in units of 160 instructions on the board, as the emulator counts them
/// (`docs/firmware.md`); with the detector's share at rest, less than 12 000 instructions.
const TIME: usize = 62;
/// Time of a sample while others wait: the detector looks at several of them then, and seldom has
/// more to do.
const MOST_TIME: usize = 69;
/// Number of waiting samples above which no step is done that an event's coefficients do not need.
/// Tuned: with fewer, first events are less certain whose samples waited for the noise to be known;
/// with more, the window fills before the others are worked off.
const LATE: u32 = 160;
