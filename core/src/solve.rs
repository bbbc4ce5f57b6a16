//! The normal equations of the event fit.

use crate::math;
use crate::model::{Gradient, UNKNOWNS};

/// A symmetric matrix of the fit's size.
pub type Matrix = [[f32; UNKNOWNS]; UNKNOWNS];

/// `Σ w g gᵀ`, `Σ w g r` and `Σ w r²` of weighted residuals.
#[derive(Clone, Copy, Debug, Default)]
pub struct Normal {
    /// `Σ w g gᵀ`, lower triangle.
    pub matrix: Matrix,
    /// `Σ w g r`.
    pub right: Gradient,
    /// `Σ w r²`.
    pub cost: f32,
}

impl Normal {
    /// Takes one residual (measured minus model) with its gradient and weight.
    pub fn add(&mut self, residual: f32, gradient: &Gradient, weight: f32) {
        self.cost += weight * residual * residual;
        for (i, row) in self.matrix.iter_mut().enumerate() {
            let scaled = weight * gradient[i];
            for (j, entry) in row.iter_mut().enumerate().take(i + 1) {
                *entry += scaled * gradient[j];
            }
            self.right[i] += scaled * residual;
        }
    }

    /// Factors the matrix with its diagonal raised by `damping` times itself.
    ///
    /// `None` when it is singular to working precision.
    #[must_use]
    pub fn factor(&self, damping: f32) -> Option<Factor> {
        Factor::new(&self.matrix, damping)
    }
}

/// Cholesky factor of a matrix scaled to a unit diagonal, so that newtons,
/// periods and radians do not disturb each other in single precision.
#[derive(Clone, Copy, Debug)]
pub struct Factor {
    lower: Matrix,
    /// One over the root of the original diagonal.
    scale: Gradient,
}

/// A pivot of the scaled matrix below this is lost in rounding.
const SMALLEST_PIVOT: f32 = 1e-6;

impl Factor {
    fn new(matrix: &Matrix, damping: f32) -> Option<Self> {
        let mut scale = [0.0; UNKNOWNS];
        for (i, s) in scale.iter_mut().enumerate() {
            let diagonal = matrix[i][i];
            if !(diagonal > 0.0 && diagonal.is_finite()) {
                return None;
            }
            *s = 1.0 / math::sqrt(diagonal);
        }
        let mut lower = Matrix::default();
        for i in 0..UNKNOWNS {
            for j in 0..=i {
                let raised =
                    if i == j { 1.0 + damping } else { matrix[i][j] * scale[i] * scale[j] };
                let sum = (0..j).fold(raised, |sum, k| sum - lower[i][k] * lower[j][k]);
                lower[i][j] = if i != j {
                    sum / lower[j][j]
                } else if sum > SMALLEST_PIVOT {
                    math::sqrt(sum)
                } else {
                    return None;
                };
            }
        }
        Some(Self { lower, scale })
    }

    /// Solves `A x = right`.
    #[must_use]
    pub fn solve(&self, right: &Gradient) -> Gradient {
        let mut x = [0.0; UNKNOWNS];
        for i in 0..UNKNOWNS {
            let sum = (0..i).fold(right[i] * self.scale[i], |sum, k| sum - self.lower[i][k] * x[k]);
            x[i] = sum / self.lower[i][i];
        }
        for i in (0..UNKNOWNS).rev() {
            let sum = (i + 1..UNKNOWNS).fold(x[i], |sum, k| sum - self.lower[k][i] * x[k]);
            x[i] = sum / self.lower[i][i];
        }
        for (value, scale) in x.iter_mut().zip(self.scale) {
            *value *= scale;
        }
        x
    }

    /// `uᵀ A⁻¹ v`: a covariance, in units of the variance of weight one.
    #[must_use]
    pub fn covariance(&self, u: &Gradient, v: &Gradient) -> f32 {
        dot(u, &self.solve(v))
    }
}

/// Scalar product.
#[must_use]
pub fn dot(u: &Gradient, v: &Gradient) -> f32 {
    u.iter().zip(v).fold(0.0, |sum, (a, b)| sum + a * b)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example() -> Normal {
        let mut normal = Normal::default();
        let rows = [
            ([-360.0, 0.1, 1.0, 0.0, 0.0, 0.0], 1.0),
            ([-350.0, 0.2, 1.0, -0.3, 2.0, 0.0], -2.0),
            ([5000.0, 0.05, 1.0, -0.9, -11.0, 0.0], 3.0),
            ([-360.0, 0.4, 1.0, -1.9, 3.0, 0.2], 0.5),
            ([-360.0, 1.4, 1.0, -1.9, 3.1, 1.2], 0.0),
            ([0.0, 9.0, 0.0, 0.0, 0.0, 0.0], 1.5),
            ([0.0, 0.0, 0.0, 0.0, 0.0, 7.0], 0.3),
        ];
        rows.iter().for_each(|(g, r)| normal.add(*r, g, 0.7));
        normal
    }

    #[test]
    fn the_solution_satisfies_the_equations() {
        let normal = example();
        let x = normal.factor(0.0).unwrap().solve(&normal.right);
        for i in 0..UNKNOWNS {
            let full = |i: usize, j: usize| normal.matrix[i.max(j)][i.min(j)];
            let left = (0..UNKNOWNS).fold(0.0, |sum, j| sum + full(i, j) * x[j]);
            let size = (0..UNKNOWNS).fold(1e-3, |sum, j| sum + (full(i, j) * x[j]).abs());
            assert!(
                (left - normal.right[i]).abs() < 1e-4 * size,
                "{i}: {left} {}",
                normal.right[i]
            );
        }
    }

    #[test]
    fn a_singular_matrix_is_refused_and_damping_mends_it() {
        let mut normal = Normal::default();
        normal.add(1.0, &[1.0; UNKNOWNS], 1.0);
        assert!(normal.factor(0.0).is_none());
        assert!(normal.factor(0.1).is_some());
        assert!(Normal::default().factor(0.1).is_none());
    }
}
