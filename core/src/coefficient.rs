//! Coefficients from forces, and the means over them.

use crate::model;
use crate::num::math;
use crate::stats::student::t95;

/// A coefficient and its standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Coefficient {
    /// The estimate.
    pub value: f32,
    /// One standard deviation of this event's estimate, the random part alone.
    pub std: f32,
    /// One standard deviation of what is the same in all events: the inputs (weight, slope, zero,
    /// span, damping), a drift of the zero and a changed weight. See [`crate::budget()`].
    pub systematic_std: f32,
}

impl Coefficient {
    /// Without a systematic part.
    #[must_use]
    pub const fn random(value: f32, std: f32) -> Self {
        Self { value, std, systematic_std: 0.0 }
    }

    /// Standard deviation of the random and the systematic part together.
    #[must_use]
    pub fn combined_std(&self) -> f32 {
        math::hypotenuse(self.std, self.systematic_std)
    }

    /// The 95 % interval of a normal distribution: the noise is known from many samples.
    #[must_use]
    pub fn ci95(&self) -> (f32, f32) {
        let half = t95(f32::INFINITY) * self.combined_std();
        (self.value - half, self.value + half)
    }
}

/// Mean of a coefficient over the events of a test.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Estimate {
    /// Mean.
    pub mean: f32,
    /// Standard error of the mean, the random part alone, with the variation between events. `None`
    /// with one event, which carries no information on that variation.
    pub std_error: Option<f32>,
    /// Degrees of freedom of `std_error`.
    pub freedom: f32,
    /// Standard deviation of what is the same in all events, which no number of them
    /// averages out.
    pub systematic_std: f32,
    /// The part of `systematic_std` that is due to no input: parameters that the model estimates
    /// from the events, assumptions that all of them rest on, and the events without coefficients.
    pub common_std: f32,
    /// Standard deviation between events, noise removed; needs two events.
    pub spread: Option<f32>,
    /// How many events count.
    pub events: u32,
}

impl Estimate {
    /// Standard deviation of the random and the systematic part together; `None` with one event.
    #[must_use]
    pub fn combined_std(&self) -> Option<f32> {
        self.std_error.map(|random| math::hypotenuse(random, self.systematic_std))
    }

    /// The 95 % interval by Student's t, its degrees of freedom by Welch and Satterthwaite: those
    /// of the systematic part are unlimited. `None` with one event.
    #[must_use]
    pub fn ci95(&self) -> Option<(f32, f32)> {
        let (random, combined) = self.std_error.zip(self.combined_std())?;
        // At most a thousand: where nothing is random the degrees of freedom hardly matter.
        let ratio = combined / math::larger(random, 1e-3 * combined);
        let half = t95(self.freedom * ratio * ratio * ratio * ratio) * combined;
        Some((self.mean - half, self.mean + half))
    }
}

/// Given quantities of a test, which turn forces into coefficients.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Site {
    /// Weight of the block, N.
    pub weight_n: f32,
    /// Mass of the block times the speed of the winch, N periods; NaN where that speed is not
    /// known.
    pub momentum: f32,
    /// Sine and cosine of the slope of the ice.
    pub slope: (f32, f32),
    /// Samples per second.
    pub rate_hz: f32,
}

impl Site {
    /// The coefficient of a force with its variance, N² (26 to 28).
    pub(crate) fn coefficient(&self, force_n: f32, variance_n2: f32) -> Coefficient {
        let value = model::coefficient(force_n, self.weight_n, self.slope);
        Coefficient::random(value, self.std(variance_n2))
    }

    /// Standard deviation of a coefficient whose force has a variance, N².
    pub(crate) fn std(&self, variance_n2: f32) -> f32 {
        math::sqrt(variance_n2) / (self.weight_n * self.slope.1)
    }
}
