//! Sag: a cable that sags is softer at small forces.
//!
//! At rest the elongation ([`Elongation`]) grows at the constant rate `k w`. A rest from `Fe` to
//! `Fs` therefore lasts longer than the rate near its end implies, which determines the softness
//! `S`. Once `S` is significant, events are fitted in elongation, in which their lines are
//! straight, and the results are converted back to forces. A slip ends where its work is done,
//! `∫ (F − Fp) dy = 0` from `Fs` to `Fe`, whatever the winch does meanwhile:
//!
//! `Fp = (Fs + Fe)/2 − S Δ² / (4 (Fs² Fe² + S (Fs + Fe)/2))`, `Δ = Fs − Fe`.

use crate::effect::Parameter;
use crate::model::CycleParams;
use crate::model::elongation::Elongation;
use crate::num::math::{self, larger};
use crate::stats::fading_trend::FadingTrend;

/// Standard errors of the mean softness beyond which it is significant. Tuned: with 5 the events of
/// a cable that flops as well are fitted in elongation from the fifteenth on only.
const CLEAR: f32 = 2.0;

/// Standard deviations of the softness between rests beyond which its mean is significant. Tuned:
/// with 1 a winch that ripples once in a second passes for a sag more often, with 1.7 scene `all`
/// loses its sag in mid-record.
const ALIKE: f32 = 1.4;

/// A rest between two slips.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rest {
    /// Duration, periods.
    pub(crate) time: f32,
    /// Force at its start, N, and its variance, N².
    pub(crate) from_n: f32,
    pub(crate) from_n2: f32,
    /// Force at its end, N.
    pub(crate) to_n: f32,
    /// Rate of the elongation near its end, N per period, the variance of the rate, and the force
    /// at which it holds, N.
    pub(crate) rate: f32,
    pub(crate) rate_variance: f32,
    pub(crate) rate_at_n: f32,
}

impl Rest {
    /// Softness `S`, N³, and its variance, from a rest whose rate was measured in this elongation.
    fn softness(&self, cable: &Elongation) -> Option<(f32, f32)> {
        let inverse_square = |force_n: f32| 1.0 / (force_n * force_n);
        let by_softness = 0.5 * (inverse_square(self.from_n) - inverse_square(self.to_n))
            - self.rate * self.time * inverse_square(self.rate_at_n) / self.rate_at_n;
        let loads = self.from_n > 0.0 && self.from_n < self.to_n;
        if !loads || by_softness <= 0.0 {
            return None;
        }
        let stretched_n = cable.of(self.to_n) - cable.of(self.from_n);
        let longer_n = self.rate * self.time - stretched_n;
        let soft = 1.0 / cable.stiffness(self.from_n);
        let longer_n2 = self.rate_variance * self.time * self.time + self.from_n2 * soft * soft;
        let part = 1.0 / by_softness;
        Some((cable.softness + longer_n * part, longer_n2 * part * part))
    }
}

/// Running mean of the softness over the rests of a test.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sag {
    softness: FadingTrend,
}

impl Sag {
    /// Fades the past, once per event.
    pub(crate) fn forget(&mut self) {
        self.softness.fade();
    }

    /// Has any rest been used? All later rests are then used too, also those without a sign of sag.
    pub(crate) fn has_begun(&self) -> bool {
        self.softness.mean().is_some()
    }

    /// Updates the mean with a rest whose rate was measured in this elongation.
    pub(crate) fn learn(&mut self, rest: &Rest, cable: &Elongation) {
        if let Some((softness, variance)) = rest.softness(cable) {
            // The trend moves on only with a rest that determines the softness.
            self.softness.pass();
            self.softness.add(softness, variance);
        }
    }

    /// The softness and its variance, if it is significant, also against its scatter between rests,
    /// which a winch that ripples would cause. `None` for a lowest force, N, at which the cable
    /// would hardly be taut.
    fn clear(&self, low_n: f32) -> Option<(f32, f32)> {
        /// Largest softness, as a part of the cube of the lowest force.
        const MOST: f32 = 4.0;
        let (mean, variance) = self.softness.now;
        let of_a_rest = 1.0 / self.softness.prior(1.0).weight;
        let least = larger(CLEAR * CLEAR * variance, ALIKE * ALIKE * of_a_rest);
        let is_taut = mean < MOST * low_n * low_n * low_n;
        let counts = self.softness.is_known() && mean > 0.0 && mean * mean > least;
        (counts && is_taut).then_some((mean, variance))
    }

    /// The softness, once it is significant.
    pub(crate) fn parameter(&self) -> Option<Parameter> {
        let (value, variance) = self.clear(f32::INFINITY)?;
        Some(Parameter { name: "softness_n3", value, std: math::sqrt(variance) })
    }

    /// The elongation in which an event with this lowest force, N, is fitted: the force itself
    /// while the softness is not significant.
    pub(crate) fn elongation(&self, low_n: f32) -> Elongation {
        let of = |(softness, _)| Elongation { softness, zero_n: low_n };
        self.clear(low_n).map_or_else(Elongation::default, of)
    }

    /// Distance of `Fp` below `(Fs + Fe)/2`, N, and its variance. The softness that shifts `Fp` is
    /// its mean, shrunk for its variance (James and Stein), and zero before it is significant; the
    /// rest of the mean adds to the variance. An event that `was_bent`, fitted in elongation, is
    /// shifted in any case: its fit took the softness for significant.
    pub(crate) fn shift(&self, cycle: &CycleParams, was_bent: bool) -> (f32, f32) {
        let (high_n, low_n) = (cycle.static_n, cycle.restick_n());
        let (product, drop_n) = (high_n * low_n, high_n - low_n);
        let Some(mean) = self.softness.mean().filter(|mean| *mean > 0.0 && product > 0.0) else {
            return (0.0, 0.0);
        };
        let (mut sure, mut unsure) = (0.0, mean * mean);
        if was_bent || self.clear(low_n).is_some() {
            let (_, variance) = self.softness.now;
            sure = larger(mean - variance / mean, 0.0);
            unsure = (mean - sure) * (mean - sure) + variance;
        }
        let all = product * product + 0.5 * mean * (high_n + low_n);
        let by_softness = 0.25 * drop_n * drop_n / all;
        (sure * by_softness, by_softness * by_softness * unsure)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CABLE: Elongation = Elongation { softness: 5.24e6, zero_n: 226.0 };

    /// A rest on that cable, measured in another elongation.
    fn rest(from_n: f32, followed: &Elongation) -> Rest {
        let (to_n, winch, rate_at_n) = (780.0, 22.5, 700.0);
        let time = (CABLE.of(to_n) - CABLE.of(from_n)) / winch;
        let rate = winch * CABLE.stiffness(rate_at_n) / followed.stiffness(rate_at_n);
        Rest { time, from_n, from_n2: 4.0, to_n, rate, rate_variance: 0.01, rate_at_n }
    }

    fn cycle() -> CycleParams {
        let (static_n, half_drop_n) = (780.0, 277.0);
        CycleParams { onset: 0.0, rate: 22.0, static_n, half_drop_n, omega: 1.2, rate_change: 0.0 }
    }

    // Without the feature no cable sags.
    #[cfg(feature = "sag")]
    #[test]
    fn a_rest_tells_the_softness_in_whatever_elongation_it_was_followed() {
        for softness in [0.0, 3e6, 5.24e6, 7e6] {
            let followed = Elongation { softness, zero_n: 230.0 };
            let of = |rest: &Rest| rest.softness(&followed).unwrap();
            let exact = rest(226.0, &followed);
            let (got, variance) = of(&exact);
            assert!((got / CABLE.softness - 1.0).abs() < 0.02, "{softness} {got}");
            // Ten per cent more of the rate is twenty standard deviations of it here.
            let more = of(&Rest { rate: 1.1 * exact.rate, ..exact }).0 - got;
            let of_rate = of(&Rest { from_n2: 0.0, ..exact }).1.sqrt();
            assert!(more > 0.8 * 22.0 * of_rate && of_rate < variance.sqrt(), "{more} {of_rate}");
        }
    }

    #[test]
    fn a_rest_that_does_not_load_tells_nothing() {
        for from_n in [0.0, -5.0, 780.0, 900.0, f32::NAN] {
            let rest = Rest { from_n, ..rest(226.0, &CABLE) };
            assert!(rest.softness(&CABLE).is_none(), "{from_n}");
        }
    }

    /// Newton's law: the work against friction along the elongation.
    #[test]
    fn the_shift_is_where_the_work_is_done() {
        let mut sag = Sag::default();
        for _ in 0..8 {
            sag.forget();
            sag.learn(&rest(226.0, &CABLE), &CABLE);
        }
        let cycle = cycle();
        let (high_n, low_n) = (cycle.static_n, cycle.restick_n());
        let steps = 20_000;
        let width_n = (high_n - low_n) / steps as f32;
        let (work, way) = (0..steps).fold((0.0_f64, 0.0_f64), |(work, way), i| {
            let force_n = low_n + (i as f32 + 0.5) * width_n;
            let by = f64::from(1.0 / CABLE.stiffness(force_n));
            (work + f64::from(force_n) * by, way + by)
        });
        let shift_n = cycle.dynamic_n() - (work / way) as f32;
        let (got_n, variance_n2) = sag.shift(&cycle, false);
        assert!((got_n / shift_n - 1.0).abs() < 0.02, "{got_n} {shift_n}");
        assert!(variance_n2 > 0.0 && variance_n2 < shift_n * shift_n);
        let Elongation { softness, zero_n } = sag.elongation(226.0);
        assert!((softness / CABLE.softness - 1.0).abs() < 0.01 && zero_n > 225.0, "{softness}");
        // A force this low would hardly stretch the cable: no fit uses the sag, and it shifts
        // nothing.
        assert!(!sag.elongation(100.0).sags());
        let slips_to_low = CycleParams { half_drop_n: 340.0, ..cycle };
        let (shift_n, variance_n2) = sag.shift(&slips_to_low, false);
        assert!(shift_n.abs() < 1e-6 && variance_n2 > 25.0, "{shift_n} {variance_n2}");
        // But one that was fitted so is shifted.
        let (shift_n, variance_n2) = sag.shift(&slips_to_low, true);
        assert!(shift_n > 25.0 && variance_n2 < 25.0, "{shift_n} {variance_n2}");
    }

    #[test]
    fn one_rest_is_an_uncertainty_and_none_is_nothing() {
        let mut sag = Sag::default();
        assert_eq!(sag.shift(&cycle(), false), (0.0, 0.0));
        sag.learn(&rest(226.0, &CABLE), &CABLE);
        let (shift_n, variance_n2) = sag.shift(&cycle(), false);
        assert!(shift_n.abs() < 1e-6 && variance_n2 > 25.0, "{shift_n} {variance_n2}");
        assert!(!sag.elongation(226.0).sags() && sag.parameter().is_none());
    }
}
