//! The load on the hook, corrected for its swing.

use floe_core::num::math::{atan2, hypotenuse, sqrt};

use super::{Rest, Unrest};

/// `sin²(A/2)` of the largest amplitude, 15 degrees; up to it the series is accurate to 0.001 %.
const WIDEST: f32 = 0.017;
/// Iterations between excess and load; each gains two digits.
const ROUNDS: u32 = 3;

/// A load on the hook, in the unit of the readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load {
    /// The mean minus the excess of the swing; negative if the readings fall under a load.
    pub value: f32,
    /// Standard deviation from the mean, the excess and an undetected swing; without those of zero
    /// and span.
    pub std: f32,
    /// The swing, if one is detected.
    pub swing: Option<Swing>,
}

/// A swing in a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Swing {
    /// Full period of the swing, s.
    pub period_s: f32,
    /// Amplitude, rad; its mean over the record if it decays.
    pub amplitude_rad: f32,
    /// Increase of the mean by the swing, about `A²/4` of the load, in the unit of the readings.
    pub excess: f32,
}

impl Rest {
    /// The load above a zero.
    ///
    /// # Errors
    /// [`Unrest::Moves`] if the swing exceeds 15 degrees, or is not that of a hanging load.
    pub fn load(&self, zero: f32) -> Result<Load, Unrest> {
        let mean = self.mean - zero;
        let oscillation = self.oscillation;
        if !oscillation.is_seen {
            // The swing may have any strength from none to that of the strongest oscillation found.
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

/// `sqrt(1/3)`: root mean square of a uniform distribution from 0 to 1.
const UNIFORM: f32 = 0.577;

/// `k² = sin²(A/2)` and the excess, from mean and amplitude: `amplitude = 3 k² load`,
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
