//! Steps that follow the end of a stick line. They begin when the fit of the event before is done.

use crate::cycle::cycle_fit::CycleFit;
use crate::cycle::ended::{By, Ended};
use crate::cycle::refusal;
use crate::cycle::slip_record::{GUESSED, SlipRecord};
use crate::cycle::{CycleTracker, LATE, Work};
use crate::detector::{Detector, Stick};
use crate::effect::Kept;
use crate::event::{Provisional, Reason};
use crate::model::elongation::Elongation;
use crate::sample::{SampleTime, since};

/// Time to gather the samples of a slip, in units of 160 instructions on the board.
const SLIP: usize = 18;
/// Time to refit both lines of a sagging cable, or to estimate an oscillation about a line.
const BENT: usize = 28;
/// Time to guess where the fit of a slip begins, and to compare several guesses.
const GUESS: usize = 9;
const GUESSES: usize = 33;
/// Time to give the event before its lines, and time for a first answer.
const LINES: usize = 8;
const ANSWER: usize = 9;

/// Number of events from which on a stick line begins with the samples right after a slip: before
/// the first event nothing shows whether the cable flops there. Tuned: with none the mean `mu_s` of
/// a record with flop is at times biased, with two one more event of a thousand with stamps that
/// jitter is an outlier.
const FLOP_SEEN: u32 = 1;
/// A line with fewer samples than this needs the samples after a slip from the first event on; it
/// is too short to show flop.
const BRIEF: u32 = 8;

impl CycleTracker {
    /// Time of the next step, in units of 160 instructions on the board.
    pub(super) fn takes(&self, ended: &Ended, detector: &Detector) -> usize {
        match (&self.work, &self.pending) {
            (Work::Fit(_), before) => {
                // An oscillation in the rests of the slip before this one may be in the rests of
                // this one too.
                let swings = before.as_ref().is_some_and(|slip| slip.wander.is_disputed());
                let bends = swings || ended.may_sag(&self.learnt, detector);
                SLIP + if bends { BENT } else { 0 }
            }
            (Work::Gathered, Some(slip)) if !self.learnt.knows_omega() => {
                GUESSES + slip.samples().forces_n.len().min(GUESSED) * 5 / 2
            }
            (Work::Gathered, _) => GUESS,
            (Work::Answering { priors, .. }, Some(slip)) => slip.pass(priors),
            (Work::Answering { .. } | Work::Answered(_), _) => {
                // The test for an even fall looks at each sample of a long fall.
                let fall = self.finishing.as_ref().map_or(0.0, |fit| fit.slip.fall());
                let is_bent = self.finishing.as_ref().is_some_and(|CycleFit { slip, .. }| {
                    slip.elongation.sags() || slip.wander.is_disputed()
                });
                let answer = if matches!(self.work, Work::Answered(None)) { 0 } else { ANSWER };
                LINES + answer + fall as usize + if is_bent { BENT } else { 0 }
            }
        }
    }

    /// Does the next step; the fit of the event before is done.
    pub(super) fn follow_up(&mut self, detector: &Detector, first: &mut Option<Provisional>) {
        match &self.work {
            Work::Fit(_) => self.take_up(detector),
            Work::Gathered => self.begin_first(),
            Work::Answering { .. } => self.step_first(),
            Work::Answered(_) => *first = self.give_lines(detector),
        }
    }

    /// Takes up the end of a stick line: the pending event becomes the one to be fitted, and the
    /// slip that ended the line becomes the pending one. The event gets its lines later, when the
    /// first answer on that slip gives the onset.
    fn take_up(&mut self, detector: &Detector) {
        let Some(ended) = &self.ended else { return };
        let Ended { stick, by } = ended;
        let (start, may_sag) = (self.start(stick), ended.may_sag(&self.learnt, detector));
        // Not with `map`: the fit is constructed in place.
        self.finishing = None;
        if let Some(before) = &self.pending {
            self.finishing = Some(CycleFit::new(before));
        } else {
            // A gap lies in the rest before this slip, or it is the first.
            (self.last_stop, self.rested) = (None, Kept::default());
        }
        self.work = match by {
            By::Slip(slip) => {
                let cable = if may_sag {
                    self.learnt.sag.read(|sag| sag.elongation(slip.low.force_n))
                } else {
                    Elongation::default()
                };
                let next =
                    self.pending.insert(SlipRecord::new(detector, stick, start, slip, cable));
                next.gather(&detector.window, slip);
                if next.wander.is_disputed() {
                    let angle = self.learnt.oscillation.read(|it| it.angle(next.wander.angle));
                    next.take_oscillation(&detector.window, stick, angle);
                }
                if may_sag {
                    next.take_late(&detector.window, stick);
                }
                if detector.waiting() > LATE { Work::Answered(None) } else { Work::Gathered }
            }
            By::Loss(_) => {
                self.pending = None;
                Work::Answered(None)
            }
        };
        if let (Some(next), Some(CycleFit { slip: before, .. })) =
            (&mut self.pending, &mut self.finishing)
        {
            if self.count >= FLOP_SEEN || next.before.count < BRIEF {
                next.lengthen_line(before, stick);
            }
            if self.recurrence.is_aliased(before.periods_to(next)) {
                next.refused = Some(Reason::Aliased);
                before.refused = next.refused;
            }
        }
    }

    /// First index of an event's samples: where the stick line ends, or, after a rest too brief for
    /// a line, right after the cable began to load.
    fn start(&self, stick: &Stick) -> u32 {
        let load = if stick.line.count < 3 { self.newest_load() } else { None };
        load.map_or(stick.next, |load| stick.next.min((load + 1).max(stick.next.saturating_sub(4))))
    }

    /// The last index before the cable of a resting block last began to load, as estimated so far.
    fn newest_load(&self) -> Option<u32> {
        match &self.pending {
            Some(slip) => {
                slip.early.map(|cycle| SampleTime::after(slip.origin, cycle.shape().loads()).index)
            }
            None => self.last_load,
        }
    }

    /// Gives the event before its lines, up to the next onset of the first answer, and returns that
    /// answer. This is the last step for the end of a line.
    fn give_lines(&mut self, detector: &Detector) -> Option<Provisional> {
        let ended = self.ended.as_ref()?;
        let Work::Answered(first) = &self.work else { return None };
        let first = first.as_ref().filter(|fit| self.shows_slip(fit));
        if let Some(slip) = &mut self.pending {
            slip.take_first_answer(first);
        }
        if let Some(finishing) = &mut self.finishing {
            let (stick, end) = (&ended.stick, ended.end());
            let creep_periods = self.learnt.creep_periods();
            let last = self.pending.as_ref().and_then(|slip| slip.last_before(creep_periods));
            finishing.give_lines(stick, &detector.window, end, last);
            let (slip, after) = (&mut finishing.slip, &finishing.after);
            let periods = since(slip.origin, end) - slip.low.time;
            let rest = (after, stick.highest.force_n);
            let refused = refusal::of_fall(slip, rest, periods, self.slides, self.learnt.swing());
            slip.refused = slip.refused.or(refused);
            self.slides |= slip.refused.is_none() && refusal::takes_time(slip);
        }
        let answer = first.and_then(|fit| self.first_answer(*fit));
        (self.ended, self.work) = (None, Work::default());
        answer
    }
}
