//! Group means and straight lines with their uncertainties.

use serde::Serialize;

use super::TestRecord;
use crate::rounding::LEAST;

/// A mean over tests.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Mean {
    /// Number of tests with a value.
    pub tests: usize,
    /// Mean.
    pub mean: f64,
    /// Standard error of the mean from the scatter between tests; `null` for one test or for
    /// repetitions of the same test.
    pub std_error: Option<f64>,
}

/// Mean of values; `None` without any.
#[must_use]
pub fn mean(values: &[f64]) -> Option<Mean> {
    if values.is_empty() {
        return None;
    }
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    let std_error = (squares / (n - 1.0) / n).sqrt();
    let scatters = std_error > LEAST * mean.abs();
    Some(Mean { tests: values.len(), mean, std_error: scatters.then_some(std_error) })
}

/// A least-squares line through tests, `y = value + slope (x - centre)`; the uncertainties are
/// standard deviations from the scatter.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Trend {
    /// Number of tests with a value.
    pub tests: usize,
    /// Mean of `x`.
    pub centre: f64,
    /// `y` at the centre.
    pub value: f64,
    /// Standard error of the value at the centre.
    pub value_std_error: f64,
    /// Slope.
    pub slope: f64,
    /// Standard error of the slope.
    pub slope_std_error: f64,
}

impl Trend {
    /// Value of the line at `x`, and its standard error.
    #[must_use]
    pub fn at(&self, x: f64) -> (f64, f64) {
        let from_centre = x - self.centre;
        let error = self.value_std_error.hypot(self.slope_std_error * from_centre);
        (self.value + self.slope * from_centre, error)
    }
}

/// The line through points `(x, y)`; `None` for fewer than three points, or for equal `x`.
#[must_use]
pub fn trend(points: &[(f64, f64)]) -> Option<Trend> {
    if points.len() < 3 {
        return None;
    }
    let n = points.len() as f64;
    let centre = points.iter().map(|p| p.0).sum::<f64>() / n;
    let value = points.iter().map(|p| p.1).sum::<f64>() / n;
    let spread: f64 = points.iter().map(|p| (p.0 - centre).powi(2)).sum();
    if spread <= 1e-24 * n * centre * centre {
        return None;
    }
    let slope = points.iter().map(|p| (p.0 - centre) * (p.1 - value)).sum::<f64>() / spread;
    let residual = |p: &(f64, f64)| p.1 - value - slope * (p.0 - centre);
    let scatter = (points.iter().map(|p| residual(p).powi(2)).sum::<f64>() / (n - 2.0)).sqrt();
    Some(Trend {
        tests: points.len(),
        centre,
        value,
        value_std_error: scatter / n.sqrt(),
        slope,
        slope_std_error: scatter / spread.sqrt(),
    })
}

/// A group of tests.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Group {
    /// Without snow.
    NoSnow,
    /// On snow.
    Snow,
    /// All tests.
    All,
    /// Pulled over level or sloping ice.
    Sliding,
    /// Pulled up a ramp.
    Rafting,
    /// Pulled over the edge of another sheet.
    OverRiding,
}

impl Group {
    /// In the order of the published means.
    pub const ALL: [Self; 3] = [Self::NoSnow, Self::Snow, Self::All];
    /// Groups by the kind of pull.
    pub const KINDS: [Self; 3] = [Self::Sliding, Self::Rafting, Self::OverRiding];

    /// Name in text output.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::NoSnow => "no snow",
            Self::Snow => "snow",
            Self::All => "all",
            Self::Sliding => "sliding",
            Self::Rafting => "rafting",
            Self::OverRiding => "over-riding",
        }
    }

    /// Whether a test belongs to the group.
    #[must_use]
    pub fn holds(self, test: &TestRecord) -> bool {
        match self {
            Self::NoSnow => test.has_snow() == Some(false),
            Self::Snow => test.has_snow() == Some(true),
            Self::All => true,
            Self::Sliding | Self::Rafting | Self::OverRiding => {
                test.kind.as_deref() == Some(self.name())
            }
        }
    }
}

/// One of the two coefficients.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Coefficient {
    /// `mu_s`.
    MuS,
    /// `mu`.
    Mu,
}

impl Coefficient {
    /// Both coefficients.
    pub const ALL: [Self; 2] = [Self::MuS, Self::Mu];

    /// Mean of the coefficient over the events of a test.
    #[must_use]
    pub fn of(self, test: &TestRecord) -> Option<f64> {
        match self {
            Self::MuS => test.mu_s.mean,
            Self::Mu => test.mu.mean,
        }
    }

    /// Name in text output.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::MuS => "mu_s",
            Self::Mu => "mu",
        }
    }
}

/// Independent variable of a trend.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Against {
    /// Weight, kN.
    WeightKn,
    /// Pull rate, mm/s.
    PullMmPerS,
    /// Depth of the snow, mm.
    SnowMm,
    /// Mean time of rest before a slip, in decades of a second.
    HoldDecades,
}

impl Against {
    /// All variables.
    pub const ALL: [Self; 4] = [Self::WeightKn, Self::PullMmPerS, Self::SnowMm, Self::HoldDecades];

    /// Value of the variable for a test, if known.
    #[must_use]
    pub fn of(self, test: &TestRecord) -> Option<f64> {
        match self {
            Self::WeightKn => Some(test.weight_n * 1e-3),
            Self::PullMmPerS => test.winch_m_per_s.map(|w| w * 1e3),
            Self::SnowMm => test.snow_mm,
            Self::HoldDecades => test.hold_s.filter(|&hold_s| hold_s > 0.0).map(f64::log10),
        }
    }

    /// Name and unit in text output.
    #[must_use]
    pub fn name(self) -> (&'static str, &'static str) {
        match self {
            Self::WeightKn => ("weight", "kN"),
            Self::PullMmPerS => ("pull rate", "mm/s"),
            Self::SnowMm => ("snow", "mm"),
            Self::HoldDecades => ("log of hold time", "decade of s"),
        }
    }
}

/// The points of a group's tests for a plot or a line.
#[must_use]
pub fn points(
    tests: &[TestRecord],
    group: Group,
    against: Against,
    coefficient: Coefficient,
) -> Vec<(f64, f64)> {
    let of = |test: &TestRecord| Some((against.of(test)?, coefficient.of(test)?));
    tests.iter().filter(|test| group.holds(test)).filter_map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A published example: Anscombe's first set.
    #[test]
    fn a_line_agrees_with_a_published_fit() {
        let x = [10.0, 8.0, 13.0, 9.0, 11.0, 14.0, 6.0, 4.0, 12.0, 7.0, 5.0];
        let y = [8.04, 6.95, 7.58, 8.81, 8.33, 9.96, 7.24, 4.26, 10.84, 4.82, 5.68];
        let points: Vec<_> = x.into_iter().zip(y).collect();
        let line = trend(&points).unwrap();
        assert!((line.slope - 0.500_09).abs() < 1e-5 && (line.at(0.0).0 - 3.000_09).abs() < 1e-5);
        assert!((line.slope_std_error - 0.117_91).abs() < 1e-5);
        assert!((line.at(0.0).1 - 1.124_75).abs() < 1e-4);
    }

    #[test]
    fn too_little_gives_nothing() {
        assert_eq!(trend(&[(1.0, 2.0), (2.0, 3.0)]), None);
        assert_eq!(trend(&[(1.0, 2.0), (1.0, 3.0), (1.0, 4.0)]), None);
        assert_eq!(mean(&[]), None);
        assert_eq!(mean(&[2.0]), Some(Mean { tests: 1, mean: 2.0, std_error: None }));
        // Equal tests have no scatter, even if their sum is rounded.
        assert_eq!(mean(&[0.1; 3]).and_then(|mean| mean.std_error), None);
        assert_eq!(mean(&[1.0, 3.0]).and_then(|mean| mean.std_error), Some(1.0));
    }
}
