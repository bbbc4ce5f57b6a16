//! What the events of a test have told so far, as expectations for the next one.

use crate::fit::{Data, Fit, Prior};
use crate::line::Line;
use crate::model::UNKNOWNS;
use crate::pending::Pending;
use crate::posterior::Posterior;
use crate::residuals::Residuals;
use crate::shared::{Shared, without_prior};

/// Loading rate, swing `1/ω` and bend that the events share, and the noise.
#[derive(Clone, Debug, Default)]
pub(crate) struct Learnt {
    pub(crate) rate: Shared,
    pub(crate) swing: Shared,
    bend: Shared,
    pub(crate) residuals: Residuals,
    /// Events in a row that did not fit.
    misfits: u8,
}

/// So many events in a row that do not fit: what was expected is no longer true.
const CHANGED: u8 = 3;
/// Least part of a fitted precision that has to be the event's own: less than one event
/// has in the memory of all, else nothing would be learnt after the first few.
const LEAST_OWN: f32 = 0.003;

impl Learnt {
    /// Variance of the noise: from the fits so far, else the detector's.
    pub(crate) fn noise_n2(&self, pending: &Pending) -> f32 {
        self.residuals.variance_n2().unwrap_or(pending.noise_n2)
    }

    /// Does an event leave far more than the others do? The winch paused or started, the
    /// block hit something; or, after several of them, all is different from now on, and
    /// nothing is expected any more.
    pub(crate) fn is_misfit(&mut self, squares_n2: f32, free: f32) -> bool {
        if !self.residuals.are_far_less_than(squares_n2, free) {
            self.misfits = 0;
            return false;
        }
        self.misfits += 1;
        if self.misfits == CHANGED {
            self.misfits = 0;
            [self.rate, self.swing, self.bend] = [Shared::default(); 3];
        }
        true
    }

    /// An event's samples and lines with what is expected of it.
    pub(crate) fn data<'a>(
        &self,
        pending: &'a Pending,
        after: &'a Line,
        noise_n2: f32,
    ) -> Data<'a> {
        let rough = &pending.rough;
        Data {
            before: &pending.before,
            samples: pending.samples(),
            after,
            rate: expected(&self.rate, rough.rate, 0.7 * rough.rate, noise_n2),
            swing: expected(
                &self.swing,
                rough.slide * core::f32::consts::FRAC_1_PI,
                rough.slide_std * core::f32::consts::FRAC_1_PI,
                noise_n2,
            ),
            bend: self.bend_prior(rough.rate, noise_n2),
            onset: rough.onset(noise_n2),
        }
    }

    /// Until the events tell otherwise the winch turns steadily.
    fn bend_prior(&self, rough_rate: f32, noise_n2: f32) -> Prior {
        const STEADY: f32 = 0.003;
        let learnt = self.bend.prior_around_zero(noise_n2);
        if learnt.weight > 0.0 {
            return learnt;
        }
        let spread = STEADY * self.rate.mean().unwrap_or(rough_rate);
        Prior { mean: 0.0, weight: noise_n2 / (spread * spread) }
    }

    /// Is the swing known from earlier events?
    pub(crate) fn knows_swing(&self) -> bool {
        self.swing.prior(1.0).weight > 0.0
    }

    /// Carries the event's own loading rate, swing and bend to the next ones.
    pub(crate) fn learn(&mut self, data: &Data<'_>, posterior: &Posterior, noise_n2: f32) {
        let Posterior { cycle, unknowns: [_, rate, _, _, swing, bend], .. } = *posterior;
        self.rate.forget();
        self.bend.forget();
        if posterior.is_resolved() {
            self.swing.forget();
        }
        let own =
            |value, variance, prior| without_prior(value, variance, prior, noise_n2, LEAST_OWN);
        // The loading rate and the swing are above zero; the bend may have any sign.
        if let Some((value, variance)) = own(cycle.rate, rate, data.rate).filter(|own| own.0 > 0.0)
        {
            self.rate.add(value, variance);
        }
        // What hardly resolved slips tell of it is what was expected of them.
        let own_swing = own(cycle.swing(), swing, data.swing);
        if let Some((value, variance)) =
            own_swing.filter(|own| own.0 > 0.0 && posterior.is_resolved())
        {
            self.swing.add(value, variance);
        }
        if let Some((value, variance)) = own(cycle.bend, bend, data.bend) {
            self.bend.add(value, variance);
        }
    }
}

/// What earlier events tell of a quantity, else a guess and its standard deviation.
fn expected(shared: &Shared, guess: f32, spread: f32, noise_n2: f32) -> Prior {
    let learnt = shared.prior(noise_n2);
    if learnt.weight > 0.0 {
        return learnt;
    }
    Prior { mean: guess, weight: noise_n2 / (spread * spread) }
}

/// Squared residuals of an event that no other event counts, N², and their degrees
/// of freedom: observations less unknowns, as far as these come from the samples
/// and not from what was expected.
pub(crate) fn own_residuals(data: &Data<'_>, fit: &Fit) -> (f32, f32) {
    let (mut squares, mut unknowns) = (fit.cost() + data.after.residual(), UNKNOWNS as f32);
    for (unknown, (prior, value)) in data.priors(&fit.cycle).into_iter().enumerate() {
        squares -= prior.weight * (prior.mean - value) * (prior.mean - value);
        unknowns -= prior.weight * fit.variance(unknown);
    }
    let lines = data.before.count.min(2) as f32 + data.after.weight;
    (squares.max(0.0), data.samples.good().count() as f32 + lines - unknowns)
}
