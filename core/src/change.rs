//! Have the forces gone to another level?
//!
//! Friction scatters and wanders from event to event; a change is more than that:
//! half of the last eight events' `Fs` or `Fp`, the middle half, lie elsewhere than
//! the events before, by several times what such differences have been so far. The
//! scale is learnt from the differences themselves, so it knows the scatter, the
//! wandering and the drifts of this very test.

use crate::event::SampleTime;

/// Why the forces changed, as far as the events tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
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
pub struct Change {
    /// Index of the first event after the change.
    pub event: u32,
    /// Onset of that event.
    pub onset: SampleTime,
    /// What changed.
    pub cause: Cause,
    /// Weight in use from there on over the given one.
    pub weight_ratio: f32,
    /// Its standard deviation, common to all coefficients from there on.
    pub weight_ratio_std: f32,
}

/// Events that make a level.
const RECENT: usize = 8;
/// Events over which the past fades, and its differences.
const MEMORY: f32 = 24.0;
/// Events before which there is nothing to differ from.
const FEWEST: f32 = 8.0;
/// Squared scales by which both levels together have to differ.
const FAR: f32 = 49.0;
/// A smaller relative difference is not worth telling.
const LEAST: f32 = 0.05;

/// The level of one force.
#[derive(Clone, Copy, Debug, Default)]
struct Level {
    /// The last values, oldest first, N.
    recent: [f32; RECENT],
    /// Mean of those before, N.
    before: f32,
    /// Mean square of a value's distance from it, and of the recent level's, N².
    scatter: f32,
    difference: f32,
}

impl Level {
    /// Takes a value; `count` values have left the recent ones so far.
    fn add(&mut self, value: f32, count: f32) {
        let [oldest, rest @ ..] = self.recent;
        let share = 1.0 / (count + 1.0).min(MEMORY);
        if count >= 0.0 {
            let off = oldest - self.before;
            self.before += share * off;
            self.scatter += share * (off * off * (1.0 - share) - self.scatter);
        }
        self.recent = [value; RECENT];
        self.recent.iter_mut().zip(rest).for_each(|(to, from)| *to = from);
        self.difference += share * (self.off() * self.off() - self.difference);
    }

    /// Mean of the middle half of the recent values, less the mean before, N.
    fn off(&self) -> f32 {
        let mut sorted = self.recent;
        sorted.sort_unstable_by(f32::total_cmp);
        let middle = sorted.iter().skip(RECENT / 4).take(RECENT / 2);
        middle.sum::<f32>() / (RECENT / 2) as f32 - self.before
    }

    /// Squared difference in units of the usual one.
    fn score(&self) -> f32 {
        // Independent events: the middle half of eight, and the mean before.
        const INDEPENDENT: f32 = 0.15 + 1.0 / MEMORY;
        let usual = self.difference.max(INDEPENDENT * self.scatter);
        if usual > 0.0 { self.off() * self.off() / usual } else { 0.0 }
    }

    fn is_worth_telling(&self) -> bool {
        self.off().abs() > LEAST * self.before.abs()
    }
}

/// Follows the levels of `Fs` and `Fp`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Levels {
    /// Values taken since the last change.
    taken: f32,
    forces: [Level; 2],
}

impl Levels {
    /// Takes an event's forces; tells how many events ago they changed, if so.
    pub fn take(&mut self, static_n: f32, dynamic_n: f32) -> Option<u32> {
        let left = self.taken - RECENT as f32;
        let before = self.forces;
        for (level, value) in self.forces.iter_mut().zip([static_n, dynamic_n]) {
            level.add(value, left);
        }
        self.taken += 1.0;
        let score = self.forces.iter().fold(0.0, |sum, level| sum + level.score());
        if left < FEWEST || score < FAR || !self.forces.iter().any(Level::is_worth_telling) {
            return None;
        }
        let _ = before;
        let ago = self.since();
        *self = Self::default();
        Some(ago)
    }

    /// Nothing before counts any more.
    pub fn forget(&mut self) {
        *self = Self::default();
    }

    /// How many of the recent events in a row lie nearer to the new level.
    fn since(&self) -> u32 {
        let worst = self.forces.iter().max_by(|a, b| a.score().total_cmp(&b.score()));
        worst.map_or(0, |level| {
            let off = level.off();
            let is_new = |value: &&f32| (**value - level.before) * off > 0.5 * off * off;
            level.recent.iter().rev().take_while(is_new).count() as u32
        })
    }
}
