//! Is the slip over? Once the force has turned, the fall was a slip if the force stays below the
//! old stick line.

use crate::detector::Detector;
use crate::num::math::{self, larger, smaller};
use crate::sample::ForcePoint;
use crate::stats::significance::SURE;

/// Least rise that ends a slip at once, parts of the drop. Tuned: a lower value lets noise and flop
/// end long slips early, with a higher one a slip ends half its length after the lowest sample.
const CLEAR_RISE: f32 = 0.12;
/// Largest difference of two samples at zero, standard deviations of the noise: one normal sample
/// in 370 is further off.
const AS_LOW: f32 = 3.0;
/// A slip leaves the force lower by at least this part of its drop; a spike does not. Tuned: a slip
/// that is cut short by flop needs a low value, two spikes in a row a high one.
const LEAST_SHIFT: f32 = 0.4;
/// Number of samples before the highest one that lies before a spike of two.
const BEFORE_SPIKES: u32 = 3;
/// Part of the drop by which a slip without a line ends below the sample before its peak. Tuned
/// like [`LEAST_SHIFT`].
const LEAST_SHIFT_BRIEF: f32 = 0.1;

/// Gain of the running estimates of a slip's drop, fall and rise. Tuned: a larger gain follows each
/// slip, a smaller one takes longer than a few slips to adapt to another block.
const USUAL_GAIN: f32 = 0.25;

impl Detector {
    /// Has the force stopped falling?
    pub(super) fn turns(&self, now: ForcePoint) -> bool {
        let drop = self.stick.highest.force_n - self.lowest.force_n;
        let fall = self.lowest.index - self.stick.highest.index;
        let rise = now.force_n - self.lowest.force_n;
        let rises = rise > larger(SURE * self.std_n, CLEAR_RISE * drop);
        rises || now.index - self.lowest.index >= fall.div_ceil(2).max(2)
    }

    /// Is the force back on the old stick line, as after a spike? A force that has left its line
    /// before the slip, since the block creeps or the cable stiffens, has to be back on a parallel
    /// line through the highest sample, or through one before it: a spike is higher than that.
    pub(super) fn is_back(&self, now: ForcePoint, drop: f32) -> bool {
        if let Some(off_n) = self.off_line_n(now).filter(|_| self.line_fits()) {
            let peak_off_n = self.off_line_n(self.stick.highest).unwrap_or_default();
            let before = self.before_peak(BEFORE_SPIKES).and_then(|it| self.off_line_n(it));
            return off_n - smaller(peak_off_n, before.unwrap_or_default()) > -LEAST_SHIFT * drop;
        }
        let least_n = self.lowest.force_n + LEAST_SHIFT_BRIEF * drop;
        self.before_peak(1).is_some_and(|before| before.force_n < least_n)
    }

    /// The sample that lies `back` before the highest one, if it belongs to the same stick line.
    fn before_peak(&self, back: u32) -> Option<ForcePoint> {
        let index = self.stick.highest.index.checked_sub(back)?;
        let force_n = self.window.get(index).filter(|_| index >= self.stick.origin)?;
        Some(ForcePoint { index, force_n })
    }

    /// The first sample after the peak that equals the lowest one but for noise: on a slack cable
    /// all of them are at zero.
    pub(super) fn first_low(&self, peak: u32) -> ForcePoint {
        let limit_n = self.lowest.force_n + AS_LOW * self.std_n;
        let sample = |index| Some(ForcePoint { index, force_n: self.window.get(index)? });
        let low = (peak + 1..self.lowest.index).filter_map(sample).find(|s| s.force_n < limit_n);
        low.unwrap_or(self.lowest)
    }

    /// Updates the usual drop, N, and the usual fall, periods, by those of a slip.
    pub(super) fn update_usual(&mut self, drop: f32, fall: f32) {
        if self.usual_drop_n > 0.0 {
            let change = larger(drop - self.usual_drop_n, -0.5 * self.usual_drop_n);
            self.usual_drop_n = larger(self.usual_drop_n + USUAL_GAIN * change, 0.5 * drop);
            self.usual_fall += USUAL_GAIN * (fall - self.usual_fall);
        } else {
            self.usual_drop_n = drop;
            self.usual_fall = fall;
        }
        if let Some(rise) = self.rise(drop, fall) {
            let gain = if self.usual_rise > 0.0 { USUAL_GAIN } else { 1.0 };
            self.usual_rise += gain * (rise - self.usual_rise);
        }
        self.update_delay();
    }

    /// Periods from the onset to the highest force, `φ/ω` with `sin φ = 2 r / (ω drop)`; from the
    /// highest to the lowest force it is half a turn.
    fn rise(&self, drop: f32, fall: f32) -> Option<f32> {
        let swing = fall * core::f32::consts::FRAC_1_PI;
        let rise = swing * math::asin(2.0 * self.stick.line.slope()? * swing / drop);
        // `None` for a drop of zero, which a knock may leave.
        rise.is_finite().then_some(rise)
    }

    /// Examines samples that came before a peak or a re-stick was seen and belong to what follows:
    /// takes the highest, and ends the wait for a slack cable that is taut already.
    pub(super) fn look_back(&mut self, from: u32, now: u32) {
        for index in from..now + 1 {
            let Some(force_n) = self.window.get(index) else { continue };
            if force_n > self.stick.highest.force_n {
                self.stick.highest = ForcePoint { index, force_n };
            }
            if self.slack_wait.as_mut().is_some_and(|wait| wait.risen_n(force_n).is_some()) {
                self.slack_wait = None;
            }
        }
    }
}
