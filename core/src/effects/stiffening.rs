//! Shift of `Fp` by a cable that gets shorter, and so stiffer, while the block slides (scene
//! `shortening`).
//!
//! With the stiffness `k` the loading rate grows by `b` over a slip. A rate change that persists is
//! the cable's, since a winch that gained speed would do so in rests as well. The slip ends where
//! its work is done, `∫ (F − Fp) dF / k = 0`; with `k` changing linearly over the slip, `Fp` lies
//! `d b / 6 r` above the midpoint of `Fs` and `Fe`, where `d` is half the drop and `r` the loading
//! rate.

use crate::effect::Parameter;
use crate::model::CycleParams;
use crate::num::math;
use crate::stats::fading_trend::FadingTrend;

/// Upper limit of the relative gain of the rate in a slip: no cable stiffens by more.
const MOST: f32 = 0.1;

/// Relative gain of a loading rate, N per period, over a slip, from the mean rate change so far;
/// zero where the gain is too large for a cable.
fn gain(rate_change: &FadingTrend, rate: f32) -> f32 {
    let part = rate_change.prior_around_zero(1.0).mean / rate;
    // False for a rate of zero as well.
    if part.abs() < MOST { part } else { 0.0 }
}

/// Distance of `Fp` above the midpoint of `Fs` and `Fe`, N, from the mean rate change so far, N per
/// period.
pub(crate) fn shift_n(rate_change: &FadingTrend, cycle: &CycleParams) -> f32 {
    cycle.half_drop_n * gain(rate_change, cycle.rate) / 6.0
}

/// Is the mean gain of the rate over a slip not zero?
pub(crate) fn is_found(rate: &FadingTrend, rate_change: &FadingTrend) -> bool {
    rate.mean().is_some_and(|rate| gain(rate_change, rate).abs() > 0.0)
}

/// The relative gain of the loading rate over a slip, once the rate is known.
pub(crate) fn parameter(rate: &FadingTrend, rate_change: &FadingTrend) -> Option<Parameter> {
    let rate_n = rate.mean()?;
    let std = 1.0 / math::sqrt(rate_change.prior_around_zero(1.0).weight) / rate_n;
    Some(Parameter { name: "rate_gain", value: gain(rate_change, rate_n), std })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gaining(gain: f32) -> FadingTrend {
        let mut rate_change = FadingTrend::default();
        (0..20).for_each(|_| rate_change.add(gain, 1e-6));
        rate_change
    }

    fn cycle(rate: f32) -> CycleParams {
        let (static_n, half_drop_n) = (781.2, 289.8);
        CycleParams { onset: 0.0, rate, static_n, half_drop_n, omega: 1.18, rate_change: 0.0 }
    }

    #[test]
    fn only_a_cable_gets_stiffer() {
        let rate_change = gaining(0.2);
        let expected_n = 289.8 * 0.2 / (6.0 * 22.5);
        assert!((shift_n(&rate_change, &cycle(22.5)) / expected_n - 1.0).abs() < 0.01);
        for rate in [1.0, 1e-9, 0.0, -1e-9] {
            assert!(shift_n(&rate_change, &cycle(rate)).abs() < 1e-9, "{rate}");
        }
    }

    /// Newton's law: the work along the slide, on a cable whose stiffness is linear in the force.
    #[test]
    fn the_shift_is_where_the_work_is_done() {
        let (cycle, gain) = (cycle(22.5), 0.9);
        let (low_n, drop_n, steps) = (cycle.restick_n(), 2.0 * cycle.half_drop_n, 10_000_u16);
        let (work, way) = (0..steps).fold((0.0_f64, 0.0_f64), |(work, way), step| {
            let part = (f32::from(step) + 0.5) / f32::from(steps);
            // At first, where the force is large, the cable is softer.
            let by = f64::from(1.0 / (cycle.rate + gain * (0.5 - part)));
            (work + f64::from(low_n + part * drop_n) * by, way + by)
        });
        let exact_n = (work / way) as f32 - cycle.dynamic_n();
        let shift_n = shift_n(&gaining(gain), &cycle);
        assert!((shift_n / exact_n - 1.0).abs() < 0.01, "{shift_n} {exact_n}");
    }

    #[test]
    fn a_gain_is_a_number_once_the_rate_is_known() {
        let (mut rate, rate_change) = (FadingTrend::default(), gaining(0.225));
        assert_eq!((parameter(&rate, &rate_change), is_found(&rate, &rate_change)), (None, false));
        rate.add(22.5, 0.01);
        let Parameter { value, std, .. } = parameter(&rate, &rate_change).unwrap();
        assert!((value - 0.01).abs() < 1e-4 && std < 1e-3, "{value} {std}");
        assert!(is_found(&rate, &rate_change));
        assert!(!is_found(&rate, &FadingTrend::default()));
        assert!(!is_found(&rate, &gaining(9.0)));
    }
}
