//! Stiffness of the cable from a pull against a post: slope of the force against the take-up (the
//! paper's Fig. 8).

use serde::Serialize;

/// Start of the fit, as a share of the largest force: above it the cable is straight enough.
const FROM: f64 = 0.2;
/// End of the fit, as a share of the largest force: below it the winch has not slowed down.
const TO: f64 = 0.95;
/// Fewest samples for a line with an uncertainty.
const FEWEST: usize = 8;
/// Least rise of the line, in scatters about it: noise reaches one.
const RISE: f64 = 4.0;

/// A value with one standard deviation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Measured {
    /// The value.
    pub value: f64,
    /// One standard deviation.
    pub std_error: f64,
}

impl Measured {
    fn relative(&self) -> f64 {
        (self.std_error / self.value).abs()
    }
}

/// The winch and the cable of the pull.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pull {
    /// Take-up speed, m/s.
    pub winch_m_per_s: Measured,
    /// Free length of the cable, m.
    pub cable_length_m: Option<Measured>,
}

/// Results of a pull.
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

impl Stiffness {
    /// Contribution of the winch's speed to the relative uncertainty of `k`.
    fn winch_relative(&self) -> f64 {
        let (k, rate) = (self.stiffness_n_per_m.relative(), self.loading_rate_n_per_s.relative());
        (k * k - rate * rate).max(0.0).sqrt()
    }
}

/// Fits the straight part of a pull, from 20 to 95 % of the largest force, given as (time in s,
/// force in N) in order; `None` if too few samples rise.
///
/// The uncertainty of the line uses an effective number of samples, `n (1 - r)/(1 + r)`, with `r`
/// the correlation of neighbouring residuals. Errors that bend the line (sag, creep of the splices)
/// are not included.
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

/// Combined result of several pulls of a cable: the compliance of the cable and that of everything
/// else (splices, shackles, post), `1/k = 1/k0 + L/AE`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Together {
    /// Number of pulls.
    pub pulls: usize,
    /// Mean `k`, N/m, where all had the same length; `null` for several lengths.
    pub stiffness_n_per_m: Option<Measured>,
    /// `AE`, N, from the change of `1/k` with the length; `null` for one length, and where the
    /// change is within two standard deviations of zero.
    pub ae_n: Option<Measured>,
    /// `k0`, N/m; `null` for one length, and where `1/k0` is within two standard deviations of
    /// zero.
    pub end_stiffness_n_per_m: Option<Measured>,
}

/// Combines pulls, each with the length of its cable, m; `None` for fewer than two.
///
/// The weights come from the uncertainties of the lines. Where the pulls scatter by more than these,
/// all deviations are larger by the ratio. The uncertainty of the winch's speed is common to all pulls
/// and is not reduced by their number.
#[must_use]
pub fn together(pulls: &[(Stiffness, f64)]) -> Option<Together> {
    let [(_, first_m), _, ..] = pulls else { return None };
    let same = pulls.iter().all(|(_, length_m)| (length_m / first_m - 1.0).abs() < SAME_LENGTH);
    let points: Vec<(f64, f64, f64)> = pulls.iter().map(compliance).collect();
    let sum = |of: fn(&(f64, f64, f64)) -> f64| points.iter().map(|p| p.2 * of(p)).sum::<f64>();
    let weight = sum(|_| 1.0);
    let (length_m, compliance) = (sum(|p| p.0) / weight, sum(|p| p.1) / weight);
    let common = pulls.iter().map(|(pull, _)| pull.winch_relative()).fold(0.0, f64::max);
    let spread: f64 = points.iter().map(|p| p.2 * (p.0 - length_m).powi(2)).sum();
    let slope = match same {
        true => 0.0,
        false => points.iter().map(|p| p.2 * (p.0 - length_m) * p.1).sum::<f64>() / spread,
    };
    let off = |p: &(f64, f64, f64)| p.1 - compliance - slope * (p.0 - length_m);
    let squares: f64 = points.iter().map(|p| p.2 * off(p).powi(2)).sum();
    let free = points.len() - if same { 1 } else { 2 };
    let wider = (squares / free.max(1) as f64).sqrt().max(1.0);
    let inverse = |value: f64, std: f64| {
        let relative = (wider * std / value).hypot(common);
        Measured { value: 1.0 / value, std_error: relative / value.abs() }
    };
    let none = Together { pulls: pulls.len(), ..Together::default() };
    if same {
        let mean = inverse(compliance, weight.powf(-0.5));
        return Some(Together { stiffness_n_per_m: Some(mean), ..none });
    }
    let end = compliance - slope * length_m;
    let end_std = (1.0 / weight + length_m.powi(2) / spread).sqrt();
    let told = |value: f64, std: f64| (value > SURE * wider * std).then(|| inverse(value, std));
    Some(Together {
        ae_n: told(slope, spread.powf(-0.5)),
        end_stiffness_n_per_m: told(end, end_std),
        ..none
    })
}

/// Length, m, compliance, m/N, and statistical weight.
fn compliance((pull, length_m): &(Stiffness, f64)) -> (f64, f64, f64) {
    let k = pull.stiffness_n_per_m.value;
    let std = pull.loading_rate_n_per_s.relative().max(SMALLEST) / k;
    (*length_m, 1.0 / k, std.powi(-2))
}

/// Relative difference below which two lengths count as one.
const SAME_LENGTH: f64 = 0.01;
/// Standard deviations from zero below which a compliance is not inverted.
const SURE: f64 = 2.0;
/// Smallest relative standard deviation of a pull.
const SMALLEST: f64 = 1e-6;

/// A product or quotient of two values: relative variances add.
fn product(a: Measured, b: Measured, combine: impl Fn(f64, f64) -> f64) -> Measured {
    let value = combine(a.value, b.value);
    Measured { value, std_error: value.abs() * a.relative().hypot(b.relative()) }
}

/// The samples of the rise to the largest force, within the straight part.
#[must_use]
pub fn straight_part(samples: &[(f64, f64)]) -> &[(f64, f64)] {
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
    let rise_n = value * (line.last()?.0 - line.first()?.0);
    let rises = rise_n.is_finite() && rise_n > RISE * residual_n;
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

    /// 12 pulls each of three lengths of a cable of 345 kN behind fittings of 200 kN/m.
    #[test]
    fn several_lengths_tell_the_cable_from_its_ends() {
        let (ae, ends) = (345_000.0, 200_000.0);
        let of = |length_m: f64, off: f64| {
            let k = (1.0 / ends + length_m / ae).recip();
            let value = k * (1.0 + 0.002 * off);
            let measured =
                |scale: f64| Measured { value: scale * value, std_error: 0.002 * scale * k };
            let (stiffness_n_per_m, loading_rate_n_per_s) = (measured(1.0), measured(0.0157));
            (Stiffness { stiffness_n_per_m, loading_rate_n_per_s, ..pull(1).unwrap() }, length_m)
        };
        let offs = [1.1, -0.7, 0.2, -1.4, 0.9, 0.5, -0.3, -1.0, 1.6, -0.2, 0.4, -0.9];
        let pulls: Vec<_> =
            [5.0, 10.0, 15.0].iter().flat_map(|&l| offs.map(|off| of(l, off))).collect();
        let found = together(&pulls).unwrap();
        let near = |found: Option<Measured>, truth: f64| {
            let found = found.unwrap();
            (found.value - truth).abs() < 3.0 * found.std_error && found.std_error < 0.1 * truth
        };
        assert!(near(found.ae_n, ae) && near(found.end_stiffness_n_per_m, ends), "{found:?}");
        assert_eq!(found.stiffness_n_per_m, None);
        // One length: the mean only, neither `AE` nor `k0`.
        let found = together(&pulls[..12]).unwrap();
        let k = (1.0 / ends + 5.0 / ae).recip();
        assert!(near(found.stiffness_n_per_m, k), "{found:?} {k}");
        assert_eq!((found.ae_n, found.end_stiffness_n_per_m), (None, None));
        assert_eq!(together(&pulls[..1]), None);
    }

    /// Pulls of one length that differ by more than their lines say: the mean says so too.
    #[test]
    fn pulls_that_differ_widen_the_mean() {
        let of = |value: f64| {
            let measured = |scale: f64| Measured { value: scale * value, std_error: 20.0 * scale };
            let (stiffness_n_per_m, loading_rate_n_per_s) = (measured(1.0), measured(0.0157));
            (Stiffness { stiffness_n_per_m, loading_rate_n_per_s, ..pull(1).unwrap() }, 15.0)
        };
        let mean = |k: f64| together(&[of(23_000.0), of(k)]).unwrap().stiffness_n_per_m.unwrap();
        assert!((mean(23_010.0).std_error / 14.1 - 1.0).abs() < 0.01);
        let far = mean(22_000.0).std_error;
        assert!((450.0..550.0).contains(&far), "{far}");
    }

    /// Lengths so close that the change of `k` is lost in its scatter.
    #[test]
    fn a_change_that_is_not_sure_tells_no_ae() {
        let of = |length_m: f64, value: f64| {
            let measured = |scale: f64| Measured { value: scale * value, std_error: 400.0 * scale };
            let (stiffness_n_per_m, loading_rate_n_per_s) = (measured(1.0), measured(0.0157));
            (Stiffness { stiffness_n_per_m, loading_rate_n_per_s, ..pull(1).unwrap() }, length_m)
        };
        let found = |k: f64| together(&[of(14.0, 23_000.0), of(15.0, k)]).unwrap();
        assert_eq!(found(22_500.0).ae_n, None, "one standard deviation");
        let sure = found(20_500.0).ae_n.unwrap();
        assert!(sure.std_error < 0.5 * sure.value, "{sure:?}");
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
        // Noise about a constant force, which by chance has a slope above zero.
        let noise = |i: u32| 10.0 + f64::from(i.wrapping_mul(2_654_435_761) >> 20) * 1e-3;
        let lines: Vec<_> = (0..50)
            .map(|from| (0..400).map(|i| (f64::from(i) / 16.0, noise(400 * from + i))).collect())
            .filter_map(|idle: Vec<_>| stiffness(&idle, &pull))
            .collect();
        assert_eq!(lines, []);
        assert_eq!(stiffness(&[], &pull), None);
    }
}
