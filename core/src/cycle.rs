//! From transitions to events: the lines and samples around a slip, fitted.
//!
//! A slip is fitted twice: when the block has come to rest, for a first answer, and
//! when the stick line after it is complete, for the final one.

use crate::detector::{Detector, Extreme, Stick};
use crate::event::{Coefficient, Event, Quality, Reason, SampleTime};
use crate::fit::{Data, Fit, Point, Prior};
use crate::line::Line;
use crate::model::{self, Cycle, Gradient};
use crate::shared::{Shared, without_prior};
use crate::window::Window;

/// Most samples between the two stick lines.
const CORE: usize = 96;

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

/// A slip whose stick line after it is still growing.
#[derive(Clone, Copy, Debug)]
struct Pending {
    /// Index at time zero of the points and of `before`.
    origin: u64,
    before: Line,
    points: [Point; CORE],
    length: usize,
    peak: Extreme,
    low: Extreme,
    fit: Option<Fit>,
    /// A saturated sample, or too many missing ones, between the lines.
    hidden: bool,
}

/// Builds events.
#[derive(Clone, Debug)]
pub struct Cycles {
    site: Site,
    pending: Option<Pending>,
    rate: Shared,
    omega: Shared,
    residuals: Residuals,
    /// Stop of the last event.
    last_stop: Option<SampleTime>,
    count: u32,
}

/// Residuals of the fits, pooled over the events: the noise that is reported.
#[derive(Clone, Copy, Debug, Default)]
struct Residuals {
    squares_n2: f32,
    free: f32,
}

impl Residuals {
    /// Degrees of freedom after which old events fade.
    const MEMORY: f32 = 8000.0;

    fn add(&mut self, squares_n2: f32, free: f32) {
        if self.free > Self::MEMORY {
            self.squares_n2 *= 0.5;
            self.free *= 0.5;
        }
        self.squares_n2 += squares_n2;
        self.free += free;
    }

    fn variance_n2(&self) -> Option<f32> {
        (self.free >= 1.0).then(|| self.squares_n2 / self.free)
    }
}

impl Cycles {
    /// Before the first event.
    #[must_use]
    pub fn new(site: Site) -> Self {
        Self {
            site,
            pending: None,
            rate: Shared::default(),
            omega: Shared::default(),
            residuals: Residuals::default(),
            last_stop: None,
            count: 0,
        }
    }

    /// Standard deviation of the noise, N, from the residuals of all fits.
    #[must_use]
    pub fn noise_n(&self) -> Option<f32> {
        self.residuals.variance_n2().map(crate::math::sqrt)
    }

    /// Loading rate, N/s, and omega, rad/s, of the recent events.
    #[must_use]
    pub fn shared(&self) -> (Option<f32>, Option<f32>) {
        let hz = self.site.rate_hz;
        (self.rate.mean().map(|r| r * hz), self.omega.mean().map(|w| w * hz))
    }

    /// The block rests again: completes the event before and starts the next one.
    ///
    /// `last_hidden` is the newest saturated index.
    pub fn restick(
        &mut self,
        detector: &Detector,
        (peak, low): (Extreme, Extreme),
        last_hidden: Option<u64>,
    ) -> Option<Event> {
        let (stick, window) = (detector.ended(), detector.window());
        let noise_n = detector.noise_n().unwrap_or(1.0);
        let finished = self.complete(stick, window, peak);
        let now = detector.last().index;
        let mut next = Pending::new(stick, self.start(stick), window, now, (peak, low));
        next.hidden |= last_hidden.is_some_and(|index| index + 4 >= stick.next);
        let noise_n2 = self.residuals.variance_n2().unwrap_or(noise_n * noise_n);
        next.fit = self.fit(&next, &Line::default(), noise_n2);
        self.pending = Some(next);
        finished
    }

    /// Completes the pending event with what there is of its stick line.
    pub fn finish(&mut self, stick: &Stick, window: &Window, last: Extreme) -> Option<Event> {
        self.complete(stick, window, last)
    }

    /// First index of an event's samples: where the stick line ends, or right after
    /// the last stop when the block rested too briefly for a line.
    fn start(&self, stick: &Stick) -> u64 {
        match self.last_stop {
            Some(stop) if stick.line.count < 3 => stick.next.min(stop.index + 1),
            _ => stick.next,
        }
    }

    fn complete(&mut self, stick: &Stick, window: &Window, next_peak: Extreme) -> Option<Event> {
        let mut pending = self.pending.take()?;
        pending.end_before(stick, window, next_peak.index);
        let mut after = stick.first;
        after.shift(since(stick.origin, pending.origin));
        let noise_n2 = self.residuals.variance_n2().unwrap_or(1.0);
        let fit = self.fit(&pending, &after, noise_n2);
        let event = self.event(&pending, &after, fit.as_ref());
        self.count = self.count.saturating_add(1);
        Some(event)
    }

    fn fit(&self, pending: &Pending, after: &Line, noise_n2: f32) -> Option<Fit> {
        let data = self.data(pending, after, noise_n2);
        match pending.fit {
            Some(first) => data.fit(&first.cycle, noise_n2),
            None => data.fit(&pending.guess(&data)?, noise_n2),
        }
    }

    fn data<'a>(&self, pending: &'a Pending, after: &'a Line, noise_n2: f32) -> Data<'a> {
        Data {
            before: &pending.before,
            points: pending.points.get(..pending.length).unwrap_or_default(),
            after,
            rate: self.rate.prior(noise_n2),
            omega: self.omega.prior(noise_n2),
            onset: Prior::default(),
        }
    }

    fn event(&mut self, pending: &Pending, after: &Line, fit: Option<&Fit>) -> Event {
        let Some(fit) = fit.filter(|fit| fit.converged) else {
            return self.without_coefficients(pending, Reason::NoFit);
        };
        let data = self.data(pending, after, self.residuals.variance_n2().unwrap_or(1.0));
        let (squares_n2, free) = own_residuals(&data, fit);
        if free < 1.0 {
            return self.without_coefficients(pending, Reason::TooShort);
        }
        if pending.hidden {
            return self.without_coefficients(pending, Reason::Hidden);
        }
        self.residuals.add(squares_n2, free);
        let noise_n2 = self.residuals.variance_n2().unwrap_or(squares_n2 / free);
        self.learn(&data, fit, noise_n2);
        self.measured(pending, fit, noise_n2)
    }

    /// Carries the event's own loading rate and omega to the next ones.
    fn learn(&mut self, data: &Data<'_>, fit: &Fit, noise_n2: f32) {
        const RATE: Gradient = [0.0, 1.0, 0.0, 0.0, 0.0];
        const OMEGA: Gradient = [0.0, 0.0, 0.0, 0.0, 1.0];
        let own = |value: f32, unit: &Gradient, prior: Prior| {
            let variance = noise_n2 * fit.information.covariance(unit, unit);
            without_prior(value, variance, prior, noise_n2)
        };
        if let Some((value, variance)) = own(fit.cycle.rate, &RATE, data.rate) {
            self.rate.add(value, variance);
        }
        if let Some((value, variance)) = own(fit.cycle.omega, &OMEGA, data.omega) {
            self.omega.add(value, variance);
        }
    }

    fn measured(&mut self, pending: &Pending, fit: &Fit, noise_n2: f32) -> Event {
        const STATIC: Gradient = [0.0, 0.0, 1.0, 0.0, 0.0];
        const DYNAMIC: Gradient = [0.0, 0.0, 1.0, -1.0, 0.0];
        let site = self.site;
        let (_, cos) = crate::math::sin_cos(site.slope_rad);
        let coefficient = |force_n: f32, unit: &Gradient| {
            let variance = noise_n2 * fit.information.covariance(unit, unit);
            Some(Coefficient {
                value: model::coefficient(force_n, site.weight_n, site.slope_rad),
                std: crate::math::sqrt(variance) / (site.weight_n * cos),
            })
        };
        let cycle = &fit.cycle;
        let mut event = self.bare(pending, cycle);
        event.mu_s = coefficient(cycle.static_n, &STATIC);
        event.mu = coefficient(cycle.dynamic_n(), &DYNAMIC);
        if cycle.slide_time() < 1.0 {
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
        };
        let mut event = self.bare(pending, &cycle);
        event.quality =
            if reason == Reason::Hidden { Quality::Clipped } else { Quality::Unresolved };
        event.omega_rad_per_s = None;
        event.reason = Some(reason);
        event
    }
}

impl Pending {
    fn new(
        stick: &Stick,
        start: u64,
        window: &Window,
        now: u64,
        (peak, low): (Extreme, Extreme),
    ) -> Self {
        let first = stick.next;
        let mut before = stick.line;
        before.shift(since(stick.origin, first));
        let mut pending = Self {
            origin: first,
            before,
            points: [Point::default(); CORE],
            length: 0,
            peak,
            low,
            fit: None,
            hidden: false,
        };
        pending.take(window, start, now);
        let missing = (first..=now).filter(|&index| window.get(index).is_none()).count();
        pending.hidden = missing > 3 || pending.length == CORE;
        pending
    }

    /// Takes the samples `from` to `to`, as many as fit.
    fn take(&mut self, window: &Window, from: u64, to: u64) {
        for index in from..=to {
            let Some(force_n) = window.get(index) else { continue };
            let Some(point) = self.points.get_mut(self.length) else { return };
            *point = Point { time: since(self.origin, index), force_n, weight: 1.0 };
            self.length += 1;
        }
    }

    /// Ends the event before the next one's peak; a stick too brief for a line
    /// gives its samples one by one.
    fn end_before(&mut self, stick: &Stick, window: &Window, next_peak: u64) {
        if stick.first.count == 0 {
            let last = self.points.get(..self.length).and_then(<[Point]>::last);
            let next =
                last.map_or(0, |point| self.origin.saturating_add_signed(point.time as i64) + 1);
            self.take(window, next, next_peak.saturating_sub(1));
        }
        let end = since(self.origin, next_peak);
        let points = self.points.get(..self.length).unwrap_or_default();
        self.length = points.iter().take_while(|point| point.time < end).count();
    }

    /// A first guess: the lines' level and slope, half-way down in time, and the
    /// slip's length that fits best of a few.
    fn guess(&self, data: &Data<'_>) -> Option<Cycle> {
        let drop = self.peak.force_n - self.low.force_n;
        let peak_time = since(self.origin, self.peak.index);
        let low_time = since(self.origin, self.low.index);
        let slope = if data.rate.weight > 0.0 { Some(data.rate.mean) } else { self.before.slope() };
        let rate = slope.unwrap_or(0.0).max(1e-4 * drop);
        let half_drop_n = 0.5 * drop;
        let middle =
            self.crossing(self.peak.force_n - half_drop_n).unwrap_or(0.5 * (peak_time + low_time));
        let with_slide = |slide: f32| {
            let phase = crate::math::atan2(rate * slide, core::f32::consts::PI * half_drop_n);
            let onset = middle - 0.5 * slide;
            let static_n = if self.before.count >= 3 {
                self.before.at(onset, rate)
            } else {
                self.peak.force_n
            };
            let omega = (core::f32::consts::PI + 2.0 * phase) / slide;
            Cycle { onset, rate, static_n, half_drop_n, omega }
        };
        if data.omega.weight > 0.0 {
            let phase = crate::math::atan2(rate / data.omega.mean, half_drop_n);
            return Some(with_slide((core::f32::consts::PI + 2.0 * phase) / data.omega.mean));
        }
        let fall = low_time - peak_time;
        [0.6, 0.8, 1.0, 1.25, 1.6]
            .map(|part| with_slide((part * fall).max(0.5)))
            .into_iter()
            .min_by(|a, b| data.cost(a).total_cmp(&data.cost(b)))
    }

    /// Time at which the samples fall through a force.
    fn crossing(&self, force_n: f32) -> Option<f32> {
        let points = self.points.get(..self.length)?;
        let peak_time = since(self.origin, self.peak.index);
        let pair = points
            .windows(2)
            .find(|pair| pair.last().is_some_and(|p| p.time > peak_time && p.force_n < force_n))?;
        let [a, b] = pair else { return None };
        Some(b.time - (b.time - a.time) * (force_n - b.force_n) / (a.force_n - b.force_n))
    }
}

/// Squared residuals of an event that no other event counts, N², and how many
/// degrees of freedom they have.
fn own_residuals(data: &Data<'_>, fit: &Fit) -> (f32, f32) {
    let from_prior =
        |prior: Prior, value: f32| prior.weight * (prior.mean - value) * (prior.mean - value);
    let priors = from_prior(data.rate, fit.cycle.rate) + from_prior(data.omega, fit.cycle.omega);
    let squares = fit.cost - priors + data.after.residual();
    let observations =
        data.points.len() as f32 + data.before.count.min(2) as f32 + data.after.count as f32;
    let known = (data.rate.weight > 0.0) as u8 + (data.omega.weight > 0.0) as u8;
    (squares.max(0.0), observations - (model::UNKNOWNS as f32 - f32::from(known)))
}

/// Periods from an origin to an index, which may lie before it.
fn since(origin: u64, index: u64) -> f32 {
    index.wrapping_sub(origin).cast_signed() as f32
}

/// A time in periods from an origin, as index and fraction.
fn moment(origin: u64, time: f32) -> SampleTime {
    let whole = libm::floorf(time);
    SampleTime { index: origin.saturating_add_signed(whole as i64), fraction: time - whole }
}
