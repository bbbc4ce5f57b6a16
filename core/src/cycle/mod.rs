//! From transitions to events: the lines and samples around a slip, fitted.
//!
//! ```text
//!  onset ──► force has turned ──► re-stick ──► next re-stick ───► some samples later
//!  mu_s      first answer         pending      finishing: fit     outcome: the event
//! ```
//!
//! While a slip's stick line grows it is *pending*; when the next slip has ended that
//! line it is *finishing*: its fit is made, some iterations a sample. A first answer,
//! from what the other events tell, is there as soon as the force has turned.

mod cable;
mod change;
mod cycle_fit;
mod expectations;
mod first_answer;
mod outcome;
mod readings;
mod refusal;
mod slip_record;
mod terms;

use core::ops::ControlFlow;

use crate::coefficient::{Coefficient, Site};
use crate::cycle::cycle_fit::CycleFit;
use crate::cycle::expectations::Expectations;
use crate::cycle::refusal::Recurrence;
use crate::cycle::slip_record::{SlipRecord, UNSURE};
use crate::detector::{Detector, Stick};
use crate::effect::{Effect, Kept};
use crate::effects::level_shift::{Change, Levels};
use crate::event::{Event, Reason};
use crate::model::CycleParams;
use crate::sample::{ForcePoint, SampleTime, since};
use crate::signal::window::Window;

/// A complete event.
#[derive(Clone, Copy, Debug)]
pub struct Finished {
    /// The best that is known of it.
    pub event: Event,
    /// `mu_s` and `mu` without what other events told of the loading rate: for means
    /// over events, whose errors must not be the same in all of them.
    pub alone: Option<(Coefficient, Coefficient)>,
    /// Part of their standard deviations that is common to all events.
    pub common: (f32, f32),
    /// A change that this event told.
    pub change: Option<Change>,
}

impl From<Event> for Finished {
    fn from(event: Event) -> Self {
        Self { event, alone: None, common: (0.0, 0.0), change: None }
    }
}

/// Builds events.
#[derive(Clone, Debug)]
pub struct CycleTracker {
    site: Site,
    learnt: Expectations,
    /// The last slip.
    pending: Option<SlipRecord>,
    /// The one before it.
    finishing: Option<CycleFit>,
    /// First answer on the slip that has just ended, and the index of its time zero.
    early: Option<(u64, CycleParams)>,
    levels: Kept<Levels, { Effect::Level.room() }>,
    /// The first event after what may be a change.
    suspect: Option<(u32, SampleTime)>,
    /// Stop of the last event, and when its cable began to load.
    last_stop: Option<SampleTime>,
    last_load: Option<SampleTime>,
    /// The same stop and the force there, N, if it was measured.
    rested: Option<(SampleTime, f32)>,
    count: u32,
    /// A slip was seen to take time: the block slides, and no hand lets go.
    slides: bool,
    recurrence: Recurrence,
}

impl CycleTracker {
    /// Before the first event.
    #[must_use]
    // In one piece: field by field, where it is called, it takes some hundred bytes of flash more.
    #[inline(never)]
    pub fn new(site: Site) -> Self {
        Self {
            site,
            learnt: Expectations::new(&site),
            pending: None,
            finishing: None,
            early: None,
            levels: Kept::default(),
            suspect: None,
            last_stop: None,
            last_load: None,
            rested: None,
            count: 0,
            slides: false,
            recurrence: Recurrence::default(),
        }
    }

    /// The last event is none: it takes no number.
    pub fn withdraw(&mut self) {
        self.count = self.count.saturating_sub(1);
    }

    /// The block rests again: the event before has its lines, and this one is pending.
    ///
    /// `last_hidden` is the newest saturated index. Gives the event before that one if
    /// it was not finished yet.
    pub fn restick(
        &mut self,
        detector: &Detector,
        (peak, low): (ForcePoint, ForcePoint),
        last_hidden: Option<u64>,
    ) -> Option<Finished> {
        let (stick, window) = (detector.ended(), detector.window());
        let mut refused = None;
        if let Some(before) = &mut self.pending
            && self.recurrence.is_aliased(since(before.peak.index, peak.index))
        {
            refused = Some(Reason::Aliased);
            before.refused = refused;
        }
        let finished = self.complete(stick, window, peak);
        let mut next = self.slip(stick, detector, (peak, low));
        if last_hidden.is_some_and(|index| index + 4 >= stick.next) {
            next.hidden = Some(Reason::Hidden);
        }
        if let Some((origin, cycle)) = self.early.take() {
            next.know(CycleParams { onset: cycle.onset + since(next.origin, origin), ..cycle });
        }
        next.refused = refused;
        self.pending = Some(next);
        finished
    }

    /// Ends the pending event with what there is of its stick line. Gives the event
    /// before it if it was not finished yet.
    fn complete(
        &mut self,
        stick: &Stick,
        window: &Window,
        next_peak: ForcePoint,
    ) -> Option<Finished> {
        let outcome = self.finishing.as_mut().map(|finishing| finishing.cut(&mut self.learnt));
        let finished = outcome.and_then(|outcome| self.end(outcome));
        let next_onset = self.early.map(|(origin, cycle)| {
            SampleTime::after(origin, cycle.onset - self.creep_periods() - UNSURE).index
        });
        if let Some(pending) = &mut self.pending {
            pending.end_before(stick, window, next_peak.index, next_onset);
            let periods = since(pending.low.index, next_peak.index);
            let after = pending.line_after(stick, window, next_onset);
            let rest = (&after, stick.highest.force_n);
            let swing = self.learnt.swing();
            let refused = refusal::of_fall(pending, rest, periods, self.slides, swing);
            pending.refused = pending.refused.or(refused);
            self.slides |= pending.refused.is_none() && refusal::takes_time(pending);
            self.finishing = Some(CycleFit::new(pending, after));
        }
        self.pending = None;
        finished
    }

    /// The slip between a stick line and now.
    fn slip(
        &self,
        stick: &Stick,
        detector: &Detector,
        extremes: (ForcePoint, ForcePoint),
    ) -> SlipRecord {
        SlipRecord::new(detector, stick, self.start(stick), extremes, self.unfinished())
    }

    /// First index of an event's samples: where the stick line ends, or right after
    /// the cable began to load when the block rested too briefly for a line.
    fn start(&self, stick: &Stick) -> u64 {
        let load = if stick.line.count < 3 { self.newest_load() } else { None };
        load.map_or(stick.next, |load| {
            stick.next.min((load.index + 1).max(stick.next.saturating_sub(4)))
        })
    }

    /// The slip before the one that is going on or has just ended, until it is fitted.
    fn unfinished(&self) -> Option<&SlipRecord> {
        self.pending.as_ref().or(self.finishing.as_ref().map(|f| &f.pending))
    }

    /// When the cable of a resting block last began to load, as far as is known yet.
    fn newest_load(&self) -> Option<SampleTime> {
        match self.unfinished() {
            Some(slip) => {
                slip.early.map(|cycle| SampleTime::after(slip.origin, cycle.shape().loads()))
            }
            None => self.last_load,
        }
    }

    /// Is no fit under way?
    #[must_use]
    pub fn is_idle(&self) -> bool {
        self.finishing.is_none()
    }

    /// Does some iterations of the fit that is under way: no sample waits for a whole fit.
    pub fn work(&mut self) -> Option<Finished> {
        let most = self.finishing.as_ref()?.iterations();
        for done in 0..most {
            let finishing = self.finishing.as_mut()?;
            if done > 0 && finishing.is_long() {
                break;
            }
            if let ControlFlow::Break(outcome) = finishing.step(&mut self.learnt) {
                return self.end(outcome);
            }
        }
        None
    }

    /// A long gap: ends the pending event with the stick line that has ended.
    pub fn lose(&mut self, detector: &Detector) -> Option<Finished> {
        self.complete(detector.ended(), detector.window(), detector.last())
    }

    /// Ends the test: does all that is left, one event a call, until `None`.
    pub fn finish(&mut self, detector: &Detector) -> Option<Finished> {
        self.drain().or_else(|| {
            let last = detector.last();
            let end = ForcePoint { index: last.index + 1, ..last };
            self.complete(detector.stick(), detector.window(), end);
            self.drain()
        })
    }

    /// All that is left of the fit that is under way.
    fn drain(&mut self) -> Option<Finished> {
        let finishing = self.finishing.as_mut()?;
        loop {
            if let ControlFlow::Break(outcome) = finishing.step(&mut self.learnt) {
                return self.end(outcome);
            }
        }
    }
}
