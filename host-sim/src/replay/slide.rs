//! How far the block slides in an event, and the work against the friction on the way.

use floe_core::estimator::Estimator;
use floe_core::{Coefficient, Config, Estimate, Input, Report, budget};

use super::events::Events;
use super::quantities::Relative;
use super::recurrence::add;
use super::result::EventSummary;

/// What a slip length and its energy are computed from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Slide {
    pub(super) stiffness_n_per_m: f64,
    /// Where it is not known, every event has that of its own rate.
    pub(super) winch_m_per_s: Option<f64>,
    /// `None` while the test runs.
    pub(super) unsure: Option<Unsure>,
}

/// What is the same in all events of a test, one standard deviation each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Unsure {
    /// Of the stiffness, relative and without the span.
    stiffness: f64,
    /// Of the span, in the length and in the energy.
    span: [f64; 2],
    /// Of `Fp` as a part of the normal force: zero, its drift, damping.
    force: f64,
}

impl Unsure {
    /// `rate` and `omega` as the test has them.
    pub(super) fn of(
        config: &Config,
        report: &Report,
        rate: Option<Relative>,
        omega: Option<Relative>,
    ) -> Option<Self> {
        let own = |input| contributions(config, report, input).map(|[_, mu]| mu);
        let force = own(Input::Zero)?.hypot(own(Input::ZeroDrift)?).hypot(own(Input::Damping)?);
        let [winch, span, weight] = [config.std.winch, config.std.span, config.std.weight];
        let [winch, span, weight] = [winch, span, weight].map(f64::from);
        // A stiffness from the rate has the span of the forces, which cancels in the length.
        Some(match (config.winch_m_per_s, rate, omega) {
            (Some(_), Some((_, rate)), _) => {
                Self { stiffness: rate.hypot(winch), span: [0.0, span], force }
            }
            (_, _, Some((_, omega))) => {
                let weight = weight.hypot(report.weight_ratio_std.into());
                Self { stiffness: (2.0 * omega).hypot(weight), span: [span, 2.0 * span], force }
            }
            _ => return None,
        })
    }
}

/// What an input of the budget does to `mu_s` and `mu`, one standard deviation.
pub(super) fn contributions(config: &Config, report: &Report, input: Input) -> Option<[f64; 2]> {
    let entry = budget(config, report)?.into_iter().find(|entry| entry.input == input)?;
    Some(entry.shares.map(|share| share.contribution.into()))
}

impl Slide {
    /// `(Fs − Fe)/k + w T`, m, and `Fp` times that, J; `None` where the cable went slack or the event
    /// is refused.
    pub(super) fn of(&self, event: &EventSummary) -> Option<[f64; 2]> {
        if event.slack || event.reason.is_some() {
            return None;
        }
        let stiffness = self.stiffness_n_per_m;
        let winch = self.winch_m_per_s.unwrap_or(event.loading_rate_n_per_s / stiffness);
        let drop_n = event.static_force_n - event.restick_force_n;
        let length_m = drop_n / stiffness + winch * event.slip_s;
        Some([length_m, event.dynamic_force_n * length_m]).filter(|it| it[0].is_finite())
    }

    /// The same with what is unsure of each: the event's own part, and that of all events.
    ///
    /// `Fs` and `Fe` are from the lines on either side of the slip, and `Fp` is their mean: so `Fs −
    /// Fe` is as unsure as `2 Fp`, whatever the one has to do with the other. What is wrong with the
    /// onset and the stop takes as much from `w T` as it gives to `(Fs − Fe)/k`.
    pub(super) fn with_std(&self, event: &EventSummary) -> Option<[Coefficient; 2]> {
        let ([length_m, energy_j], unsure) = (self.of(event)?, self.unsure?);
        let normal_n = (event.static_force_n - event.dynamic_force_n) / (event.mu_s? - event.mu?);
        let force_n = event.mu_std? * normal_n.abs();
        let length_std = 2.0 * force_n / self.stiffness_n_per_m;
        let energy_std = (length_m * force_n).hypot(event.dynamic_force_n * length_std);
        let [in_length, in_energy] = unsure.span.map(|span| unsure.stiffness.hypot(span));
        let by_force = length_m * unsure.force * normal_n;
        let coefficient = |value: f64, std: f64, systematic: f64| {
            let [value, std, systematic_std] = [value, std, systematic].map(|it| it as f32);
            Coefficient { value, std, systematic_std }
        };
        let both = [
            coefficient(length_m, length_std, length_m.abs() * in_length),
            coefficient(energy_j, energy_std, (energy_j * in_energy).hypot(by_force)),
        ];
        both.iter().all(|it| it.combined_std().is_finite()).then_some(both)
    }

    /// Means over the events; `None` where none has a value.
    pub(super) fn means(&self, events: &Events) -> [Option<Estimate>; 2] {
        let mut means = [Estimator::default(); 2];
        let read = events.for_each_as_kept(|event| {
            for (mean, it) in means.iter_mut().zip(self.with_std(&event).into_iter().flatten()) {
                add(mean, it.value.into(), (it.std.into(), it.systematic_std.into()));
            }
            Ok(())
        });
        means.map(|mean| mean.estimate().filter(|_| read.is_ok()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::replay::recurrence::tests::{normal, scatter};
    use crate::replay::table::tests::event;

    const SLIDE: Slide =
        Slide { stiffness_n_per_m: 23_000.0, winch_m_per_s: None, unsure: Some(UNSURE) };
    const UNSURE: Unsure = Unsure { stiffness: 0.01, span: [0.002, 0.004], force: 0.003 };

    /// Length and energy of an event with what is wrong in it drawn at random.
    fn drawn(normal: &mut impl FnMut() -> f64, truth: &EventSummary) -> [f64; 2] {
        let normal_n = 630.0;
        let span = 1.0 + 0.002 * normal();
        // `Fs` and `Fe` each as unsure as makes `Fp`, their mean, one by .001 of the normal force.
        let own_n = 0.001 * normal_n * std::f64::consts::SQRT_2;
        let [static_n, restick_n] = [truth.static_force_n, truth.restick_force_n]
            .map(|force_n| span * (force_n + own_n * normal()));
        let zero_n = 0.003 * normal_n * normal();
        let slide = Slide { stiffness_n_per_m: 23_000.0 * (1.0 + 0.01 * normal()), ..SLIDE };
        let event = EventSummary {
            static_force_n: static_n,
            dynamic_force_n: 0.5 * (static_n + restick_n) + zero_n,
            restick_force_n: restick_n,
            loading_rate_n_per_s: span * truth.loading_rate_n_per_s,
            ..truth.clone()
        };
        slide.of(&event).unwrap()
    }

    #[test]
    fn lengths_and_energies_scatter_as_they_say() {
        let truth = EventSummary {
            mu_s: Some(1.24),
            mu_std: Some(0.001),
            reason: None,
            static_force_n: 781.2,
            ..event()
        };
        let said = SLIDE.with_std(&truth).unwrap().map(|it| f64::from(it.combined_std()));
        let mut normal = normal(1);
        let draws: Vec<[f64; 2]> = (0..20_000).map(|_| drawn(&mut normal, &truth)).collect();
        for (place, said) in said.into_iter().enumerate() {
            let scatter = scatter(draws.iter().map(|it| it[place]));
            assert!((scatter / said - 1.0).abs() < 0.03, "{place}: {scatter} {said}");
        }
    }

    #[test]
    fn what_is_not_known_has_no_deviation() {
        let event = EventSummary { mu_s: Some(1.24), reason: None, ..event() };
        let running = Slide { unsure: None, ..SLIDE };
        assert!(running.of(&event).is_some() && running.with_std(&event).is_none());
        let even = EventSummary { mu_s: event.mu, ..event.clone() };
        assert!(SLIDE.with_std(&even).is_none(), "no drop");
        assert!(SLIDE.of(&EventSummary { slack: true, ..event }).is_none());
    }
}
