//! Correlated noise about a slip's stick lines, and the oscillation about them.

use core::ops::Range;

use crate::cycle::slip_record::SlipRecord;
use crate::detector::Stick;
use crate::noise::ripple::ColoredNoise;
use crate::noise::sinusoid::{self, AboutLine, Sinusoid};
use crate::sample::since;
use crate::signal::window::Window;
use crate::stats::line::Line;

impl SlipRecord {
    /// Does the force depart from its lines by a bend or an oscillation?
    pub(crate) fn wanders(&self) -> bool {
        self.wander.level > 0.0 || self.wander.is_disputed()
    }

    /// Part of the white noise in the mean square of all residuals. Only the residuals about the
    /// line contain the wander.
    pub(crate) fn white_share(&self) -> f32 {
        let line = self.before.count as f32;
        let part = line / (line + self.length as f32);
        1.0 - part * (1.0 - self.wander.white_share())
    }

    /// Estimates the oscillation about the line before the slip, of `angle` rad a period.
    pub(crate) fn take_oscillation(&mut self, window: &Window, stick: &Stick, angle: f32) {
        self.wander.update(|wander| wander.angle = angle);
        let from = stick.next.saturating_sub(sinusoid::MOST).max(stick.origin);
        self.oscillation = self.oscillation_about(&self.before, window, from..stick.next).into();
    }

    /// The oscillation about a line, estimated from the samples of a range.
    pub(crate) fn oscillation_about(
        &self,
        line: &Line,
        window: &Window,
        range: Range<u32>,
    ) -> Sinusoid {
        let ColoredNoise { angle, unsure, .. } = *self.wander;
        let (from, length) = (range.start, range.end.saturating_sub(range.start));
        let start = since(self.origin, from);
        let samples = AboutLine { line, window, from, length, start };
        Sinusoid::new(&samples, angle, self.wander.noise_part() / unsure)
    }
}
