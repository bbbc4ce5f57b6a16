//! Results of all samples so far: the report and the systematic parts.

use crate::budget::losses::values;
use crate::budget::{Known, Losses};
use crate::coefficient::{Coefficient, Estimate};
use crate::effects::level_shift::Change;
use crate::effects::zero_drift::Drift;
use crate::num::math;
use crate::pipeline::Pipeline;
use crate::report::Report;
use crate::stats::quantity::Quantity;

impl Pipeline {
    /// The result so far.
    #[must_use]
    pub fn report(&self) -> Report {
        let (loading_rate, omega) = self.cycles.shared();
        let known = Known {
            weight_ratio: (self.cycles.weight_ratio().0, self.weight_std.value()),
            drift_n: self.cycles.normal_n() * self.drift.read(Drift::mean_std),
            ..self.known()
        };
        let (mu_s, mu) = self.estimates(&known);
        Report {
            counters: self.counters,
            events: self.cycles.events(),
            mu_s,
            mu,
            noise_n: self.noise_n().map(|noise_n| noise_n * self.block_root),
            loading_rate_n_per_s: loading_rate,
            omega_rad_per_s: omega,
            stiffness_n_per_m: self.stiffness(loading_rate, omega),
            recurrence_s: self.recurrence_s(),
            zero_n: self.zero_n(),
            zero_std_n: known.zero_n,
            zero_drift_n: known.drift_n,
            damping_std: known.losses.damping_std,
            weight_ratio: known.weight_ratio.0,
            weight_ratio_std: known.weight_ratio.1,
            change: self.change.map(|change| {
                let (weight_ratio, relative) = self.cycles.weight_ratio();
                Change { weight_ratio, weight_ratio_std: relative * weight_ratio, ..change }
            }),
            found: self.found(),
        }
    }

    /// The means, with their systematic parts.
    fn estimates(&self, known: &Known<'_>) -> (Option<Estimate>, Option<Estimate>) {
        let (mut mu_s, mut mu) = (self.mu_s.estimate(), self.mu.estimate());
        let means = [mu_s.or(mu), mu.or(mu_s)].map(|it| it.map_or(0.0, |it| it.mean));
        for (estimate, variance) in [&mut mu_s, &mut mu].into_iter().zip(known.variances(means)) {
            if let Some(it) = estimate {
                // Friction that scatters decides in part which events have a coefficient: on average
                // the others may differ from these by as much as these do from each other.
                let others = 1.0 - it.events as f32 / self.cycles.events() as f32;
                let choice_std = others * it.spread.unwrap_or_default();
                it.common_std = math::hypotenuse(it.common_std, choice_std);
                it.systematic_std = math::hypotenuse(it.common_std, math::sqrt(variance));
            }
        }
        (mu_s, mu)
    }

    /// Sets the systematic standard deviations of an event's coefficients.
    pub(super) fn add_systematic(
        &self,
        mu_s: Option<&mut Coefficient>,
        mu: Option<&mut Coefficient>,
    ) {
        let variances = self.known().variances(values(mu_s.as_deref(), mu.as_deref()));
        for (coefficient, variance) in [mu_s, mu].into_iter().zip(variances) {
            if let Some(it) = coefficient {
                it.systematic_std = math::sqrt(variance);
            }
        }
    }

    /// The inputs of the budget as known at this time.
    fn known(&self) -> Known<'_> {
        let normal_n = self.cycles.normal_n();
        Known {
            config: &self.config,
            slope: self.cycles.slope(),
            weight_ratio: self.cycles.weight_ratio(),
            zero_n: self.config.std.zero_n(self.largest_n),
            drift_n: normal_n * self.drift.read(Drift::std),
            losses: self.losses_at(normal_n),
        }
    }

    /// Effect of the cable's losses on an event, as known at this time. An event's systematic part
    /// contains the losses that were known when it was given.
    #[must_use]
    pub fn losses(&self) -> Losses {
        self.losses_at(self.cycles.normal_n())
    }

    fn losses_at(&self, normal_n: f32) -> Losses {
        let damping_std = self.cycles.damping_std(self.config.std.damping);
        Losses::new(damping_std, self.cycles.overshoot_n(), normal_n)
    }

    /// The stiffness `k`, N/m: from `F' = k w` where the winch speed is known, else from `ω² = k /
    /// M`.
    fn stiffness(&self, rate: Option<Quantity>, omega: Option<Quantity>) -> Option<f32> {
        let mass_kg = self.cycles.weight_ratio().0 * self.config.mass_kg();
        match self.config.winch_m_per_s {
            Some(winch) => rate.map(|rate| rate.value / winch),
            None => omega.map(|omega| omega.value * omega.value * mass_kg),
        }
    }

    /// Standard deviation of a block's noise, N: by the fits so far, else the detector's.
    pub(super) fn noise_n(&self) -> Option<f32> {
        self.cycles.noise_n().or(self.detector.noise_n())
    }

    fn recurrence_s(&self) -> Option<f32> {
        let period_s = self.decimator.factor() / self.config.rate_hz;
        (self.intervals > 0).then_some(self.recurrence * period_s)
    }
}
