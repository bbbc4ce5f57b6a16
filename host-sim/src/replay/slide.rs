//! How far the block slides in an event, and the work against the friction on the way.

use floe_core::estimator::Estimator;
use floe_core::{Coefficient, Config, Estimate, Input, Report, budget};

use super::events::Events;
use super::quantities::Relative;
use super::recurrence::add;
use super::result::EventSummary;

/// One event in so many may be left out of the mean length: where the longest tenth of lengths that
/// scatter by a tenth is left out the mean is low by 2 %, where this part is, by 1 %.
const LEFT_OUT: u64 = 20;

/// What a slip length and its energy are computed from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Slide {
    pub(super) stiffness_n_per_m: f64,
    /// Where it is not known, every event has that of its own rate.
    pub(super) winch_m_per_s: Option<f64>,
    /// Tangent of the slope: the weight along it over the normal force.
    pub(super) grade: f64,
    /// `None` while the test runs.
    pub(super) unsure: Option<Unsure>,
}

/// What is the same in all events of a test, one standard deviation each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Unsure {
    /// Of the stiffness, relative and without weight and span.
    stiffness: f64,
    /// Of the weight, relative: in the length, and in the weight along the slope.
    weight: [f64; 2],
    /// Of the span: in the length, and in `Fp`.
    span: [f64; 2],
    /// Of the friction as a part of the normal force: slope, zero, its drift, damping.
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
        let force = force.hypot(config.std.slope_rad.into());
        let [winch, span, weight] = [config.std.winch, config.std.span, config.std.weight];
        let [winch, span, weight] = [winch, span, weight].map(f64::from);
        let weight = weight.hypot(report.weight_ratio_std.into());
        // A stiffness from the rate has the span of the forces, which cancels in the length, and
        // one from omega has the weight.
        let (stiffness, is_of_rate) = match (config.winch_m_per_s, rate, omega) {
            (Some(_), Some((_, rate)), _) => (rate.hypot(winch), true),
            (_, _, Some((_, omega))) => (2.0 * omega, false),
            _ => return None,
        };
        let both = |own: f64| [if is_of_rate { 0.0 } else { own }, own];
        Some(Self { stiffness, weight: both(weight), span: both(span), force })
    }
}

/// What an input of the budget does to `mu_s` and `mu`, one standard deviation.
pub(super) fn contributions(config: &Config, report: &Report, input: Input) -> Option<[f64; 2]> {
    let entry = budget(config, report)?.into_iter().find(|entry| entry.input == input)?;
    Some(entry.shares.map(|share| share.contribution.into()))
}

impl Slide {
    /// `(Fs − Fe)/k + w T`, m, and the friction `Fp − W sin a` times that, J; `None` where the cable
    /// went slack or the event is refused.
    pub(super) fn of(&self, event: &EventSummary) -> Option<[f64; 2]> {
        if event.slack || event.reason.is_some() {
            return None;
        }
        let stiffness = self.stiffness_n_per_m;
        let winch = self.winch_m_per_s.unwrap_or(event.loading_rate_n_per_s / stiffness);
        let drop_n = event.static_force_n - event.restick_force_n;
        let length_m = drop_n / stiffness + winch * event.slip_s;
        let friction_n = event.dynamic_force_n - self.grade * normal_n(event)?;
        Some([length_m, friction_n * length_m]).filter(|it| it.iter().all(|it| it.is_finite()))
    }

    /// The same with what is unsure of each: the event's own part, and that of all events.
    ///
    /// `Fs` and `Fe` are from the lines on either side of the slip, and `Fp` is their mean: so `Fs −
    /// Fe` is as unsure as `2 Fp`, whatever the one has to do with the other. What is wrong with the
    /// onset and the stop takes as much from `w T` as it gives to `(Fs − Fe)/k`.
    pub(super) fn with_std(&self, event: &EventSummary) -> Option<[Coefficient; 2]> {
        let ([length_m, energy_j], unsure) = (self.of(event)?, self.unsure?);
        let normal_n = normal_n(event)?;
        let force_n = event.mu_std? * normal_n.abs();
        let length_std = 2.0 * force_n / self.stiffness_n_per_m;
        let energy_std = (length_m * force_n).hypot(energy_j / length_m * length_std);
        // In the length as a part of it, in the friction as a force.
        let each = [
            ([unsure.stiffness, 0.0], 0.0),
            (unsure.weight, self.grade * normal_n),
            (unsure.span, event.dynamic_force_n),
            ([0.0, unsure.force], normal_n),
        ];
        let in_length = each.map(|([length, _], _)| length_m * length);
        let in_energy =
            each.map(|([length, force], of_n)| energy_j * length + length_m * force * of_n);
        let whole = |of: [f64; 4]| of.into_iter().fold(0.0, f64::hypot);
        let coefficient = |value: f64, std: f64, systematic: f64| {
            let [value, std, systematic_std] = [value, std, systematic].map(|it| it as f32);
            Coefficient { value, std, systematic_std }
        };
        let both = [
            coefficient(length_m, length_std, whole(in_length)),
            coefficient(energy_j, energy_std, whole(in_energy)),
        ];
        both.iter().all(|it| it.combined_std().is_finite()).then_some(both)
    }

    /// Means over the events; `None` where none has a value, or where more than one in
    /// [`LEFT_OUT`] went slack: those are the longest.
    pub(super) fn means(&self, events: &Events) -> [Option<Estimate>; 2] {
        let (mut means, mut slack, mut all) = ([Estimator::default(); 2], 0, 0);
        let read = events.for_each_as_kept(|event| {
            if event.reason.is_none() {
                all += 1;
                slack += u64::from(event.slack);
            }
            for (mean, it) in means.iter_mut().zip(self.with_std(&event).into_iter().flatten()) {
                add(mean, it.value.into(), (it.std.into(), it.systematic_std.into()));
            }
            Ok(())
        });
        let represent = read.is_ok() && LEFT_OUT * slack <= all;
        means.map(|mean| mean.estimate().filter(|_| represent))
    }
}

/// `W cos a`, N, as the event's forces and coefficients have it.
fn normal_n(event: &EventSummary) -> Option<f64> {
    Some((event.static_force_n - event.dynamic_force_n) / (event.mu_s? - event.mu?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::replay::recurrence::tests::{normal, scatter};
    use crate::replay::table::tests::event;

    const SLIDE: Slide =
        Slide { stiffness_n_per_m: 23_000.0, winch_m_per_s: None, grade: 0.0, unsure: None };
    const NORMAL_N: f64 = 630.0;
    /// Standard deviations of the stiffness by itself, the weight, the span, the zero as a part of the
    /// normal force, and the slope.
    const STD: [f64; 5] = [0.01, 0.004, 0.002, 0.003, 0.0035];

    /// Length and energy of an event with what is wrong in it drawn at random; the stiffness is from
    /// the rate or from omega.
    fn drawn(
        normal: &mut impl FnMut() -> f64,
        (grade, is_of_rate): (f64, bool),
        truth: &EventSummary,
    ) -> [f64; 2] {
        let [stiffness, weight, span, zero, slope] = STD.map(|std| std * normal());
        let (weight, span) = (1.0 + weight, 1.0 + span);
        // `Fs` and `Fe` each as unsure as makes `Fp`, their mean, one by .001 of the normal force.
        let own_n = 0.001 * NORMAL_N * std::f64::consts::SQRT_2;
        let [static_n, restick_n] = [truth.static_force_n, truth.restick_force_n]
            .map(|force_n| span * (force_n + own_n * normal()));
        let dynamic_n = 0.5 * (static_n + restick_n) + NORMAL_N * zero;
        let stated_n = weight * NORMAL_N * (1.0 - grade * slope);
        let stiffness = 23_000.0 * (1.0 + stiffness) * if is_of_rate { span } else { weight };
        let grade = (grade.atan() + slope).tan();
        let slide = Slide { stiffness_n_per_m: stiffness, grade, ..SLIDE };
        let event = EventSummary {
            static_force_n: static_n,
            dynamic_force_n: dynamic_n,
            restick_force_n: restick_n,
            mu_s: Some((static_n - dynamic_n) / stated_n),
            mu: Some(0.0),
            loading_rate_n_per_s: span * truth.loading_rate_n_per_s,
            ..truth.clone()
        };
        slide.of(&event).unwrap()
    }

    /// Friction coefficients of 1.24 and .78 on a slope.
    fn event_on(grade: f64) -> EventSummary {
        let [static_force_n, dynamic_force_n, restick_force_n] =
            [1.24, 0.78, 0.32].map(|mu| NORMAL_N * (mu + grade));
        let (mu_s, mu_std) = (Some(1.24), Some(0.001));
        let forces = EventSummary { static_force_n, dynamic_force_n, restick_force_n, ..event() };
        EventSummary { mu_s, mu_std, reason: None, ..forces }
    }

    #[test]
    fn lengths_and_energies_scatter_as_they_say() {
        let [stiffness, weight, span, zero, slope] = STD;
        for (grade, is_of_rate) in [(0.0, false), (0.0, true), (0.3, false), (-0.3, true)] {
            let both = |own: f64| [if is_of_rate { 0.0 } else { own }, own];
            let (weight, span, force) = (both(weight), both(span), zero.hypot(slope));
            let unsure = Some(Unsure { stiffness, weight, span, force });
            let (truth, slide) = (event_on(grade), Slide { grade, unsure, ..SLIDE });
            let said = slide.with_std(&truth).unwrap().map(|it| f64::from(it.combined_std()));
            let mut normal = normal(1);
            let draws: Vec<[f64; 2]> =
                (0..20_000).map(|_| drawn(&mut normal, (grade, is_of_rate), &truth)).collect();
            for (place, said) in said.into_iter().enumerate() {
                let scatter = scatter(draws.iter().map(|it| it[place]));
                assert!((scatter / said - 1.0).abs() < 0.03, "{grade} {place}: {scatter} {said}");
            }
        }
    }

    #[test]
    fn the_weight_along_a_slope_is_no_friction() {
        for grade in [-0.1, 0.0, 0.2] {
            let [length_m, energy_j] = Slide { grade, ..SLIDE }.of(&event_on(grade)).unwrap();
            assert!((energy_j / length_m / NORMAL_N - 0.78).abs() < 1e-9, "{energy_j} {length_m}");
        }
    }

    #[test]
    fn what_is_not_known_has_no_deviation() {
        let event = EventSummary { mu_s: Some(1.24), reason: None, ..event() };
        assert!(SLIDE.of(&event).is_some() && SLIDE.with_std(&event).is_none());
        let unsure = Unsure { stiffness: 0.01, weight: [0.0; 2], span: [0.002; 2], force: 0.003 };
        let known = Slide { unsure: Some(unsure), ..SLIDE };
        let even = EventSummary { mu_s: event.mu, ..event.clone() };
        assert!(known.with_std(&event).is_some() && known.with_std(&even).is_none(), "no drop");
        assert!(SLIDE.of(&EventSummary { slack: true, ..event }).is_none());
    }
}
