//! Effect of the cable's losses on the coefficients of an event.
//!
//! A cable has the same losses in every event. When the first events are given only the stated
//! losses are known; what the whole test shows holds for the first events as well. So a replay
//! takes the losses that an event was given with out of its standard deviations
//! ([`Losses::taken_off`]), and puts in those of the whole test ([`Losses::put_on`]).

use crate::coefficient::Coefficient;
use crate::config::Config;
use crate::num::math;
use crate::report::Report;

/// `mu_s` and `mu` of an event, where they are known.
type Pair = [Option<Coefficient>; 2];

/// The losses as known at some time of a test; the default is none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Losses {
    /// Standard deviation of the damping ratio.
    pub(crate) damping_std: f32,
    /// Derivative of `mu_s` by the damping ratio.
    pub(crate) by_onset: f32,
}

impl Losses {
    /// The losses that a report has.
    #[must_use]
    pub fn of(config: &Config, report: &Report) -> Self {
        let Report { loading_rate_n_per_s, omega_rad_per_s, .. } = *report;
        let overshoot_n = loading_rate_n_per_s.zip(omega_rad_per_s);
        let overshoot_n = overshoot_n.map_or(0.0, |(rate, omega)| rate.value / omega.value);
        let normal_n = report.weight_ratio * config.weight_n * math::sin_cos(config.slope_rad).1;
        Self::new(report.damping_std, overshoot_n, normal_n)
    }

    /// From the loading rate over omega, N, and the force, N, of a coefficient of one.
    pub(crate) fn new(damping_std: f32, overshoot_n: f32, normal_n: f32) -> Self {
        Self { damping_std, by_onset: -2.5 * overshoot_n / normal_n }
    }

    /// Derivatives of `mu_s` and `mu` by the damping ratio.
    pub(crate) fn sensitivities(&self, [mu_s, mu]: [f32; 2]) -> [f32; 2] {
        [self.by_onset, -core::f32::consts::FRAC_PI_2 * (mu_s - mu)]
    }

    /// `mu_s` and `mu` of an event, with these losses taken out of their standard deviations.
    #[must_use]
    pub fn taken_off(&self, event: Pair) -> Pair {
        self.changed(event, -1.0)
    }

    /// `mu_s` and `mu` of an event, with these losses put into their standard deviations.
    #[must_use]
    pub fn put_on(&self, event: Pair) -> Pair {
        self.changed(event, 1.0)
    }

    fn changed(&self, [mu_s, mu]: Pair, sign: f32) -> Pair {
        let [by_mu_s, by_mu] = self.sensitivities(values(mu_s.as_ref(), mu.as_ref()));
        let with = |it: Coefficient, by: f32| {
            let losses = by * self.damping_std;
            let variance = it.systematic_std * it.systematic_std + sign * losses * losses;
            Coefficient { systematic_std: math::sqrt(math::larger(variance, 0.0)), ..it }
        };
        [mu_s.map(|it| with(it, by_mu_s)), mu.map(|it| with(it, by_mu))]
    }
}

/// Values of both coefficients; where one is not known, the other's stands for it.
pub(crate) fn values(mu_s: Option<&Coefficient>, mu: Option<&Coefficient>) -> [f32; 2] {
    let (a, b) = (mu_s.map(|it| it.value), mu.map(|it| it.value));
    [a.or(b), b.or(a)].map(Option::unwrap_or_default)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_an_event_is_told_with_makes_room_for_what_the_test_tells() {
        let event = |systematic_std: [f32; 2]| {
            [(1.24, systematic_std[0]), (0.78, systematic_std[1])].map(|(value, systematic_std)| {
                Some(Coefficient { value, std: 1e-3, systematic_std })
            })
        };
        let [then, later] = [0.005, 0.03].map(|std| Losses::new(std, 19.1, 630.0));
        let own = |of: Losses| of.sensitivities([1.24, 0.78]).map(|by| (by * of.damping_std).abs());
        assert!((own(then)[0] - 0.005 * 2.5 * 19.1 / 630.0).abs() < 1e-7);
        assert!((own(then)[1] - 0.005 * 0.7226).abs() < 1e-6);
        let given = event(own(then).map(|losses| math::hypotenuse(losses, 2e-3)));
        let known = later.put_on(then.taken_off(given));
        let expected = own(later).map(|losses| math::hypotenuse(losses, 2e-3));
        for (known, expected) in known.into_iter().zip(expected) {
            assert!((known.unwrap().systematic_std - expected).abs() < 1e-6);
        }
        // More than there is cannot be taken off, and one coefficient has no drop.
        assert_eq!(later.taken_off(event([0.0; 2])), event([0.0; 2]));
        let [_, mu] = event([2e-3; 2]);
        assert_eq!(later.put_on([None, mu]), [None, mu]);
    }
}
