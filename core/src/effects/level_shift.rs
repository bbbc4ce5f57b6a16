//! Have the forces gone to another level?
//!
//! Friction scatters and wanders from event to event; a change is more than that: the middle half
//! of the last eight events' `Fs` or `Fp` lies elsewhere than the events before, by several times
//! what such differences have been so far. The scale is learnt from the differences themselves, so
//! it knows the scatter, the wandering and the drifts of this very test.

use crate::num::math::{larger, smaller};
use crate::sample::SampleTime;

/// Why the forces changed, as far as the events tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Cause {
    /// The block's mass changed: so says omega.
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
    /// Onset of that event; where the level of the forces tells it, of the event that did.
    pub onset: SampleTime,
    /// What changed.
    pub cause: Cause,
    /// Weight in use from there on over the given one.
    pub weight_ratio: f32,
    /// Its standard deviation, common to all coefficients from there on.
    pub weight_ratio_std: f32,
}

/// Events that make a level: two that are far off, to either side, do not move their middle half.
const RECENT: usize = 8;
/// Events over which the mean before, and the usual differences, fade: so many that this mean is surer
/// than the level that is compared with it (1/24 of the variance and .15). More follow less of what
/// wanders.
const MEMORY: f32 = 24.0;
/// Events before which there is no mean to differ from: as many as make a level.
const FEWEST: f32 = 8.0;
/// Sum of both forces' squared differences, over their usual squares, beyond which the level
/// changed: seven standard deviations. Few levels tell what is usual, and every event is asked.
const FAR_SQUARED: f32 = 49.0;
/// Such a square beyond which a difference is no longer learnt as a usual one: two standard deviations.
const MOST_USUAL: f32 = 4.0;
/// A smaller relative difference is not worth telling: as with a change of the mass (`LEAST` in
/// `mass_change/swings.rs`).
const LEAST: f32 = 0.05;

/// The level of one force.
#[derive(Clone, Copy, Debug, Default)]
struct Level {
    /// The last values, oldest first, N.
    recent: [f32; RECENT],
    /// Mean of the values before those, N.
    before: f32,
    /// Mean of the middle half of the recent values, less that mean, N.
    off: f32,
    /// Mean squares of a value's distance from the mean before, and of `off`, N².
    scatter: f32,
    difference: f32,
}

impl Level {
    /// Takes a value. `left` is the number of values that have left the recent ones since the last
    /// change, `compared` that of the levels compared in all.
    fn add(&mut self, value: f32, left: f32, compared: f32) {
        let [oldest, rest @ ..] = self.recent;
        self.recent = [value; RECENT];
        self.recent.iter_mut().zip(rest).for_each(|(to, from)| *to = from);
        if left < 0.0 {
            return;
        }
        let (share, off) = (1.0 / smaller(left + 1.0, MEMORY), oldest - self.before);
        self.before += share * off;
        self.scatter += share * (off * off * (1.0 - share) - self.scatter);
        if left >= FEWEST {
            self.off = middle_half(&self.recent) - self.before;
            let share = 1.0 / smaller(compared + 1.0, MEMORY);
            // A change is not usual: what exceeds the usual by far counts for less.
            let square = smaller(self.off * self.off, MOST_USUAL * self.usual());
            self.difference += share * (square - self.difference);
        }
    }

    /// Usual square of `off`, N²: the one that was seen, or that of independent events if it is more.
    fn usual(&self) -> f32 {
        // Variances of the middle half of eight normal values, and of the mean before.
        const INDEPENDENT: f32 = 0.15 + 1.0 / MEMORY;
        larger(self.difference, INDEPENDENT * self.scatter)
    }

    /// Starts anew, but for the usual difference.
    fn forget(&mut self) {
        *self = Self { difference: self.difference, ..Self::default() };
    }

    /// Squared difference in units of the usual one.
    fn score(&self) -> f32 {
        let usual = self.usual();
        if usual > 0.0 { self.off * self.off / usual } else { 0.0 }
    }

    /// How many of the recent events in a row lie nearer to the new level.
    fn since(&self) -> u32 {
        let off = self.off;
        let is_new = |value: &&f32| (**value - self.before) * off > 0.5 * off * off;
        self.recent.iter().rev().take_while(is_new).count() as u32
    }

    fn is_worth_telling(&self) -> bool {
        self.off.abs() > LEAST * self.before.abs()
    }
}

/// Mean of the middle half of the values.
fn middle_half(values: &[f32; RECENT]) -> f32 {
    let rank = |value: f32, place: usize| {
        values.iter().zip(0..).filter(|&(&other, at)| (other, at) < (value, place)).count()
    };
    let ranked =
        values.iter().zip(0..).filter(|&(&value, place)| (2..6).contains(&rank(value, place)));
    0.25 * ranked.map(|(value, _)| value).sum::<f32>()
}

/// Follows the levels of `Fs` and `Fp`.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Levels {
    /// Values taken since the last change, and levels compared in all, which outlast a change.
    taken: f32,
    compared: f32,
    static_n: Level,
    dynamic_n: Level,
}

/// Where the levels changed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct NewLevel {
    /// Number of events since the first one of the new level.
    pub events_ago: u32,
    /// `Fp` before, N.
    pub dynamic_before_n: f32,
}

impl Levels {
    /// Takes an event's forces; `None` unless the level has changed.
    pub(crate) fn take(&mut self, static_n: f32, dynamic_n: f32) -> Option<NewLevel> {
        let left = self.taken - RECENT as f32;
        self.taken += 1.0;
        self.static_n.add(static_n, left, self.compared);
        self.dynamic_n.add(dynamic_n, left, self.compared);
        if left < FEWEST {
            return None;
        }
        self.compared += 1.0;
        let (a, b) = (&self.static_n, &self.dynamic_n);
        if a.score() + b.score() < FAR_SQUARED || !(a.is_worth_telling() || b.is_worth_telling()) {
            return None;
        }
        let worst = if a.score() > b.score() { a } else { b };
        // The newest event is of the new level as well.
        let events_ago = worst.since().saturating_sub(1);
        let shift = NewLevel { events_ago, dynamic_before_n: b.before };
        self.forget();
        Some(shift)
    }

    /// Nothing before counts any more, but how much the levels usually differ.
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

    /// Where changes are told, and since when.
    fn told(forces: impl Iterator<Item = f32>) -> impl Iterator<Item = (usize, usize)> {
        let mut levels = Levels::default();
        forces.enumerate().filter_map(move |(i, force_n)| {
            let shift = levels.take(1.6 * force_n, force_n)?;
            Some((i, i - shift.events_ago as usize))
        })
    }

    #[test]
    fn a_new_level_is_told_within_eight_events() {
        let mut shifts = told((0..80).map(|i| force(i, if i < 40 { 490.0 } else { 250.0 })));
        let (at, since) = shifts.next().unwrap();
        assert!((43..48).contains(&at) && since == 40, "{at} {since}");
        assert_eq!(shifts.next(), None);
    }

    #[test]
    fn scatter_drift_and_single_events_are_no_change() {
        assert_eq!(told((0..400).map(|i| force(i, 490.0))).count(), 0);
        assert_eq!(told((0..400).map(|i| force(i, 490.0 + i as f32))).count(), 0);
        let odd = |i: usize| force(i, if i % 10 == 7 { 150.0 } else { 490.0 });
        assert_eq!(told((0..400).map(odd)).count(), 0);
    }
}
