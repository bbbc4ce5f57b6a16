//! Quantities of a test other than the coefficients, each with its standard deviation.

use floe_core::{Config, Estimate, Losses, Quantity, Report};
use serde::Serialize;

use super::check::Check;
use super::events::Events;
use super::result::{EventSummary, known, short_or_null};
use super::slide::{Slide, Unsure};
use crate::log::STANDARD_GRAVITY;

/// Rates, frequencies, stiffnesses and times. A quantity that is not known is `None`: all of them
/// where no event counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Quantities {
    /// Mean rate of the force at rest.
    #[serde(with = "short_or_null")]
    pub loading_rate_n_per_s: Option<f64>,
    /// Natural frequency while sliding.
    #[serde(with = "short_or_null")]
    pub omega_rad_per_s: Option<f64>,
    /// Stiffness of the cable: from the winch speed if it is known, else from omega.
    #[serde(with = "short_or_null")]
    pub stiffness_n_per_m: Option<f64>,
    /// Mean time between onsets, over those intervals in which no slip can be hidden.
    #[serde(with = "short_or_null")]
    pub recurrence_s: Option<f64>,
    /// One standard deviation.
    #[serde(with = "short_or_null")]
    pub loading_rate_n_per_s_std: Option<f64>,
    /// One standard deviation.
    #[serde(with = "short_or_null")]
    pub omega_rad_per_s_std: Option<f64>,
    /// `k = F'/w`, from the winch speed.
    #[serde(with = "short_or_null")]
    pub stiffness_from_rate_n_per_m: Option<f64>,
    /// One standard deviation.
    #[serde(with = "short_or_null")]
    pub stiffness_from_rate_n_per_m_std: Option<f64>,
    /// `k = ω² M`, from the weight.
    #[serde(with = "short_or_null")]
    pub stiffness_from_omega_n_per_m: Option<f64>,
    /// One standard deviation.
    #[serde(with = "short_or_null")]
    pub stiffness_from_omega_n_per_m_std: Option<f64>,
    /// `stiffness_from_rate_n_per_m` over `stiffness_from_omega_n_per_m`: 1 if weight and winch
    /// speed are right.
    #[serde(with = "short_or_null")]
    pub stiffness_ratio: Option<f64>,
    /// One standard deviation.
    #[serde(with = "short_or_null")]
    pub stiffness_ratio_std: Option<f64>,
    /// Recurrence by equations (22) to (25); `None` on a cable that goes slack.
    #[serde(with = "short_or_null")]
    pub recurrence_predicted_s: Option<f64>,
    /// One standard deviation of `recurrence_s`, from the scatter of the intervals.
    #[serde(with = "short_or_null")]
    pub recurrence_s_std: Option<f64>,
    /// One standard deviation, propagated to first order from drop, rate and omega.
    #[serde(with = "short_or_null")]
    pub recurrence_predicted_s_std: Option<f64>,
    /// Mean slip length of the events.
    #[serde(with = "short_or_null")]
    pub slip_length_m: Option<f64>,
    /// One standard deviation.
    #[serde(with = "short_or_null")]
    pub slip_length_m_std: Option<f64>,
    /// Mean work against the friction in an event.
    #[serde(with = "short_or_null")]
    pub energy_j: Option<f64>,
    /// One standard deviation.
    #[serde(with = "short_or_null")]
    pub energy_j_std: Option<f64>,
    /// Input of [`Quantities::slide`].
    #[serde(skip)]
    pub(crate) slide: Option<Slide>,
    /// Losses of the cable by all events of the test; input of [`Quantities::complete`].
    #[serde(skip)]
    pub(crate) losses: Losses,
    /// Drift of the zero by the end of the test, a standard deviation in units of the coefficients,
    /// and the number of events until then; input of [`Quantities::complete`].
    #[serde(skip)]
    pub(crate) drift: (f32, u32),
}

/// Standard deviation of a coefficient due to the drift of the zero.
fn drift_std(config: &Config, report: &Report) -> f32 {
    let normal_n = report.weight_ratio * config.weight_n * config.slope_rad.cos();
    report.zero_n.map_or(0.0, |zero_n| zero_n / normal_n)
}

/// `k = F'/w` and `k = ω² M`, N/m.
fn stiffnesses(
    config: &Config,
    report: &Report,
    [rate, omega]: [Option<Relative>; 2],
) -> [Option<Relative>; 2] {
    let [winch, span, weight] = [config.std.winch, config.std.span, config.std.weight];
    let [winch, span, weight] = [winch, span, weight].map(f64::from);
    let from_rate = rate.zip(config.winch_m_per_s).map(|((rate, own), winch_m_per_s)| {
        (rate / f64::from(winch_m_per_s), own.hypot(winch).hypot(span))
    });
    let of_weight = f64::from(config.weight_n) / STANDARD_GRAVITY;
    let mass_kg = config.mass_kg.map_or(of_weight, f64::from) * f64::from(report.weight_ratio);
    let weight = weight.hypot(report.weight_ratio_std.into());
    let from_omega = omega.map(|(omega, own)| (omega * omega * mass_kg, (2.0 * own).hypot(weight)));
    [from_rate, from_omega]
}

/// A value and its relative standard deviation.
pub(super) type Relative = (f64, f64);

impl Quantities {
    /// The quantities that follow from the report of the core; `omega` is its omega, where the
    /// events determine it.
    #[must_use]
    pub fn new(config: &Config, report: &Report, omega: Option<Quantity>) -> Self {
        if report.mu_s.or(report.mu).is_none() {
            return Self::default();
        }
        let rate = relative(report.loading_rate_n_per_s);
        let omega = relative(omega);
        let winch = config.winch_m_per_s.map(f64::from);
        let [from_rate, from_omega] = stiffnesses(config, report, [rate, omega]);
        let check = from_rate.zip(from_omega).map(|(a, b)| (a.0 / b.0, a.1.hypot(b.1)));
        let value = |of: Option<Relative>| of.map(|(value, _)| value);
        let stiffness = value(from_rate).or(value(from_omega));
        let unsure = Unsure::of(config, report, rate, omega);
        let std = |of: Option<Relative>| of.map(|(value, std)| value.abs() * std);
        Self {
            loading_rate_n_per_s: value(rate),
            omega_rad_per_s: value(omega),
            stiffness_n_per_m: stiffness,
            // The span is the same factor for all forces.
            loading_rate_n_per_s_std: std(
                rate.map(|(rate, own)| (rate, own.hypot(config.std.span.into())))
            ),
            omega_rad_per_s_std: std(omega),
            stiffness_from_rate_n_per_m: value(from_rate),
            stiffness_from_rate_n_per_m_std: std(from_rate),
            stiffness_from_omega_n_per_m: value(from_omega),
            stiffness_from_omega_n_per_m_std: std(from_omega),
            stiffness_ratio: value(check),
            stiffness_ratio_std: std(check),
            slide: stiffness.map(|stiffness_n_per_m| Slide {
                stiffness_n_per_m,
                winch_m_per_s: winch,
                grade: f64::from(config.slope_rad).tan(),
                unsure,
            }),
            losses: Losses::of(config, report),
            drift: (drift_std(config, report), report.events),
            ..Self::default()
        }
    }

    /// Adds the quantities that need every event: recurrence, slip length and energy.
    pub(super) fn with(self, events: &Events, of: (&Config, &Report)) -> Self {
        let (_, report) = of;
        if report.mu_s.or(report.mu).is_none() {
            return self;
        }
        let rate = relative(report.loading_rate_n_per_s);
        let omega = self.omega_rad_per_s.zip(self.omega_rad_per_s_std);
        let omega = omega.map(|(value, std)| (value, std / value));
        let predicted = events.recurrence.predicted_s(of, rate, omega);
        let recurrence = events.recurrence.seen_s();
        let [length, energy] = self.slide.map_or([None; 2], |slide| slide.means(events));
        let value = |of: Option<Estimate>| known(of.map(|it| it.mean));
        let std = |of: Option<Estimate>| known(of.and_then(|it| it.combined_std()));
        Self {
            recurrence_s: value(recurrence),
            recurrence_s_std: std(recurrence),
            recurrence_predicted_s: predicted.map(|(value, _)| value),
            recurrence_predicted_s_std: predicted.and_then(|(_, std)| std),
            slip_length_m: value(length),
            slip_length_m_std: std(length),
            energy_j: value(energy),
            energy_j_std: std(energy),
            ..self
        }
    }

    /// Verdict on the ratio of the two stiffnesses; `None` without a ratio.
    #[must_use]
    pub fn check(&self) -> Option<Check> {
        let (ratio, std) = self.stiffness_ratio.zip(self.stiffness_ratio_std)?;
        Some(Check::of(ratio, std))
    }

    /// Quantities of a test that is still running, from one event, winch speed and slope.
    #[must_use]
    pub fn of_event(event: &EventSummary, config: &Config) -> Self {
        let winch_m_per_s = config.winch_m_per_s.map(f64::from);
        let slide = winch_m_per_s.map(|winch| Slide {
            stiffness_n_per_m: event.loading_rate_n_per_s / winch,
            winch_m_per_s,
            grade: f64::from(config.slope_rad).tan(),
            unsure: None,
        });
        Self { slide, ..Self::default() }
    }

    /// Completes an event: the losses of the cable if it has none, the drift of the zero as known
    /// at the end of the test, and the fields of [`Self::slide`].
    pub fn complete(&self, event: &mut EventSummary) {
        // The drift is taken to grow evenly, since the zero was known at the beginning.
        let (std, events) = self.drift;
        event.put_on(self.losses, std * (event.index + 1) as f32 / events.max(1) as f32);
        self.slide(event);
    }

    /// Sets the slip length of an event and the work against the friction over it.
    pub fn slide(&self, event: &mut EventSummary) {
        let Some(slide) = self.slide else { return };
        let [length_m, energy_j] = slide.of(event).map_or([None; 2], |both| both.map(Some));
        let [length_std, energy_std] =
            slide.with_std(event).map_or([None; 2], |both| both.map(|it| Some(it.combined_std())));
        (event.slip_length_m, event.energy_j) = (length_m, energy_j);
        (event.slip_length_m_std, event.energy_j_std) = (known(length_std), known(energy_std));
    }
}

fn relative(quantity: Option<Quantity>) -> Option<Relative> {
    let Quantity { value, std } = quantity?;
    let (value, std) = (known(Some(value))?, known(Some(std))?);
    (value > 0.0).then(|| (value, std / value))
}
