//! The rate of the force, online.
//!
//! Both are centred on the middle of the last good samples. They see the rate of a
//! slip too small, because a slip is short: at angular frequency ω the answer is
//! the true rate times the attenuation.
//!
//! | method | weights | delay | attenuation at ω | noise of the rate |
//! |---|---|---|---|---|
//! | [`Central`] | (−1, 0, 1)/2 | 1 period | sin(ω dt)/(ω dt) | 0.71 σ/dt |
//! | [`LeastSquares`] | (−2, −1, 0, 1, 2)/10 | 2 periods | (sin ω dt + 2 sin 2ω dt)/(5 ω dt) | 0.32 σ/dt |
//!
//! DFF8-13 (ω dt = 1.18): 0.78 and 0.39. The paper uses the central difference;
//! the rates serve pictures and live values, the coefficients come from the fit.

/// A force and its rate at the same moment.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Rate {
    /// Index of the sample it belongs to.
    pub index: u32,
    /// Force of that sample, N.
    pub force_n: f32,
    /// Rate of the force, N/s.
    pub rate_n_per_s: f32,
}

/// Least-squares slope through `2 M + 1` samples in a row; `M` = 1 is the central
/// difference of the paper.
#[derive(Clone, Copy, Debug)]
pub struct Slope<const LEN: usize> {
    /// Newest last.
    forces_n: [f32; LEN],
    /// Samples in a row without a gap, of those before the newest; at most `LEN - 1`.
    filled: usize,
    /// Index of the next one in the row.
    next: u32,
    rate_hz: f32,
}

/// The paper's derivative: three samples.
pub type Central = Slope<3>;
/// The least-squares derivative: five samples.
pub type LeastSquares = Slope<5>;

impl<const LEN: usize> Slope<LEN> {
    /// For a sampling rate in hertz.
    #[must_use]
    pub fn new(rate_hz: f32) -> Self {
        Self { forces_n: [0.0; LEN], filled: 0, next: 0, rate_hz }
    }

    /// Takes a good sample; gives the rate at the middle of the last `LEN` ones, or
    /// `None` at the start and after a gap until enough are there in a row.
    pub fn step(&mut self, index: u32, force_n: f32) -> Option<Rate> {
        if index != self.next {
            self.filled = 0;
        }
        self.next = index.wrapping_add(1);
        self.forces_n.copy_within(1.., 0);
        if let Some(newest) = self.forces_n.last_mut() {
            *newest = force_n;
        }
        if self.filled < LEN - 1 {
            self.filled += 1;
            return None;
        }
        Some(self.rate())
    }

    fn rate(&self) -> Rate {
        let half = (LEN / 2) as f32;
        // Σ m² for m = −M..M is M (M + 1) (2 M + 1) / 3.
        let norm = half * (half + 1.0) * (2.0 * half + 1.0) / 3.0;
        let at = |place: usize| self.forces_n.get(place).copied().unwrap_or_default();
        let pair = |m: usize| m as f32 * (at(LEN / 2 + m) - at(LEN / 2 - m));
        Rate {
            index: self.next.wrapping_sub((LEN / 2 + 1) as u32),
            force_n: at(LEN / 2),
            rate_n_per_s: (1..=LEN / 2).map(pair).sum::<f32>() / norm * self.rate_hz,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn attenuation<const LEN: usize>(omega_dt: f32) -> f32 {
        let mut slope = Slope::<LEN>::new(16.0);
        (0..40)
            .filter_map(|i| slope.step(i, (omega_dt * i as f32).sin()))
            .map(|rate| {
                rate.rate_n_per_s / (omega_dt * 16.0 * (omega_dt * rate.index as f32).cos())
            })
            .last()
            .unwrap()
    }

    #[test]
    fn both_attenuate_as_stated() {
        for w in [0.2_f32, 0.7, 1.1828] {
            let central = w.sin() / w;
            let squares = (w.sin() + 2.0 * (2.0 * w).sin()) / (5.0 * w);
            assert!((attenuation::<3>(w) - central).abs() < 1e-4);
            assert!((attenuation::<5>(w) - squares).abs() < 1e-4);
        }
        assert!((attenuation::<3>(1.1828) - 0.78).abs() < 0.005);
        assert!((attenuation::<5>(1.1828) - 0.393).abs() < 0.005);
    }

    #[test]
    fn a_line_is_exact_whatever_its_offset_and_a_gap_starts_anew() {
        let mut slope = LeastSquares::new(10.0);
        let line = |i: u32| 3000.0 + 0.5 * i as f32;
        let rates: [Option<f32>; 5] =
            core::array::from_fn(|i| slope.step(i as u32, line(i as u32)).map(|r| r.rate_n_per_s));
        assert_eq!(rates[..4], [None; 4]);
        assert!((rates[4].unwrap() - 5.0).abs() < 1e-3);
        assert!(slope.step(6, line(6)).is_none());
    }
}
