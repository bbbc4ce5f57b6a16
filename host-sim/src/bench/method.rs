//! Input and output of a method.

/// Information for every method before the first sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setup {
    /// Samples per second.
    pub rate_hz: f64,
    /// Weight of the block, N.
    pub weight_n: f64,
    /// Slope of the ice, rad.
    pub slope_rad: f64,
    /// Largest force of the cell, N; higher readings are not forces.
    pub range_n: Option<f64>,
}

impl Setup {
    /// `mu_s` from `Fs`, or `mu` from `Fp` (26 to 28).
    #[must_use]
    pub fn coefficient(&self, force_n: f64) -> f64 {
        let (sin, cos) = self.slope_rad.sin_cos();
        (force_n / self.weight_n - sin) / cos
    }

    /// The coefficient as an estimate, with the standard deviation of the force, N, if the method
    /// states one; `None` if it is not finite.
    #[must_use]
    pub fn value(&self, force_n: f64, std_n: Option<f64>) -> Option<Value> {
        let value = self.coefficient(force_n);
        let std = std_n.map(|std_n| std_n * self.per_newton());
        value.is_finite().then_some(Value { value, std })
    }

    /// Change of a coefficient per newton.
    #[must_use]
    pub fn per_newton(&self) -> f64 {
        1.0 / (self.weight_n * self.slope_rad.cos())
    }

    /// Whether a reading is within the range of forces.
    #[must_use]
    pub fn is_force(&self, force_n: f32) -> bool {
        self.range_n.is_none_or(|range_n| f64::from(force_n) < range_n)
    }
}

/// One sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// Number of the sampling period.
    pub index: u32,
    /// Force, N.
    pub force_n: f32,
}

/// An estimate of a coefficient.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Value {
    /// The estimate.
    pub value: f64,
    /// Standard deviation, if the method states one.
    pub std: Option<f64>,
}

/// An event that a method found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// Onset of the slip, s.
    pub onset_s: f64,
    /// Static coefficient, if the method determines it.
    pub mu_s: Option<Value>,
    /// Dynamic coefficient, if the method determines it.
    pub mu: Option<Value>,
}

/// Result of a sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tick {
    /// Whether the method reports that the block slips.
    pub slips: bool,
    /// An event that is now complete.
    pub event: Option<Found>,
}

/// A method that finds events in samples.
pub trait Method {
    /// Name in the tables.
    const NAME: &'static str;
    /// Whether the method answers during the record; otherwise it keeps all samples and answers at
    /// the end.
    const STREAMS: bool = true;

    /// State before the first sample.
    fn new(setup: &Setup) -> Self;

    /// Takes a sample.
    fn step(&mut self, sample: Sample) -> Tick;

    /// Returns the remaining events after the last sample, one per call.
    fn finish(&mut self) -> Option<Found> {
        None
    }

    /// Bytes that the method keeps between samples.
    fn state_bytes(&self) -> usize;
}
