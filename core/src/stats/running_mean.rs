//! A running mean and the scatter about it.

/// Mean of a quantity over recent values, and their mean squared distance from it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct RunningMean {
    pub mean: f32,
    pub variance: f32,
}

impl RunningMean {
    /// Takes a value, whose part of the mean is `share`: one for the first.
    pub(crate) fn add(&mut self, value: f32, share: f32) {
        let off = value - self.mean;
        self.mean += share * off;
        self.variance += share * (off * off * (1.0 - share) - self.variance);
    }
}
