//! How far samples scatter around the stick line, learnt online.
//!
//! The running median of the innovations' size, moved by a constant factor up or
//! down: no threshold in newtons, no division, and neither slips nor spikes can
//! carry it away. Good to about 10 %, for the detector's limits; what is reported
//! comes from the residuals of the fits.

/// Running robust standard deviation.
#[derive(Clone, Copy, Debug, Default)]
pub struct Noise {
    /// Median of the innovations' absolute value, N.
    median_n: f32,
    /// Smallest step between samples that was seen, N: the resolution.
    resolution_n: f32,
    count: u32,
}

/// Median of |x| over the standard deviation, for a normal distribution.
const MEDIAN_PER_STD: f32 = 0.674_49;
/// Final step of the median: settles to 8 % within a hundred samples.
const SMALLEST_GAIN: f32 = 0.04;

impl Noise {
    /// Takes an innovation, already divided by its own spread relative to a sample.
    pub fn add(&mut self, innovation_n: f32) {
        let size = innovation_n.abs();
        if self.count == 0 {
            self.median_n = size;
        }
        self.count = self.count.saturating_add(1);
        let gain = (2.0 / self.count as f32).clamp(SMALLEST_GAIN, 0.5);
        if size > self.median_n {
            // Zero (a noiseless start) could not grow by a factor alone.
            self.median_n = (self.median_n * (1.0 + gain)).max(1e-3 * size);
        } else {
            self.median_n /= 1.0 + gain;
        }
    }

    /// Takes the difference of two neighbouring samples.
    pub fn see_step(&mut self, step_n: f32) {
        let step = step_n.abs();
        if step > 0.0 && (self.resolution_n <= 0.0 || step < self.resolution_n) {
            self.resolution_n = step;
        }
    }

    /// Standard deviation, N: never below the resolution's own, nor below the
    /// rounding of a force of this size. `None` until eight innovations were seen.
    #[must_use]
    pub fn std_n(&self, force_n: f32) -> Option<f32> {
        let floor = (0.3 * self.resolution_n).max(4e-7 * force_n.abs());
        (self.count >= 8).then(|| (self.median_n / MEDIAN_PER_STD).max(floor))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Approximately normal numbers from a fixed recurrence.
    fn normal(state: &mut u32) -> f32 {
        (0..12).fold(-6.0, |sum, _| {
            *state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            sum + (*state >> 8) as f32 / 16_777_216.0
        })
    }

    #[test]
    fn settles_on_the_standard_deviation_whatever_its_size() {
        for std in [1e-4, 2.0, 300.0] {
            let (mut noise, mut state) = (Noise::default(), 7);
            (0..2000).for_each(|_| noise.add(std * normal(&mut state)));
            let mean: f32 = (0..500)
                .map(|_| {
                    noise.add(std * normal(&mut state));
                    noise.std_n(0.0).unwrap() / 500.0
                })
                .sum();
            assert!((mean / std - 1.0).abs() < 0.1, "{mean} {std}");
        }
    }

    #[test]
    fn a_wild_start_and_later_outliers_do_not_stay() {
        let (mut noise, mut state) = (Noise::default(), 9);
        noise.add(1e4);
        (0..300).for_each(|i| noise.add(if i % 20 == 0 { 500.0 } else { normal(&mut state) }));
        let std = noise.std_n(0.0).unwrap();
        assert!((0.6..1.6).contains(&std), "{std}");
    }

    #[test]
    fn coarse_steps_set_a_floor() {
        let mut noise = Noise::default();
        (0..50).for_each(|_| noise.add(0.0));
        noise.see_step(5.0);
        assert!(noise.std_n(0.0).unwrap() >= 1.5);
    }
}
