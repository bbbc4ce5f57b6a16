//! The pull against a post: the cable's stiffness from a line through force and
//! take-up, the paper's Fig. 8.

use serde::Serialize;

/// Part of the largest force from which the cable is straight enough.
const FROM: f64 = 0.2;
/// Part of the largest force up to which the winch has not slowed down.
const TO: f64 = 0.95;
/// Fewest samples for a line with an uncertainty.
const FEWEST: usize = 8;

/// A value with one standard deviation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Measured {
    /// The value.
    pub value: f64,
    /// One standard deviation.
    pub std_error: f64,
}

/// The winch and the cable of the pull.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pull {
    /// Take-up speed, m/s.
    pub winch_m_per_s: Measured,
    /// Free length of the cable, m.
    pub cable_length_m: Option<Measured>,
}

/// What the pull tells.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Stiffness {
    /// `k = F' / w`, N/m.
    pub stiffness_n_per_m: Measured,
    /// `AE = k L`, N; `null` without the length.
    pub ae_n: Option<Measured>,
    /// `F'`, N/s.
    pub loading_rate_n_per_s: Measured,
    /// Scatter about the line, N.
    pub residual_n: f64,
    /// Samples on the line.
    pub samples: usize,
    /// First and last force of the line, N.
    pub range_n: (f64, f64),
}

/// Fits the straight part of a pull, from 20 to 95 % of the largest force, given
/// as (time in s, force in N) in order; `None` if too few samples rise.
///
/// The uncertainty of the line counts samples whose residuals go together as
/// fewer: `n (1 - r)/(1 + r)` with `r` the correlation of neighbours. What a
/// bent line hides (sag, creep of the splices) is not in it.
#[must_use]
pub fn stiffness(samples: &[(f64, f64)], pull: &Pull) -> Option<Stiffness> {
    let line = straight_part(samples);
    let rate = fit(line)?;
    let k = product(rate.slope, pull.winch_m_per_s, |rate, w| rate / w);
    Some(Stiffness {
        stiffness_n_per_m: k,
        ae_n: pull.cable_length_m.map(|length| product(k, length, |k, l| k * l)),
        loading_rate_n_per_s: rate.slope,
        residual_n: rate.residual_n,
        samples: line.len(),
        range_n: (line.first()?.1, line.last()?.1),
    })
}

/// A product or quotient: relative variances add.
fn product(a: Measured, b: Measured, combine: impl Fn(f64, f64) -> f64) -> Measured {
    let value = combine(a.value, b.value);
    let relative = (a.std_error / a.value).hypot(b.std_error / b.value);
    Measured { value, std_error: value.abs() * relative }
}

/// The samples on the way up to the largest force.
fn straight_part(samples: &[(f64, f64)]) -> &[(f64, f64)] {
    let largest_n = samples.iter().map(|s| s.1).fold(0.0, f64::max);
    let end = samples.iter().position(|s| s.1 >= TO * largest_n).unwrap_or(0);
    let rise = samples.get(..end).unwrap_or_default();
    let start = rise.iter().rposition(|s| s.1 < FROM * largest_n).map_or(0, |i| i + 1);
    rise.get(start..).unwrap_or_default()
}

struct Line {
    slope: Measured,
    residual_n: f64,
}

fn fit(line: &[(f64, f64)]) -> Option<Line> {
    if line.len() < FEWEST {
        return None;
    }
    let n = line.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| line.iter().map(of).sum::<f64>() / n;
    let (t0, f0) = (mean(|s| s.0), mean(|s| s.1));
    let spread: f64 = line.iter().map(|s| (s.0 - t0).powi(2)).sum();
    let value = line.iter().map(|s| (s.0 - t0) * (s.1 - f0)).sum::<f64>() / spread;
    let residuals: Vec<f64> = line.iter().map(|s| s.1 - f0 - value * (s.0 - t0)).collect();
    let squares: f64 = residuals.iter().map(|r| r * r).sum();
    let neighbours: f64 = residuals.iter().zip(residuals.iter().skip(1)).map(|(a, b)| a * b).sum();
    let r = if squares > 0.0 { (neighbours / squares).clamp(0.0, 0.99) } else { 0.0 };
    let residual_n = (squares / (n - 2.0)).sqrt();
    let std_error = residual_n / spread.sqrt() * ((1.0 + r) / (1.0 - r)).sqrt();
    let rises = value.is_finite() && value > 0.0;
    rises.then_some(Line { slope: Measured { value, std_error }, residual_n })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sim::{Measurement, Scene, simulate};

    fn pull(seed: u64) -> Option<Stiffness> {
        let scene = Scene {
            post: true,
            duration_s: 3.0,
            winch_m_per_s: 0.0157,
            measurement: Measurement { white_n: 5.0, ..Measurement::default() },
            ..Scene::default()
        };
        let samples = simulate(&scene, seed).unwrap().samples;
        let samples: Vec<_> = samples.iter().map(|s| (s.time_s, s.force_n)).collect();
        let exact = |value: f64| Measured { value, std_error: 0.0 };
        let cable_length_m = Some(Measured { value: 15.0, std_error: 0.15 });
        stiffness(&samples, &Pull { winch_m_per_s: exact(0.0157), cable_length_m })
    }

    #[test]
    fn stiffness_is_found_and_its_uncertainty_holds() {
        let z: Vec<f64> = (0..400)
            .map(|seed| {
                let k = pull(seed).unwrap().stiffness_n_per_m;
                (k.value - 23_000.0) / k.std_error
            })
            .collect();
        let mean = z.iter().sum::<f64>() / 400.0;
        let spread = (z.iter().map(|z| z * z).sum::<f64>() / 400.0).sqrt();
        assert!(mean.abs() < 0.2 && (0.85..1.15).contains(&spread), "{mean} {spread}");
    }

    #[test]
    fn ae_carries_the_uncertainty_of_the_length() {
        let found = pull(1).unwrap();
        let ae = found.ae_n.unwrap();
        assert!((ae.value / 345_000.0 - 1.0).abs() < 0.02);
        assert!(ae.std_error > 0.01 * ae.value);
    }

    #[test]
    fn a_flat_record_has_no_stiffness() {
        let exact = |value: f64| Measured { value, std_error: 0.0 };
        let flat: Vec<_> = (0..100).map(|i| (f64::from(i) / 16.0, 1.0)).collect();
        let pull = Pull { winch_m_per_s: exact(0.0157), cable_length_m: None };
        assert_eq!(stiffness(&flat, &pull), None);
        assert_eq!(stiffness(&[], &pull), None);
    }
}
