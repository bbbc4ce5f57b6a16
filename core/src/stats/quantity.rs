//! A quantity and its uncertainty.

/// A number with its standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Quantity {
    /// The number.
    pub value: f32,
    /// One standard deviation.
    pub std: f32,
}

impl Quantity {
    /// In another unit.
    #[must_use]
    pub fn times(self, factor: f32) -> Self {
        Self { value: factor * self.value, std: factor.abs() * self.std }
    }
}
