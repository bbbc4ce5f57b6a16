//! The Fisher matrix of some samples, and its inverse.

use super::UNKNOWNS;

pub(in crate::sim) type Matrix<const N: usize = UNKNOWNS> = [[f64; N]; N];

/// Sum of the products of the gradients at the samples.
pub(in crate::sim) fn fisher(gradients: impl Iterator<Item = [f64; UNKNOWNS]>) -> Matrix {
    let mut fisher = [[0.0; UNKNOWNS]; UNKNOWNS];
    for gradient in gradients {
        for (row, g) in fisher.iter_mut().zip(gradient) {
            for (cell, h) in row.iter_mut().zip(gradient) {
                *cell += g * h;
            }
        }
    }
    fisher
}

/// Inverse of a symmetric positive definite matrix, by Gauss-Jordan on the
/// matrix scaled to ones on its diagonal; `None` if it is singular.
pub(in crate::sim) fn inverse<const N: usize>(matrix: Matrix<N>) -> Option<Matrix<N>> {
    let mut scale = [0.0; N];
    for (i, s) in scale.iter_mut().enumerate() {
        if matrix[i][i] <= 0.0 {
            return None;
        }
        *s = matrix[i][i].sqrt().recip();
    }
    let mut left = matrix;
    let mut right = [[0.0; N]; N];
    for i in 0..N {
        for j in 0..N {
            left[i][j] *= scale[i] * scale[j];
        }
        right[i][i] = 1.0;
    }
    for i in 0..N {
        // The pivots are Schur complements of a positive definite matrix: no row exchange is
        // needed.
        let pivot = left[i][i];
        if pivot < 1e-13 {
            return None;
        }
        for j in 0..N {
            left[i][j] /= pivot;
            right[i][j] /= pivot;
        }
        for other in (0..N).filter(|&other| other != i) {
            let factor = left[other][i];
            for j in 0..N {
                left[other][j] -= factor * left[i][j];
                right[other][j] -= factor * right[i][j];
            }
        }
    }
    for i in 0..N {
        for j in 0..N {
            right[i][j] *= scale[i] * scale[j];
        }
    }
    Some(right)
}
