//! Linear least squares with three unknowns.

use nalgebra::{Matrix3, Vector3};

/// Finds the `x` with the smallest sum of `(row · x - value)²`; `None` when the
/// rows do not determine it.
#[must_use]
pub fn solve(rows: impl Iterator<Item = (Vector3<f64>, f64)>) -> Option<Vector3<f64>> {
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for (row, value) in rows {
        normal += row * row.transpose();
        right += row * value;
    }
    normal.cholesky().map(|factor| factor.solve(&right)).filter(|x| x.iter().all(|x| x.is_finite()))
}
