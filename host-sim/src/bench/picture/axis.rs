//! A logarithmic axis.

/// A logarithmic axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axis {
    /// Decimal logarithms of the values at the ends.
    pub(super) decades: (f64, f64),
    /// Coordinates of the ends.
    pub(super) ends: (f64, f64),
}

impl Axis {
    /// An axis from `start` to `end` that contains all values and ends at half decades.
    pub(super) fn around(values: &[f64], start: f64, end: f64) -> Self {
        let logs = || values.iter().filter(|v| **v > 0.0).map(|v| v.log10());
        let low = logs().fold(0.0, f64::min) - 0.2;
        let high = logs().fold(1.0, f64::max) + 0.2;
        let half = |x: f64| 0.5 * x;
        let decades = (half((2.0 * low).floor()), half((2.0 * high).ceil()));
        Self { decades, ends: (start, end) }
    }

    pub(super) fn at(&self, value: f64) -> f64 {
        let (low, high) = self.decades;
        let part = (value.log10() - low) / (high - low);
        self.ends.0 + part.clamp(0.0, 1.0) * (self.ends.1 - self.ends.0)
    }

    /// Powers of ten on the axis.
    pub(super) fn ticks(&self) -> impl Iterator<Item = f64> {
        let (low, high) = self.decades;
        (low.ceil() as i32..=high.floor() as i32).map(|power| 10_f64.powi(power))
    }
}

/// Short text of a power of ten.
pub(super) fn short_power(value: f64) -> String {
    if value >= 1e4 { format!("{}k", value / 1e3) } else { format!("{value}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_axis_is_logarithmic() {
        let axis = Axis::around(&[2.0, 900.0], 100.0, 500.0);
        assert!((axis.at(10.0) - axis.at(1.0) - (axis.at(100.0) - axis.at(10.0))).abs() < 1e-9);
        assert!(axis.at(2.0) > 100.0 && axis.at(900.0) < 500.0);
        assert_eq!(axis.ticks().count(), 4);
    }
}
