//! Time asymmetry of the force: noise and oscillations look the same in reversed time. Slips do
//! not: they fall faster than the winch pulls.
//!
//! Rises and falls are compared by the steepest step of each run in one direction.

use crate::num::math::smaller;
use crate::stats::quantile::Quantile;
use crate::stats::significance::SIGNIFICANT;

/// Compares rises and falls, until the fits give the noise.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct TimeAsymmetry {
    /// Mean of the recent steps, N, which is subtracted: a force that is let go falls evenly.
    drift_n: f32,
    /// Steepest step of the current run, N, signed.
    steepest_n: f32,
    /// Upper quartile of the steepest steps, N.
    usual_n: Quantile,
    /// Sums of the scores of falls, of rises, and of the squared scores of both. A run's score is
    /// the cube of its steepest step, in units of `usual_n`.
    falls: f32,
    rises: f32,
    squares: f32,
    /// Sum of the falls' steepest steps, each times its score, N.
    fall_n: f32,
}

impl TimeAsymmetry {
    /// Takes a step from one sample to the next, N.
    pub(crate) fn add(&mut self, step_n: f32) {
        const MEMORY: f32 = 16.0;
        self.drift_n += (step_n - self.drift_n) / MEMORY;
        let step_n = step_n - self.drift_n;
        if step_n * self.steepest_n < 0.0 {
            let run_n = core::mem::take(&mut self.steepest_n);
            self.end_run(run_n.abs(), run_n < 0.0);
        }
        if step_n.abs() > self.steepest_n.abs() {
            self.steepest_n = step_n;
        }
    }

    fn end_run(&mut self, size_n: f32, falls: bool) {
        /// Largest steepest step that counts, in upper quartiles: no spike decides alone.
        const MOST: f32 = 3.0;
        self.usual_n.add(size_n, 0.75);
        let Some(usual_n) = self.usual_n.value().filter(|&usual_n| usual_n > 0.0) else { return };
        let size = smaller(size_n / usual_n, MOST);
        let score = size * size * size;
        self.squares += score * score;
        if falls {
            self.falls += score;
            self.fall_n += score * size * usual_n;
        } else {
            self.rises += score;
        }
    }

    /// Mean steepest step of a fall, N, weighted by the scores, if the falls' scores are more than
    /// twice the rises', and the difference is beyond 3 standard errors.
    pub(crate) fn slip_n(&self) -> Option<f32> {
        let more = self.falls - self.rises;
        let sure = more > self.rises && more * more > SIGNIFICANT * SIGNIFICANT * self.squares;
        sure.then(|| self.fall_n / self.falls)
    }
}
