//! The data of a slip's fits.

use crate::cycle::slip_record::SlipRecord;
use crate::fit::levenberg_marquardt::SAMPLES_A_STEP;
use crate::fit::{Data, Priors};
use crate::stats::line::Line;

impl SlipRecord {
    /// The data of a fit: samples and lines of the event, with these priors.
    #[inline(never)]
    pub(crate) fn data<'a>(&'a self, priors: &'a Priors, after: &'a Line) -> Data<'a> {
        let (before, samples, wander) = (&self.before, self.samples(), self.wander);
        Data { before, samples, after, wander, priors }
    }

    /// Time of one pass over samples and lines, in units of 160 instructions on the board.
    pub(crate) fn pass(&self, priors: &Priors) -> usize {
        let samples = self.samples().forces_n.len().min(SAMPLES_A_STEP);
        let wanders = if self.wander.level > 0.0 { 3 } else { 0 };
        let sharp = priors.corner.is_sharp();
        let pass = if sharp { 12 + samples * 5 / 4 } else { 16 + samples * 5 / 2 };
        pass + wanders
    }
}
