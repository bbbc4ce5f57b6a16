//! The normal equations of the event fit.

use core::ops::{Index, IndexMut};

/// Number of unknowns of a cycle.
pub(crate) const UNKNOWNS: usize = 6;

/// Gradient of the force with respect to the unknowns of the fit: onset, rate, `Fs`, `d`, swing
/// `1/ω` and rate change. The swing, not ω: times are proportional to it, so its estimate from few
/// samples is nearly normally distributed.
pub(crate) type Gradient = [f32; UNKNOWNS];

/// Number of first unknowns, onset, rate and `Fs`: the line before the slip depends on no others.
const FIRST: usize = 3;

/// Entries of a symmetric matrix of the fit's size, on its diagonal and below.
const ENTRIES: usize = UNKNOWNS * (UNKNOWNS + 1) / 2;

/// Entries of the matrix of these first three alone.
pub(crate) const ENTRIES_OF_FIRST: usize = FIRST * (FIRST + 1) / 2;

/// A symmetric matrix of the fit's size: its lower triangle, row by row.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Symmetric([f32; ENTRIES]);

impl Symmetric {
    /// A row up to the diagonal.
    fn row(&self, row: usize) -> &[f32] {
        self.0.get(place(row, 0)..=place(row, row)).unwrap_or_default()
    }

    /// A row up to the diagonal, to be changed.
    fn row_mut(&mut self, row: usize) -> &mut [f32] {
        self.0.get_mut(place(row, 0)..=place(row, row)).unwrap_or_default()
    }

    /// Factors the matrix with its diagonal multiplied by one plus `damping`.
    ///
    /// `None` when it is singular to working precision.
    // In a call of its own, or its loops are not unrolled: thrice the time.
    pub(crate) fn factor(&self, damping: f32) -> Option<Factor> {
        Factor::new(self, damping)
    }

    /// Its lower triangle, row by row: the entries of the first unknowns come first.
    pub(crate) fn entries(&self) -> &[f32] {
        &self.0
    }

    /// The matrix of the first three unknowns. The others, of which nothing is known, get a one on
    /// the diagonal, so that it can be factored.
    pub(crate) fn of_first(entries: &[f32; ENTRIES_OF_FIRST]) -> Self {
        let mut all = Self::default();
        all.0.iter_mut().zip(entries).for_each(|(entry, first)| *entry = *first);
        (FIRST..UNKNOWNS).for_each(|unknown| all.add_to_diagonal(unknown, 1.0));
        all
    }

    /// Adds to an entry of the diagonal.
    pub(crate) fn add_to_diagonal(&mut self, unknown: usize, number: f32) {
        if let Some(entry) = self.0.get_mut(place(unknown, unknown)) {
            *entry += number;
        }
    }
}

/// Place of an entry in the lower triangle; `column` is at most `row`.
pub(crate) const fn place(row: usize, column: usize) -> usize {
    row * (row + 1) / 2 + column
}

impl Index<[usize; 2]> for Symmetric {
    type Output = f32;

    fn index(&self, [row, column]: [usize; 2]) -> &f32 {
        &self.0[place(row, column)]
    }
}

impl IndexMut<[usize; 2]> for Symmetric {
    fn index_mut(&mut self, [row, column]: [usize; 2]) -> &mut f32 {
        &mut self.0[place(row, column)]
    }
}

/// `Σ w g gᵀ`, `Σ w g r` and `Σ w r²` of weighted residuals.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Normal {
    /// `Σ w g gᵀ`.
    pub matrix: Symmetric,
    /// `Σ w g r`.
    pub right: Gradient,
    /// `Σ w r²`.
    pub cost: f32,
}

impl Normal {
    /// Takes one residual (measured minus model) with its gradient and weight.
    pub(crate) fn add(&mut self, residual: f32, gradient: &Gradient, weight: f32) {
        self.cost += weight * residual * residual;
        (0..FIRST).for_each(|unknown| self.add_row(residual, gradient, weight, unknown));
        // Before the slip the force depends on the first ones alone.
        let [.., drop, swing, rate_change] = gradient;
        if *drop != 0.0 || *swing != 0.0 || *rate_change != 0.0 {
            (FIRST..UNKNOWNS).for_each(|unknown| self.add_row(residual, gradient, weight, unknown));
        }
    }

    #[inline(always)]
    fn add_row(&mut self, residual: f32, gradient: &Gradient, weight: f32, unknown: usize) {
        let scaled = weight * gradient[unknown];
        for (entry, by) in self.matrix.row_mut(unknown).iter_mut().zip(gradient) {
            *entry += scaled * by;
        }
        self.right[unknown] += scaled * residual;
    }

    /// Takes a residual that depends on one unknown alone.
    pub(crate) fn add_one(&mut self, residual: f32, unknown: usize, weight: f32) {
        self.cost += weight * residual * residual;
        self.matrix.add_to_diagonal(unknown, weight);
        if let Some(right) = self.right.get_mut(unknown) {
            *right += weight * residual;
        }
    }
}

/// `A = L D Lᵀ` with a unit diagonal in `L`. Neither the result nor its rounding
/// depends on the units of the unknowns, so newtons, periods and radians do not
/// disturb each other in single precision.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Factor {
    /// Below the diagonal, row by row.
    lower: [f32; ENTRIES - UNKNOWNS],
    /// One over the diagonal of `D`.
    inverse: Gradient,
}

/// Place of an entry below the diagonal; `column` is less than `row`.
const fn below(row: usize, column: usize) -> usize {
    row * row.saturating_sub(1) / 2 + column
}

/// A pivot below this part of its diagonal element is lost in rounding: sixteen units of 2⁻²⁴.
const SMALLEST_PIVOT: f32 = 1e-6;

impl Factor {
    fn new(matrix: &Symmetric, damping: f32) -> Option<Self> {
        let mut lower = [0.0; ENTRIES - UNKNOWNS];
        let mut inverse = Gradient::default();
        let raise = 1.0 + damping;
        for i in 0..UNKNOWNS {
            // The row of L D first, its products with L as they are known.
            let mut row = Gradient::default();
            let (diagonal, given) = matrix.row(i).split_last()?;
            let mut pivot = diagonal * raise;
            for (j, entry) in given.iter().enumerate().take(UNKNOWNS) {
                let mut sum = *entry;
                for k in 0..j {
                    sum -= row[k] * lower[below(j, k)];
                }
                row[j] = sum;
                lower[below(i, j)] = sum * inverse[j];
                pivot -= sum * lower[below(i, j)];
            }
            // Also false for NaN.
            if !(pivot > SMALLEST_PIVOT * diagonal && pivot < f32::MAX) {
                return None;
            }
            inverse[i] = 1.0 / pivot;
        }
        Some(Self { lower, inverse })
    }

    /// Solves `A x = right`.
    pub(crate) fn solve(&self, right: &Gradient) -> Gradient {
        let mut x = *right;
        for i in 1..UNKNOWNS {
            for k in 0..i {
                x[i] -= self.lower[below(i, k)] * x[k];
            }
        }
        for i in (0..UNKNOWNS).rev() {
            x[i] *= self.inverse[i];
            for k in i + 1..UNKNOWNS {
                x[i] -= self.lower[below(k, i)] * x[k];
            }
        }
        x
    }

    /// Variances of the unknowns, the diagonal of `A⁻¹`, in units of the variance of
    /// weight one.
    pub(crate) fn variances(&self) -> Gradient {
        core::array::from_fn(|unknown| self.variance(unknown))
    }

    /// Variance of one unknown, in units of the variance of weight one.
    #[inline(always)]
    pub(crate) fn variance(&self, unknown: usize) -> f32 {
        let mut unit = Gradient::default();
        unit[unknown] = 1.0;
        self.spread(&unit, unknown)
    }

    /// `uᵀ A⁻¹ u`, the variance of a known combination of unknowns, whose entries before the place
    /// `first` are zero. Inlined: a fifth of the time of a call.
    #[inline(always)]
    pub(crate) fn spread(&self, u: &Gradient, first: usize) -> f32 {
        // Σ (L⁻¹ u)² / D: forward substitution is enough.
        let (mut x, mut sum_of_squares) = (*u, 0.0);
        for i in first..UNKNOWNS {
            for k in first..i {
                x[i] -= self.lower[below(i, k)] * x[k];
            }
            sum_of_squares += x[i] * x[i] * self.inverse[i];
        }
        sum_of_squares
    }
}

/// A gradient times a number.
#[inline(never)]
pub(crate) fn scaled(u: &Gradient, by: f32) -> Gradient {
    u.map(|entry| by * entry)
}

/// Scalar product.
#[inline(never)]
pub(crate) fn dot(u: &Gradient, v: &Gradient) -> f32 {
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
        let x = normal.matrix.factor(0.0).unwrap().solve(&normal.right);
        for i in 0..UNKNOWNS {
            let full = |i: usize, j: usize| normal.matrix[[i.max(j), i.min(j)]];
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
    fn the_variances_are_the_diagonal_of_the_inverse() {
        let factor = example().matrix.factor(0.0).unwrap();
        for (unknown, direct) in factor.variances().into_iter().enumerate() {
            let mut unit = Gradient::default();
            unit[unknown] = 1.0;
            let solved = dot(&unit, &factor.solve(&unit));
            assert!((direct / solved - 1.0).abs() < 1e-4, "{unknown}: {direct} {solved}");
        }
    }

    #[test]
    fn a_singular_matrix_is_refused_and_damping_mends_it() {
        let mut normal = Normal::default();
        normal.add(1.0, &[1.0; UNKNOWNS], 1.0);
        assert!(normal.matrix.factor(0.0).is_none());
        assert!(normal.matrix.factor(0.1).is_some());
        assert!(Symmetric::default().factor(0.1).is_none());
    }
}
