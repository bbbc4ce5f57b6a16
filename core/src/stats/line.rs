//! A straight line fitted sample by sample: the stick line.
//!
//! Weighted least squares of force against time, in recursive form: each point moves the line by a
//! part of its distance from it, and adds to the squared residuals. No number is the small
//! difference of two large sums, so neither a large force nor a long stick costs precision.
//! Constant memory.

use crate::num::math::larger;

/// Sums of a straight line through weighted points.
///
/// Times are in sampling periods from an origin that the owner keeps, forces in
/// newtons. Without points every number is zero.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Line {
    /// Sum of the weights.
    pub weight: f32,
    /// Weighted mean time, periods.
    pub time: f32,
    /// Weighted mean force, N.
    pub level_n: f32,
    /// Rounding error of `level_n`, N, which the next step makes good (Kahan).
    lost_n: f32,
    /// Weight of the slope: Σ w (t − mean)².
    pub slope_weight: f32,
    /// Slope, N per period; zero before it is known, see [`Self::slope`].
    pub slope: f32,
    /// Σ w (F − line)², N².
    pub residual_n2: f32,
    /// Number of points.
    pub count: u32,
}

impl Line {
    /// Without points.
    pub(crate) const NONE: Self = Self {
        weight: 0.0,
        time: 0.0,
        level_n: 0.0,
        lost_n: 0.0,
        slope_weight: 0.0,
        slope: 0.0,
        residual_n2: 0.0,
        count: 0,
    };

    /// Takes a point with a weight above zero. Its squared residual is multiplied by `trust`. With
    /// weight and trust of one over the point's own variance, the sum of the squared residuals over
    /// that of the weights is the variance of a point of weight one.
    // Not inlined: on the path of every sample it would be there twice.
    #[inline(never)]
    pub(crate) fn add(&mut self, time: f32, force_n: f32, weight: f32, trust: f32) {
        let total = self.weight + weight;
        let share = weight / total;
        let dt = time - self.time;
        // Recursive least squares: everything moves by parts of the distance from the line so far.
        // Rounding then acts on noise, and not on the mean, where it would be the same in every
        // event.
        let off_n = force_n - self.at(time, self.slope);
        let rest = self.weight * share;
        let slope_weight = self.slope_weight + rest * dt * dt;
        let mean = self.time + share * dt;
        // In a long rest every sample moves the mean by nearly as much: the rounding error of that
        // step is always the same, and adds up unless it is kept (Kahan).
        let step_n = self.slope * (mean - self.time) + share * off_n + self.lost_n;
        let level_n = self.level_n + step_n;
        self.lost_n = step_n - (level_n - self.level_n);
        self.level_n = level_n;
        self.time = mean;
        if slope_weight > 0.0 {
            let inverse = 1.0 / slope_weight;
            self.residual_n2 += trust * rest * off_n * off_n * (self.slope_weight * inverse);
            self.slope += rest * dt * inverse * off_n;
        } else {
            self.residual_n2 += trust * rest * off_n * off_n;
        }
        self.slope_weight = slope_weight;
        self.weight = total;
        self.count = self.count.saturating_add(1);
    }

    /// Multiplies all weights by a factor, to forget the past.
    pub(crate) fn fade(&mut self, factor: f32) {
        self.weight *= factor;
        self.slope_weight *= factor;
        self.residual_n2 *= factor;
    }

    /// Moves the origin of time forward by `periods`: all times become less.
    pub(crate) fn shift(&mut self, periods: f32) {
        self.time -= periods;
    }

    /// Slope, N per period; `None` with fewer than two different times.
    #[inline(always)]
    pub(crate) fn slope(&self) -> Option<f32> {
        (self.slope_weight > 0.0).then_some(self.slope)
    }

    /// Force on the line of the given slope through the mean point, N.
    #[inline(always)]
    pub(crate) fn at(&self, time: f32, slope: f32) -> f32 {
        self.level_n + slope * (time - self.time)
    }

    /// Variance of the line at a time, in units of the variance of a point of
    /// weight one; infinite without points.
    #[inline(always)]
    pub(crate) fn leverage(&self, time: f32) -> f32 {
        if self.weight <= 0.0 {
            return f32::INFINITY;
        }
        let dt = time - self.time;
        let turn = if self.slope_weight > 0.0 { dt * dt / self.slope_weight } else { 0.0 };
        1.0 / self.weight + turn
    }

    /// Weighted sum of squared residuals of the best line, N², and their degrees of freedom where the
    /// sum of the weights is their number.
    pub(crate) fn residuals(&self) -> (f32, f32) {
        (self.residual_n2, larger(self.weight - 2.0, 0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points() -> [(f32, f32); 6] {
        [(0.0, 9000.1), (1.0, 9001.9), (2.0, 9004.2), (4.0, 9007.9), (5.0, 9010.2), (9.0, 9017.8)]
    }

    /// Reference in f64, by the textbook formulas.
    fn reference() -> (f64, f64, f64) {
        let p = points().map(|(t, y)| (f64::from(t), f64::from(y)));
        let n = p.len() as f64;
        let (mt, my) =
            (p.iter().map(|a| a.0).sum::<f64>() / n, p.iter().map(|a| a.1).sum::<f64>() / n);
        let tt: f64 = p.iter().map(|a| (a.0 - mt).powi(2)).sum();
        let ty: f64 = p.iter().map(|a| (a.0 - mt) * (a.1 - my)).sum();
        let slope = ty / tt;
        let rss = p.iter().map(|a| (a.1 - my - slope * (a.0 - mt)).powi(2)).sum();
        (slope, my + slope * (20.0 - mt), rss)
    }

    #[test]
    fn follows_the_textbook_formulas() {
        let mut line = Line::default();
        points().iter().for_each(|&(t, y)| line.add(t, y, 1.0, 1.0));
        let (slope, at20, rss) = reference();
        let got = line.slope().unwrap();
        assert!((f64::from(got) - slope).abs() < 1e-3);
        assert!((f64::from(line.at(20.0, got)) - at20).abs() < 4e-3);
        assert!((f64::from(line.residual_n2) - rss).abs() < 2e-3, "{} {rss}", line.residual_n2);
        let mut half = Line::default();
        points().iter().for_each(|&(t, y)| half.add(t, y, 0.5, 1.0));
        assert!((f64::from(half.residual_n2) - 0.5 * rss).abs() < 1e-3, "{}", half.residual_n2);
    }

    /// A stick of a thousand samples that rises thirty thousand times the noise.
    #[test]
    fn the_residual_of_a_long_steep_line_keeps_its_digits() {
        let mut line = Line::default();
        let noise = |i: i32| f32::from((i * 7919 % 257 - 128) as i16) / 128.0;
        (0..1000).for_each(|i| line.add(i as f32, 16.0 * i as f32 + noise(i), 1.0, 1.0));
        let direct: f32 = (0..1000).map(|i| noise(i) * noise(i)).sum();
        assert!((line.residual_n2 / direct - 1.0).abs() < 0.02, "{} {direct}", line.residual_n2);
    }

    #[test]
    fn degenerate_lines_have_no_slope() {
        let mut line = Line::default();
        assert!(line.slope().is_none() && line.leverage(0.0).is_infinite());
        line.add(3.0, 5.0, 1.0, 1.0);
        assert!(line.slope().is_none());
        assert!((line.at(100.0, 0.0) - 5.0).abs() < 1e-6);
        assert!((line.leverage(9.0) - 1.0).abs() < 1e-6);
    }
}
