//! From transitions to events: the lines and samples around a slip, fitted.
//!
//! A slip is fitted twice: when the block has come to rest, for a first answer, and
//! when the stick line after it is complete, for the final one.

use crate::detector::{Detector, Extreme, Stick};
use crate::event::{Coefficient, Event, Quality, Reason, SampleTime};
use crate::fit::{Data, Fit, Prior};
use crate::line::Line;
use crate::math;
use crate::model::{self, Cycle};
use crate::pending::{Pending, since};
use crate::posterior::Posterior;
use crate::residuals::Residuals;
use crate::shared::{Shared, without_prior};
use crate::window::Window;

/// What turns forces into coefficients.
#[derive(Clone, Copy, Debug)]
pub struct Site {
    /// Weight of the block, N.
    pub weight_n: f32,
    /// Slope of the ice, rad.
    pub slope_rad: f32,
    /// Samples per second.
    pub rate_hz: f32,
}

impl Site {
    /// A force and its variance as a coefficient (26 to 28).
    fn coefficient(&self, force_n: f32, variance_n2: f32) -> Coefficient {
        let (_, cos) = math::sin_cos(self.slope_rad);
        Coefficient {
            value: model::coefficient(force_n, self.weight_n, self.slope_rad),
            std: math::sqrt(variance_n2) / (self.weight_n * cos),
        }
    }
}

/// A complete event.
#[derive(Clone, Copy, Debug)]
pub struct Finished {
    /// The best that is known of it.
    pub event: Event,
    /// `mu_s` and `mu` without what other events told of the loading rate: for means
    /// over events, whose errors must not be the same in all of them.
    pub alone: Option<(Coefficient, Coefficient)>,
}

impl From<Event> for Finished {
    fn from(event: Event) -> Self {
        Self { event, alone: None }
    }
}

/// Builds events.
#[derive(Clone, Debug)]
pub struct Cycles {
    site: Site,
    pending: Option<Pending>,
    rate: Shared,
    swing: Shared,
    bend: Shared,
    residuals: Residuals,
    /// Stop of the last event.
    last_stop: Option<SampleTime>,
    count: u32,
}

impl Cycles {
    /// Before the first event.
    #[must_use]
    pub fn new(site: Site) -> Self {
        Self {
            site,
            pending: None,
            rate: Shared::default(),
            swing: Shared::default(),
            bend: Shared::default(),
            residuals: Residuals::default(),
            last_stop: None,
            count: 0,
        }
    }

    /// Standard deviation of the noise, N, from the residuals of all fits.
    #[must_use]
    pub fn noise_n(&self) -> Option<f32> {
        self.residuals.variance_n2().map(math::sqrt)
    }

    /// Loading rate, N/s, and omega, rad/s, of the recent events.
    #[must_use]
    pub fn shared(&self) -> (Option<f32>, Option<f32>) {
        let hz = self.site.rate_hz;
        (self.rate.mean().map(|r| r * hz), self.swing.mean().map(|swing| hz / swing))
    }

    /// The block rests again: completes the event before and starts the next one.
    ///
    /// `last_hidden` is the newest saturated index.
    pub fn restick(
        &mut self,
        detector: &Detector,
        (peak, low): (Extreme, Extreme),
        last_hidden: Option<u64>,
    ) -> Option<Finished> {
        let (stick, window) = (detector.ended(), detector.window());
        let noise_n = detector.noise_n().unwrap_or(1.0);
        let finished = self.complete(stick, window, peak);
        let now = detector.last().index;
        let mut next = Pending::new(stick, self.start(stick), window, now, (peak, low));
        next.hidden |= last_hidden.is_some_and(|index| index + 4 >= stick.next);
        next.noise_n2 = noise_n * noise_n;
        next.fit = self.first_fit(&mut next);
        self.pending = Some(next);
        finished
    }

    /// Fits the event without the stick line after it.
    ///
    /// Where the block never rests the detector's noise is only a bound, far too
    /// large, and would make rough expectations look precise: there the event's own
    /// residuals, fitted with hardly any expectation, come first.
    fn first_fit(&self, pending: &mut Pending) -> Option<Fit> {
        const HARDLY: f32 = 1e-3;
        let none = Line::default();
        if let Some(pooled_n2) = self.residuals.variance_n2() {
            return self.fit(pending, &none, pooled_n2);
        }
        let free_n2 = HARDLY * pending.noise_n2;
        if let Some(fit) = self.fit(pending, &none, free_n2) {
            let (squares_n2, free) = own_residuals(&self.data(pending, &none, free_n2), &fit);
            if free >= 1.0 {
                pending.noise_n2 = pending.noise_n2.min(squares_n2 / free).max(free_n2);
            }
        }
        self.fit(pending, &none, pending.noise_n2)
    }

    /// Completes the pending event with what there is of its stick line.
    pub fn finish(&mut self, stick: &Stick, window: &Window, last: Extreme) -> Option<Finished> {
        self.complete(stick, window, last)
    }

    /// First index of an event's samples: where the stick line ends, or right after
    /// the last stop when the block rested too briefly for a line.
    fn start(&self, stick: &Stick) -> u64 {
        match self.last_stop {
            Some(stop) if stick.line.count < 3 => {
                stick.next.min((stop.index + 1).max(stick.next.saturating_sub(4)))
            }
            _ => stick.next,
        }
    }

    fn complete(&mut self, stick: &Stick, window: &Window, next_peak: Extreme) -> Option<Finished> {
        let mut pending = self.pending.take()?;
        pending.end_before(stick, window, next_peak.index);
        let after = stick.first_from(pending.origin);
        let noise_n2 = self.noise_n2(&pending);
        let fit = self.fit(&pending, &after, noise_n2);
        let finished = self.event(&pending, &after, fit.as_ref());
        self.count = self.count.saturating_add(1);
        Some(finished)
    }

    fn fit(&self, pending: &Pending, after: &Line, noise_n2: f32) -> Option<Fit> {
        let data = self.data(pending, after, noise_n2);
        match pending.fit {
            Some(first) => data.fit(&first.cycle, noise_n2),
            None => {
                data.fit(&pending.guess(&data, self.swing.prior(noise_n2).weight > 0.0)?, noise_n2)
            }
        }
    }

    fn data<'a>(&self, pending: &'a Pending, after: &'a Line, noise_n2: f32) -> Data<'a> {
        Data {
            before: &pending.before,
            points: pending.points.get(..pending.length).unwrap_or_default(),
            after,
            rate: expected(&self.rate, pending.rough.rate, 0.7 * pending.rough.rate, noise_n2),
            swing: expected(
                &self.swing,
                pending.rough.slide * core::f32::consts::FRAC_1_PI,
                pending.rough.slide_std * core::f32::consts::FRAC_1_PI,
                noise_n2,
            ),
            bend: self.bend_prior(pending.rough.rate, noise_n2),
            onset: pending.rough.onset(noise_n2),
        }
    }

    /// Variance of the noise: from the fits so far, else the detector's.
    fn noise_n2(&self, pending: &Pending) -> f32 {
        self.residuals.variance_n2().unwrap_or(pending.noise_n2)
    }

    /// Until the events tell otherwise the winch turns steadily.
    fn bend_prior(&self, rough_rate: f32, noise_n2: f32) -> Prior {
        const STEADY: f32 = 0.003;
        let learnt = self.bend.prior_around_zero(noise_n2);
        if learnt.weight > 0.0 {
            return learnt;
        }
        let spread = STEADY * self.rate.mean().unwrap_or(rough_rate);
        Prior { mean: 0.0, weight: noise_n2 / (spread * spread) }
    }

    fn event(&mut self, pending: &Pending, after: &Line, fit: Option<&Fit>) -> Finished {
        let Some(fit) = fit.filter(|fit| fit.converged && pending.holds(&fit.cycle)) else {
            return self.without_coefficients(pending, Reason::NoFit).into();
        };
        let data = self.data(pending, after, self.noise_n2(pending));
        let (squares_n2, free) = own_residuals(&data, fit);
        if pending.hidden {
            return self.without_coefficients(pending, Reason::Hidden).into();
        }
        if self.residuals.are_far_less_than(squares_n2, free) {
            return self.without_coefficients(pending, Reason::NoFit).into();
        }
        if free >= 1.0 {
            self.residuals.add(squares_n2, free, pending.noise_n2);
        }
        let noise_n2 = self.noise_n2(pending);
        let posterior = Posterior::new(&data, fit, noise_n2);
        self.learn(&data, &posterior, noise_n2);
        let event = self.measured(pending, &posterior);
        let alone = fit.forces_alone(data.rate).filter(|_| posterior.is_resolved());
        let alone = alone.map(|forces| {
            let variance = noise_n2 * forces.static_variance;
            let mu_s = self.site.coefficient(forces.static_n, variance);
            (mu_s, self.site.coefficient(forces.dynamic_n, noise_n2 * forces.dynamic_variance))
        });
        Finished { event, alone }
    }

    /// Carries the event's own loading rate and swing to the next ones.
    fn learn(&mut self, data: &Data<'_>, posterior: &Posterior, noise_n2: f32) {
        let Posterior { cycle, unknowns: [_, rate, _, _, swing, bend], .. } = *posterior;
        // What hardly resolved slips tell is bent towards what was expected of them.
        let least = if posterior.is_resolved() { 0.01 } else { 0.7 };
        if posterior.is_resolved() {
            for shared in [&mut self.rate, &mut self.swing, &mut self.bend] {
                shared.forget();
            }
        }
        let own = |value, variance, prior| without_prior(value, variance, prior, noise_n2, least);
        // The loading rate and the swing are above zero; the bend may have any sign.
        if let Some((value, variance)) = own(cycle.rate, rate, data.rate).filter(|own| own.0 > 0.0)
        {
            self.rate.add(value, variance);
        }
        if let Some((value, variance)) =
            own(cycle.swing(), swing, data.swing).filter(|own| own.0 > 0.0)
        {
            self.swing.add(value, variance);
        }
        if let Some((value, variance)) = own(cycle.bend, bend, data.bend) {
            self.bend.add(value, variance);
        }
    }

    fn measured(&mut self, pending: &Pending, posterior: &Posterior) -> Event {
        let cycle = &posterior.cycle;
        let mut event = self.bare(pending, cycle);
        event.mu_s = Some(self.site.coefficient(cycle.static_n, posterior.static_n2));
        event.mu = Some(self.site.coefficient(cycle.dynamic_n(), posterior.dynamic_n2));
        if !posterior.is_resolved() {
            event.quality = Quality::Unresolved;
            event.omega_rad_per_s = None;
        }
        event
    }

    /// Times and forces of an event.
    fn bare(&mut self, pending: &Pending, cycle: &Cycle) -> Event {
        let hz = self.site.rate_hz;
        let onset = moment(pending.origin, cycle.onset);
        let stop = moment(pending.origin, cycle.shape().stop());
        let rest = self.last_stop.map(|last| {
            (since(last.index, onset.index) + onset.fraction - last.fraction).max(0.0) / hz
        });
        self.last_stop = Some(stop);
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
            slip_s: cycle.slide_time() / hz,
            loading_rate_n_per_s: cycle.rate * hz,
            omega_rad_per_s: Some(cycle.omega * hz),
            slack: false,
            quality: Quality::Good,
            reason: None,
        }
    }

    /// An event that is only seen, from its highest and lowest sample.
    fn without_coefficients(&mut self, pending: &Pending, reason: Reason) -> Event {
        let onset = since(pending.origin, pending.peak.index);
        let fall = (pending.low.index - pending.peak.index) as f32;
        let drop = pending.peak.force_n - pending.low.force_n;
        let cycle = Cycle {
            onset,
            rate: self.rate.mean().or(pending.before.slope()).unwrap_or(0.0).max(1e-6 * drop),
            static_n: pending.peak.force_n,
            half_drop_n: 0.5 * drop,
            omega: core::f32::consts::PI / fall.max(1.0),
            bend: 0.0,
        };
        let mut event = self.bare(pending, &cycle);
        event.quality =
            if reason == Reason::Hidden { Quality::Clipped } else { Quality::Unresolved };
        event.omega_rad_per_s = None;
        event.reason = Some(reason);
        event
    }
}

/// What earlier events tell of a quantity, else a guess and its standard deviation.
fn expected(shared: &Shared, guess: f32, spread: f32, noise_n2: f32) -> Prior {
    let learnt = shared.prior(noise_n2);
    if learnt.weight > 0.0 {
        return learnt;
    }
    Prior { mean: guess, weight: noise_n2 / (spread * spread) }
}

/// Squared residuals of an event that no other event counts, N², and their degrees
/// of freedom: observations less unknowns, as far as these come from the samples
/// and not from what was expected.
fn own_residuals(data: &Data<'_>, fit: &Fit) -> (f32, f32) {
    let (mut squares, mut unknowns) = (fit.cost + data.after.residual(), model::UNKNOWNS as f32);
    for (unknown, (prior, value)) in data.priors(&fit.cycle).into_iter().enumerate() {
        squares -= prior.weight * (prior.mean - value) * (prior.mean - value);
        unknowns -= prior.weight * fit.variance(unknown);
    }
    let lines = data.before.count.min(2) as f32 + data.after.weight;
    (squares.max(0.0), data.points.len() as f32 + lines - unknowns)
}

/// A time in periods from an origin, as index and fraction.
fn moment(origin: u64, time: f32) -> SampleTime {
    let whole = libm::floorf(time);
    SampleTime { index: origin.saturating_add_signed(whole as i64), fraction: time - whole }
}
