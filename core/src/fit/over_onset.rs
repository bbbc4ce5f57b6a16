//! Average over the onset, for slips with hardly a sample.
//!
//! With enough samples in the slip the best fit and its information matrix are sufficient. With
//! hardly a sample the onset may lie anywhere between two samples. Each place of it has its own
//! best fit and almost the same sum of squares, with a kink where the slip's end passes a sample.
//! So the onset is held at a row of places, and the fits are averaged with their likelihoods
//! `exp(−cost / 2 σ²)` as weights. What the samples do not determine widens the interval.

use core::ops::ControlFlow;

use crate::fit::levenberg_marquardt::moved;
use crate::fit::posterior::{Posterior, RESOLVED};
use crate::fit::{Data, Fit, Fitting, Priors};
use crate::model::{CycleParams, Shape};
use crate::num::math::{self, smaller};
use crate::stats::normal_equations::{UNKNOWNS, scaled};
use crate::stats::prior::Prior;

/// Length, periods, up to which a slip is also averaged while the swing is not known from other
/// events, or if it ends right at a sample on a slack cable: a longer slip has three samples.
const CLEARLY_RESOLVED: f32 = 3.0;
/// Distance between places of the onset, periods.
const STEP: f32 = 0.125;
/// Number of places on either side of the best fit, up to a period from it.
const STEPS: i16 = 8;
/// Factor by which the places within the first step are closer where the slip is short: a sample
/// right at one of its ends leaves a tenth of a period open.
const FINE: i16 = 4;
/// Information that holds the onset at a place, in units of that of one sample on the steepest part
/// of the slip: it holds to a hundredth of what such a sample leaves open.
const HELD: f32 = 1e4;
/// Most steps of the fit at a place; one or two usually suffice. A fit that has not converged by
/// then has a kink and gets no better.
const MOST_STEPS: u8 = 8;
/// Part of the best fit's variances beyond the noise that is added to the average: a scatter of the
/// slip's samples shifts the onset, and the places include some of that. Tuned: with none the
/// intervals of slips that are no ellipse are too narrow, with all of it three halves of their
/// errors.
const SCATTER: f32 = 0.5;
/// Likelihood relative to the best fit's that adds nothing to sums in single precision.
const UNLIKELY: f32 = 1.2e-7;

/// Average over places of the onset, weighted by likelihood. A step is one iteration of the fit at
/// one place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OverOnset {
    sums: Sums,
    /// Number of places within the first step.
    fine: i16,
    /// The next place, and the cycle from which its fit begins.
    place: i16,
    from: CycleParams,
    fitting: Option<Fitting>,
}

impl OverOnset {
    /// Begins the average for a slip that its best fit does not resolve; else `None`.
    #[must_use]
    pub(crate) fn new(best: &Fit, knows_omega: bool, noise_n2: f32) -> Option<Self> {
        let fall = best.shape.fall_time();
        let clear = knows_omega && !is_at_edge(&best.shape, noise_n2);
        let least = if clear { RESOLVED } else { CLEARLY_RESOLVED };
        let fine = if fall < RESOLVED { FINE } else { 1 };
        let (sums, place, from) = (Sums::default(), 0, *best.cycle());
        (fall < least).then_some(Self { sums, fine, place, from, fitting: None })
    }

    /// One iteration. Breaks with the posterior after the last place.
    pub(crate) fn step(&mut self, data: &Data<'_>, best: &Fit) -> ControlFlow<Posterior> {
        let onset = best.cycle().onset + offset(self.place, self.fine).0;
        let steepest = self.from.rate + self.from.half_drop_n * self.from.omega;
        let held = Prior { mean: onset, weight: HELD * steepest * steepest };
        let held = Data { priors: &Priors { onset: held, ..*data.priors }, ..*data };
        let guess = CycleParams { onset, ..self.from };
        let fitting = self.fitting.get_or_insert_with(|| Fitting::brief(&guess, MOST_STEPS));
        let ControlFlow::Break(fit) = fitting.step(&held) else {
            return ControlFlow::Continue(());
        };
        self.fitting = None;
        self.take(data, best, fit)
    }

    /// Number of places that were fitted.
    pub(crate) fn seen(&self) -> i16 {
        if self.place < 0 { STEPS + self.fine - 1 - self.place } else { self.place }
    }

    /// Adds the fit of one place.
    fn take(&mut self, data: &Data<'_>, best: &Fit, fit: Option<Fit>) -> ControlFlow<Posterior> {
        let (prior, noise_n2) = (data.priors.onset, data.priors.noise_n2);
        let (by, width) = offset(self.place, self.fine);
        let onset = best.cycle().onset + by;
        // Beyond an unlikely place all places are unlikely.
        let mut ends = fit.is_none();
        if let Some(fit) = &fit {
            let expected = prior.weight * (onset - prior.mean) * (onset - prior.mean);
            let cost = fit.cost + expected - best.cost;
            let likelihood = math::exp(-0.5 * cost / noise_n2);
            ends = likelihood < UNLIKELY;
            self.sums.add(width * likelihood, &Posterior::at(fit, noise_n2), best);
        }
        let Some(next) = following(self.place, STEPS + self.fine - 1, ends) else {
            return ControlFlow::Break(self.sums.posterior(best, noise_n2));
        };
        // The other side begins again at the best fit.
        let turns = self.place > 0 && next < 0;
        let (fit, here) = match &fit {
            Some(fit) if !turns => (fit, by),
            _ => (best, 0.0),
        };
        self.from = along(fit, offset(next, self.fine).0 - here);
        self.place = next;
        ControlFlow::Continue(())
    }
}

/// Is the force of the last sample before the cable goes slack within the noise of zero? The cable
/// may then have gone slack earlier with the same likelihood: the fit determines only that the fall
/// does not end before this sample.
fn is_at_edge(shape: &Shape, noise_n2: f32) -> bool {
    // Standard deviations: of normal variables one in 16 000.
    const SURE: f32 = 4.0;
    if !shape.is_slack() {
        return false;
    }
    let (force_n, _) = shape.force(math::floor(shape.cycle().onset + shape.fall_time()));
    force_n * force_n < SURE * SURE * noise_n2
}

/// A fit after a shift of its onset, the other unknowns shifted by their correlation with it.
fn along(fit: &Fit, by: f32) -> CycleParams {
    let onset = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let tied = fit.factor.solve(&onset);
    moved(fit.cycle(), &scaled(&tied, by / tied[0]))
}

/// Distance of a place from the best fit, periods, and the width of the interval that it
/// represents, in steps.
fn offset(place: i16, fine: i16) -> (f32, f32) {
    let (number, closer) = (place.abs(), f32::from(fine));
    let (steps, width) = if number < fine {
        (f32::from(number) / closer, 1.0 / closer)
    } else {
        (f32::from(number - fine + 1), if number == fine { 0.5 + 0.5 / closer } else { 1.0 })
    };
    ((STEP * steps).copysign(f32::from(place)), width)
}

/// The place after this one: up to the last, or to one that ends this side, and then down.
fn following(place: i16, last: i16, ends: bool) -> Option<i16> {
    if place < 0 {
        (!ends && place > -last).then_some(place - 1)
    } else if place < last && !ends {
        Some(place + 1)
    } else {
        Some(-1)
    }
}

/// Weighted sums of values relative to the best fit, and of their squares and variances: the
/// unknowns and `Fp`.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    weight: f32,
    moments: [[f32; 2]; UNKNOWNS + 1],
}

impl Sums {
    fn add(&mut self, weight: f32, one: &Posterior, best: &Fit) {
        // Likelihoods above one occur: the best fit was not quite the best.
        let weight = if weight.is_finite() { smaller(weight, 1e3) } else { 0.0 };
        self.weight += weight;
        let (values, bests) = (values(&one.cycle), values(best.cycle()));
        for (i, moment) in self.moments.iter_mut().enumerate() {
            let difference = values[i] - bests[i];
            moment[0] += weight * difference;
            moment[1] += weight * (difference * difference + one.variances[i]);
        }
    }

    fn posterior(&self, best: &Fit, noise_n2: f32) -> Posterior {
        if self.weight <= 0.0 {
            return Posterior::at(best, noise_n2);
        }
        let mut spread = self.moments;
        for [mean, square] in &mut spread {
            *mean /= self.weight;
            *square = math::larger(*square / self.weight - *mean * *mean, 0.0);
        }
        let [onset, rate, by_static, _, inverse_omega, rate_change, by_dynamic] =
            spread.map(|[mean, _]| mean);
        let from = best.cycle();
        let static_n = from.static_n + by_static;
        let cycle = CycleParams {
            onset: from.onset + onset,
            rate: from.rate + rate,
            static_n,
            half_drop_n: static_n - (from.dynamic_n() + by_dynamic),
            omega: 1.0 / (from.inverse_omega() + inverse_omega),
            rate_change: from.rate_change + rate_change,
        };
        let (fall_time, common_n2) = (cycle.shape().fall_time(), (0.0, 0.0));
        let variances = spread.map(|[_, variance]| variance);
        let mut over = Posterior { cycle, fall_time, common_n2, variances };
        let wider = best.wider_n2(noise_n2);
        over.widen(SCATTER * wider.0, SCATTER * wider.1);
        // If the onset is known better than the spacing of the places, few of these carry all the
        // weight, and their fits lack the onset's own variance: the best fit's variances are the
        // least.
        if best.shape.fall_time() >= RESOLVED || over.variances[0] <= STEP * STEP / 4.0 {
            for (variance, least) in over.variances.iter_mut().zip(best.variances) {
                *variance = math::larger(*variance, noise_n2 * least);
            }
        }
        over
    }
}

/// The unknowns of a cycle and `Fp`.
fn values(c: &CycleParams) -> [f32; UNKNOWNS + 1] {
    [c.onset, c.rate, c.static_n, c.half_drop_n, c.inverse_omega(), c.rate_change, c.dynamic_n()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::Samples;
    use crate::model::corner::Corner;
    use crate::noise::ripple::ColoredNoise;
    use crate::stats::line::Line;

    /// A stiff cable's event sampled at whole periods, without noise.
    fn forces_n(cycle: &CycleParams) -> [f32; 12] {
        let shape = cycle.shape();
        core::array::from_fn(|i| shape.force(i as f32 - 6.0).0)
    }

    /// The true cycle, its posterior, and the numbers of passes and of places.
    fn posterior(slide: f32, onset: f32) -> (CycleParams, Posterior, [u32; 2]) {
        let omega = 3.3 / slide;
        let truth = CycleParams {
            onset,
            rate: 20.0,
            static_n: 780.0,
            half_drop_n: 290.0,
            omega,
            rate_change: 0.0,
        };
        let forces_n = forces_n(&truth);
        let line = Line::default();
        let data = Data {
            before: &line,
            samples: Samples::new(-6.0, &forces_n),
            after: &line,
            wander: ColoredNoise::NONE.into(),
            priors: &Priors {
                noise_n2: 4.0,
                rate: Prior { mean: 20.0, weight: 0.1 },
                inverse_omega: Prior { mean: 0.8 / omega, weight: 4.0 * omega * omega / 0.25 },
                rate_change: Prior { mean: 0.0, weight: 1e6 },
                onset: Prior { mean: 0.5 - 0.5 * slide, weight: 44.0 },
                corner: Corner::default(),
            },
        };
        let fit = data.fit(&CycleParams { onset: onset + 0.1, ..truth }).unwrap();
        let Some(mut places) = OverOnset::new(&fit, true, 4.0) else {
            return (truth, Posterior::at(&fit, 4.0), [0, 0]);
        };
        let [mut passes, mut seen] = [0, 1];
        loop {
            let step = places.step(&data, &fit);
            passes += 1;
            if let ControlFlow::Break(posterior) = step {
                return (truth, posterior, [passes, seen]);
            }
            if places.fitting.is_none() {
                seen += 1;
            }
        }
    }

    #[test]
    fn a_slip_between_two_samples_leaves_the_onset_open() {
        let (truth, got, [passes, places]) = posterior(0.5, 0.25);
        assert!(places == 16 && passes < 3 * places, "{passes} passes, {places} places");
        let onset_std = math::sqrt(got.variances[0]);
        assert!(onset_std > 0.05 && onset_std < 0.5, "{onset_std}");
        let std = math::sqrt(got.forces_n2().0);
        assert!(std > 20.0 * 0.05, "{std}");
        assert!((got.cycle.static_n - truth.static_n).abs() < 2.0 * std);
        assert!(!got.is_resolved());
    }

    #[test]
    fn a_slip_of_three_samples_is_told_by_its_fit() {
        let (truth, got, _) = posterior(3.0, 0.25);
        assert!(got.is_resolved() && got.variances[0] < 1e-3);
        assert!((got.cycle.static_n - truth.static_n).abs() < 1.0);
    }
}
