//! What the fits need to know of colored noise.

use core::ops::Deref;

use crate::effect::{Effect, Kept};
use crate::num::math::larger;

/// Departures of the force from its line; variances in units of that of the white noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ColoredNoise {
    /// Variance of the force about the line.
    pub level: f32,
    /// Variance of the force's slope, per period squared.
    pub slope: f32,
    /// Part of a sample's variance about the line that is an oscillation of few samples, or a bend
    /// that is not quite the same in all rests. It may be the cell's instead of the cable's: the
    /// end of a line gives the force no better than to that variance.
    pub unsure: f32,
    /// Noise with correlated neighbours: relative increase of the variance of a line over that
    /// under white noise.
    pub line_excess: f32,
    /// Angle of an oscillation that may be the cable's or the cell's, rad a period; zero if none.
    pub angle: f32,
    /// All rests have the same bend: it is in the force.
    pub bends: bool,
    /// All rests are bent down in their last samples: the block may creep before it slips.
    pub creeps: bool,
}

/// Colored noise; where its effect is not compiled in, none, which is known at compile time.
pub(crate) type Wander = Kept<ColoredNoise, { Effect::Ripple.room() }>;

impl Deref for Wander {
    type Target = ColoredNoise;

    #[inline(always)]
    fn deref(&self) -> &ColoredNoise {
        self.get().unwrap_or(&ColoredNoise::NONE)
    }
}

impl ColoredNoise {
    /// A straight line with white noise.
    pub(crate) const NONE: Self = Self {
        level: 0.0,
        slope: 0.0,
        unsure: 0.0,
        line_excess: 0.0,
        angle: 0.0,
        bends: false,
        creeps: false,
    };

    /// Does the force depart from its lines by white noise alone?
    pub(crate) fn is_none(&self) -> bool {
        self.level + self.line_excess + self.unsure <= 0.0
    }

    /// Is there an oscillation that may be the cable's or the cell's?
    pub(crate) fn is_disputed(&self) -> bool {
        self.angle > 0.0
    }

    /// White noise's part of the variance about lines with an oscillation that is not followed.
    pub(crate) fn noise_part(&self) -> f32 {
        // Every oscillation comes with some noise.
        const LEAST: f32 = 0.01;
        larger(1.0 - self.unsure, LEAST)
    }

    /// White noise's part of the variance of a sample about the line.
    pub(crate) fn white_share(&self) -> f32 {
        1.0 / (1.0 + self.level)
    }
}
