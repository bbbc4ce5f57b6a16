//! From values to places on paper.

/// A straight map from values to coordinates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    /// Values at the two ends.
    pub domain: (f64, f64),
    /// Coordinates there.
    pub range: (f64, f64),
}

impl Scale {
    /// Coordinate of a value.
    pub fn at(&self, value: f64) -> f64 {
        let (low, high) = self.domain;
        self.range.0 + (value - low) / (high - low) * (self.range.1 - self.range.0)
    }
}

/// An interval that holds all values, with `margin` (a fraction of its width)
/// at both ends; never empty.
pub(super) fn extent(values: impl IntoIterator<Item = f64>, margin: f64) -> (f64, f64) {
    let wider = |(low, high): (f64, f64), x: f64| (low.min(x), high.max(x));
    let start = (f64::INFINITY, f64::NEG_INFINITY);
    let (low, high) = values.into_iter().filter(|x| x.is_finite()).fold(start, wider);
    if low > high {
        return (0.0, 1.0);
    }
    let least = 1e-9_f64.max(low.abs().max(high.abs()) * 1e-6);
    let width = (high - low).max(least);
    let centre = (low + high) / 2.0;
    let half = width * (0.5 + margin);
    (centre - half, centre + half)
}

/// Round values within an interval.
#[derive(Clone, Debug)]
pub(super) struct Ticks {
    /// In order.
    pub values: Vec<f64>,
    /// Decimals their labels need.
    pub decimals: usize,
}

/// At most about `wanted` round values from `low` to `high`, in steps of 1, 2 or
/// 5 times a power of ten, no smaller than `least_step`.
pub(super) fn ticks((low, high): (f64, f64), wanted: f64, least_step: f64) -> Ticks {
    let raw = ((high - low) / wanted.max(1.0)).max(least_step);
    let decade = 10_f64.powf(raw.log10().floor());
    let step = match raw / decade {
        r if r <= 1.001 => decade,
        r if r <= 2.2 => 2.0 * decade,
        r if r <= 5.5 => 5.0 * decade,
        _ => 10.0 * decade,
    };
    let (first, last) = ((low / step).ceil(), (high / step).floor());
    let count = (last - first).clamp(0.0, 100.0) as usize;
    let values = (0..=count).map(|i| (first + i as f64) * step).filter(|x| *x <= high).collect();
    let decimals = (-(step * 1.0001).log10().floor()).clamp(0.0, 9.0) as usize;
    Ticks { values, decimals }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        let t = ticks((-0.3, 783.0), 5.0, 0.0);
        assert_eq!((t.values, t.decimals), (vec![0.0, 200.0, 400.0, 600.0], 0));
        let t = ticks((0.278, 0.291), 3.0, 0.0);
        assert_eq!(t.decimals, 3);
        assert_eq!(t.values.len(), 3);
        assert_eq!(ticks((-0.6, 0.6), 5.0, 1.0).values, [0.0]);
        assert!(ticks((1e9, 1e9 + 1e-3), 5.0, 0.0).values.len() <= 101);
    }

    #[test]
    fn extent_is_never_empty() {
        assert_eq!(extent([], 0.1), (0.0, 1.0));
        let (low, high) = extent([5.0, f64::NAN], 0.1);
        assert!(low < 5.0 && 5.0 < high);
        assert_eq!(extent([0.0, 10.0], 0.1), (-1.0, 11.0));
    }
}
