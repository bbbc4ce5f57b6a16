//! What hangs there, without what its swing adds.

use floe_core::num::math::{atan2, hypotenuse, sqrt};

use super::{Rest, Unrest};

/// `sin²(A/2)` of the widest swing, 15 degrees: up to there the series holds to 0.001 %.
const WIDEST: f32 = 0.017;
/// Rounds of excess from load and load from excess; each gains two digits.
const ROUNDS: u32 = 3;

/// A load on the hook, in the unit of the readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load {
    /// What hangs there, the excess of its swing taken off; negative if the readings fall
    /// when something is hung there.
    pub value: f32,
    /// One standard deviation: the mean's, the excess's, and what a swing that is not seen
    /// may add. Not the zero's and not the span's.
    pub std: f32,
    /// The swing, if it is seen.
    pub swing: Option<Swing>,
}

/// A swing in a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Swing {
    /// Period, there and back, s.
    pub period_s: f32,
    /// Largest angle, rad; a damped one's mean over the record.
    pub amplitude_rad: f32,
    /// What it added to the mean, about `A²/4` of the load, in the unit of the readings.
    pub excess: f32,
}

impl Rest {
    /// The load above a zero.
    ///
    /// # Errors
    /// [`Unrest::Moves`] if it swings by more than 15 degrees, or is no hanging load.
    pub fn load(&self, zero: f32) -> Result<Load, Unrest> {
        let mean = self.mean - zero;
        let oscillation = self.oscillation;
        if !oscillation.is_seen {
            // Anything from nothing to the strongest that was found.
            let unseen = oscillation.amplitude / 3.0 * UNIFORM;
            return Ok(Load { value: mean, std: hypotenuse(self.std, unseen), swing: None });
        }
        let (k2, excess) = excess(mean.abs(), oscillation.amplitude).ok_or(Unrest::Moves)?;
        let swing = Swing {
            period_s: 2.0 * oscillation.period_s,
            amplitude_rad: 2.0 * atan2(sqrt(k2), sqrt(1.0 - k2)),
            excess: excess.copysign(mean),
        };
        let std = hypotenuse(self.std, oscillation.amplitude_std / 3.0);
        Ok(Load { value: mean - swing.excess, std, swing: Some(swing) })
    }
}

/// Root of a third: standard deviation of what is anywhere between nothing and one, about
/// nothing.
const UNIFORM: f32 = 0.577;

/// `sin²(A/2)` and the excess, from the mean and the amplitude: `amplitude = 3 k² load`,
/// `excess = (k² - 3/8 k⁴) load`, from the elliptic integrals of a pendulum.
fn excess(mean: f32, amplitude: f32) -> Option<(f32, f32)> {
    let (mut k2, mut excess) = (0.0, 0.0);
    for _ in 0..ROUNDS {
        let load = mean - excess;
        k2 = amplitude / (3.0 * load);
        if !(0.0..=WIDEST).contains(&k2) {
            return None;
        }
        excess = k2 * (1.0 - 0.375 * k2) * load;
    }
    Some((k2, excess))
}
