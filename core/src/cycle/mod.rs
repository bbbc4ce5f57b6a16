//! From transitions to events: the lines and samples around a slip, fitted.
//!
//! While a slip's stick line grows it is *pending*; when the next slip has ended that
//! line it is *finishing*: its fit is made one iteration a sample. A first answer,
//! from what the other events tell, is there as soon as the force has turned.

mod cycle_fit;
mod expectations;
mod refusal;
mod slip_record;

use core::ops::ControlFlow;

use crate::coefficient::{Coefficient, Site};
use crate::cycle::cycle_fit::{CycleFit, Measured, Outcome, iterations_within};
use crate::cycle::expectations::{Expectations, is_clear};
use crate::cycle::slip_record::{SlipRecord, UNSURE};
use crate::detector::{Detector, Stick};
use crate::effect::{Effect, Parameter};
use crate::effects::level_shift::{Cause, Change, Levels};
use crate::effects::mass_change::Verdict;
use crate::effects::sag::Rest;
use crate::event::{Event, Provisional, Quality, Reason};
use crate::fit::posterior::Posterior;
use crate::model::{CycleParams, Shape};
use crate::num::math;
use crate::sample::{ForcePoint, SampleTime, since};
use crate::signal::window::Window;
use crate::stats::line::Line;
use crate::stats::quantity::Quantity;

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

/// Steps of the fit for the first answer, which is wanted at once: two are usual.
const FIRST_STEPS: usize = 5;
/// The same for the first three events of a test, whose omega is unknown: five guesses and
/// most iterations. These are the longest steps there are.
const STEPS_UNKNOWN: usize = 29;
/// Samples that all steps together may look at: the time there is.
const FIRST_SAMPLES: usize = 240;

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
    levels: Levels,
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
}

impl CycleTracker {
    /// Before the first event.
    #[must_use]
    pub fn new(site: Site) -> Self {
        Self {
            site,
            learnt: Expectations::new(site.effects),
            pending: None,
            finishing: None,
            early: None,
            levels: Levels::default(),
            suspect: None,
            last_stop: None,
            last_load: None,
            rested: None,
            count: 0,
            slides: false,
        }
    }

    /// Standard deviation of the noise, N, from the residuals of all fits.
    #[must_use]
    pub fn noise_n(&self) -> Option<f32> {
        self.learnt.residuals.variance_n2().map(math::sqrt)
    }

    /// Periods before the onset in which creep bends the stick line.
    #[must_use]
    pub fn creep_periods(&self) -> f32 {
        self.learnt.creep_periods()
    }

    /// Loading rate, N/s, and omega, rad/s, of the recent events, each with its standard
    /// deviation; omega where it is known to a third.
    #[must_use]
    pub fn shared(&self) -> (Option<Quantity>, Option<Quantity>) {
        let hz = self.site.rate_hz;
        let Expectations { rate, mass, .. } = &self.learnt;
        let omega = |inverse: Quantity| {
            let value = hz / inverse.value;
            Quantity { value, std: value * inverse.std / inverse.value }
        };
        let omega = mass.inverse_omega().known().map(omega);
        let is_known = |omega: &Quantity| omega.std < omega.value / 3.0;
        (rate.known().map(|rate| rate.times(hz)), omega.filter(is_known))
    }

    /// What the events show of an effect: its numbers.
    #[must_use]
    pub fn parameters(&self, effect: Effect) -> [Option<Parameter>; 2] {
        match effect {
            Effect::Corner => self.learnt.corner.parameters(self.site.rate_hz),
            Effect::Damping => [self.learnt.damping.parameter(), None],
            Effect::Sag => [self.learnt.sag.parameter(), None],
            Effect::Stiffening => [self.learnt.stiffening(), None],
            Effect::Mass => {
                let (value, relative) = self.learnt.mass.weight_ratio();
                let ratio = Parameter { name: "weight_ratio", value, std: relative * value };
                [(relative > 0.0).then_some(ratio), None]
            }
            Effect::Level | Effect::Drift | Effect::Flop | Effect::Ripple | Effect::Forgetting => {
                [None; 2]
            }
        }
    }

    /// The slip has begun: a first value of `mu_s`, between the last sample on the line
    /// and the first one off it.
    #[must_use]
    pub fn onset(&mut self, detector: &Detector) -> Option<Provisional> {
        self.early = None;
        let (stick, now) = (detector.stick(), detector.last());
        let line = stick.line_from(now.index);
        let (slope, noise_n, time) = (line.slope()?, detector.noise_n()?, -1.0);
        // Anywhere within the two periods before: a uniform distribution.
        const SPREAD: f32 = 0.577;
        let onset_n = SPREAD * slope;
        let variance_n2 = onset_n * onset_n + noise_n * noise_n * line.leverage(time);
        let mu_s = self.site().coefficient(line.at(time, slope), variance_n2);
        Some(Provisional { mu_s, mu: None })
    }

    /// The force has turned: a first answer from what the other events tell.
    pub fn turned(&mut self, detector: &Detector) -> Option<Provisional> {
        let (stick, extremes) = (detector.stick(), detector.extremes());
        let slip = self.slip(stick, detector, extremes);
        let noise_n2 = self.learnt.fitted_noise_n2(&slip);
        let most = if self.learnt.knows_omega() { FIRST_STEPS } else { STEPS_UNKNOWN };
        let steps = most.min(iterations_within(FIRST_SAMPLES, slip.samples().forces_n.len()));
        let none = Line::default();
        let data = self.learnt.data(&slip, &none, noise_n2);
        let mut fitting = slip.begin(&data, self.learnt.knows_omega());
        let mut step = || fitting.step(&data, noise_n2).break_value();
        let fit = (0..steps).find_map(|_| step()).flatten();
        let fit = fit.filter(|fit| fit.converged && slip.holds(&fit.cycle))?;
        self.early = Some((slip.origin, fit.cycle));
        let posterior = Posterior::at(&fit, noise_n2);
        let known = self.learnt.residuals.variance_n2().is_some();
        if slip.hidden || !posterior.is_resolved() || !known {
            return None;
        }
        let Posterior { cycle, static_n2, dynamic_n2, .. } = &posterior;
        Some(Provisional {
            mu_s: self.site().coefficient(cycle.static_n, *static_n2),
            // On a slack cable the time at zero will tell it.
            mu: cycle.is_taut().then(|| self.site().coefficient(cycle.dynamic_n(), *dynamic_n2)),
        })
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
            && refusal::is_aliased(before.peak.index, peak.index)
        {
            refused = Some(Reason::Aliased);
            before.refused = refused;
        }
        let finished = self.complete(stick, window, peak);
        let mut next = self.slip(stick, detector, (peak, low));
        next.hidden |= last_hidden.is_some_and(|index| index + 4 >= stick.next);
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
            moment(origin, cycle.onset - self.creep_periods() - UNSURE).index
        });
        if let Some(pending) = &mut self.pending {
            pending.end_before(stick, window, next_peak.index);
            let periods = since(pending.low.index, next_peak.index);
            let refused = refusal::of_fall(pending, stick.highest.force_n, periods, self.slides);
            pending.refused = pending.refused.or(refused);
            self.slides |= pending.refused.is_none() && refusal::takes_time(pending);
            let after = pending.line_after(stick, window, next_onset);
            self.finishing = Some(CycleFit::new(*pending, after));
        }
        self.pending = None;
        finished
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

    /// The slip between a stick line and now.
    fn slip(
        &self,
        stick: &Stick,
        detector: &Detector,
        extremes: (ForcePoint, ForcePoint),
    ) -> SlipRecord {
        let now = detector.last().index;
        let (start, noise_n) = (self.start(stick), detector.noise_n().unwrap_or(1.0));
        let mut slip = SlipRecord::new(stick, start, detector.window(), now, extremes, noise_n);
        slip.wander = detector.wander();
        slip.rest_weight = detector.rest_weight();
        if let Some(previous) = self.unfinished() {
            slip.lengthen_line(previous, stick);
        }
        slip
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
            Some(slip) => slip.early.map(|cycle| moment(slip.origin, cycle.shape().loads())),
            None => self.last_load,
        }
    }

    fn end(&mut self, outcome: Outcome) -> Option<Finished> {
        let finishing = self.finishing.take()?;
        let pending = finishing.pending;
        let mut load = None;
        let mut finished = match outcome {
            Outcome::Failed(reason) => self.without_coefficients(&pending, reason).into(),
            Outcome::Fitted(Measured { posterior, alone, noise_n2, verdict }) => {
                let site = self.site();
                let alone = alone.map(|forces| {
                    let mu_s = site.coefficient(forces.static_n, noise_n2 * forces.static_variance);
                    let (shift_n, _) = self.shift(&pending, &posterior.cycle);
                    (
                        mu_s,
                        site.coefficient(
                            forces.dynamic_n - shift_n,
                            noise_n2 * forces.dynamic_variance,
                        ),
                    )
                });
                let shape = posterior.cycle.shape();
                self.learn_sag(&pending, &posterior, &shape);
                let loads = shape.loads();
                load = Some(moment(pending.origin, loads));
                let shift = self.shift(&pending, &posterior.cycle);
                let event = self.measured(&pending, &posterior, &shape, shift);
                let mut finished = self.judged(event, alone, &posterior, shift, verdict);
                if event.slack && !finishing.shows(loads) {
                    // How far the block slid on a slack cable was not seen.
                    (finished.event.mu, finished.alone) = (None, None);
                    finished.event.reason = finished.event.reason.or(Some(Reason::TooShort));
                }
                finished
            }
        };
        let event = &finished.event;
        let limit = moment(pending.origin, pending.limit);
        let overlaps = event.stop > limit || self.last_stop.is_some_and(|it| it > event.onset);
        let overlaps = overlaps.then_some(Reason::NoFit).filter(|_| event.reason.is_none());
        if let Some(reason) = refusal::of_event(event).or(overlaps) {
            finished = self.without_coefficients(&pending, reason).into();
        }
        let event = &mut finished.event;
        event.onset = self.last_stop.map_or(event.onset, |it| later(it, event.onset));
        event.stop = later(event.onset, earlier(event.stop, limit));
        self.last_stop = Some(event.stop);
        self.last_load = load.or(self.last_stop);
        if !event.reason.is_some_and(Reason::is_no_slip) {
            self.count = self.count.saturating_add(1);
        }
        Some(finished)
    }

    /// What a rest between two slips tells of a cable that sags, if the force strays from
    /// its line at all.
    fn learn_sag(&mut self, pending: &SlipRecord, posterior: &Posterior, shape: &Shape) {
        let cycle = &posterior.cycle;
        let rested = self.rested.take();
        if !self.site.effects.has(Effect::Sag) || shape.is_slack() || !posterior.is_resolved() {
            return;
        }
        self.rested = Some((moment(pending.origin, shape.stop()), cycle.restick_n()));
        let rested = rested.filter(|_| pending.wander.level > 0.0 && !pending.broken);
        let Some(((from, from_n), (rate, rate_variance))) = rested.zip(self.learnt.own_rate) else {
            return;
        };
        let to = moment(pending.origin, cycle.onset);
        self.learnt.sag.learn(&Rest {
            time: periods(from, to),
            from_n,
            // Where the line goes on to: what creep takes from it is not the cable's.
            to_n: cycle.static_n + self.learnt.corner.missing_n(),
            rate,
            rate_variance,
            rate_at_n: pending.before.level_n,
        });
    }

    /// How far the cable takes `Fp` below the middle of `Fs` and `Fe`, N, and its variance. A
    /// line that is not straight tells nothing of a cable that gets stiffer by sliding.
    fn shift(&self, pending: &SlipRecord, cycle: &CycleParams) -> (f32, f32) {
        let (sag_n, sag_n2) = self.learnt.sag.shift(cycle);
        if sag_n <= 0.0 && pending.wander.is_quick() {
            // A quick swing bends no rest: it says nothing of a sag that only may be.
            return (0.0, 0.0);
        }
        let stiffens = self.site.effects.has(Effect::Stiffening);
        let is_straight = pending.wander.level <= 0.0 && sag_n2 <= 0.0 && cycle.is_taut();
        if !is_straight {
            return (sag_n, sag_n2);
        }
        let stiffening_n = if stiffens { self.learnt.stiffening_n(cycle) } else { 0.0 };
        (sag_n - stiffening_n, sag_n2 + self.learnt.unsteady_n2(cycle))
    }

    /// A measured event with what it tells of a change.
    fn judged(
        &mut self,
        mut event: Event,
        alone: Option<(Coefficient, Coefficient)>,
        posterior: &Posterior,
        (shift_n, shift_n2): (f32, f32),
        verdict: Verdict,
    ) -> Finished {
        let change = self.change(verdict, &event, posterior);
        if verdict == Verdict::Suspect {
            (event.mu_s, event.mu, event.reason) = (None, None, Some(Reason::Suspect));
            return event.into();
        }
        let site = self.site();
        // A sag that only may be is no part of what all events have in common.
        let sag_n2 = if shift_n > 0.0 { shift_n2 } else { 0.0 };
        let (static_n2, dynamic_n2) = posterior.common_n2;
        let common = (site.std(static_n2), site.std(dynamic_n2 + sag_n2));
        Finished { event, alone, common, change }
    }

    /// The site with the weight as far as it is known to have changed.
    fn site(&self) -> Site {
        let (ratio, _) = self.learnt.mass.weight_ratio();
        Site { weight_n: ratio * self.site.weight_n, ..self.site }
    }

    /// Force of so much of a coefficient, N.
    #[must_use]
    pub fn force_n(&self, coefficient: f32) -> f32 {
        let site = self.site();
        coefficient * site.weight_n * site.slope.1
    }

    /// Standard deviation of the damping ratio where it is stated to be so much.
    #[must_use]
    pub fn damping_std(&self, stated: f32) -> f32 {
        self.learnt.damping.std(stated)
    }

    /// Weight in use over the given one, and its relative standard deviation.
    #[must_use]
    pub fn weight_ratio(&self) -> (f32, f32) {
        self.learnt.mass.weight_ratio()
    }

    /// What an event tells of a change.
    fn change(&mut self, verdict: Verdict, event: &Event, posterior: &Posterior) -> Option<Change> {
        let here = (event.index, event.onset);
        let suspect = self.suspect.take();
        let (cause, (first, onset)) = match verdict {
            Verdict::Suspect => {
                self.suspect = suspect.or(Some(here));
                return None;
            }
            Verdict::Same => {
                let CycleParams { static_n, .. } = posterior.cycle;
                let dynamic_n = posterior.cycle.dynamic_n();
                let follows = self.site.effects.has(Effect::Level);
                let shift = follows.then(|| self.levels.take(static_n, dynamic_n))??;
                let first = (event.index.saturating_sub(shift.events_ago), event.onset);
                let watches = self.site.effects.has(Effect::Mass);
                if watches && is_clear(posterior) && self.learnt.mass.doubt(shift.dynamic_before_n)
                {
                    self.suspect = Some(first);
                    return None;
                }
                (Cause::Unknown, first)
            }
            Verdict::Mass => (Cause::Mass, suspect.unwrap_or(here)),
            Verdict::SameMass => (Cause::Friction, suspect.unwrap_or(here)),
            Verdict::Unknown => (Cause::Unknown, suspect.unwrap_or(here)),
        };
        self.levels.forget();
        let (weight_ratio, relative) = self.learnt.mass.weight_ratio();
        let weight_ratio_std = relative * weight_ratio;
        Some(Change { event: first, onset, cause, weight_ratio, weight_ratio_std })
    }

    fn measured(
        &self,
        pending: &SlipRecord,
        posterior: &Posterior,
        shape: &Shape,
        (shift_n, shift_n2): (f32, f32),
    ) -> Event {
        let cycle = &posterior.cycle;
        let mut event = self.bare(pending, cycle, shape);
        let site = self.site();
        event.mu_s = Some(site.coefficient(cycle.static_n, posterior.static_n2));
        event.dynamic_force_n -= shift_n;
        event.mu = Some(site.coefficient(event.dynamic_force_n, posterior.dynamic_n2 + shift_n2));
        if !posterior.is_resolved() {
            if !event.slack {
                event.quality = Quality::Unresolved;
            }
            event.omega_rad_per_s = None;
        }
        event
    }

    /// Times and forces of an event.
    fn bare(&self, pending: &SlipRecord, cycle: &CycleParams, shape: &Shape) -> Event {
        let hz = self.site.rate_hz;
        let onset = moment(pending.origin, cycle.onset);
        let stop = moment(pending.origin, shape.stop());
        let rest = self.last_stop.map(|last| periods(last, onset).max(0.0) / hz);
        Event {
            index: self.count,
            onset,
            stop,
            static_force_n: cycle.static_n,
            dynamic_force_n: cycle.dynamic_n(),
            peak_force_n: cycle.peak_n(),
            restick_force_n: cycle.restick_n(),
            mu_s: None,
            mu: None,
            stick_s: rest,
            slip_s: shape.slide_time() / hz,
            loading_rate_n_per_s: cycle.rate * hz,
            omega_rad_per_s: Some(cycle.omega * hz),
            slack: shape.is_slack(),
            quality: if shape.is_slack() { Quality::Slack } else { Quality::Good },
            reason: None,
        }
    }

    /// An event that is only seen, from its highest and lowest sample.
    fn without_coefficients(&self, pending: &SlipRecord, reason: Reason) -> Event {
        let (onset, stop) = pending.fall_edges();
        let fall = stop - onset;
        let drop = pending.peak.force_n - pending.low.force_n;
        let cycle = CycleParams {
            onset,
            rate: self
                .learnt
                .rate
                .mean()
                .or(pending.before.slope())
                .unwrap_or(0.0)
                .max(1e-6 * drop),
            static_n: pending.peak.force_n,
            half_drop_n: 0.5 * drop,
            omega: core::f32::consts::PI / fall.max(1.0),
            rate_change: 0.0,
        };
        let mut event = self.bare(pending, &cycle, &cycle.shape());
        event.stop = moment(pending.origin, stop);
        event.slip_s = fall / self.site.rate_hz;
        (event.peak_force_n, event.restick_force_n) = (pending.peak.force_n, pending.low.force_n);
        event.slack = false;
        event.quality =
            if reason == Reason::Hidden { Quality::Clipped } else { Quality::Unresolved };
        event.omega_rad_per_s = None;
        event.reason = Some(reason);
        event
    }
}

/// A time in periods from an origin, as index and fraction.
fn moment(origin: u64, time: f32) -> SampleTime {
    let whole = libm::floorf(time);
    SampleTime { index: origin.saturating_add_signed(whole as i64), fraction: time - whole }
}

fn earlier(a: SampleTime, b: SampleTime) -> SampleTime {
    if b < a { b } else { a }
}

fn later(a: SampleTime, b: SampleTime) -> SampleTime {
    if b > a { b } else { a }
}

/// Periods from one moment to another.
fn periods(from: SampleTime, to: SampleTime) -> f32 {
    since(from.index, to.index) + to.fraction - from.fraction
}
