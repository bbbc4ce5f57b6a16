//! What follows from a test beside the coefficients, each with its standard deviation.

use floe_core::{Config, Losses, Quantity, Report};
use serde::Serialize;

use super::result::{EventSummary, known, short_or_null};
use crate::log::STANDARD_GRAVITY;

/// Rates, frequencies, stiffnesses, times. What is not known is `None`: all of them where no
/// event counts.
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
    /// Mean time from onset to onset.
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
    /// The first over the second: 1 if weight and winch speed are right.
    #[serde(with = "short_or_null")]
    pub stiffness_ratio: Option<f64>,
    /// One standard deviation.
    #[serde(with = "short_or_null")]
    pub stiffness_ratio_std: Option<f64>,
    /// What the recurrence should be by (22) to (25); `None` on a cable that goes slack.
    #[serde(with = "short_or_null")]
    pub recurrence_predicted_s: Option<f64>,
    /// The winch speed, for [`Quantities::complete`].
    #[serde(skip)]
    pub(crate) winch_m_per_s: Option<f64>,
    /// The losses as the whole test tells them, for [`Quantities::complete`].
    #[serde(skip)]
    pub(crate) losses: Losses,
}

/// A number with its relative standard deviation.
type Relative = (f64, f64);

impl Quantities {
    /// Of a test.
    #[must_use]
    pub fn new(config: &Config, report: &Report) -> Self {
        if report.mu_s.or(report.mu).is_none() {
            return Self::default();
        }
        let rate = relative(report.loading_rate_n_per_s);
        let omega = relative(report.omega_rad_per_s);
        let winch = config.winch_m_per_s.map(f64::from);
        let std = |of: f32| f64::from(of);
        let ratio = f64::from(report.weight_ratio);
        let of_weight = f64::from(config.weight_n) / STANDARD_GRAVITY;
        let mass_kg = ratio * config.mass_kg.map_or(of_weight, f64::from);
        let weight = std(config.std.weight).hypot(std(report.weight_ratio_std));
        let from_rate = rate.zip(winch).map(|((rate, own), winch)| {
            (rate / winch, own.hypot(std(config.std.winch)).hypot(std(config.std.span)))
        });
        let from_omega =
            omega.map(|(omega, own)| (omega * omega * mass_kg, (2.0 * own).hypot(weight)));
        let check = from_rate.zip(from_omega).map(|(a, b)| (a.0 / b.0, a.1.hypot(b.1)));
        let value = |of: Option<Relative>| of.map(|(value, _)| value);
        let std = |of: Option<Relative>| of.map(|(value, std)| value.abs() * std);
        Self {
            loading_rate_n_per_s: value(rate),
            omega_rad_per_s: value(omega),
            stiffness_n_per_m: value(from_rate).or(value(from_omega)),
            recurrence_s: known(report.recurrence_s),
            loading_rate_n_per_s_std: std(rate),
            omega_rad_per_s_std: std(omega),
            stiffness_from_rate_n_per_m: value(from_rate),
            stiffness_from_rate_n_per_m_std: std(from_rate),
            stiffness_from_omega_n_per_m: value(from_omega),
            stiffness_from_omega_n_per_m_std: std(from_omega),
            stiffness_ratio: value(check),
            stiffness_ratio_std: std(check),
            recurrence_predicted_s: predicted_s(config, report, value(rate), value(omega)),
            winch_m_per_s: winch,
            losses: Losses::of(config, report),
        }
    }

    /// Do the two stiffnesses differ by more than three standard deviations? Then weight or winch
    /// speed is wrong, or the slips are.
    #[must_use]
    pub fn disagree(&self) -> bool {
        let ratio = self.stiffness_ratio.zip(self.stiffness_ratio_std);
        ratio.is_some_and(|(ratio, std)| (ratio - 1.0).abs() > 3.0 * std)
    }

    /// What is known of a test while it runs, by one event of it: from the winch speed.
    #[must_use]
    pub fn of_event(event: &EventSummary, winch_m_per_s: Option<f64>) -> Self {
        let stiffness_n_per_m = winch_m_per_s.map(|winch| event.loading_rate_n_per_s / winch);
        Self { stiffness_n_per_m, winch_m_per_s, ..Self::default() }
    }

    /// Gives an event, which has none yet, the losses of the cable, and what [`Self::slide`] does.
    pub fn complete(&self, event: &mut EventSummary) {
        event.put_on(self.losses);
        self.slide(event);
    }

    /// Gives an event its slip length, `(Fs − Fe)/k + w T`, with the work against the friction over
    /// it, unless the cable went slack or the stiffness is not known.
    pub fn slide(&self, event: &mut EventSummary) {
        let Some(stiffness) = self.stiffness_n_per_m else { return };
        if event.slack || event.reason.is_some() {
            return;
        }
        let winch = self.winch_m_per_s.unwrap_or(event.loading_rate_n_per_s / stiffness);
        let drop_n = event.static_force_n - event.restick_force_n;
        let length_m = drop_n / stiffness + winch * event.slip_s;
        event.slip_length_m = Some(length_m).filter(|it| it.is_finite());
        event.energy_j = event.slip_length_m.map(|length_m| event.dynamic_force_n * length_m);
    }
}

fn relative(quantity: Option<Quantity>) -> Option<Relative> {
    let Quantity { value, std } = quantity?;
    let (value, std) = (known(Some(value))?, known(Some(std))?);
    (value > 0.0).then(|| (value, std / value))
}

/// Rest (22) and slide (25) of the mean event.
fn predicted_s(
    config: &Config,
    report: &Report,
    rate: Option<f64>,
    omega: Option<f64>,
) -> Option<f64> {
    let (mu_s, mu) = (known(report.mu_s.map(|e| e.mean))?, known(report.mu.map(|e| e.mean))?);
    let (rate, omega) = (rate?, omega?);
    let (sin, cos) = f64::from(config.slope_rad).sin_cos();
    let weight_n = f64::from(report.weight_ratio) * f64::from(config.weight_n);
    let drop_n = (mu_s - mu) * weight_n * cos;
    let restick_n = weight_n * (sin + (2.0 * mu - mu_s) * cos);
    let beside_n = rate / omega;
    let slide_s = (std::f64::consts::PI + 2.0 * (beside_n / drop_n).atan()) / omega;
    let lowest_n = weight_n * (sin + mu * cos) - drop_n.hypot(beside_n);
    (drop_n > 0.0 && restick_n > 0.0 && lowest_n > 0.0).then(|| 2.0 * drop_n / rate + slide_s)
}
