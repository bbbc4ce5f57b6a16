//! The expectations (priors) for one event, from the events before it.

use crate::cycle::slip_record::SlipRecord;
use crate::fit::Data;
use crate::fit::levenberg_marquardt::SAMPLES_A_STEP;
use crate::model::corner::Corner;
use crate::noise::ripple::ColoredNoise;
use crate::stats::line::Line;
use crate::stats::prior::Prior;

/// Priors of one event's unknowns, and the shape of its corners.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Expected {
    /// Variance of the noise, N²: the unit of the priors' weights.
    pub(crate) noise_n2: f32,
    pub(super) rate: Prior,
    pub(super) inverse_omega: Prior,
    pub(super) rate_change: Prior,
    pub(super) onset: Prior,
    pub(crate) corner: Corner,
}

impl Expected {
    /// The data of a fit: samples and lines of the event, with these priors.
    #[inline(never)]
    pub(crate) fn data<'a>(&self, slip: &'a SlipRecord, after: &'a Line) -> Data<'a> {
        let Self { rate, inverse_omega, rate_change, onset, corner, .. } = *self;
        Data {
            before: &slip.before,
            samples: slip.samples(),
            after,
            wander: slip.wander,
            rate,
            inverse_omega,
            rate_change,
            onset,
            corner,
        }
    }

    /// The data for the score test of force terms, without priors of all unknowns but the last, the
    /// rate change. Where the force bends down before the onset, the
    /// lines do not follow the bend: creep may cause it, and would not show about lines that follow
    /// it.
    #[inline(never)]
    pub(crate) fn asked<'a>(&self, slip: &'a SlipRecord, after: &'a Line) -> Data<'a> {
        let mut data = self.data(slip, after);
        [data.onset, data.rate, data.inverse_omega] = [Prior::default(); 3];
        if slip.wander.creeps {
            data.wander = ColoredNoise::NONE.into();
        }
        data
    }

    /// Time of one pass over samples and lines, in units of 160 instructions on the board.
    pub(crate) fn pass(&self, slip: &SlipRecord) -> usize {
        let samples = slip.samples().forces_n.len().min(SAMPLES_A_STEP);
        let wanders = if slip.wander.level > 0.0 { 3 } else { 0 };
        let pass = if self.corner.is_sharp() { 12 + samples * 5 / 4 } else { 16 + samples * 5 / 2 };
        pass + wanders
    }
}
