//! The load cell at the chip's inputs.

/// A load cell that plays a record: one ratio (output over excitation) per sampling period,
/// constant within the period.
#[derive(Clone, Debug)]
pub struct LoadCell {
    ratios: Vec<f64>,
    period_ns: u64,
    noise_codes: f64,
    connected: bool,
    random: u64,
}

impl LoadCell {
    /// A load cell from codes that a noiseless converter with gain 128 would give.
    #[must_use]
    pub fn from_codes(codes: &[i32], rate_hz: f64) -> Self {
        let full_scale = 128.0 * f64::from(1 << 23);
        Self {
            ratios: codes.iter().map(|&code| f64::from(code) / full_scale).collect(),
            period_ns: (1e9 / rate_hz).round() as u64,
            noise_codes: 0.0,
            connected: true,
            random: 1,
        }
    }

    /// Adds converter noise: standard deviation in codes, and a seed.
    #[must_use]
    pub fn with_noise(self, noise_codes: f64, seed: u64) -> Self {
        Self { noise_codes, random: seed, ..self }
    }

    /// The load cell with a broken wire.
    #[must_use]
    pub fn disconnected(self) -> Self {
        Self { connected: false, ..self }
    }

    pub(super) fn samples(&self) -> u64 {
        self.ratios.len() as u64
    }

    /// Index of the sample at a time since the first conversion.
    pub(super) fn sample_at(&self, since_ns: u64) -> u64 {
        (since_ns + self.period_ns / 2) / self.period_ns
    }

    /// End of a sample, as time since the first conversion.
    pub(super) fn end_ns(&self, sample: u64) -> u64 {
        sample.saturating_add(1).saturating_mul(self.period_ns) - self.period_ns / 2
    }

    /// Ratio at a time; the last sample is held after the end of the record.
    pub(super) fn ratio(&self, since_ns: u64, burn_out: bool) -> f64 {
        if !self.connected {
            return if burn_out { 1.0 } else { 0.0 };
        }
        let sample = usize::try_from(self.sample_at(since_ns)).unwrap_or(usize::MAX);
        self.ratios.get(sample).or(self.ratios.last()).copied().unwrap_or(0.0)
    }

    /// Random number, Gaussian to 3 %: the sum of 12 uniform numbers.
    pub(super) fn noise(&mut self) -> f64 {
        let sum: f64 = (0..12).map(|_| self.uniform()).sum();
        (sum - 6.0) * self.noise_codes
    }

    /// splitmix64.
    fn uniform(&mut self) -> f64 {
        self.random = self.random.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.random;
        z = (z ^ z >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ z >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ z >> 31) >> 11) as f64 / (1_u64 << 53) as f64
    }
}
