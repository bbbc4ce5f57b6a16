//! The mean of a load at rest: a block on the tripod, the empty hook, a known weight.
//!
//! Readings go in one by one, in newtons or in codes; means of a quarter of a second are
//! kept for the last 64 s. A line and one sine are fitted to them together, so the mean is
//! that over whole periods wherever the record begins and ends.
//!
//! A swinging block weighs too much. With the angle `A cos(pi t / T)` of a pendulum of the
//! period `2 T` the cell, which measures along the cable, feels
//!
//! ```text
//! F / W = 3 cos(angle) - 2 cos(A) = 1 + A²/4 - 3/4 A² cos(2 pi t / T) + ...
//! ```
//!
//! so the excess of the mean is a third of the amplitude that is seen, and decays with it.
//! What is not seen is a swing in a circle, where the force does not change: then the mean
//! is too large by `A²/2` and nothing tells. Let the block swing in a plane, or calm it.

mod load;
mod sine;
mod window;

pub use load::{Load, Swing};
pub use sine::Oscillation;

use floe_core::num::math::{hypotenuse, larger, sqrt};
use sine::Fit;
pub use window::MEANS;
use window::Window;

/// Means a second that are kept.
const BLOCKS_PER_S: f32 = 4.0;
/// Shortest record that gives an answer, s.
const SHORTEST_S: f32 = 8.0;
/// A slope so many standard deviations from zero is one: by chance in one of a million.
const SURE: f32 = 5.0;
/// One of so many may be one, and counts in the standard deviation: by chance in one of 400.
const LIKELY: f32 = 3.0;
/// Root of a twelfth: standard deviation of what is anywhere along a drift.
const ALONG: f32 = 0.289;
/// A drift over the record that matters, as a part of the mean: half of what a weighing
/// of 0.02 % may be off.
const DRIFT_THAT_MATTERS: f32 = 1e-4;

/// Neighbouring means of a load that rests are hardly correlated; of one that is pulled,
/// carried or leant on they are, by more than this and by four of its standard deviations.
const MOVED: (f32, f32) = (0.5, 4.0);
/// What is moved matters when it makes the mean so uncertain, as a part of it.
const MOVE_THAT_MATTERS: f32 = 1e-3;

/// Readings of which one mean is kept, at so many a second.
#[must_use]
pub fn readings_a_mean(rate_hz: f32) -> u32 {
    ((rate_hz / BLOCKS_PER_S + 0.5) as u32).max(1)
}

/// Averages the readings of a load that rests or swings.
#[derive(Clone, Debug)]
pub struct Weighing {
    window: Window,
}

/// A load at rest. Forces are in the unit of the readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rest {
    /// Mean over the record, what a swing adds included.
    pub mean: f32,
    /// One standard deviation of the mean, from the readings' own scatter, and of a drift that is
    /// likely but not sure.
    pub std: f32,
    /// Standard deviation of a reading about the fit, as averaged over a quarter of a second.
    pub scatter: f32,
    /// The strongest oscillation, seen or not.
    pub oscillation: Oscillation,
    /// Length of the record that was used, s; 64 at most.
    pub duration_s: f32,
}

/// Why there is no answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unrest {
    /// Shorter than 8 s, or readings were missing for a quarter of a second lately.
    Short,
    /// The force rises or falls: its slope, unit of the readings a second.
    Drifts(f32),
    /// It moves otherwise than a block that swings by up to 15 degrees.
    Moves,
}

impl Weighing {
    /// Of readings at so many a second, 1 to 2000.
    #[must_use]
    pub fn new(rate_hz: f32) -> Self {
        Self { window: Window::new(readings_a_mean(rate_hz), rate_hz) }
    }

    /// Takes a reading, `None` for one that failed.
    pub fn add(&mut self, reading: Option<f32>) {
        self.window.add(reading);
    }

    /// Length of the record so far, s.
    #[must_use]
    pub fn duration_s(&self) -> f32 {
        self.window.len() as f32 * self.window.block_s()
    }

    /// The mean and its standard deviation; costs as much as some hundred thousand
    /// readings, so ask once a second.
    ///
    /// # Errors
    /// The load does not rest, or not for long enough.
    pub fn rest(&self) -> Result<Rest, Unrest> {
        if self.duration_s() < SHORTEST_S {
            return Err(Unrest::Short);
        }
        let fit = Fit::new(&self.window);
        let mean = self.window.origin() + fit.mean;
        let duration_s = self.duration_s();
        let slope_per_s = fit.slope / self.window.block_s();
        let drift = (slope_per_s * duration_s).abs();
        if fit.slope.abs() > SURE * fit.slope_std && drift > DRIFT_THAT_MATTERS * mean.abs() {
            return Err(Unrest::Drifts(slope_per_s));
        }
        let moved = fit.correlation > larger(MOVED.0, MOVED.1 / sqrt(self.window.len() as f32));
        if moved && fit.mean_std > MOVE_THAT_MATTERS * mean.abs() {
            return Err(Unrest::Moves);
        }
        let is_likely = fit.slope.abs() > LIKELY * fit.slope_std;
        let along = if is_likely { ALONG * drift } else { 0.0 };
        let (std, scatter) = (hypotenuse(fit.mean_std, along), sqrt(fit.variance));
        Ok(Rest { mean, std, scatter, oscillation: fit.oscillation, duration_s })
    }
}
