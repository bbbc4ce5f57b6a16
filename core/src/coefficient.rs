//! Forces as coefficients, and the means over them.

use crate::model;
use crate::num::math;

/// A coefficient and its standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Coefficient {
    /// The estimate.
    pub value: f32,
    /// One standard deviation of this event's estimate.
    pub std: f32,
}

impl Coefficient {
    /// With one more independent error of such a standard deviation.
    pub(crate) fn widen(&mut self, std: f32) {
        self.std = math::hypotenuse(self.std, std);
    }
}

/// Mean of a coefficient over the events of a test.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Estimate {
    /// Mean.
    pub mean: f32,
    /// Standard error of the mean, including the variation between events.
    pub std_error: f32,
    /// Standard deviation between events, noise removed; needs two events.
    pub spread: Option<f32>,
    /// How many events count.
    pub events: u32,
}

impl Estimate {
    /// With one more independent error of such a standard deviation.
    pub(crate) fn widened(self, std: f32) -> Self {
        Self { std_error: math::hypotenuse(self.std_error, std), ..self }
    }
}

/// What turns forces into coefficients.
#[derive(Clone, Copy, Debug)]
pub struct Site {
    /// Weight of the block, N.
    pub weight_n: f32,
    /// Sine and cosine of the slope of the ice.
    pub slope: (f32, f32),
    /// Relative standard deviation of the weight; zero for the given one.
    pub weight_spread: f32,
    /// Samples per second.
    pub rate_hz: f32,
}

impl Site {
    /// A force and its variance as a coefficient (26 to 28).
    pub(crate) fn coefficient(&self, force_n: f32, variance_n2: f32) -> Coefficient {
        Coefficient {
            value: model::coefficient(force_n, self.weight_n, self.slope),
            std: math::sqrt(variance_n2) / (self.weight_n * self.slope.1),
        }
    }

    /// Standard deviation of a force's coefficient because of the weight's, and of a
    /// variance that the events share.
    pub(crate) fn common_std(&self, force_n: f32, shared_n2: f32) -> f32 {
        let weight_n = self.weight_spread * force_n;
        math::sqrt(weight_n * weight_n + shared_n2) / (self.weight_n * self.slope.1)
    }

    /// The same with the weight's uncertainty in the standard deviation.
    pub(crate) fn whole(&self, force_n: f32, variance_n2: f32) -> Coefficient {
        let mut whole = self.coefficient(force_n, variance_n2);
        whole.widen(self.common_std(force_n, 0.0));
        whole
    }
}
