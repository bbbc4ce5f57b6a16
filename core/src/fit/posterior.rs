//! What an event's samples tell of its unknowns: means and variances.
//!
//! Where the slip holds enough samples the best fit and its information matrix say
//! it all. A slip of hardly a sample is different: its onset may lie anywhere
//! between two samples, every place with its own best fit and almost the same sum
//! of squares, with a kink where the slip's end passes a sample. There the onset is
//! held at a row of places, and the fits are averaged with their likelihoods
//! `exp(−cost / 2 σ²)`: what the samples cannot tell widens the interval.

use core::ops::ControlFlow;

use crate::fit::correction::Correction;
use crate::fit::{Data, Fit, Fitting};
use crate::model::CycleParams;
use crate::num::math;
use crate::stats::normal_equations::{Gradient, UNKNOWNS};
use crate::stats::prior::Prior;

/// Slips shorter than this are averaged over the onset, periods; so are those up to the
/// second limit while no other event tells how long a slip is.
const RESOLVED: f32 = 1.5;
const CLEARLY_RESOLVED: f32 = 3.0;
/// A slip whose swing is less well known than this part of it is not resolved.
const SWING_KNOWN: f32 = 0.2;
/// Places of the onset: so many on either side of the best fit, so far apart, periods.
const PLACES: i16 = 8;
const STEP: f32 = 0.125;
/// Information that holds the onset in its place: so many times what one sample on
/// the steepest part of the slip would tell.
const HELD: f32 = 1e4;
/// Most steps of the fit at a place: three are usual. A fit that has not settled by then has a
/// kink, and is as good as it gets.
const MOST_STEPS: u8 = 8;
/// A likelihood, in parts of the best fit's, that adds nothing to sums in single precision.
const UNLIKELY: f32 = 1.2e-7;

/// Means and variances of one event's unknowns; forces in N, times in periods.
#[derive(Clone, Copy, Debug)]
pub struct Posterior {
    /// The cycle of the means.
    pub cycle: CycleParams,
    /// Its time of sliding, periods.
    pub slide_time: f32,
    /// Variance of `Fs`, N².
    pub static_n2: f32,
    /// Variance of `Fp`, N².
    pub dynamic_n2: f32,
    /// What of these two is common to the events, N²: how the corners are rounded off, and what
    /// the samples of the slips scatter, which may be the same in all of them.
    pub common_n2: (f32, f32),
    /// Variances of the onset, rate, ., ., swing and bend.
    pub unknowns: Gradient,
}

impl Posterior {
    /// Is the slip long enough for the samples?
    #[must_use]
    pub fn is_resolved(&self) -> bool {
        let most = SWING_KNOWN * self.cycle.inverse_omega();
        self.slide_time >= RESOLVED && self.unknowns[4] < most * most
    }

    /// Does it tell the next events how long a slip is? What one sample in a slip of less than
    /// two leaves open is no normal distribution: many such events know no more than one.
    #[must_use]
    pub(crate) fn tells_swing(&self) -> bool {
        const CLEAR: f32 = 2.0;
        const WELL: f32 = 0.08;
        let well = WELL * self.cycle.inverse_omega();
        self.is_resolved() && (self.slide_time > CLEAR || self.unknowns[4] < well * well)
    }

    /// Takes what is known of the corners since the fit.
    pub(crate) fn take(&mut self, effect: &Correction) {
        let Correction {
            moved: [onset, rate, static_n, half_drop_n, inverse_omega, rate_change],
            ..
        } = effect;
        let c = &mut self.cycle;
        c.onset += onset;
        c.rate += rate;
        c.static_n += static_n;
        c.half_drop_n += half_drop_n;
        c.omega = 1.0 / (c.inverse_omega() + inverse_omega);
        c.rate_change += rate_change;
        self.static_n2 += effect.static_n2;
        self.dynamic_n2 += effect.dynamic_n2;
        let (static_n2, dynamic_n2) = self.common_n2;
        self.common_n2 = (static_n2 + effect.static_n2, dynamic_n2 + effect.dynamic_n2);
    }

    /// The slip began anywhere within a period before and after, and may have any length that
    /// goes with it: `Fs` is as unsure as the onset, `Fp` by half as much.
    pub(crate) fn begin_anywhere(&mut self) {
        const UNIFORM: f32 = 1.0 / 3.0;
        let CycleParams { rate, omega, .. } = self.cycle;
        let onset_n2 = UNIFORM * rate * rate;
        self.static_n2 += onset_n2;
        self.dynamic_n2 += 0.25 * onset_n2;
        self.unknowns[0] += UNIFORM;
        self.unknowns[4] += 1.0 / (omega * omega);
    }

    /// With no variance less than another's.
    fn widened(mut self, other: &Self) -> Self {
        self.static_n2 = self.static_n2.max(other.static_n2);
        self.dynamic_n2 = self.dynamic_n2.max(other.dynamic_n2);
        for (variance, least) in self.unknowns.iter_mut().zip(other.unknowns) {
            *variance = variance.max(least);
        }
        self
    }

    /// At the best fit, with the variance of the noise.
    #[must_use]
    pub fn at(fit: &Fit, noise_n2: f32) -> Self {
        let Fit { forces, .. } = fit;
        let unknowns = fit.variances.map(|variance| noise_n2 * variance);
        let static_n2 = noise_n2 * forces.static_variance;
        let dynamic_n2 = noise_n2 * forces.dynamic_variance;
        let slide_time = fit.cycle.slide_time();
        let common_n2 = (0.0, 0.0);
        Self { cycle: fit.cycle, slide_time, static_n2, dynamic_n2, common_n2, unknowns }
    }
}

/// Averages over places of the onset, weighted by likelihood: one iteration of one place's
/// fit a step.
#[derive(Clone, Copy, Debug)]
pub struct OverOnset {
    sums: Sums,
    /// Next place, and where its fit begins.
    place: i16,
    from: CycleParams,
    fitting: Option<Fitting>,
}

impl OverOnset {
    /// For a slip that its best fit does not resolve; `None`: the fit says it all.
    #[must_use]
    pub fn new(best: &Fit, knows_omega: bool) -> Option<Self> {
        let least = if knows_omega { RESOLVED } else { CLEARLY_RESOLVED };
        let is_short = best.cycle.slide_time() < least;
        let (sums, place, from) = (Sums::default(), 0, best.cycle);
        is_short.then_some(Self { sums, place, from, fitting: None })
    }

    /// One iteration; breaks with the result after the last place.
    pub fn step(&mut self, data: &Data<'_>, best: &Fit, noise_n2: f32) -> ControlFlow<Posterior> {
        let onset = best.cycle.onset + STEP * f32::from(self.place);
        let steepest = self.from.rate + self.from.half_drop_n * self.from.omega;
        let held = Prior { mean: onset, weight: HELD * steepest * steepest };
        let held = Data { onset: held, ..*data };
        let guess = CycleParams { onset, ..self.from };
        let fitting = self.fitting.get_or_insert_with(|| Fitting::brief(&guess, MOST_STEPS));
        let ControlFlow::Break(fit) = fitting.step(&held, noise_n2) else {
            return ControlFlow::Continue(());
        };
        self.fitting = None;
        self.take(data, best, fit, noise_n2)
    }

    /// The result of the places so far.
    #[must_use]
    pub fn so_far(&self, best: &Fit, noise_n2: f32) -> Posterior {
        self.sums.posterior(best, noise_n2)
    }

    /// Takes the fit of one place.
    fn take(
        &mut self,
        data: &Data<'_>,
        best: &Fit,
        fit: Option<Fit>,
        noise_n2: f32,
    ) -> ControlFlow<Posterior> {
        let onset = best.cycle.onset + STEP * f32::from(self.place);
        // A slip of samples enough has one best place: where nothing is likely any more
        // nothing is beyond.
        let mut ends = fit.is_none();
        if let Some(fit) = &fit {
            let expected =
                data.onset.weight * (onset - data.onset.mean) * (onset - data.onset.mean);
            let cost = fit.cost() + expected - best.cost();
            let likelihood = math::exp(-0.5 * cost / noise_n2);
            ends = likelihood < UNLIKELY && best.cycle.slide_time() >= RESOLVED;
            self.sums.add(likelihood, &Posterior::at(fit, noise_n2), best);
        }
        let Some(next) = following(self.place, ends) else {
            return ControlFlow::Break(self.so_far(best, noise_n2));
        };
        // The other way begins at the best fit again.
        let turns = self.place > 0 && next < 0;
        self.from = fit.filter(|_| !turns).map_or(best.cycle, |fit| fit.cycle);
        self.place = next;
        ControlFlow::Continue(())
    }
}

/// Places go up to the last, or to one that ends them, and then down.
fn following(place: i16, ends: bool) -> Option<i16> {
    match place {
        0..PLACES if !ends => Some(place + 1),
        0.. => Some(-1),
        _ => (!ends && place > -PLACES).then_some(place - 1),
    }
}

/// Weighted sums of values relative to the best fit, of their squares and of their
/// variances: `Fs`, `Fp` and the unknowns.
#[derive(Clone, Copy, Debug, Default)]
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
        let cycle = CycleParams {
            onset: from.onset + mean(2),
            rate: from.rate + mean(3),
            static_n,
            half_drop_n: static_n - dynamic_n,
            omega: 1.0 / (from.inverse_omega() + mean(6)),
            rate_change: from.rate_change + mean(7),
        };
        let mut unknowns = Gradient::default();
        for (unknown, entry) in unknowns.iter_mut().enumerate() {
            *entry = variance(unknown + 2);
        }
        let (static_n2, dynamic_n2) = (variance(0), variance(1));
        let (slide_time, common_n2) = (cycle.slide_time(), (0.0, 0.0));
        let over = Posterior { cycle, slide_time, static_n2, dynamic_n2, common_n2, unknowns };
        // An onset that is known better than the places are apart: one place has all the
        // weight, and its fit knows nothing of the onset's own uncertainty.
        if from.slide_time() < RESOLVED {
            over
        } else {
            over.widened(&Posterior::at(best, noise_n2))
        }
    }
}

/// `Fs`, `Fp` and the unknowns of a cycle.
fn values(c: &CycleParams) -> [f32; 2 + UNKNOWNS] {
    [
        c.static_n,
        c.dynamic_n(),
        c.onset,
        c.rate,
        c.static_n,
        c.half_drop_n,
        c.inverse_omega(),
        c.rate_change,
    ]
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

    fn posterior(slide: f32, onset: f32) -> (CycleParams, Posterior) {
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
            wander: ColoredNoise::NONE,
            rate: Prior { mean: 20.0, weight: 0.1 },
            inverse_omega: Prior { mean: 0.8 / omega, weight: 4.0 * omega * omega / 0.25 },
            rate_change: Prior { mean: 0.0, weight: 1e6 },
            onset: Prior { mean: 0.5 - 0.5 * slide, weight: 44.0 },
            corner: Corner::default(),
        };
        let fit = data.fit(&CycleParams { onset: onset + 0.1, ..truth }, 4.0).unwrap();
        let Some(mut places) = OverOnset::new(&fit, true) else {
            return (truth, Posterior::at(&fit, 4.0));
        };
        loop {
            if let ControlFlow::Break(posterior) = places.step(&data, &fit, 4.0) {
                return (truth, posterior);
            }
        }
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
