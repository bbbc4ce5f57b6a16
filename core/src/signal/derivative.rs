//! The rate of the force, online: the paper's central difference.
//!
//! `(F₊ − F₋)/2 dt`, centred on the middle of the last three good samples: a delay of one period,
//! and noise of 0.71 σ/dt. It underestimates the rate in a slip, which is short: at the angular
//! frequency ω its gain is `sin(ω dt)/(ω dt)`, 0.78 for DFF8-13 (ω dt = 1.18). The rates serve
//! plots and live values, the coefficients come from the fit.

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

/// The paper's derivative: three samples.
#[derive(Clone, Copy, Debug)]
pub struct Central {
    /// The last two forces without a gap after them, N, newest last; NaN is none.
    forces_n: [f32; 2],
    /// Index that continues the row without a gap.
    next: u32,
    rate_hz: f32,
}

impl Central {
    /// For a sampling rate in hertz.
    #[must_use]
    pub fn new(rate_hz: f32) -> Self {
        Self { forces_n: [f32::NAN; 2], next: 0, rate_hz }
    }

    /// Takes a good sample; gives the rate at the middle of the last three, or `None` at the start
    /// and after a gap until three are there in a row.
    pub fn step(&mut self, index: u32, force_n: f32) -> Option<Rate> {
        if index != self.next {
            self.forces_n = [f32::NAN; 2];
        }
        self.next = index.wrapping_add(1);
        let [before_n, middle_n] = self.forces_n;
        self.forces_n = [middle_n, force_n];
        let rate_n_per_s = 0.5 * (force_n - before_n) * self.rate_hz;
        let rate = Rate { index: index.wrapping_sub(1), force_n: middle_n, rate_n_per_s };
        (!before_n.is_nan()).then_some(rate)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn attenuation(omega_dt: f32) -> f32 {
        let mut slope = Central::new(16.0);
        (0..40)
            .filter_map(|i| slope.step(i, (omega_dt * i as f32).sin()))
            .map(|rate| {
                rate.rate_n_per_s / (omega_dt * 16.0 * (omega_dt * rate.index as f32).cos())
            })
            .last()
            .unwrap()
    }

    #[test]
    fn it_attenuates_as_stated() {
        for w in [0.2_f32, 0.7, 1.1828] {
            assert!((attenuation(w) - w.sin() / w).abs() < 1e-4);
        }
        assert!((attenuation(1.1828) - 0.78).abs() < 0.005);
    }

    #[test]
    fn a_line_is_exact_whatever_its_offset_and_a_gap_starts_anew() {
        let mut slope = Central::new(10.0);
        let line = |i: u32| 3000.0 + 0.5 * i as f32;
        assert!(slope.step(0, line(0)).is_none() && slope.step(1, line(1)).is_none());
        let rate = slope.step(2, line(2)).unwrap();
        assert_eq!((rate.index, rate.force_n), (1, line(1)));
        assert!((rate.rate_n_per_s - 5.0).abs() < 1e-3);
        assert!(slope.step(4, line(4)).is_none());
    }
}
