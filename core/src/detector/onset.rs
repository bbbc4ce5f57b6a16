//! Does a slip begin? The limits of an onset: multiples of the noise, and parts of the drops
//! seen so far.

use crate::detector::Detector;
use crate::detector::stick_line::LINE_POINTS;
use crate::num::math::larger;
use crate::sample::{ForcePoint, Phase, periods_between};

/// Innovation beyond which a sample is not on the line, standard deviations of the noise: exceeded
/// by one normal sample in 5e8, and the noise is known to about 10 %.
pub(super) const OFF_LINE: f32 = 6.0;
/// Least drop of the first slip, standard deviations of the noise: more than later, since there is
/// no usual drop to compare with. Tuned: with 6 noise with a correlation of .9 is taken for slips
/// more than twice as often, with 8 one scene in 350 of `--example plane` has no event for it.
pub const FIRST_DROP: f32 = 8.0;
/// Least drop of a slip once the usual drop is known, or without a line, standard deviations of the
/// noise: as [`OFF_LINE`].
const LEAST_DROP: f32 = 6.0;
/// Least drop of a slip that starts from a stick line in the upper half of the usual range, parts of
/// the usual drop: a part of the contact may slip alone. Tuned: a higher value misses partial slips,
/// a lower one takes ripple for them.
const LEAST_PART: f32 = 0.05;
/// Least drop of a slip in the upper half without a line, where one sample that is too high would
/// feign a smaller drop, and in the lower half from a line, soon after another slip; parts of the
/// usual drop. Tuned: with 0.35 one in 300 of small slips after rests of two samples is missed
/// (`tests/detection.rs`), with 0.1 fits of slips every eight to ten samples get worse, and a real
/// recording has one fall more that is no slip.
const LEAST_PART_CLEAR: f32 = 0.2;
/// Least drop of a slip that starts in the lower half of the usual range without a line, or where
/// cables flop, which begins there, parts of the usual drop. Tuned: a lower value takes flop for
/// slips.
const LEAST_PART_LOW: f32 = 0.5;
/// Least fall within one sample, parts of the usual drop, that shows a slip whatever the line. Tuned:
/// with .2 slips of 16 samples in as many of rest are cut in two.
const LEAST_FALL: f32 = 0.3;
/// Part of that by which the sample before the last one has to be higher as well: one sample that is
/// too high feigns no fall. Less than one, since the line rises.
const FROM_EARLIER: f32 = 0.7;
/// Samples on the first line beyond which a quick fall is a slip whatever the line: of slips that
/// recur faster none is missed for so long. Tuned: with 34 one in 150 is lost in real recordings with
/// seven to twelve samples a slip.
const LONG_LINE: u32 = 64;
/// Number of samples that show the noise of single ones, and two more: to a sixth.
const LOOKED_AT: u32 = 34;
/// Mean of |second difference| over the noise, `√(6 · 2/π)`.
const SECOND: f32 = 1.954;
/// Most samples by which a slip is detected late: going back over them takes 16 of the 62 units of
/// time of a step.
pub(super) const FARTHEST: i32 = 32;
/// Largest fall, usual drops, that is taken for a slip beforehand: a larger one is more likely a
/// spike. Only the displayed phase depends on it.
const LARGEST_DROP: f32 = 1.1;

impl Detector {
    /// Has the force left the stick line downwards, by more than noise and flop explain?
    pub(super) fn slips(&self, now: ForcePoint) -> bool {
        let drop = self.stick.highest.force_n - now.force_n;
        // No slip has a smaller drop than either of these two: they decide most samples.
        drop > 0.0
            && (drop >= LEAST_DROP * self.std_n && self.leaves_line(now, drop)
                || (self.usual_drop_n > 0.0 || self.stick.line.count > LONG_LINE)
                    && drop >= LEAST_FALL * self.usual_drop_n
                    && self.falls_at_once(now))
            && self.stick.highest.force_n > self.ceiling_n
    }

    /// Has the force fallen within one sample by more than the noise of single samples, and far more
    /// than in the sample before? A slip that was missed bends the line and enlarges the scatter
    /// about it, so that the next one would be missed as well, and the force of a cable that
    /// stiffens lies far above its line: such a fall is seen whatever the line.
    fn falls_at_once(&self, now: ForcePoint) -> bool {
        let before = |samples: u32| self.window.get(now.index.saturating_sub(samples));
        let (Some(last_n), Some(earlier_n)) = (before(1), before(2)) else { return false };
        let (fall_n, is_first) = (last_n - now.force_n, self.usual_drop_n <= 0.0);
        let least_n = if is_first {
            FIRST_DROP * self.noise.quick_n()
        } else {
            LEAST_FALL * self.usual_drop_n
        };
        let falls = |least_n: f32| {
            fall_n > larger(least_n, 2.0 * (earlier_n - last_n))
                && earlier_n - now.force_n > FROM_EARLIER * least_n
        };
        falls(least_n)
            && (self.is_high() || !self.flops())
            && (is_first || falls(OFF_LINE * self.quick_n(now.index)))
    }

    /// Standard deviation of the noise of single samples, N, by the second differences of the samples
    /// before this one: what changes slowly is not in it. Those of half a usual drop are slips.
    /// Infinite without any, as after a gap.
    fn quick_n(&self, now: u32) -> f32 {
        let (mut sum_n, mut count) = (0.0, 0.0);
        let (mut last, mut next) = (f32::NAN, f32::NAN);
        for back in 1..LOOKED_AT {
            let n = self.window.get(now.saturating_sub(back)).unwrap_or(f32::NAN);
            let second_n = (n - 2.0 * next + last).abs();
            // False for NaN as well.
            if second_n < 0.5 * self.usual_drop_n {
                (sum_n, count) = (sum_n + second_n, count + 1.0);
            }
            (last, next) = (next, n);
        }
        let known = count > 0.0;
        if known { larger(sum_n / (count * SECOND), self.noise.step_n()) } else { f32::INFINITY }
    }

    /// Does the force come from the upper half of its usual range? A cable flops in the lower one.
    fn is_high(&self) -> bool {
        self.stick.highest.force_n > self.middle_n
    }

    fn leaves_line(&self, now: ForcePoint, drop: f32) -> bool {
        drop >= self.least_drop()
            // Without a line, after a brief rest, the drop alone decides.
            && self.depth(now).is_none_or(|depth| depth > OFF_LINE * self.std_n)
    }

    /// Least drop of a slip, N.
    fn least_drop(&self) -> f32 {
        let (stick, std, usual) = (&self.stick, self.std_n, self.usual_drop_n);
        let has_line = stick.line.count >= LINE_POINTS;
        if usual <= 0.0 {
            // A record may begin in the middle of a slip: that slip is not looked for.
            return match self.line_fits() {
                true if has_line => FIRST_DROP * std,
                false if stick.highest.index > stick.origin => LEAST_DROP * std,
                _ => f32::INFINITY,
            };
        }
        let part = match (has_line, self.is_high()) {
            (true, true) => LEAST_PART,
            (false, true) => LEAST_PART_CLEAR,
            (true, false) if !self.flops() => LEAST_PART_CLEAR,
            _ => LEAST_PART_LOW,
        };
        larger(LEAST_DROP * std, part * usual)
    }

    /// Depth of a sample below the stick line, N, over the standard deviation of its innovation in
    /// units of a sample's: as significant as the same depth of one sample below a known line.
    /// `None` with fewer than four samples on the line.
    fn depth(&self, now: ForcePoint) -> Option<f32> {
        let off_n = self.off_line_n(now)?;
        Some(-off_n / self.spread(now.index))
    }

    /// Sets the peak to the highest sample since the force last lay on the line. Where the force
    /// rises by less than its noise, the highest sample of the rest may lie long before the slip.
    pub(super) fn find_peak(&mut self, now: u32) {
        let most = periods_between(self.stick.highest.index, now).clamp(0, FARTHEST);
        self.spent += most as usize / 2;
        for back in 1..most {
            let index = now - back as u32;
            let force_n = self.window.get(index).unwrap_or(f32::NEG_INFINITY);
            let off_n = self.off_line_n(ForcePoint { index, force_n });
            if off_n > Some(-self.std_n) {
                self.stick.highest = ForcePoint { index, force_n };
                return self.look_back(index + 1, now);
            }
        }
    }

    /// Is the sample far above all earlier ones and above the stick line, as several spikes in a
    /// row are?
    pub(super) fn jumps(&self, now: ForcePoint) -> bool {
        let far = OFF_LINE * self.std_n;
        // The spread is one or more: most samples are decided without it.
        let is_above = |off_n| off_n > far && off_n > far * self.spread(now.index);
        now.force_n > self.stick.highest.force_n + far && self.off_line_n(now).is_some_and(is_above)
    }

    /// Would this sample begin a slip if it came next and were no spike? Asked before it is judged;
    /// changes nothing. A fall much larger than the usual drop is more likely a spike.
    pub(crate) fn foresees_slip(&self, next: ForcePoint) -> bool {
        let drop = self.stick.highest.force_n - next.force_n;
        drop > 0.0
            && self.phase == Phase::Stick
            && !self.is_behind
            && drop < LARGEST_DROP * self.usual_drop_n
            && self.slips(next)
    }
}
