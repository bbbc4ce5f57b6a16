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
use crate::num::math::{self, larger, smaller};
use crate::stats::normal_equations::{UNKNOWNS, scaled};
use crate::stats::prior::Prior;
use crate::stats::significance::SURE;

/// Length, periods, up to which a slip is also averaged while the swing is not known from other
/// events, or if it ends right at a sample on a slack cable: a longer slip has three samples.
const CLEARLY_RESOLVED: f32 = 3.0;
/// Most places on either side of the best fit, up to a period from it: as many as there are periods
/// until the next slip, whose fit needs the time. Tuned: with six or twelve, intervals of short
/// slips become too narrow.
const MOST: f32 = 8.0;
/// Factor by which the places within the first step are closer where the slip is short: a sample
/// right at one of its ends leaves a tenth of a period open.
const FINE: i16 = 3;
/// Information that holds the onset at a place, in units of that of one sample on the steepest part
/// of the slip: it holds to a hundredth of what such a sample leaves open.
const HELD: f32 = 1e4;
/// Most steps of the fit at a place; one or two usually suffice. A fit that has not converged by
/// then has a kink and gets no better.
const MOST_STEPS: u8 = 8;
/// Tolerance of the fit at a place, as a part of the noise variance: likelihoods need no more. A
/// choice: with a tenth intervals are the same, and the fits take longer.
const SETTLED: f32 = 0.5;
/// Part of the best fit's variances beyond the noise that is added to the average: a scatter of the
/// slip's samples shifts the onset, and the places include some of that. Tuned: with none the
/// intervals of slips that are no ellipse are too narrow, with all of it three halves of their
/// errors.
const SCATTER: f32 = 0.5;
/// Likelihood relative to the best fit's that adds nothing to sums in single precision.
const UNLIKELY: f32 = 1.2e-7;

/// Average over places of the onset, weighted by likelihood. A step is one iteration of the fit at
/// one place.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct OverOnset {
    sums: Sums,
    /// Numbers of places in a period and within the first step.
    steps: i16,
    fine: i16,
    /// Is a place at a period from the best fit as likely as others?
    is_open: bool,
    /// The next place, and the cycle from which its fit begins.
    place: i16,
    from: CycleParams,
    fitting: Option<Fitting>,
}

impl OverOnset {
    /// Begins the average for a slip that its best fit does not resolve, with the next slip
    /// `periods` later; else `None`.
    pub(crate) fn new(best: &Fit, knows_omega: bool, noise_n2: f32, periods: f32) -> Option<Self> {
        let fall = best.shape.fall_time();
        let clear = knows_omega && !is_at_edge(&best.shape, noise_n2);
        let least = if clear { RESOLVED } else { CLEARLY_RESOLVED };
        let fine = if fall < RESOLVED { FINE } else { 1 };
        let steps = larger(smaller(periods, MOST), 1.0) as i16;
        let from = *best.cycle();
        (fall < least).then(|| Self { steps, fine, from, ..Self::default() })
    }

    /// One iteration. Breaks with the posterior after the last place.
    pub(crate) fn step(&mut self, data: &Data<'_>, best: &Fit) -> ControlFlow<Posterior> {
        let (by, width) = self.offset(self.place);
        let onset = best.cycle().onset + by;
        let steepest = self.from.rate + self.from.half_drop_n * self.from.omega;
        let held = Prior { mean: onset, weight: HELD * steepest * steepest };
        let held = Data { priors: &Priors { onset: held, ..*data.priors }, ..*data };
        let guess = CycleParams { onset, ..self.from };
        let fitting =
            self.fitting.get_or_insert_with(|| Fitting::brief(&guess, MOST_STEPS, SETTLED));
        let ControlFlow::Break(fit) = fitting.step(&held) else {
            return ControlFlow::Continue(());
        };
        self.fitting = None;
        self.take(data, best, fit, (by, width))
    }

    /// Is the onset undetermined within a period to either side?
    pub(crate) fn is_open(&self) -> bool {
        self.is_open
    }

    /// Distance of a place from the best fit, periods, and the width of the interval that it
    /// represents, in steps.
    fn offset(&self, place: i16) -> (f32, f32) {
        let (number, closer) = (place.abs(), f32::from(self.fine));
        let (steps, width) = if number < self.fine {
            (f32::from(number) / closer, 1.0 / closer)
        } else {
            let width = if number == self.fine { 0.5 + 0.5 / closer } else { 1.0 };
            (f32::from(number - self.fine + 1), width)
        };
        ((steps / f32::from(self.steps)).copysign(f32::from(place)), width)
    }

    /// Adds the fit of one place, `by` from the best fit, which represents this width.
    fn take(
        &mut self,
        data: &Data<'_>,
        best: &Fit,
        fit: Option<Fit>,
        (by, width): (f32, f32),
    ) -> ControlFlow<Posterior> {
        let (prior, noise_n2) = (data.priors.onset, data.priors.noise_n2);
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
        let last = self.steps + self.fine - 1;
        self.is_open |= !ends && self.place.abs() == last;
        let Some(next) = following(self.place, last, ends) else {
            let step = 1.0 / f32::from(self.steps);
            return ControlFlow::Break(self.sums.posterior(best, noise_n2, step));
        };
        // The other side begins again at the best fit.
        let turns = self.place > 0 && next < 0;
        let (fit, here) = match &fit {
            Some(fit) if !turns => (fit, by),
            _ => (best, 0.0),
        };
        self.from = along(fit, self.offset(next).0 - here);
        self.place = next;
        ControlFlow::Continue(())
    }
}

/// Is the force of the last sample before the cable goes slack within the noise of zero? The cable
/// may then have gone slack earlier with the same likelihood: the fit determines only that the fall
/// does not end before this sample.
fn is_at_edge(shape: &Shape, noise_n2: f32) -> bool {
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

    fn posterior(&self, best: &Fit, noise_n2: f32, step: f32) -> Posterior {
        if self.weight <= 0.0 {
            return Posterior::at(best, noise_n2);
        }
        let mut spread = self.moments;
        for [mean, square] in &mut spread {
            *mean /= self.weight;
            *square = larger(*square / self.weight - *mean * *mean, 0.0);
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
        if best.shape.fall_time() >= RESOLVED || over.variances[0] <= step * step / 4.0 {
            for (variance, least) in over.variances.iter_mut().zip(best.variances) {
                *variance = larger(*variance, noise_n2 * least);
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
    fn posterior(slide: f32, onset: f32, periods: f32) -> (CycleParams, Posterior, [u32; 2]) {
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
        let Some(mut places) = OverOnset::new(&fit, true, 4.0, periods) else {
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
        let (truth, got, [passes, places]) = posterior(0.5, 0.25, 20.0);
        assert!(places == 14 && passes < 3 * places, "{passes} passes, {places} places");
        let onset_std = math::sqrt(got.variances[0]);
        assert!(onset_std > 0.05 && onset_std < 0.5, "{onset_std}");
        let std = math::sqrt(got.forces_n2().0);
        assert!(std > 20.0 * 0.05, "{std}");
        assert!((got.cycle.static_n - truth.static_n).abs() < 2.0 * std);
        assert!(!got.is_resolved());
    }

    #[test]
    fn a_slip_that_recurs_soon_is_averaged_over_fewer_places() {
        let (truth, many, [_, most]) = posterior(0.5, 0.25, 20.0);
        let (_, few, [_, places]) = posterior(0.5, 0.25, 5.0);
        assert!(places + 2 < most, "{places} of {most} places");
        let [many_n, few_n] = [many, few].map(|it| math::sqrt(it.forces_n2().0));
        assert!((0.8..1.25).contains(&(few_n / many_n)), "{few_n} {many_n}");
        assert!((few.cycle.static_n - truth.static_n).abs() < 2.0 * few_n);
    }

    #[test]
    fn a_slip_of_three_samples_is_told_by_its_fit() {
        let (truth, got, _) = posterior(3.0, 0.25, 20.0);
        assert!(got.is_resolved() && got.variances[0] < 1e-3);
        assert!((got.cycle.static_n - truth.static_n).abs() < 1.0);
    }
}
