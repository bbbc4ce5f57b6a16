//! Is the slip over? Where the force has turned, it was a slip if the force stays below the
//! old stick line.

use crate::detector::Detector;
use crate::num::math::{self, larger, smaller};
use crate::sample::{ForcePoint, since};

/// Rise that ends a slip at once, standard deviations of the noise: of normal ones one in 16 000.
const SURE_RISE: f32 = 4.0;
/// Part of the drop that is enough where the noise is larger than that.
const MOST_RISE: f32 = 0.5;
/// Least part of the drop by which it has to rise. Tuned: a lower one lets noise and flop end long slips
/// early, a higher one waits for the half of a slip's length.
const CLEAR_RISE: f32 = 0.12;
/// A slip is too young to end before this part both of the usual fall and of the usual drop. A choice: a
/// quarter or three quarters change no class of `docs/honesty.md`.
const EARLY: f32 = 0.5;
/// Standard deviations of the noise by which samples differ that are all at zero: of normal ones one in
/// 370 is further off.
const AS_LOW: f32 = 3.0;
/// A slip leaves the force lower by at least this part of its drop; a spike does not. Tuned: a
/// slip that is cut short by flop needs a low one, two spikes in a row a high one.
const LEAST_SHIFT: f32 = 0.4;
/// Without a line: below the sample before the highest one. Tuned like the other.
const LEAST_SHIFT_BRIEF: f32 = 0.1;

/// Part of a slip's difference from the usual one that the usual one follows. Tuned: a larger
/// part follows each slip, a smaller one takes longer than a few slips to another block.
const USUAL_GAIN: f32 = 0.25;

impl Detector {
    /// Has the force stopped falling?
    pub(super) fn turns(&self, now: ForcePoint) -> bool {
        let drop = self.stick.highest.force_n - self.lowest.force_n;
        let fall = self.lowest.index - self.stick.highest.index;
        // All slips of a block take as long: in the first part of a long one noise turns the force as well.
        let elapsed = since(self.stick.highest.index, now.index);
        if drop < EARLY * self.usual_drop_n && elapsed < EARLY * self.usual_fall {
            return false;
        }
        let rise = now.force_n - self.lowest.force_n;
        let rises =
            rise > larger(smaller(SURE_RISE * self.std_n, MOST_RISE * drop), CLEAR_RISE * drop);
        rises || now.index - self.lowest.index >= fall.div_ceil(2).max(2)
    }

    /// Is the force back on the old stick line, as after a spike? A block that creeps leaves the line
    /// before it slips: then on the one through the highest sample.
    pub(super) fn is_back(&self, now: ForcePoint, drop: f32) -> bool {
        let off_n = self.off_line_n(now).filter(|_| self.line_fits());
        match (off_n, self.before_peak_n()) {
            (Some(off_n), _) => {
                let peak_off_n = self.off_line_n(self.stick.highest).unwrap_or_default();
                off_n - smaller(peak_off_n, 0.0) > -LEAST_SHIFT * drop
            }
            (None, Some(before_n)) => self.lowest.force_n > before_n - LEAST_SHIFT_BRIEF * drop,
            (None, None) => false,
        }
    }

    /// The sample before the highest one, N, if it is of the same stick line.
    fn before_peak_n(&self) -> Option<f32> {
        let index = self.stick.highest.index.checked_sub(1)?;
        self.window.get(index).filter(|_| index >= self.stick.origin)
    }

    /// The first sample after the peak that is as low as the lowest one, but for noise:
    /// on a slack cable all are at zero.
    pub(super) fn first_low(&self, peak: u32) -> ForcePoint {
        let limit_n = self.lowest.force_n + AS_LOW * self.std_n;
        let sample = |index| Some(ForcePoint { index, force_n: self.window.get(index)? });
        let low = (peak + 1..self.lowest.index).filter_map(sample).find(|s| s.force_n < limit_n);
        low.unwrap_or(self.lowest)
    }

    /// Takes a slip's drop, N, and fall, periods, into the usual ones.
    pub(super) fn update_usual(&mut self, drop: f32, fall: f32) {
        if self.usual_drop_n > 0.0 {
            // Not `clamp`, which panics at a limit that is no number.
            let change = smaller(larger(drop - self.usual_drop_n, -0.5 * self.usual_drop_n), drop);
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

    /// Periods from the onset to the highest force, `φ/ω` with `sin φ = 2 r / (ω drop)`: from the
    /// highest to the lowest it is half a turn.
    fn rise(&self, drop: f32, fall: f32) -> Option<f32> {
        let swing = fall * core::f32::consts::FRAC_1_PI;
        let rise = swing * math::asin(2.0 * self.stick.line.slope()? * swing / drop);
        // None of a drop of zero, as that of a knock may come out.
        rise.is_finite().then_some(rise)
    }

    /// Goes through the samples that came before a peak or a re-stick was seen, and belong to what
    /// follows it: for the highest of them, and for a cable that is taut already.
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
