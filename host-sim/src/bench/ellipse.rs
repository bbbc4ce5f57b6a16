//! Fits an ellipse to the points of a slip in the phase plane.
//!
//! With the centre on `F' = 0` and axes parallel to those of the plane (15),
//! `F² = 2 Fp F - F'²/omega² + (a² - Fp²)`, which is linear in three unknowns. `Fs` is the
//! intersection with the stick line. A slip with fewer than three points gives no result.

use nalgebra::{Matrix3, Vector3};

use super::loops::{Loop, LoopReading, OfLoops};

/// The method.
pub type Ellipse = OfLoops<Fit>;

/// Reading of a loop by the ellipse through its points off the stick line.
#[derive(Clone, Copy, Debug)]
pub struct Fit;

impl LoopReading for Fit {
    const NAME: &'static str = "ellipse fit";

    fn forces_n(found: &Loop) -> Option<(f64, f64)> {
        let points = found.ellipse();
        if points.len() < 3 {
            return None;
        }
        // Centring and scaling make the normal equations well conditioned.
        let middle_n = points.iter().map(|p| p.force_n).sum::<f64>() / points.len() as f64;
        let largest = |f: fn(f64) -> f64, of: &dyn Fn(usize) -> f64| {
            (0..points.len()).map(|i| f(of(i))).fold(0.0, f64::max)
        };
        let width_n = largest(f64::abs, &|i| points[i].force_n - middle_n);
        let height_n = largest(f64::abs, &|i| points[i].rate_n);
        let rows = points.iter().map(|p| {
            let (x, y) = ((p.force_n - middle_n) / width_n, p.rate_n / height_n);
            (Vector3::new(2.0 * x, -y * y, 1.0), x * x)
        });
        let fit = solve(rows)?;
        let (centre, flatness) = (fit[0], fit[1]);
        let level = found.level_n / height_n;
        let half_chord2 = fit[2] + centre * centre - flatness * level * level;
        let is_ellipse = flatness > 0.0 && half_chord2 > 0.0;
        let force_n = |x: f64| middle_n + width_n * x;
        is_ellipse.then(|| (force_n(centre + half_chord2.sqrt()), force_n(centre)))
    }
}

/// The `x` that minimizes the sum of `(row · x - value)²`; `None` if the rows do not determine it.
fn solve(rows: impl Iterator<Item = (Vector3<f64>, f64)>) -> Option<Vector3<f64>> {
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for (row, value) in rows {
        normal += row * row.transpose();
        right += row * value;
    }
    normal.cholesky().map(|factor| factor.solve(&right)).filter(|x| x.iter().all(|x| x.is_finite()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::history::Point;

    #[test]
    fn points_of_an_ellipse_give_it_back() {
        let (dynamic_n, static_n, level_n, omega) = (491.4, 781.2, 22.5, 1.18_f64);
        let a = static_n - dynamic_n;
        let start = -(level_n / omega).atan2(a);
        let half_length_n = a.hypot(level_n / omega);
        let point = |i: u32| {
            let angle: f64 = start + f64::from(i) * 0.6;
            Point {
                index: i,
                force_n: dynamic_n + half_length_n * angle.cos(),
                rate_n: -omega * half_length_n * angle.sin(),
            }
        };
        let found = Loop { points: (0..8).map(point).collect(), bottom: 3, level_n };
        let (fs, fp) = Fit::forces_n(&found).unwrap();
        assert!((fs - static_n).abs() < 1e-6 && (fp - dynamic_n).abs() < 1e-6, "{fs} {fp}");
    }
}
