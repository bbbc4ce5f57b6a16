//! The score test of an event's residuals for force terms that its fit lacks, some levels a step.

use crate::cycle::cycle_fit::{CycleFit, FitStage, Measured, Terms};
use crate::cycle::expectations::Expectations;
use crate::cycle::slip_record::SlipRecord;
use crate::effects::corner::ask;
use crate::effects::score::Asked;
use crate::fit::correction::Correction;
use crate::fit::{Data, Priors};
use crate::noise::ripple::ColoredNoise;
use crate::stats::line::Line;

/// Levels per step of the score test: twelve take 60 of the 62 units of a sample's time
/// (`next_takes`).
pub(super) const LEVELS_A_STEP: usize = 12;

impl CycleFit {
    /// Sets up the normal equations of the event without its priors.
    pub(super) fn alone(&mut self, stage: &mut FitStage) {
        let FitStage::Alone(pass) = stage else { return };
        let data = self.slip.asked(&self.priors, &self.after);
        if pass.advance(&data, &self.fit.shape) {
            *stage = pass.alone().map_or(FitStage::Done, |it| {
                FitStage::Asked(Terms::Widen, it, Asked::default(), 0)
            });
        }
    }

    /// Adds some levels to the score test. After the last one the terms are learnt; then the
    /// corners follow, if the event is due for them.
    // A function of its own: inlined into `step` it takes two hundred bytes of flash more.
    #[inline(never)]
    pub(super) fn asked(&mut self, stage: &mut FitStage, learnt: &mut Expectations) {
        let FitStage::Asked(terms, alone, asked, next) = stage else {
            return;
        };
        let data = self.slip.asked(&self.priors, &self.after);
        let levels = *next..*next + LEVELS_A_STEP;
        match terms {
            Terms::Widen => learnt.ask_scores(asked, (&data, levels), &self.fit.shape),
            Terms::Corner => ask(asked, &data, &self.fit, levels),
        }
        *next += LEVELS_A_STEP;
        if *next < data.places() {
            return;
        }
        let (corner, noise_n2) = (self.priors.corner, self.priors.noise_n2);
        asked.free(alone);
        let widens = matches!(terms, Terms::Widen);
        let correction = if widens {
            let static_n2 = learnt.learn_scores(asked, noise_n2);
            Correction { static_n2, ..Correction::default() }
        } else {
            learnt.learn_corner(corner, &self.fit, asked, noise_n2)
        };
        if widens && learnt.asks_corner(&corner) {
            (*terms, *asked, *next) = (Terms::Corner, Asked::default(), 0);
        } else {
            *stage = FitStage::Done;
        }
        self.measured.share(&correction);
    }
}

impl SlipRecord {
    /// The data for the score test of force terms. Where the force bends down before the onset, the
    /// lines do not follow the bend: creep may cause it, and would not show about lines that follow
    /// it.
    pub(crate) fn asked<'a>(&'a self, priors: &'a Priors, after: &'a Line) -> Data<'a> {
        let mut data = self.data(priors, after);
        if self.wander.creeps {
            data.wander = ColoredNoise::NONE.into();
        }
        data
    }
}

impl Measured {
    /// Applies a correction found after the fit.
    pub(crate) fn apply(&mut self, correction: &Correction) {
        self.posterior.apply(correction);
        if let Some(forces) = &mut self.alone {
            forces.apply(correction);
        }
    }

    /// Applies a correction found after the fit whose error is the same in every event.
    fn share(&mut self, correction: &Correction) {
        self.apply(correction);
        self.posterior.common_n2.0 += correction.static_n2;
        self.posterior.common_n2.1 += correction.dynamic_n2;
    }
}
