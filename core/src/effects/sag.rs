//! A cable that sags is softer at small forces.
//!
//! With `1/k_eff = (1 + S/F³)/k` (Ernst; `S = k q² L³/12`, `q` the cable's weight per length) a
//! force stretches it by `y(F) = F − S/(2 F²)`, in units of force. At rest `y` grows at the steady
//! rate `k w`, so a rest from `Fe` to `Fs` takes longer than the loading rate just before
//! the slip would need: that tells `S`. And a slip ends where its work is done,
//! `∫ (F − Fp) dy = 0` from `Fs` to `Fe`, whatever the winch does meanwhile:
//!
//! `Fp = (Fs + Fe)/2 − S Δ² / (4 (Fs² Fe² + S (Fs + Fe)/2))`, `Δ = Fs − Fe`.

use crate::effect::Parameter;
use crate::model::CycleParams;
use crate::num::math::{self, larger};
use crate::stats::fading_trend::FadingTrend;

/// A rest between two slips.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rest {
    /// How long, periods.
    pub(crate) time: f32,
    /// Force at its start and at its end, N.
    pub(crate) from_n: f32,
    pub(crate) to_n: f32,
    /// Loading rate towards its end, N per period, its variance, and the force that it
    /// belongs to, N.
    pub(crate) rate: f32,
    pub(crate) rate_variance: f32,
    pub(crate) rate_at_n: f32,
}

impl Rest {
    /// Softness `S`, N³, and its variance.
    fn softness(&self) -> Option<(f32, f32)> {
        let inverse_square = |force_n: f32| 1.0 / (force_n * force_n);
        let by_softness = 0.5 * (inverse_square(self.from_n) - inverse_square(self.to_n))
            - self.rate * self.time * inverse_square(self.rate_at_n) / self.rate_at_n;
        let loads = self.from_n > 0.0 && self.from_n < self.to_n;
        if !loads || by_softness <= 0.0 {
            return None;
        }
        let part = self.time / by_softness;
        let longer_n = self.rate * self.time - (self.to_n - self.from_n);
        Some((longer_n / by_softness, self.rate_variance * part * part))
    }
}

/// The softness that the rests of a test show.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sag {
    softness: FadingTrend,
}

impl Sag {
    /// Lets the past count for less, once an event.
    pub(crate) fn forget(&mut self) {
        self.softness.fade();
    }

    /// Takes a rest.
    pub(crate) fn learn(&mut self, rest: &Rest) {
        if let Some((softness, variance)) = rest.softness() {
            // The trend moves on only with a rest that tells of it.
            self.softness.pass();
            self.softness.add(softness, variance);
        }
    }

    /// The softness, once it counts.
    pub(crate) fn parameter(&self) -> Option<Parameter> {
        let value = self.softness.mean().filter(|_| self.softness.is_well_known())?;
        let std = 1.0 / math::sqrt(self.softness.prior(1.0).weight);
        (value > std).then_some(Parameter { name: "softness_n3", value, std })
    }

    /// How far `Fp` lies below `(Fs + Fe)/2`, N, and its variance. A mean that is itself uncertain
    /// shifts `Fp` by the part of it that its variance leaves (James and Stein), and by nothing
    /// before several rests; what it does not shift is uncertainty.
    pub(crate) fn shift(&self, cycle: &CycleParams) -> (f32, f32) {
        let (high_n, low_n) = (cycle.static_n, cycle.restick_n());
        let (product, drop_n) = (high_n * low_n, high_n - low_n);
        let Some(mean) = self.softness.mean().filter(|mean| *mean > 0.0 && product > 0.0) else {
            return (0.0, 0.0);
        };
        let (mut sure, mut unsure) = (0.0, mean * mean);
        let weight = self.softness.prior(1.0).weight;
        if self.softness.is_well_known() {
            sure = larger(mean - 1.0 / (weight * mean), 0.0);
            unsure = (mean - sure) * (mean - sure) + 1.0 / weight;
        }
        let all = product * product + 0.5 * mean * (high_n + low_n);
        let by_softness = 0.25 * drop_n * drop_n / all;
        (sure * by_softness, by_softness * by_softness * unsure)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOFTNESS: f32 = 5.24e6;

    fn stretch(force_n: f32) -> f32 {
        force_n - 0.5 * SOFTNESS / (force_n * force_n)
    }

    fn rest(from_n: f32) -> Rest {
        let (to_n, winch, rate_at_n) = (780.0, 22.5, 700.0);
        let rate = winch / (1.0 + SOFTNESS / (rate_at_n * rate_at_n * rate_at_n));
        let time = (stretch(to_n) - stretch(from_n)) / winch;
        Rest { time, from_n, to_n, rate, rate_variance: 0.01, rate_at_n }
    }

    fn cycle() -> CycleParams {
        let (static_n, half_drop_n) = (780.0, 277.0);
        CycleParams { onset: 0.0, rate: 22.0, static_n, half_drop_n, omega: 1.2, rate_change: 0.0 }
    }

    #[test]
    fn a_rest_tells_the_softness() {
        let (softness, variance) = rest(226.0).softness().unwrap();
        assert!((softness / SOFTNESS - 1.0).abs() < 0.01, "{softness}");
        // Ten per cent more of the rate is ten standard deviations here.
        let faster = Rest { rate: 1.1 * rest(226.0).rate, ..rest(226.0) };
        let more = faster.softness().unwrap().0 - softness;
        assert!(more > 0.8 * 22.0 * variance.sqrt(), "{more} {variance}");
    }

    #[test]
    fn a_rest_that_does_not_load_tells_nothing() {
        for from_n in [0.0, -5.0, 780.0, 900.0, f32::NAN] {
            assert!(rest(from_n).softness().is_none(), "{from_n}");
        }
    }

    /// Newton's law: the work against friction along the stretch.
    #[test]
    fn the_shift_is_where_the_work_is_done() {
        let mut sag = Sag::default();
        for _ in 0..8 {
            sag.forget();
            sag.learn(&rest(226.0));
        }
        let cycle = cycle();
        let (high_n, low_n) = (cycle.static_n, cycle.restick_n());
        let steps = 20_000;
        let width_n = (high_n - low_n) / steps as f32;
        let (work, way) = (0..steps).fold((0.0_f64, 0.0_f64), |(work, way), i| {
            let force_n = low_n + (i as f32 + 0.5) * width_n;
            let by = f64::from(1.0 + SOFTNESS / force_n.powi(3));
            (work + f64::from(force_n) * by, way + by)
        });
        let shift_n = cycle.dynamic_n() - (work / way) as f32;
        let (got_n, variance_n2) = sag.shift(&cycle);
        assert!((got_n / shift_n - 1.0).abs() < 0.02, "{got_n} {shift_n}");
        assert!(variance_n2 > 0.0 && variance_n2 < shift_n * shift_n);
    }

    #[test]
    fn one_rest_is_an_uncertainty_and_none_is_nothing() {
        let mut sag = Sag::default();
        assert_eq!(sag.shift(&cycle()), (0.0, 0.0));
        sag.learn(&rest(226.0));
        let (shift_n, variance_n2) = sag.shift(&cycle());
        assert!(shift_n.abs() < 1e-6 && variance_n2 > 25.0, "{shift_n} {variance_n2}");
    }
}
