//! Linear scales from values to coordinates, and ticks.

use super::number::fixed;

/// A linear map from values to coordinates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    /// Values at the two ends.
    pub domain: (f64, f64),
    /// Coordinates of the two ends.
    pub range: (f64, f64),
}

impl Scale {
    /// Coordinate of a value.
    pub fn at(&self, value: f64) -> f64 {
        let (low, high) = self.domain;
        self.range.0 + (value - low) / (high - low) * (self.range.1 - self.range.0)
    }
}

/// Least width of an interval, in its unit: a hundred labels with [`MOST_DECIMALS`] still differ.
const NARROWEST: f64 = 1e-6;
/// Decimals of a label at most.
const MOST_DECIMALS: i32 = 9;

/// An interval that holds all values, with `margin` (a fraction of its width)
/// at both ends; never empty. Around a single value it is as wide as a tenth of that.
pub(super) fn extent(values: impl IntoIterator<Item = f64>, margin: f64) -> (f64, f64) {
    let wider = |(low, high): (f64, f64), x: f64| (low.min(x), high.max(x));
    let start = (f64::INFINITY, f64::NEG_INFINITY);
    let (low, high) = values.into_iter().filter(|x| x.is_finite()).fold(start, wider);
    if low > high {
        return (0.0, 1.0);
    }
    let size = low.abs().max(high.abs());
    let least = if size > 0.0 { NARROWEST.max(1e-6 * size) } else { 1.0 };
    let width = if high - low > least { high - low } else { least.max(0.1 * size) };
    let centre = (low + high) / 2.0;
    let half = width * (0.5 + margin);
    (centre - half, centre + half)
}

/// Spacing of ticks.
#[derive(Clone, Copy, Debug)]
pub(super) enum Steps {
    /// 1, 2 or 5 times a power of ten.
    Decimal,
    /// 1, 2 or 5 times a power of ten, at least 1.
    Whole,
    /// Round steps of time; the values are seconds.
    Time(TimeUnit),
}

/// A unit for the labels of a time axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct TimeUnit {
    /// Symbol in labels.
    pub name: &'static str,
    /// Length of the unit, s.
    length_s: f64,
    /// Shortest span that uses the unit, s.
    from_s: f64,
    /// Steps that are round in the unit; empty: decimal steps.
    steps: &'static [f64],
}

/// Units in descending order.
const TIME_UNITS: [TimeUnit; 4] = [
    TimeUnit { name: "d", length_s: 86_400.0, from_s: 4.0 * 86_400.0, steps: &[] },
    TimeUnit {
        name: "h",
        length_s: 3600.0,
        from_s: 2.0 * 3600.0,
        steps: &[0.25, 0.5, 1.0, 2.0, 3.0, 6.0, 12.0, 24.0],
    },
    TimeUnit {
        name: "min",
        length_s: 60.0,
        from_s: 15.0 * 60.0,
        steps: &[1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 60.0],
    },
    TimeUnit { name: "s", length_s: 1.0, from_s: 0.0, steps: &[] },
];

impl TimeUnit {
    /// The unit for a span.
    pub fn of(span_s: f64) -> Self {
        let [.., seconds] = TIME_UNITS;
        TIME_UNITS.into_iter().find(|unit| span_s >= unit.from_s).unwrap_or(seconds)
    }
}

/// Round values within an interval.
#[derive(Clone, Debug)]
pub(super) struct Ticks {
    /// Values in ascending order.
    pub values: Vec<f64>,
    /// Unit of the labels, in units of the values.
    pub unit: f64,
    /// Decimals of the labels.
    pub decimals: usize,
}

impl Ticks {
    /// The label at a value.
    pub fn label(&self, value: f64) -> String {
        fixed(value / self.unit, self.decimals)
    }

    /// Characters of the longest label.
    pub fn longest(&self) -> usize {
        self.values.iter().map(|&value| self.label(value).chars().count()).max().unwrap_or(0)
    }
}

/// At most about `wanted` round values from `low` to `high`.
pub(super) fn ticks((low, high): (f64, f64), wanted: f64, steps: Steps) -> Ticks {
    let unit = if let Steps::Time(unit) = steps { unit.length_s } else { 1.0 };
    let (low, high) = (low / unit, high / unit);
    let step = step((high - low) / wanted.max(1.0), steps);
    let (first, last) = ((low / step).ceil(), (high / step).floor());
    let count = (last - first).clamp(0.0, 100.0) as usize;
    let values = (0..=count).map(|i| (first + i as f64) * step).filter(|x| *x <= high);
    let values = values.map(|x| x * unit).collect();
    let whole = |decimals: &i32| {
        let scaled = step * 10_f64.powi(*decimals);
        scaled > 0.5 && (scaled - scaled.round()).abs() < 1e-6
    };
    let decimals = (0..MOST_DECIMALS).find(whole).unwrap_or(MOST_DECIMALS) as usize;
    Ticks { values, unit, decimals }
}

/// The nearest round step to `raw`, preferably above it.
fn step(raw: f64, steps: Steps) -> f64 {
    let raw = match steps {
        Steps::Decimal => raw,
        Steps::Whole => raw.max(1.0),
        Steps::Time(unit) => match unit.steps.iter().find(|&&step| raw <= 1.1 * step) {
            Some(&step) => return step,
            None => raw,
        },
    };
    let decade = 10_f64.powf(raw.log10().floor());
    match raw / decade {
        r if r <= 1.001 => decade,
        r if r <= 2.2 => 2.0 * decade,
        r if r <= 5.5 => 5.0 * decade,
        _ => 10.0 * decade,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        let t = ticks((-0.3, 783.0), 5.0, Steps::Decimal);
        assert_eq!((t.values, t.decimals), (vec![0.0, 200.0, 400.0, 600.0], 0));
        let t = ticks((0.278, 0.291), 3.0, Steps::Decimal);
        assert_eq!(t.decimals, 3);
        assert_eq!(t.values.len(), 3);
        assert_eq!(ticks((-0.6, 0.6), 5.0, Steps::Whole).values, [0.0]);
        assert!(ticks((1e9, 1e9 + 1e-3), 5.0, Steps::Decimal).values.len() <= 101);
    }

    #[test]
    fn long_times_are_counted_in_hours() {
        const HOUR_S: f64 = 3600.0;
        let labels = |span_s: f64, wanted: f64| {
            let unit = TimeUnit::of(span_s);
            let ticks = ticks((0.0, span_s), wanted, Steps::Time(unit));
            let texts: Vec<String> = ticks
                .values
                .iter()
                .map(|v| format!("{:.*}", ticks.decimals, v / ticks.unit))
                .collect();
            format!("{} {}", texts.join(" "), unit.name)
        };
        assert_eq!(labels(120.0, 16.0), "0 10 20 30 40 50 60 70 80 90 100 110 120 s");
        assert_eq!(labels(0.5 * HOUR_S, 4.0), "0 10 20 30 min");
        assert_eq!(
            labels(2.5 * HOUR_S, 16.0),
            "0.00 0.25 0.50 0.75 1.00 1.25 1.50 1.75 2.00 2.25 2.50 h"
        );
        assert_eq!(labels(24.0 * HOUR_S, 16.0), "0 2 4 6 8 10 12 14 16 18 20 22 24 h");
        assert_eq!(labels(24.0 * HOUR_S, 4.0), "0 6 12 18 24 h");
        assert_eq!(labels(30.0 * 24.0 * HOUR_S, 4.0), "0 10 20 30 d");
    }

    #[test]
    fn extent_is_never_empty() {
        assert_eq!(extent([], 0.1), (0.0, 1.0));
        let (low, high) = extent([5.0, f64::NAN], 0.1);
        assert!(low < 5.0 && 5.0 < high);
        assert_eq!(extent([0.0, 10.0], 0.1), (-1.0, 11.0));
        assert_eq!(extent([0.63, 0.63], 0.0), (0.5985, 0.6615));
    }

    #[test]
    fn labels_of_what_stays_the_same_differ() {
        for value in [0.0, 1e-12, 1e-3, 250.0] {
            let ticks = ticks(extent([value, value], 0.1), 8.0, Steps::Decimal);
            let mut labels: Vec<String> = ticks.values.iter().map(|&v| ticks.label(v)).collect();
            labels.dedup();
            assert_eq!(labels.len(), ticks.values.len(), "{value}: {labels:?}");
        }
    }
}
