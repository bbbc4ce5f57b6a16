//! Detection of a change in the level of the forces.
//!
//! Friction scatters and wanders between events. A change is larger: the mean of the middle half of
//! the last eight events' `Fs` or `Fp` differs from the mean before them by several times the root
//! mean square of such differences so far. That scale is estimated from the differences themselves,
//! so it includes the scatter, the wander and the drifts of this test.

use crate::num::math::{larger, smaller};
use crate::sample::SampleTime;
use crate::stats::running_mean::RunningMean;

/// Why the forces changed, as far as the events determine it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Cause {
    /// The block's mass changed, since omega did.
    Mass,
    /// Omega is the same: the friction changed.
    Friction,
    /// The stiffness or the winch changed, or omega is not resolved.
    Unknown,
}

/// A change that the estimate follows.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Change {
    /// Index of the first event after the change.
    pub event: u32,
    /// Onset of that event; of a change found by the level of the forces, the onset of the event
    /// that showed it.
    pub onset: SampleTime,
    /// What changed.
    pub cause: Cause,
    /// Weight in use from that event on, over the given one.
    pub weight_ratio: f32,
    /// Standard deviation of the ratio, common to all coefficients from that event on.
    pub weight_ratio_std: f32,
}

/// Number of events in a level: two outliers on either side do not shift the mean of their middle
/// half.
const RECENT: usize = 8;
/// Memory, in events, of the mean before and of the mean squared differences. The variance of this
/// mean, 1/24 of an event's, is then well below that of the level compared with it, .15. More
/// events follow less of a wander.
const MEMORY: f32 = 24.0;
/// Number of events in the mean before, from which on a level is compared with it: as many as in a
/// level.
const FEWEST: f32 = 8.0;
/// Sum of both forces' squared differences, each over its mean square, beyond which the level has
/// changed: seven standard deviations. Few levels determine the mean square, and every event is
/// tested.
const FAR_SQUARED: f32 = 49.0;
/// Ratio of a squared difference to the mean square at which it is clipped for the mean: two
/// standard deviations.
const MOST_USUAL: f32 = 4.0;
/// Least relative change that is reported, the same as for a change of the mass (`LEAST` in
/// `mass_change/swings.rs`).
const LEAST: f32 = 0.05;

/// The level of one force.
#[derive(Clone, Copy, Debug, Default)]
struct Level {
    /// The last values, oldest first, N.
    recent: [f32; RECENT],
    /// The values before those, N.
    before: RunningMean,
    /// Mean of the middle half of the recent values, less `before`, N.
    off: f32,
    /// Mean square of `off`, N².
    difference: f32,
}

impl Level {
    /// Adds a value. `left` is the number of values that have left the recent ones since the last
    /// change, `compared` the number of levels compared in the test.
    fn add(&mut self, value: f32, left: f32, compared: f32) {
        let oldest = shifted(&mut self.recent, value);
        if left < 0.0 {
            return;
        }
        self.before.add(oldest, 1.0 / smaller(left + 1.0, MEMORY));
        if left >= FEWEST {
            self.off = middle_half(&self.recent) - self.before.mean;
            let share = 1.0 / smaller(compared + 1.0, MEMORY);
            // A change of level must not enter its own scale: large squares are clipped.
            let square = smaller(self.off * self.off, MOST_USUAL * self.usual());
            self.difference += share * (square - self.difference);
        }
    }

    /// Expected square of `off`, N²: the mean so far, or that of independent events if it is
    /// larger.
    fn usual(&self) -> f32 {
        // Variances of the middle half of eight normal values, and of the mean before.
        const INDEPENDENT: f32 = 0.15 + 1.0 / MEMORY;
        larger(self.difference, INDEPENDENT * self.before.variance)
    }

    /// Resets the level, except the mean square of the differences.
    fn forget(&mut self) {
        *self = Self { difference: self.difference, ..Self::default() };
    }

    /// Squared difference over its expected value.
    fn score(&self) -> f32 {
        let usual = self.usual();
        if usual > 0.0 { self.off * self.off / usual } else { 0.0 }
    }

    /// Number of newest events in a row that lie nearer to the new level than to the old one.
    fn since(&self) -> usize {
        let off = self.off;
        let is_new = |value: &&f32| (**value - self.before.mean) * off > 0.5 * off * off;
        self.recent.iter().rev().take_while(is_new).count()
    }

    fn is_reportable(&self) -> bool {
        self.off.abs() > LEAST * self.before.mean.abs()
    }
}

/// Appends a value, and returns the first one, which leaves.
fn shifted<T: Copy>(values: &mut [T; RECENT], newest: T) -> T {
    let [oldest, rest @ ..] = *values;
    *values = [newest; RECENT];
    values.iter_mut().zip(rest).for_each(|(to, from)| *to = from);
    oldest
}

/// Mean of the middle half of the values.
fn middle_half(values: &[f32; RECENT]) -> f32 {
    let mut sorted = *values;
    for count in 1..RECENT {
        let (before, rest) = sorted.split_at_mut(count);
        let Some(mut next) = rest.first_mut() else { continue };
        for earlier in before.iter_mut().rev() {
            if *earlier <= *next {
                break;
            }
            core::mem::swap(earlier, next);
            next = earlier;
        }
    }
    let [_, _, middle @ .., _, _] = sorted;
    0.25 * middle.into_iter().sum::<f32>()
}

/// The levels of `Fs` and `Fp`.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Levels {
    /// Values added since the last change; and levels compared in the test, also before a change.
    taken: f32,
    compared: f32,
    static_n: Level,
    dynamic_n: Level,
    /// Numbers of the recent events, oldest first: events without coefficients are not among them.
    numbers: [u32; RECENT],
}

/// A change of the level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct NewLevel {
    /// Number of the first event of the new level.
    pub event: u32,
    /// `Fp` before, N.
    pub dynamic_before_n: f32,
}

impl Levels {
    /// Adds the forces of the event with this number. Returns `None` unless the level has changed.
    pub(crate) fn take(
        &mut self,
        event: u32,
        (static_n, dynamic_n): (f32, f32),
    ) -> Option<NewLevel> {
        let left = self.taken - RECENT as f32;
        shifted(&mut self.numbers, event);
        self.taken += 1.0;
        self.static_n.add(static_n, left, self.compared);
        self.dynamic_n.add(dynamic_n, left, self.compared);
        if left < FEWEST {
            return None;
        }
        self.compared += 1.0;
        let (a, b) = (&self.static_n, &self.dynamic_n);
        if a.score() + b.score() < FAR_SQUARED || !(a.is_reportable() || b.is_reportable()) {
            return None;
        }
        let worst = if a.score() > b.score() { a } else { b };
        // The newest event is of the new level as well.
        let first = self.numbers.iter().rev().nth(worst.since().saturating_sub(1));
        let shift =
            NewLevel { event: first.copied().unwrap_or(event), dynamic_before_n: b.before.mean };
        self.forget();
        Some(shift)
    }

    /// Drops all values, except the mean squares of the differences.
    pub(crate) fn forget(&mut self) {
        self.taken = 0.0;
        self.static_n.forget();
        self.dynamic_n.forget();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Scatter of a tenth, the same every time.
    fn force(i: usize, level_n: f32) -> f32 {
        let noise = ((i * i * 31 + i * 17) % 101) as f32 / 50.0 - 1.0;
        level_n * (1.0 + 0.17 * noise)
    }

    /// Events at which changes are found, and the first event of the new level of each.
    fn shifts_of(forces: impl Iterator<Item = f32>) -> impl Iterator<Item = (usize, usize)> {
        let mut levels = Levels::default();
        // Every other event has no coefficients.
        forces.enumerate().filter_map(move |(i, force_n)| {
            let shift = levels.take(2 * i as u32, (1.6 * force_n, force_n))?;
            Some((i, shift.event as usize / 2))
        })
    }

    #[test]
    fn a_new_level_is_told_within_eight_events() {
        let mut shifts = shifts_of((0..80).map(|i| force(i, if i < 40 { 490.0 } else { 250.0 })));
        let (at, since) = shifts.next().unwrap();
        assert!((43..48).contains(&at) && since == 40, "{at} {since}");
        assert_eq!(shifts.next(), None);
    }

    #[test]
    fn scatter_drift_and_single_events_are_no_change() {
        assert_eq!(shifts_of((0..400).map(|i| force(i, 490.0))).count(), 0);
        assert_eq!(shifts_of((0..400).map(|i| force(i, 490.0 + i as f32))).count(), 0);
        let odd = |i: usize| force(i, if i % 10 == 7 { 150.0 } else { 490.0 });
        assert_eq!(shifts_of((0..400).map(odd)).count(), 0);
    }
}
