//! Mean of a load at rest: a block on the tripod, the empty hook, a known weight.
//!
//! Readings are in newtons or codes; means over a quarter of a second are kept for the last 64 s. A
//! line and one sine are fitted to them together, which gives the mean over whole periods for a
//! record of any length.
//!
//! The mean of a swinging block is too large. For a pendulum of period `2 T` at the angle
//! `A cos(pi t / T)`, the cell, which measures along the cable, reads
//!
//! ```text
//! F / W = 3 cos(angle) - 2 cos(A) = 1 + A²/4 - 3/4 A² cos(2 pi t / T) + ...
//! ```
//!
//! The excess of the mean is therefore a third of the visible amplitude, and decays with it. A
//! swing in a circle is not visible, because the force is constant: the mean is too large by `A²/2`
//! without any sign. Let the block swing in a plane, or calm it.

mod load;
mod sine;
mod window;

pub use load::{Load, Swing};
pub use sine::Oscillation;

use floe_core::num::math::{larger, sqrt};
use sine::Fit;
pub use window::MEANS;
use window::Window;

/// Means kept per second.
const BLOCKS_PER_S: f32 = 4.0;
/// Shortest record with a result, s.
const SHORTEST_S: f32 = 8.0;
/// Standard deviations from zero above which a slope is significant: by chance one in a million.
const SURE: f32 = 5.0;
/// Smallest drift over the record that matters, relative to the mean: half of the error allowed for
/// a weighing to 0.02 %.
const DRIFT_THAT_MATTERS: f32 = 1e-4;

/// Smallest correlation of neighbouring means of a load that is pulled, carried or leant on: the
/// first value, and the second in its standard deviations. Means of a load at rest are nearly
/// uncorrelated.
const MOVED: (f32, f32) = (0.5, 4.0);
/// Smallest relative standard deviation of the mean at which such a movement matters.
const MOVE_THAT_MATTERS: f32 = 1e-3;

/// Number of readings in one mean, at a sampling rate in Hz.
#[must_use]
pub fn readings_a_mean(rate_hz: f32) -> u32 {
    ((rate_hz / BLOCKS_PER_S + 0.5) as u32).max(1)
}

/// Averages the readings of a load at rest or swinging.
#[derive(Clone, Debug)]
pub struct Weighing {
    window: Window,
}

/// Result for a load at rest. Forces are in the unit of the readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rest {
    /// Mean over the record, including the excess of a swing.
    pub mean: f32,
    /// Standard deviation of the mean, from the scatter of the readings.
    pub std: f32,
    /// Standard deviation about the fit, of readings averaged over a quarter of a second.
    pub scatter: f32,
    /// The strongest oscillation, detected or not.
    pub oscillation: Oscillation,
    /// Length of the record used, s; 64 at most.
    pub duration_s: f32,
}

/// Why there is no result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unrest {
    /// The record is shorter than 8 s, or was interrupted by a quarter of a second without a
    /// reading.
    Short,
    /// The force rises or falls; its slope in the unit of the readings per second.
    Drifts(f32),
    /// The load moves in another way than by a swing of up to 15 degrees.
    Moves,
}

impl Weighing {
    /// Starts with readings at a rate of 1 to 2000 Hz.
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

    /// The mean and its standard deviation. Costs as much as some hundred thousand readings: call
    /// it once a second.
    ///
    /// # Errors
    /// The load is not at rest, or the record is too short.
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
        let (std, scatter) = (fit.mean_std, sqrt(fit.variance));
        Ok(Rest { mean, std, scatter, oscillation: fit.oscillation, duration_s })
    }
}
