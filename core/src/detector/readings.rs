//! The detector's results for other modules, and what the events set in it.

use crate::detector::{Detector, Stick};
use crate::sample::{ForcePoint, Phase};
use crate::signal::window::Window;

impl Detector {
    /// Work of the newest step beyond that of one at rest, in units of 160 instructions on the
    /// board.
    pub(crate) fn spent(&self) -> usize {
        self.spent
    }

    /// What the block is doing.
    #[must_use]
    pub fn phase(&self) -> Phase {
        self.phase
    }

    /// The newest sample looked at.
    pub(crate) fn last(&self) -> ForcePoint {
        self.last
    }

    /// The last samples.
    pub(crate) fn window(&self) -> &Window {
        &self.window
    }

    /// The stick line since the last re-stick.
    pub(crate) fn stick(&self) -> &Stick {
        &self.stick
    }

    /// The stick line before the last slip, or before the last long gap.
    pub(crate) fn ended(&self) -> &Stick {
        &self.ended
    }

    /// The first index after the rest that a long gap, or a fall without end, has ended.
    pub(crate) fn lost(&self) -> u32 {
        self.ended.next + self.line_delay
    }

    /// Standard deviation of the noise, N, to about 10 %; infinite before it is known.
    pub(crate) fn std_n(&self) -> f32 {
        self.std_n
    }

    /// Standard deviation of the noise, N, to about 10 %; `None` before it is known.
    pub(crate) fn noise_n(&self) -> Option<f32> {
        (self.std_n < f32::INFINITY).then_some(self.std_n)
    }

    /// Usual drop of a slip, N; zero before the first.
    pub(crate) fn usual_drop_n(&self) -> f32 {
        self.usual_drop_n
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
