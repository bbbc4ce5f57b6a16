//! The error budget: what limits a coefficient besides the scatter of the force.
//!
//! `c = (F/W − sin α)/cos α`, so an error of weight, slope, zero or span is the same in every
//! event, and no number of events averages it out. With `D` the damping ratio of the cable:
//!
//! | input | `∂c/∂input` |
//! |---|---|
//! | weight `W` | `−(c + tan α)/W` |
//! | slope `α` | `c tan α − 1` |
//! | zero | `−1/(W cos α)` |
//! | span (a factor) | `−(c + tan α)` |
//! | damping `D` | `mu`: `−π/2 (mu_s − mu)`, `mu_s`: `−5/2 r/(ω W cos α)` |
//! | winch speed | 0: it makes the stiffness only |
//!
//! Damping: half a turn of the ellipse loses the part `π D` of its axis, so the block rests `π D
//! (Fs − Fp)` too early, and `(Fs + Fe)/2` lies above `Fp` by half of that. An undamped curve that
//! is fitted to a damped slip begins lower by `3/2 D r/ω`, `r` the loading rate (by least squares,
//! where a slip has three samples or more). A dashpot in the cable takes another `D r/ω` off the
//! onset, which drag would give back: the larger sum is taken.
//!
//! A drift of the zero, a weight that changed during the test, and what the events of a test share
//! are lines of their own. The random part is the standard error.

pub(crate) mod losses;

use crate::config::Config;
use crate::num::math;
use crate::report::Report;
pub use losses::Losses;

/// An input that a coefficient depends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Input {
    /// Weight of the block, N.
    Weight,
    /// Slope of the ice, rad.
    Slope,
    /// Zero of the load cell, N, as it was taken.
    Zero,
    /// Span of the load cell, a factor.
    Span,
    /// Damping ratio of the cable.
    Damping,
    /// Speed of the winch, m/s.
    Winch,
    /// Drift of the zero during the test, N.
    ZeroDrift,
    /// Weight over the given one, a factor, where the block has changed.
    WeightChange,
    /// Parameters that the model estimates from the events, and assumptions common to all of them,
    /// in units of the coefficient.
    Shared,
}

/// Number of inputs.
pub(crate) const INPUTS: usize = 9;

/// Effect of an input on a coefficient.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Share {
    /// Derivative of the coefficient by the input; `None` where the input has no unit.
    pub sensitivity: Option<f32>,
    /// Standard deviation of the coefficient due to the input.
    pub contribution: f32,
}

/// One line of the budget.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Entry {
    /// The input.
    pub input: Input,
    /// Its value, if it has one.
    pub value: Option<f32>,
    /// Its standard deviation.
    pub std: Option<f32>,
    /// Its effects on `mu_s`, and on `mu`.
    pub shares: [Share; 2],
}

/// The inputs as known at some time of a test.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Known<'a> {
    pub(crate) config: &'a Config,
    /// Sine and cosine of the slope.
    pub(crate) slope: (f32, f32),
    /// Weight in use over the given one, and its relative standard deviation.
    pub(crate) weight_ratio: (f32, f32),
    /// Standard deviations of the zero as it was taken, and of its drift, N.
    pub(crate) zero_n: f32,
    pub(crate) drift_n: f32,
    pub(crate) losses: Losses,
}

impl Known<'_> {
    /// Every input but [`Input::Shared`].
    fn entries(&self, coefficients: [f32; 2]) -> [Entry; INPUTS - 1] {
        let Config { weight_n, slope_rad, winch_m_per_s, .. } = *self.config;
        let (ratio, _) = self.weight_ratio;
        let [weight, slope, zero, span, damping, winch, drift, change] =
            self.sensitivities(coefficients);
        let entry = |input, value, (std, by): (f32, [f32; 2])| {
            let share = |by: f32| Share { sensitivity: Some(by), contribution: (by * std).abs() };
            Entry { input, value, std: Some(std), shares: by.map(share) }
        };
        [
            entry(Input::Weight, Some(ratio * weight_n), weight),
            entry(Input::Slope, Some(slope_rad), slope),
            entry(Input::Zero, Some(0.0), zero),
            entry(Input::Span, Some(1.0), span),
            entry(Input::Damping, Some(0.0), damping),
            entry(Input::Winch, winch_m_per_s, winch),
            entry(Input::ZeroDrift, None, drift),
            entry(Input::WeightChange, Some(ratio), change),
        ]
    }

    /// Standard deviation of each input, and the derivatives of `mu_s` and `mu` by it.
    fn sensitivities(&self, [mu_s, mu]: [f32; 2]) -> [(f32, [f32; 2]); INPUTS - 1] {
        let Config { weight_n, winch_m_per_s, std, .. } = *self.config;
        let (ratio, ratio_std) = self.weight_ratio;
        let (sin, cos) = self.slope;
        let (tan, weight_n) = (sin / cos, ratio * weight_n);
        let each = |by: fn(f32, f32) -> f32| [by(mu_s, tan), by(mu, tan)];
        let force = each(|c, tan| -(c + tan));
        let of = |scale: f32| force.map(|by| by / scale);
        let zero = [-1.0 / (weight_n * cos); 2];
        [
            (std.weight * weight_n, of(weight_n)),
            (std.slope_rad, each(|c, tan| c * tan - 1.0)),
            (self.zero_n, zero),
            (std.span, force),
            (self.losses.damping_std, self.losses.sensitivities([mu_s, mu])),
            (std.winch * winch_m_per_s.unwrap_or(0.0), [0.0; 2]),
            (self.drift_n, zero),
            (ratio_std * ratio, of(ratio)),
        ]
    }

    /// Variances of both coefficients due to the inputs.
    pub(crate) fn variances(&self, coefficients: [f32; 2]) -> [f32; 2] {
        let mut variances = [0.0; 2];
        for (std, by) in self.sensitivities(coefficients) {
            for (variance, by) in variances.iter_mut().zip(by) {
                *variance += square(by * std);
            }
        }
        variances
    }
}

/// Coefficient of a block that slides under a constant force, and its combined standard deviation.
/// The arguments are the mean of that force over the weight, and the standard deviation of that
/// mean. The scatter between events and a drift of the zero are not included.
#[must_use]
pub fn of_constant_force(config: &Config, (force_over_weight, std): (f32, f32)) -> (f32, f32) {
    let slope @ (sin, cos) = math::sin_cos(config.slope_rad);
    let mu = (force_over_weight - sin) / cos;
    let known = Known {
        config,
        slope,
        weight_ratio: (1.0, 0.0),
        zero_n: config.std.zero_n(force_over_weight.abs() * config.weight_n),
        drift_n: 0.0,
        losses: Losses::default(),
    };
    let [variance, _] = known.variances([mu; 2]);
    (mu, math::hypotenuse(std / cos, math::sqrt(variance)))
}

fn square(x: f32) -> f32 {
    x * x
}

/// The budget of the means of a test; `None` before both are known.
#[must_use]
pub fn budget(config: &Config, report: &Report) -> Option<[Entry; INPUTS]> {
    let (mu_s, mu) = report.mu_s.zip(report.mu)?;
    let known = Known {
        config,
        slope: math::sin_cos(config.slope_rad),
        weight_ratio: (report.weight_ratio, report.weight_ratio_std),
        zero_n: report.zero_std_n,
        drift_n: report.zero_drift_n,
        losses: Losses::of(config, report),
    };
    let share = |common_std| Share { sensitivity: None, contribution: common_std };
    let shares = [share(mu_s.common_std), share(mu.common_std)];
    let last = Entry { input: Input::Shared, value: None, std: None, shares };
    let mut entries = [last; INPUTS];
    for (entry, input) in entries.iter_mut().zip(known.entries([mu_s.mean, mu.mean])) {
        *entry = input;
    }
    Some(entries)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::InputStd;

    #[test]
    fn what_a_slide_would_tell_is_no_better_than_the_inputs() {
        let std =
            InputStd { weight: 0.01, slope_rad: 0.01, zero_n: Some(6.3), ..InputStd::default() };
        let config = Config { weight_n: 630.0, slope_rad: 0.1, std, ..Config::default() };
        let (mu, combined) = of_constant_force(&config, (0.78, 1e-3));
        let (sin, cos) = math::sin_cos(0.1);
        assert!((mu - (0.78 - sin) / cos).abs() < 1e-6);
        let parts =
            [1e-3 / cos, 7.8e-3 / cos, 0.01 * (1.0 - mu * sin / cos), 0.01 / cos, 7.8e-4 / cos];
        let variance: f32 = parts.iter().map(|part| part * part).sum();
        assert!((combined - math::sqrt(variance)).abs() < 1e-7, "{combined}");
    }
}
