//! A force at zero after a slip: the cable hangs slack.
//!
//! The stick line starts only when the force has risen again; samples at zero carry no information
//! on the loading rate. A force that rises at once, or that never was near zero, starts its line at
//! once.

use crate::num::math::smaller;
use crate::sample::ForcePoint;

/// Rise that shows a taut cable, standard deviations of the noise: two samples in a row do not
/// reach it by chance.
const RISE: f32 = 5.0;
/// Upper limit of the rise that shows a taut cable, parts of the slip's drop: where the block never
/// rests only an upper bound of the noise is known.
const MOST_RISE: f32 = 0.25;
/// The cable may hang slack where a slip's lowest sample is less than this part of the drop from
/// zero: room for a small error of the cell's zero. Tuned, with little effect: half as much changes
/// no class of `docs/honesty.md`, twice as much moves two of them (`hum_20`, `falling`) in their
/// last digits.
const NEAR_ZERO: f32 = 0.1;
/// Part of the rise that is added to [`NEAR_ZERO`]: two standard deviations of the noise.
const NEAR: f32 = 0.4;
/// Part of a rise that is certainly due to loading since the cable became taut: the rest allows for
/// noise, one and a half standard deviations of it.
const SURE_PART: f32 = 0.7;

/// Number of samples at zero in a row that is too large for a turning point.
const LONG: u32 = 5;
/// Number of samples at zero beyond which this is no slack cable but another force level, which a
/// knock or a converter's overflow hid. A choice: a minute at 16 Hz.
const LONGEST: u32 = 1024;
/// Most periods by which the line starts before the rise is detected: the rate of the line before
/// is no guide where that line was flat.
const MOST_PERIODS: u32 = 24;

/// Waits for the force on a slack cable to rise.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SlackWait {
    mean_n: f32,
    count: u32,
    rise_n: f32,
    /// Did the last sample exceed the level at zero by the rise?
    above: bool,
}

impl SlackWait {
    /// Begins after a slip with this drop, N, if its lowest sample is near zero; else `None`.
    pub(crate) fn under(low: ForcePoint, drop_n: f32, std_n: f32) -> Option<Self> {
        let most_n = MOST_RISE * drop_n;
        let rise_n = smaller(most_n, RISE * std_n);
        let is_near = low.force_n.abs() < NEAR_ZERO * drop_n + NEAR * rise_n;
        is_near.then_some(Self { mean_n: low.force_n, count: 1, rise_n, above: false })
    }

    /// Has the force stayed at zero longer than any cable hangs slack after a slip?
    pub(crate) fn is_endless(self) -> bool {
        self.count > LONGEST
    }

    /// Has the force stayed down? A cell that reads no force below zero cuts the noise there.
    #[cold]
    pub(crate) fn is_long(self) -> bool {
        self.count >= LONG
    }

    /// Takes the next sample; gives the rise of the force, N, once two samples in a row show it.
    pub(crate) fn risen_n(&mut self, force_n: f32) -> Option<f32> {
        let height_n = force_n - self.mean_n;
        let was_above = core::mem::replace(&mut self.above, height_n > self.rise_n);
        if !self.above {
            self.count = self.count.saturating_add(1);
            self.mean_n += height_n / self.count as f32;
        }
        (self.above && was_above).then_some(height_n)
    }
}

/// Periods since the cable became taut, from its rise, N, and a loading rate, N per period.
pub(crate) fn periods_above(risen_n: f32, rate: f32) -> u32 {
    ((SURE_PART * risen_n / rate) as u32).min(MOST_PERIODS)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn floor(low_n: f32) -> Option<SlackWait> {
        SlackWait::under(ForcePoint { index: 7, force_n: low_n }, 600.0, 2.0)
    }

    #[test]
    fn only_a_slip_down_to_zero_is_waited_for() {
        for (low_n, waits) in [(-2.0, true), (0.0, true), (30.0, true), (200.0, false)] {
            assert_eq!(floor(low_n).is_some(), waits, "{low_n}");
        }
        assert!(
            SlackWait::under(ForcePoint { index: 7, force_n: 0.0 }, 600.0, f32::INFINITY).is_some()
        );
    }

    #[test]
    fn two_samples_in_a_row_are_a_rise_and_one_is_none() {
        let mut floor = floor(-1.0).unwrap();
        let forces_n = [1.0, 0.5, 40.0, -1.0, 2.0, 1.0, 15.0, 37.0];
        let risen = forces_n.map(|force_n| floor.risen_n(force_n));
        assert!(risen.iter().take(7).all(Option::is_none) && floor.is_long());
        assert!(risen[7].is_some_and(|height_n| (height_n - 37.0).abs() < 1.0), "{risen:?}");
        assert_eq!(periods_above(37.0, 10.0), 2);
        assert_eq!(periods_above(37.0, -1.0), 0);
    }
}
