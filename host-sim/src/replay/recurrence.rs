//! Time from slip to slip: as observed at the onsets, and by equations (22) to (25).

use std::collections::VecDeque;

use floe_core::estimator::{Common, Estimator};
use floe_core::{Coefficient, Config, Estimate, Input, Report};

use super::quantities::Relative;
use super::result::{EventSummary, known};
use super::slide::contributions;

/// Relative standard deviation of one interval's own time, apart from the scatter.
const KNOWN: f64 = 1e-4;
/// Gaps kept separately; further ones, before the next event, are merged into the last.
const APART: usize = 64;

/// Mean time from onset to onset, and mean drop of the coefficient.
#[derive(Clone, Debug, Default)]
pub(super) struct Recurrence {
    onset_s: Option<f64>,
    good_s: Option<f64>,
    /// Gaps: begin, end, and the longest slip that may be hidden in each, s.
    unread: VecDeque<(f64, f64, f64)>,
    intervals: Estimator,
    drops: Estimator,
}

impl Recurrence {
    /// Takes the time of a sample whose force can be used; a gap before it is noted.
    pub(super) fn sample(&mut self, time_s: f64, period_s: f64) {
        let before_s = self.good_s.replace(time_s).unwrap_or(time_s);
        if time_s - before_s > 1.5 * period_s {
            self.hide(before_s, time_s, time_s - before_s);
        }
    }

    /// Notes a stretch of the log that belongs to no event.
    pub(super) fn stretch(&mut self, start_s: f64, stop_s: f64) {
        self.hide(start_s, stop_s, f64::INFINITY);
    }

    fn hide(&mut self, start_s: f64, stop_s: f64, slip_s: f64) {
        let room = self.unread.len() < APART;
        match self.unread.back_mut().filter(|_| !room) {
            Some(last) => *last = (last.0.min(start_s), stop_s, f64::INFINITY),
            None => self.unread.push_back((start_s, stop_s, slip_s)),
        }
    }

    /// Takes the next event. Its interval to the event before does not count where a slip may be
    /// hidden between them.
    pub(super) fn event(&mut self, event: &EventSummary) {
        let EventSummary { onset_s, slip_s, .. } = *event;
        if let Some(before_s) = self.onset_s.replace(onset_s) {
            let hides = |&(start_s, stop_s, longest_s): &(f64, f64, f64)| {
                start_s < onset_s && stop_s > before_s && longest_s > slip_s
            };
            if !self.unread.iter().any(hides) {
                let interval_s = onset_s - before_s;
                add(&mut self.intervals, interval_s, (KNOWN * interval_s, 0.0));
            }
        }
        self.unread.retain(|&(_, stop_s, _)| stop_s > onset_s);
        if let (Some(mu_s), Some(mu), Some(std)) = (event.mu_s, event.mu, event.mu_std) {
            // The uncertainty of the drop is that of `mu`: see `Slide::with_std`.
            add(&mut self.drops, mu_s - mu, (std, 0.0));
        }
    }

    /// Mean of the intervals.
    pub(super) fn seen_s(&self) -> Option<Estimate> {
        self.intervals.estimate()
    }

    /// Rest (22) plus slide (25) of the mean event, and the standard deviation of the sum, to first
    /// order in drop, rate and omega. Weight, slope, zero and span cancel.
    pub(super) fn predicted_s(
        &self,
        (config, report): (&Config, &Report),
        rate: Option<Relative>,
        omega: Option<Relative>,
    ) -> Option<(f64, Option<f64>)> {
        let (mu_s, mu) = (known(report.mu_s.map(|e| e.mean))?, known(report.mu.map(|e| e.mean))?);
        let ((rate, rate_std), (omega, omega_std)) = (rate?, omega?);
        let (sin, cos) = f64::from(config.slope_rad).sin_cos();
        let weight_n = f64::from(report.weight_ratio) * f64::from(config.weight_n);
        let drop_n = (mu_s - mu) * weight_n * cos;
        let restick_n = weight_n * (sin + (2.0 * mu - mu_s) * cos);
        let lowest_n = weight_n * (sin + mu * cos) - drop_n.hypot(rate / omega);
        if drop_n.min(restick_n).min(lowest_n) <= 0.0 {
            return None;
        }
        let drop_std = self.drop_std(config, report).map(|std| std * weight_n * cos);
        let at = [drop_n, rate, omega];
        let std = drop_std.map(|it| first_order(at, [it, rate * rate_std, omega * omega_std]));
        Some((period_s(at), std))
    }

    /// Standard deviation of the mean of `mu_s − mu`.
    fn drop_std(&self, config: &Config, report: &Report) -> Option<f64> {
        let random = known(self.drops.estimate()?.std_error)?;
        let of = |input| contributions(config, report, input);
        let ([losses_s, losses], [shared_s, shared]) = (of(Input::Damping)?, of(Input::Shared)?);
        // Losses reduce both coefficients.
        Some(random.hypot(losses_s - losses).hypot(shared_s.hypot(shared)))
    }
}

/// Adds a value to a mean; its standard deviation has an own part and one common to all values.
pub(super) fn add(mean: &mut Estimator, value: f64, (own, common): (f64, f64)) {
    let [value, std, granted] = [value, own, common].map(|it| it as f32);
    mean.add_with_common(
        Coefficient::random(value, std),
        Common { shared: 0.0, granted, moved: false },
    );
}

fn period_s([drop_n, rate, omega]: [f64; 3]) -> f64 {
    let slide_s = (std::f64::consts::PI + 2.0 * (rate / omega / drop_n).atan()) / omega;
    2.0 * drop_n / rate + slide_s
}

/// Standard deviation of the period, propagated to first order.
fn first_order(at: [f64; 3], std: [f64; 3]) -> f64 {
    let moved = |place: usize, part: f64| {
        let mut at = at;
        at[place] += part * std[place];
        period_s(at)
    };
    // A small part of each, since a standard deviation may be as large as its value.
    let by = |place| (moved(place, 1e-3) - moved(place, -1e-3)) / 2e-3;
    by(0).hypot(by(1)).hypot(by(2))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::replay::table::tests::event;
    use crate::sim::random::{Stream, stream};
    use rand_distr::{Distribution, StandardNormal};

    /// A source of normally distributed numbers.
    pub(in crate::replay) fn normal(seed: u64) -> impl FnMut() -> f64 {
        let mut random = stream(seed, Stream::White);
        move || StandardNormal.sample(&mut random)
    }

    /// Sample standard deviation.
    pub(in crate::replay) fn scatter(of: impl Iterator<Item = f64> + Clone) -> f64 {
        let n = of.clone().count() as f64;
        let mean = of.clone().sum::<f64>() / n;
        (of.map(|it| (it - mean).powi(2)).sum::<f64>() / n).sqrt()
    }

    fn at(onset_s: f64) -> EventSummary {
        EventSummary { onset_s, stop_s: onset_s + 0.173, ..event() }
    }

    fn mean_s(recurrence: &Recurrence) -> (f32, Option<f32>, u32) {
        let it = recurrence.seen_s().unwrap();
        (it.mean, it.std_error, it.events)
    }

    #[test]
    fn long_gaps_and_stretches_without_an_event_are_no_recurrences() {
        let mut recurrence = Recurrence::default();
        // One sample is lost, then 10 s, then the force is constant.
        let there = |&i: &u32| i != 3 && !(41..200).contains(&i);
        (0..=200).filter(there).for_each(|i| recurrence.sample(f64::from(i) / 16.0, 1.0 / 16.0));
        recurrence.stretch(16.5, 30.0);
        for onset_s in [0.1, 2.0, 13.0, 15.0, 30.5, 32.3] {
            recurrence.event(&at(onset_s));
        }
        let (mean, std, count) = mean_s(&recurrence);
        assert!((mean - 1.9).abs() < 1e-5 && count == 3 && std.is_some(), "{mean} {count}");
        assert!(recurrence.unread.is_empty());
    }

    #[test]
    fn many_gaps_take_no_memory() {
        let mut recurrence = Recurrence::default();
        recurrence.event(&at(0.1));
        (0..10_000).for_each(|i| recurrence.sample(f64::from(i), 0.0625));
        assert_eq!(recurrence.unread.len(), APART);
        recurrence.event(&at(9_998.0));
        assert!(recurrence.seen_s().is_none());
    }

    #[test]
    fn the_deviation_is_that_of_the_scatter() {
        let mut recurrence = Recurrence::default();
        let (mut normal, mut onset_s) = (normal(2), 0.0);
        for _ in 0..401 {
            recurrence.event(&at(onset_s));
            onset_s += 1.8 + 0.1 * normal();
        }
        let (_, std, count) = mean_s(&recurrence);
        assert_eq!(count, 400);
        assert!((f64::from(std.unwrap()) / (0.1 / 20.0) - 1.0).abs() < 0.1, "{std:?}");
    }

    #[test]
    fn the_prediction_scatters_as_it_says() {
        let (truth, std) = ([290.0, 361.0, 18.9], [3.0, 4.0, 0.2]);
        let mut normal = normal(3);
        let mut draw = || period_s([0, 1, 2].map(|i| truth[i] + std[i] * normal()));
        let draws: Vec<f64> = (0..20_000).map(|_| draw()).collect();
        let scatter = scatter(draws.iter().copied());
        let said = first_order(truth, std);
        assert!((scatter / said - 1.0).abs() < 0.03, "{scatter} {said}");
    }
}
