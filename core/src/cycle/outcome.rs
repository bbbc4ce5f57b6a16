//! How an event ends: with its coefficients, or with the reason why there are none.

use crate::coefficient::{Coefficient, Site};
use crate::cycle::cycle_fit::{CycleFit, Measured};
use crate::cycle::refusal::{self, FAST, LEAST_UNCONFIRMED, RootStiffnessRatio};
use crate::cycle::slip_record::SlipRecord;
use crate::cycle::{CycleTracker, Finished, Work};
use crate::effect::Kept;
use crate::effects::mass_change::Verdict;
use crate::event::{Event, Quality, Reason};
use crate::fit::posterior::Posterior;
use crate::model::{CycleParams, Shape};
use crate::num::math::larger;
use crate::sample::SampleTime;
use crate::stats::line::Line;

/// Least rest between slow slips, in units of the swing `1/ω`. A smooth oscillation of the force,
/// which rises as it falls, is fitted by slips with rests of half a swing to one, whatever its
/// period.
const SWINGS: f32 = 1.4;

/// Evidence for and against a fit.
#[derive(Clone, Copy, Debug, Default)]
struct Belief {
    /// The slip is an alias: made of single samples of many faster slips.
    folded: bool,
    /// Loading rate and swing give the same stiffness of the cable, at the known speed of the
    /// winch.
    agrees_with_winch: bool,
    /// The loading rate, the drop or the rest does not differ significantly from zero.
    unsure: bool,
    /// If the cable is slack, it is so for too long.
    hangs: bool,
}

impl CycleTracker {
    /// Ends the fit and gives the event, its times limited to the interval from the stop of the
    /// event before to the peak of the next slip.
    pub(super) fn end(&mut self, failed: Option<Reason>) -> Option<Finished> {
        let CycleFit { slip, after, mut measured, .. } = self.finishing.take()?;
        self.work = Work::default();
        let slip = &slip;
        let (mut finished, load) = match failed {
            Some(reason) => {
                // The rest before this slip and the rest after it must not be taken for one.
                self.rested = Kept::default();
                (self.without_coefficients(slip, reason).into(), None)
            }
            None => {
                measured.relax(&slip.elongation);
                let (finished, load) = self.fitted(slip, &after, &measured);
                (finished, Some(load))
            }
        };
        let fit = load.is_some().then_some(&measured.posterior);
        if let Some(reason) = self.refused(slip, &after, &finished.event, fit) {
            // The change that it showed stays.
            (finished.event, finished.alone) = (self.without_coefficients(slip, reason), None);
        }
        let (event, limit) = (&mut finished.event, SampleTime::after(slip.origin, slip.limit));
        event.onset = self.last_stop.map_or(event.onset, |it| later(it, event.onset));
        event.stop = later(event.onset, earlier(event.stop, limit));
        self.last_stop = Some(event.stop);
        self.last_load = Some(load.unwrap_or(event.stop).index);
        if !event.reason.is_some_and(Reason::is_no_slip) {
            self.count = self.count.saturating_add(1);
        }
        Some(finished)
    }

    /// The event of a fit, and the time at which its cable begins to load again.
    fn fitted(
        &mut self,
        slip: &SlipRecord,
        after: &Line,
        measured: &Measured,
    ) -> (Finished, SampleTime) {
        let site = self.site();
        let Measured { posterior, alone, .. } = measured;
        let shape = posterior.cycle.shape();
        self.learn_sag(slip, posterior, shape.stop());
        let loads = shape.loads();
        let shift = self.shift(slip, &posterior.cycle);
        let alone = alone.map(|forces| {
            let mu_s = site.coefficient(forces.static_n, forces.static_n2);
            (mu_s, site.coefficient(forces.dynamic_n - shift.0, forces.dynamic_n2))
        });
        let event = self.measured(&site, slip, posterior, &shape, shift);
        let mut finished =
            self.judged(&site, event, alone, posterior, shift, measured.verdict.value());
        if event.slack && !slip.shows(after, loads) {
            // The samples do not show how far the block slid while the cable was slack.
            (finished.event.mu, finished.alone) = (None, None);
            finished.event.reason = finished.event.reason.or(Some(Reason::TooShort));
        }
        (finished, SampleTime::after(slip.origin, loads))
    }

    /// Completes a measured event: adds the change that it shows and the common parts of its
    /// errors.
    fn judged(
        &mut self,
        site: &Site,
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
        // Only a sag that shifts `Fp` is common to all events; one that is only possible is not.
        let sag_n2 = if shift_n > 0.0 { shift_n2 } else { 0.0 };
        let (static_n2, dynamic_n2) = posterior.common_n2;
        let mut common = (site.std(static_n2), site.std(dynamic_n2 + sag_n2));
        if !posterior.is_resolved() && !self.learnt.knows_omega() {
            // The length of the slip is then a guess with the same error in all events.
            let (static_n2, dynamic_n2) = posterior.forces_n2();
            common = (site.std(static_n2), site.std(dynamic_n2));
        }
        Finished { event, alone, common, change }
    }

    /// Why an event is refused: by its own fit, or because most recent events look aliased; where
    /// the next slip follows within [`FAST`] periods, any refusal counts as a sign of that. `fit`
    /// is the posterior.
    #[inline(never)]
    fn refused(
        &mut self,
        slip: &SlipRecord,
        after: &Line,
        event: &Event,
        fit: Option<&Posterior>,
    ) -> Option<Reason> {
        let limit = SampleTime::after(slip.origin, slip.limit);
        let overlaps =
            limit.precedes(event.stop) || self.last_stop.is_some_and(|it| event.onset.precedes(it));
        let overlaps = (overlaps && event.reason.is_none()).then_some(Reason::NoFit);
        let Belief { folded, agrees_with_winch, unsure, hangs } =
            fit.map(|posterior| self.of_fit(posterior, slip)).unwrap_or_default();
        // Without a stick line, a slack cable that loads within two samples shows no loading rate.
        let is_steep = |it: &Posterior| 2.0 * it.cycle.rate > it.cycle.static_n;
        let has_line = slip.before.count + after.count > 0;
        let loads_fast = event.slack && !has_line && fit.is_some_and(is_steep);
        let is_fast = slip.limit - slip.peak.time < FAST;
        let without_rest = if is_fast || loads_fast { Reason::TooShort } else { Reason::NoRest };
        let without_rest = (loads_fast || unsure).then_some(without_rest);
        let slack = fit.filter(|_| event.slack);
        let hangs = slack.is_some_and(|it| self.slackness.is_long(it) || hangs);
        let hangs = hangs.then_some(Reason::LetGo);
        let reason = refusal::of_event(event).or(hangs).or(overlaps).or(without_rest);
        // An event refused for reasons of its own is no evidence that the others are aliased,
        // except: among fast slips any reason is evidence; among slow ones, that the force does not
        // take the course of a slip.
        let doubted = reason.or(event.reason).is_some_and(|it| is_fast || it.is_of_shape());
        let likely = self.recurrence.is_folded(folded || doubted);
        // Where the event has a reason of its own, that is the one which is known to be true.
        let is_open = fit.is_some() && (folded || event.reason.is_none());
        let doubtful = likely && is_open && !agrees_with_winch;
        let why = if is_fast { Reason::Aliased } else { Reason::NoFit };
        reason.or(doubtful.then_some(why))
    }

    /// Evidence for and against a fit.
    fn of_fit(&self, posterior: &Posterior, slip: &SlipRecord) -> Belief {
        let Posterior { cycle, variances: [_, of_rate, _, of_drop, of_swing, ..], .. } = *posterior;
        let (site, learnt) = (self.site(), &self.learnt);
        let (rate, swing) = (learnt.rate.now, learnt.inverse_omega.now);
        // Decided by the mean swing of all events, not by that of a single one.
        let periods = slip.limit - cycle.onset;
        let folded =
            learnt.knows_omega() && RootStiffnessRatio::new(&site, rate, swing).is_folded(periods);
        let is_fast = periods < FAST;
        // Among fast slips by the noise alone: a cable that wanders widens the errors, and slips all
        // the same. A slow swing of the force bends its lines.
        let wander = if is_fast { slip.wander.line_excess + slip.wander.unsure } else { 0.0 };
        let part = 1.0 / (1.0 + wander);
        let (own_rate, drop) = ((cycle.rate, part * of_rate), (cycle.half_drop_n, part * of_drop));
        // Where the force wanders its lines say little, and the rate of all events is known better.
        // That of fast ones may be an alias.
        let is_shared = !is_fast && rate.0 > 0.0 && rate.1 < own_rate.1;
        let rate = if is_shared { rate } else { own_rate };
        let own = RootStiffnessRatio::new(&site, rate, (cycle.inverse_omega(), of_swing));
        let agrees_with_winch = own.is_one();
        // A smooth oscillation of the force can be fitted as slips as well, but without a sample
        // that is surely at rest, or with rests shorter than `SWINGS` if it is slow. A slip whose
        // stiffness agrees with the winch needs no such rest.
        let least = if is_fast { 1.0 } else { SWINGS * cycle.inverse_omega() };
        let rests = (2.0 * drop.0 - least * rate.0, 4.0 * drop.1 + least * least * rate.1);
        let shown = if agrees_with_winch { drop } else { rests };
        // Without a positive loading rate nothing slips.
        let unsure = !refusal::is_no_chance(rate)
            || !refusal::is_no_chance(shown)
            || ((is_fast || slip.reaches_zero(cycle.rate)) && own.is_low());
        let hangs = !agrees_with_winch && cycle.dynamic_n() < LEAST_UNCONFIRMED * cycle.static_n;
        let determines = is_fast && posterior.determines_swing(of_swing);
        let folded = folded || (determines && own.is_folded(periods));
        Belief { folded, agrees_with_winch: is_fast && agrees_with_winch, unsure, hangs }
    }

    /// The event with its coefficients, and with omega where the slip is resolved.
    fn measured(
        &self,
        site: &Site,
        slip: &SlipRecord,
        posterior: &Posterior,
        shape: &Shape,
        (shift_n, shift_n2): (f32, f32),
    ) -> Event {
        let cycle = &posterior.cycle;
        let mut event = self.bare(slip, cycle, shape);
        let (static_n2, dynamic_n2) = posterior.forces_n2();
        let unsteady_n2 = self.learnt.unsteady_n2(slip, posterior);
        event.mu_s = Some(site.coefficient(cycle.static_n, static_n2 + unsteady_n2.0));
        event.dynamic_force_n -= shift_n;
        let dynamic_n2 = dynamic_n2 + shift_n2 + unsteady_n2.1;
        event.mu = Some(site.coefficient(event.dynamic_force_n, dynamic_n2));
        if !posterior.is_resolved() {
            if !event.slack {
                event.quality = Quality::Unresolved;
            }
            event.omega_rad_per_s = None;
        }
        event
    }

    /// Times and forces of an event; its coefficients are left open.
    fn bare(&self, slip: &SlipRecord, cycle: &CycleParams, shape: &Shape) -> Event {
        let hz = self.site.rate_hz;
        let onset = SampleTime::after(slip.origin, cycle.onset);
        let stop = SampleTime::after(slip.origin, shape.stop());
        let rest = self.last_stop.map(|last| larger(onset.periods_since(last), 0.0) / hz);
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

    /// An event without coefficients: forces of its highest and lowest sample, times of its fall.
    fn without_coefficients(&self, slip: &SlipRecord, reason: Reason) -> Event {
        let (onset, stop) = slip.rough.edges;
        let fall = stop - onset;
        let peak_n = slip.elongation.force_n(slip.peak.force_n);
        let drop = peak_n - slip.low.force_n;
        let rate = self.learnt.rate.mean().or(slip.before.slope());
        let cycle = CycleParams {
            onset,
            rate: larger(rate.unwrap_or(0.0), 1e-6 * drop),
            static_n: peak_n,
            half_drop_n: 0.5 * drop,
            omega: core::f32::consts::PI / larger(fall, 1.0),
            rate_change: 0.0,
        };
        let mut event = self.bare(slip, &cycle, &cycle.shape());
        event.stop = SampleTime::after(slip.origin, stop);
        event.slip_s = fall / self.site.rate_hz;
        (event.peak_force_n, event.restick_force_n) = (peak_n, slip.low.force_n);
        event.slack = false;
        event.quality =
            if reason == Reason::Hidden { Quality::Clipped } else { Quality::Unresolved };
        event.omega_rad_per_s = None;
        event.reason = Some(reason);
        event
    }
}

fn earlier(a: SampleTime, b: SampleTime) -> SampleTime {
    if b.precedes(a) { b } else { a }
}

fn later(a: SampleTime, b: SampleTime) -> SampleTime {
    if a.precedes(b) { b } else { a }
}
