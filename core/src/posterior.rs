//! What an event's samples tell of its unknowns: means and variances.
//!
//! Where the slip holds enough samples the best fit and its information matrix say
//! it all. A slip of hardly a sample is different: its onset may lie anywhere
//! between two samples, every place with its own best fit and almost the same sum
//! of squares, with a kink where the slip's end passes a sample. There the onset is
//! held at a row of places, and the fits are averaged with their likelihoods
//! `exp(−cost / 2 σ²)`: what the samples cannot tell widens the interval.

use crate::fit::{Data, Fit, Prior};
use crate::math;
use crate::model::{Cycle, Gradient, UNKNOWNS};

/// Slips shorter than this are averaged over the onset, periods.
const RESOLVED: f32 = 1.5;
/// Places of the onset: so many on either side of the best fit, so far apart, periods.
const PLACES: i16 = 8;
const STEP: f32 = 0.125;
/// Information that holds the onset in its place, in units of one over the noise
/// variance times the squared loading rate: to a thousandth of a period.
const HELD: f32 = 1e6;

/// Means and variances of one event's unknowns; forces in N, times in periods.
#[derive(Clone, Copy, Debug)]
pub struct Posterior {
    /// The cycle of the means.
    pub cycle: Cycle,
    /// Variance of `Fs`, N².
    pub static_n2: f32,
    /// Variance of `Fp`, N².
    pub dynamic_n2: f32,
    /// Variances of the onset, rate, ., ., swing and bend.
    pub unknowns: Gradient,
}

impl Posterior {
    /// From the best fit, with the variance of the noise.
    #[must_use]
    pub fn new(data: &Data<'_>, fit: &Fit, noise_n2: f32) -> Self {
        if fit.cycle.slide_time() < RESOLVED {
            over_onset(data, fit, noise_n2)
        } else {
            Self::at(fit, noise_n2)
        }
    }

    /// Is the slip long enough for the samples?
    #[must_use]
    pub fn is_resolved(&self) -> bool {
        self.cycle.slide_time() >= RESOLVED
    }

    fn at(fit: &Fit, noise_n2: f32) -> Self {
        let forces = fit.forces();
        let mut unknowns = Gradient::default();
        for (unknown, entry) in unknowns.iter_mut().enumerate() {
            *entry = noise_n2 * fit.variance(unknown);
        }
        let static_n2 = noise_n2 * forces.static_variance;
        let dynamic_n2 = noise_n2 * forces.dynamic_variance;
        Self { cycle: fit.cycle, static_n2, dynamic_n2, unknowns }
    }
}

/// Averages over places of the onset, weighted by likelihood.
fn over_onset(data: &Data<'_>, best: &Fit, noise_n2: f32) -> Posterior {
    let mut sums = Sums::default();
    for way in [-1.0, 1.0] {
        let mut from = best.cycle;
        let first = if way > 0.0 { 0 } else { 1 };
        for place in first..=PLACES {
            let onset = best.cycle.onset + way * STEP * f32::from(place);
            let weight = HELD * (1.0 + from.rate * from.rate);
            let held = Data { onset: Prior { mean: onset, weight }, ..*data };
            let Some(fit) = held.fit(&Cycle { onset, ..from }, noise_n2) else { break };
            let expected =
                data.onset.weight * (onset - data.onset.mean) * (onset - data.onset.mean);
            let cost = fit.cost + expected - best.cost;
            sums.add(math::exp(-0.5 * cost / noise_n2), &Posterior::at(&fit, noise_n2), best);
            from = fit.cycle;
        }
    }
    sums.posterior(best, noise_n2)
}

/// Weighted sums of values relative to the best fit, of their squares and of their
/// variances: `Fs`, `Fp` and the unknowns.
#[derive(Default)]
struct Sums {
    weight: f32,
    moments: [[f32; 2]; 2 + UNKNOWNS],
}

impl Sums {
    fn add(&mut self, weight: f32, one: &Posterior, best: &Fit) {
        // Likelihoods above one: the best fit was not quite the best.
        let weight = if weight.is_finite() { weight.min(1e3) } else { 0.0 };
        self.weight += weight;
        let variances = [one.static_n2, one.dynamic_n2].into_iter().chain(one.unknowns);
        let differences =
            values(&one.cycle).into_iter().zip(values(&best.cycle)).map(|(a, b)| a - b);
        for (moment, (difference, variance)) in
            self.moments.iter_mut().zip(differences.zip(variances))
        {
            moment[0] += weight * difference;
            moment[1] += weight * (difference * difference + variance);
        }
    }

    fn posterior(&self, best: &Fit, noise_n2: f32) -> Posterior {
        if self.weight <= 0.0 {
            return Posterior::at(best, noise_n2);
        }
        let mean = |i: usize| self.moments[i][0] / self.weight;
        let variance = |i: usize| (self.moments[i][1] / self.weight - mean(i) * mean(i)).max(0.0);
        let from = &best.cycle;
        let (static_n, dynamic_n) = (from.static_n + mean(0), from.dynamic_n() + mean(1));
        let cycle = Cycle {
            onset: from.onset + mean(2),
            rate: from.rate + mean(3),
            static_n,
            half_drop_n: static_n - dynamic_n,
            omega: 1.0 / (from.swing() + mean(6)),
            bend: from.bend + mean(7),
        };
        let mut unknowns = Gradient::default();
        for (unknown, entry) in unknowns.iter_mut().enumerate() {
            *entry = variance(unknown + 2);
        }
        Posterior { cycle, static_n2: variance(0), dynamic_n2: variance(1), unknowns }
    }
}

/// `Fs`, `Fp` and the unknowns of a cycle.
fn values(c: &Cycle) -> [f32; 2 + UNKNOWNS] {
    [c.static_n, c.dynamic_n(), c.onset, c.rate, c.static_n, c.half_drop_n, c.swing(), c.bend]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::Point;
    use crate::line::Line;

    /// A stiff cable's event sampled at whole periods, without noise.
    fn points(cycle: &Cycle) -> [Point; 12] {
        let shape = cycle.shape();
        core::array::from_fn(|i| {
            let time = i as f32 - 6.0;
            Point { time, force_n: shape.force(time).0, weight: 1.0 }
        })
    }

    fn posterior(slide: f32, onset: f32) -> (Cycle, Posterior) {
        let omega = 3.3 / slide;
        let truth =
            Cycle { onset, rate: 20.0, static_n: 780.0, half_drop_n: 290.0, omega, bend: 0.0 };
        let points = points(&truth);
        let line = Line::default();
        let data = Data {
            before: &line,
            points: &points,
            after: &line,
            rate: Prior { mean: 20.0, weight: 0.1 },
            swing: Prior { mean: 0.8 / omega, weight: 4.0 * omega * omega / 0.25 },
            bend: Prior { mean: 0.0, weight: 1e6 },
            onset: Prior { mean: 0.5 - 0.5 * slide, weight: 44.0 },
        };
        let fit = data.fit(&Cycle { onset: onset + 0.1, ..truth }, 4.0).unwrap();
        (truth, Posterior::new(&data, &fit, 4.0))
    }

    #[test]
    fn a_slip_between_two_samples_leaves_the_onset_open() {
        let (truth, got) = posterior(0.5, 0.25);
        let onset_std = math::sqrt(got.unknowns[0]);
        assert!(onset_std > 0.05 && onset_std < 0.5, "{onset_std}");
        let std = math::sqrt(got.static_n2);
        assert!(std > 20.0 * 0.05, "{std}");
        assert!((got.cycle.static_n - truth.static_n).abs() < 2.0 * std);
        assert!(!got.is_resolved());
    }

    #[test]
    fn a_slip_of_three_samples_is_told_by_its_fit() {
        let (truth, got) = posterior(3.0, 0.25);
        assert!(got.is_resolved() && got.unknowns[0] < 1e-3);
        assert!((got.cycle.static_n - truth.static_n).abs() < 1.0);
    }
}
