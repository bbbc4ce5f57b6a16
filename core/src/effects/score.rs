//! Rao's score test of the events' residuals for a force term that the fit lacks.
//!
//! A term of amplitude `A` adds `A c(t)` to the samples of a slip. With the weights `W`, the
//! residuals `r`, the model's derivatives `U`, and the event's own unknowns free, its score is
//! `cᵀ W r − Rᵀ Uᵀ W r` and its information `cᵀ W c − Rᵀ Uᵀ W c`, `R = (Uᵀ W U)⁻¹ Uᵀ W c`. A term
//! of amplitude one that the fit lacks moves its unknowns by `−R`. Scores and information are
//! summed over the events, and the estimate of `A` is the ratio of the two sums.

use core::ops::Range;

use crate::fit::{Alone, Data};
use crate::model::Shape;
use crate::num::math::{self, larger};
use crate::stats::normal_equations::{Gradient, Normal, dot};
use crate::stats::significance::SIGNIFICANT;

/// Number of terms that are tested at a time.
pub(crate) const TERMS: usize = 3;
/// Least part of a term's information that is left with the unknowns free; less is rounding.
const LEAST_OWN: f32 = 1e-4;
/// Number of events, fading, that has to be exceeded before an amplitude counts: it does from the
/// third on.
const LEAST_EVENTS: f32 = 2.0;
/// Part of the sums that is kept with every event. A choice: a longer memory resolves smaller
/// amplitudes, a shorter one follows a cable that changes.
const FADE: f32 = 1.0 - 1.0 / 200.0;

/// An event's normal equations for the amplitudes of some terms, with the event's own unknowns held
/// at first, and then free.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Asked {
    /// Normal equations of the amplitudes, the first three unknowns of six; the others stay zero.
    pub(crate) normal: Normal,
    /// For each term: at first `Uᵀ W c`; once the unknowns are free, `R`, by which they fall when
    /// the term's amplitude grows by one.
    pub(crate) response: [Gradient; TERMS],
    /// Part of each term's information that is left with the unknowns free; NaN without
    /// information.
    pub(crate) left: [f32; TERMS],
}

impl Asked {
    /// Adds the levels at some places, those of samples in the slip and before the cable goes
    /// slack. `by_n` gives the forces of the terms with amplitudes of one, N, from the time since
    /// the onset and the model's gradient there.
    #[inline(always)]
    pub(crate) fn take(
        &mut self,
        (data, places): (&Data<'_>, Range<usize>),
        shape: &Shape,
        by_n: impl Fn(f32, &Gradient) -> [f32; TERMS],
    ) {
        let model = data.model(shape);
        for (time, force_n, weight) in data.levels_in(places) {
            let since_onset = time - shape.cycle().onset;
            if since_onset > 0.0 && since_onset < shape.fall_time() {
                let (off_n, gradient) = model.residual(time, force_n);
                self.add(off_n, &gradient, by_n(since_onset, &gradient), weight);
            }
        }
    }

    /// The score of one term; its information is zero where the samples do not determine the term.
    pub(crate) fn score(&self, term: usize) -> Score {
        let is_determined = self.left[term] > LEAST_OWN;
        let information = if is_determined { self.normal.matrix[[term, term]] } else { 0.0 };
        Score { score: self.normal.right[term], information, response: self.response[term] }
    }

    /// Adds a sample: its residual, the model's gradient and the terms' forces there, N, and its
    /// weight.
    pub(crate) fn add(&mut self, off_n: f32, gradient: &Gradient, by_n: [f32; TERMS], weight: f32) {
        let [first, second, third] = by_n;
        self.normal.add(off_n, &[first, second, third, 0.0, 0.0, 0.0], weight);
        for (product, by_n) in self.response.iter_mut().zip(by_n) {
            product.iter_mut().zip(gradient).for_each(|(sum, g)| *sum += weight * by_n * g);
        }
    }

    /// Frees the event's unknowns, once all its levels are added.
    pub(crate) fn free(&mut self, alone: &Alone) {
        let Self { normal, response, left } = self;
        for i in 0..TERMS {
            let (product, whole) = (response[i], normal.matrix[[i, i]]);
            response[i] = alone.factor.solve(&product);
            for (j, other) in response.iter().enumerate().take(i + 1) {
                normal.matrix[[i, j]] -= dot(&product, other);
            }
            normal.right[i] -= dot(&response[i], &alone.right);
            left[i] = normal.matrix[[i, i]] / whole;
        }
    }
}

/// One event's score and information for one term.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Score {
    pub(crate) score: f32,
    pub(crate) information: f32,
    /// Decrease of the unknowns when the amplitude grows by one.
    pub(crate) response: Gradient,
}

/// Sums of the events' scores and information for one amplitude, with a fading memory.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ScoreSum {
    /// Number of events in the sums; the past fades.
    pub(crate) count: f32,
    /// Sums over events, in units of the noise variance.
    information: f32,
    score: f32,
    /// Σ of the events' squared scores, each less its expectation from the events before and over
    /// its variance: 1 per event after the first, if there is nothing but noise.
    chi_square: f32,
}

impl ScoreSum {
    /// Adds an event's score.
    pub(crate) fn learn(&mut self, event: &Score, noise_n2: f32) {
        let (score, information) = (event.score / noise_n2, event.information / noise_n2);
        let off = score - self.value() * information;
        // The expectation has an error as well, in the first events as large as that of the score.
        let (known, all) = (self.information, self.information + information);
        let square = off * off / information * known / all;
        // False without information as well.
        if !(score + information + square).is_finite() {
            return;
        }
        let fade = |sum: &mut f32, by: f32| *sum = FADE * *sum + by;
        fade(&mut self.count, 1.0);
        fade(&mut self.score, score);
        fade(&mut self.information, information);
        fade(&mut self.chi_square, square);
    }

    /// The estimate of the amplitude.
    #[inline(never)]
    pub(crate) fn value(&self) -> f32 {
        if self.information > 0.0 { self.score / self.information } else { 0.0 }
    }

    /// Variance of the amplitude, larger where the scores scatter by more than the noise.
    #[inline(never)]
    pub(crate) fn variance(&self) -> f32 {
        larger(self.chi_square / (self.count - 1.0), 1.0) / self.information
    }

    /// Are there enough events for the amplitude to count?
    pub(crate) fn counts(&self) -> bool {
        self.count > LEAST_EVENTS
    }

    /// The amplitude and its standard deviation, if it is significant.
    pub(crate) fn found(&self) -> Option<(f32, f32)> {
        let (value, variance) = (self.value(), self.variance());
        let is_found = self.counts() && value * value > SIGNIFICANT * SIGNIFICANT * variance;
        is_found.then(|| (value, math::sqrt(variance)))
    }
}
