//! What the step of the readings leaves open of their mean.

use std::collections::VecDeque;
use std::f64::consts::PI;

/// Longest record that a weighing uses, s.
const LONGEST_S: f64 = 64.0;

/// The last readings, failed ones left out but counted.
#[derive(Clone, Debug)]
pub(super) struct Resolution {
    rate_hz: f64,
    forces_n: VecDeque<Option<f32>>,
}

impl Resolution {
    pub(super) fn new(rate_hz: f64) -> Self {
        Self { rate_hz, forces_n: VecDeque::new() }
    }

    pub(super) fn push(&mut self, force_n: Option<f32>) {
        self.forces_n.push_back(force_n);
        if self.forces_n.len() as f64 > LONGEST_S * self.rate_hz {
            self.forces_n.pop_front();
        }
    }

    /// One standard deviation of what the step adds to the mean of the last seconds, N; `None`
    /// where no reading differs from another.
    ///
    /// Noise of more than the step averages it out, with `exp(-2 pi² noise² / step²)`. Readings
    /// that change between two values tell no noise: they scatter by half a step at most.
    pub(super) fn std_n(&self, duration_s: f64) -> Option<f64> {
        let last = self.forces_n.iter().rev().take((duration_s * self.rate_hz).round() as usize);
        let forces: Vec<f64> = last.flatten().map(|&force_n| force_n.into()).collect();
        let differences = || {
            forces.windows(2).map(|pair| match pair {
                [a, b] => (a - b).abs(),
                _ => 0.0,
            })
        };
        let step_n = differences().filter(|&it| it > 0.0).min_by(f64::total_cmp)?;
        let squares = differences().map(|it| it * it).sum::<f64>();
        let scatter = squares / (2.0 * forces.len() as f64) / (step_n * step_n);
        let averaged = (-2.0 * PI * PI * (scatter - 0.25).max(0.0)).exp();
        Some(step_n / 12.0_f64.sqrt() * averaged)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn std_n(forces_n: impl Iterator<Item = f32>) -> Option<f64> {
        let mut resolution = Resolution::new(16.0);
        forces_n.for_each(|force_n| resolution.push(Some(force_n)));
        resolution.std_n(40.0)
    }

    #[test]
    fn a_step_counts_where_no_noise_averages_it_out() {
        let rarely = (0..640).map(|i: u16| if i.is_multiple_of(7) { 640.0 } else { 630.0 });
        assert!((std_n(rarely).expect("a step") - 2.887).abs() < 0.01);
        let noisy = (0..640).map(|i: u16| 630.0 + f32::from(i % 7 * (i % 7) % 7));
        assert!(std_n(noisy).expect("a step") < 1e-6);
        assert_eq!(std_n((0..640).map(|_| 630.0)), None);
        let before = (0..1280).map(|i: u16| if i < 640 { f32::from(i) } else { 630.0 });
        assert_eq!(std_n(before), None, "what came before the weighing tells nothing");
    }
}
