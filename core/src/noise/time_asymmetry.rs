//! The direction of time in a force: noise and swings look the same backwards, slips do
//! not. They fall faster than the winch pulls.
//!
//! Rises and falls are compared by their steepest steps: a slow one counts once.

use crate::num::math::smaller;
use crate::stats::quantile::Quantile;

/// Compares rises and falls, until the fits tell the noise.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TimeAsymmetry {
    /// Mean step of late: a force that is let go falls evenly.
    drift_n: f32,
    /// Steepest step of the run that is going on, signed.
    steepest_n: f32,
    /// Upper quartile of the steepest steps.
    usual_n: Quantile,
    /// Sums of the steepest steps' scores, their cubes.
    falls: f32,
    rises: f32,
    squares: f32,
    /// Sum of the falls, each times its score, N.
    fall_n: f32,
}

impl TimeAsymmetry {
    pub(crate) const fn new() -> Self {
        Self {
            drift_n: 0.0,
            steepest_n: 0.0,
            usual_n: Quantile::new(0.75),
            falls: 0.0,
            rises: 0.0,
            squares: 0.0,
            fall_n: 0.0,
        }
    }

    /// Takes a step from one sample to the next.
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
        /// Larger steps are as good as this one, usual steps: no spike decides alone.
        const MOST: f32 = 3.0;
        self.usual_n.add(size_n);
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

    /// The usual fall in a sample, N, if falls are steeper than rises: by twice, and
    /// beyond any doubt.
    pub(crate) fn slip_n(&self) -> Option<f32> {
        /// Standard errors.
        const SURE: f32 = 3.0;
        let more = self.falls - self.rises;
        let sure = more > self.rises && more * more > SURE * SURE * self.squares;
        sure.then(|| self.fall_n / self.falls)
    }
}
