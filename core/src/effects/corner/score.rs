//! What one event says of the corners by itself: Rao's score with its information.

#![allow(clippy::needless_range_loop, reason = "an index is that of rows and columns alike")]

use crate::fit::{Alone, Data, Fit};
use crate::model::corner::{Corner, NUMBERS};
use crate::stats::normal_equations::{Gradient, Normal, dot};

/// A number of which less than this part of the information is left when the unknowns are
/// free is lost in rounding: the event does not tell it.
const LEAST_OWN: f32 = 1e-3;

/// What an event tells of the corners by itself.
pub(super) struct Score {
    /// The corners that it was fitted with, and its swing.
    pub(super) corner: Corner,
    pub(super) inverse_omega: f32,
    /// Normal equations of the three numbers' steps from there, the unknowns free.
    pub(super) normal: Normal,
    /// By how much the unknowns fall when a number grows by one.
    pub(super) response: [Gradient; NUMBERS],
    /// It does not tell its smoothing or what it lacks.
    pub(super) is_lost: bool,
}

impl Score {
    pub(super) fn of(data: &Data<'_>, fit: &Fit, alone: &Alone) -> Option<Self> {
        let (corner, cycle, shape) = (data.corner, fit.cycle(), &fit.shape);
        let mut products = [Gradient::default(); NUMBERS];
        let mut normal = Normal::default();
        let rounded = corner.at(shape);
        for (time, force_n, weight) in data.levels() {
            let since_onset = time - cycle.onset;
            let (force, mut gradient) = shape.force(time);
            let shift = rounded.shift(since_onset);
            gradient[0] -= shift.rate;
            let [smoothing, missing, range] = shift.by;
            normal.add(
                force_n - force - shift.force_n,
                &[smoothing, missing, range, 0.0, 0.0, 0.0],
                weight,
            );
            for (product, by) in products.iter_mut().zip(shift.by) {
                product.iter_mut().zip(gradient).for_each(|(sum, g)| *sum += weight * by * g);
            }
        }
        let response = products.map(|product| alone.factor.solve(&product));
        let mut is_lost = false;
        for i in 0..NUMBERS {
            let whole = normal.matrix[[i, i]];
            for j in 0..=i {
                normal.matrix[[i, j]] -= dot(&products[i], &response[j]);
            }
            normal.right[i] -= dot(&response[i], &alone.right);
            // Without creep its range is not known at all.
            let own = normal.matrix[[i, i]];
            if own.is_nan() {
                return None;
            }
            is_lost |= i < 2 && own <= LEAST_OWN * whole;
        }
        Some(Self { corner, inverse_omega: cycle.inverse_omega(), normal, response, is_lost })
    }

    /// By how much a force moves when the numbers do.
    pub(super) fn by(&self, force: &Gradient) -> [f32; NUMBERS] {
        self.response.map(|response| dot(&response, force))
    }

    /// By how much the unknowns move when the numbers do.
    pub(super) fn moved(&self, steps: &Gradient) -> Gradient {
        let mut moved = Gradient::default();
        for (response, step) in self.response.iter().zip(steps) {
            moved.iter_mut().zip(response).for_each(|(moved, by)| *moved -= step * by);
        }
        moved
    }

    /// The score as if the fit had used sharp corners.
    pub(super) fn told(&self, used: &Gradient) -> Gradient {
        let mut told = self.times(used);
        told.iter_mut().zip(self.normal.right).for_each(|(told, right)| *told += right);
        told
    }

    /// The information times the numbers.
    #[inline(never)]
    pub(super) fn times(&self, numbers: &Gradient) -> Gradient {
        let mut product = Gradient::default();
        for (i, sum) in product.iter_mut().enumerate().take(NUMBERS) {
            for (j, number) in numbers.iter().enumerate().take(NUMBERS) {
                *sum += self.normal.matrix[[i.max(j), i.min(j)]] * number;
            }
        }
        product
    }
}
