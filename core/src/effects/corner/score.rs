//! What one event says of the corners by itself: Rao's score with its information.

use core::ops::Range;

use crate::effects::score::Asked;
use crate::fit::{Alone, Data, Fit};
use crate::model::corner::{Corner, NUMBERS, Numbers};
use crate::stats::normal_equations::{Factor, Gradient, dot};

/// Least part of a number's information that has to be left when the unknowns are free: less is
/// lost in rounding, and the event does not tell the number.
const LEAST_OWN: f32 = 1e-3;

/// What an event tells of the corners by itself.
pub(super) struct CornerScore {
    /// The corners that it was fitted with, and its swing.
    pub(super) corner: Corner,
    pub(super) inverse_omega: f32,
    /// Of the three numbers' steps from there, the unknowns free.
    pub(super) asked: Asked,
}

/// Asks an event's levels at some places for its corners.
pub(crate) fn ask(asked: &mut Asked, data: &Data<'_>, fit: &Fit, places: Range<usize>) {
    let (shape, rounded) = (&fit.shape, data.corner.at(&fit.shape));
    for (time, force_n, weight) in data.levels_in(places) {
        let (force, mut gradient) = shape.force(time);
        let shift = rounded.shift(time - fit.cycle().onset);
        gradient[0] -= shift.rate;
        asked.add(force_n - force - shift.force_n, &gradient, shift.by, weight);
    }
}

impl CornerScore {
    /// Frees the unknowns, when all levels have been asked. `None` where the terms are no numbers.
    pub(super) fn of(corner: Corner, fit: &Fit, alone: &Alone, mut asked: Asked) -> Option<Self> {
        let inverse_omega = fit.cycle().inverse_omega();
        asked.free(alone);
        // Zero is a number: without creep there is no information on its range.
        let is_number = (0..NUMBERS).all(|i| !asked.normal.matrix[[i, i]].is_nan());
        is_number.then_some(Self { corner, inverse_omega, asked })
    }

    /// Does the event tell a number, but for rounding?
    pub(super) fn tells(&self, number: usize) -> bool {
        self.asked.left[number] > LEAST_OWN
    }

    /// By how much a force falls when the numbers grow by one each.
    pub(super) fn by(&self, force: &Gradient) -> Numbers {
        self.asked.response.map(|response| dot(&response, force))
    }

    /// By how much the unknowns move when the numbers grow by these steps.
    pub(super) fn moved(&self, steps: &Numbers) -> Gradient {
        let mut moved = Gradient::default();
        for (response, step) in self.asked.response.iter().zip(steps) {
            moved.iter_mut().zip(response).for_each(|(moved, by)| *moved -= step * by);
        }
        moved
    }

    /// The score as if the fit had used sharp corners.
    pub(super) fn of_sharp(&self, used: &Numbers) -> Numbers {
        let mut score = self.times(used);
        score.iter_mut().zip(self.asked.normal.right).for_each(|(score, right)| *score += right);
        score
    }

    /// The information times the numbers.
    #[inline(never)]
    pub(super) fn times(&self, numbers: &Numbers) -> Numbers {
        let mut product = Numbers::default();
        for (i, sum) in product.iter_mut().enumerate() {
            for (j, number) in numbers.iter().enumerate() {
                *sum += self.asked.normal.matrix[[i.max(j), i.min(j)]] * number;
            }
        }
        product
    }
}

/// The numbers as unknowns of a fit, whose other three are zero.
pub(super) fn with_zeros([smoothing, missing_n, range]: &Numbers) -> Gradient {
    [*smoothing, *missing_n, *range, 0.0, 0.0, 0.0]
}

/// The numbers that solve their normal equations.
pub(super) fn numbers_of(factor: &Factor, right: &Numbers) -> Numbers {
    let [smoothing, missing_n, range, ..] = factor.solve(&with_zeros(right));
    [smoothing, missing_n, range]
}
