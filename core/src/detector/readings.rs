//! The detector's results for other modules, and what the events set in it.

use crate::detector::Detector;
use crate::sample::Phase;

impl Detector {
    /// What the block is doing.
    #[must_use]
    pub fn phase(&self) -> Phase {
        self.phase
    }

    /// The first index after the rest that a long gap, or a fall without end, has ended.
    pub(crate) fn lost(&self) -> u32 {
        self.ended.next + self.line_delay
    }

    /// Standard deviation of the noise, N, to about 10 %; `None` before it is known.
    pub(crate) fn noise_n(&self) -> Option<f32> {
        (self.std_n < f32::INFINITY).then_some(self.std_n)
    }

    /// Takes the noise, N, estimated from the residuals of all events so far; `believed` if the
    /// newest event has coefficients.
    pub(crate) fn fitted_noise(&mut self, noise_n: f32, believed: bool) {
        self.noise.add_fit(noise_n, believed);
    }

    /// Sets the force, N, that a constant force has to rise above before a slip; `None`: no limit.
    pub(crate) fn stays_below(&mut self, ceiling_n: Option<f32>) {
        self.ceiling_n = ceiling_n.unwrap_or(f32::NEG_INFINITY);
    }
}
