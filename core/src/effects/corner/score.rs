//! One event's score for the corners, with its information (Rao's score test).

use core::ops::Range;

use crate::effects::score::Asked;
use crate::fit::{Data, Fit};
use crate::model::corner::Numbers;
use crate::stats::normal_equations::{Factor, Gradient, dot};

/// Least part of a parameter's information that is left with the unknowns free: less is lost in
/// rounding, and the event does not determine the parameter.
const LEAST_OWN: f32 = 1e-3;

/// Adds an event's levels at some places to the score of its corners.
pub(crate) fn ask(asked: &mut Asked, data: &Data<'_>, fit: &Fit, places: Range<usize>) {
    let (shape, rounded) = (&fit.shape, data.priors.corner.at(&fit.shape));
    for (time, force_n, weight) in data.levels_in(places) {
        let (force, mut gradient) = shape.force(time);
        let shift = rounded.shift(time - fit.cycle().onset);
        gradient[0] -= shift.rate;
        asked.add(force_n - force - shift.force_n, &gradient, shift.by, weight);
    }
}

/// The normal equations of the steps of the three parameters, the unknowns free.
impl Asked {
    /// Does the event determine a parameter beyond rounding?
    pub(super) fn determines(&self, number: usize) -> bool {
        self.left[number] > LEAST_OWN
    }

    /// Decrease of a force when each parameter grows by one.
    pub(super) fn by(&self, force: &Gradient) -> Numbers {
        self.response.map(|response| dot(&response, force))
    }

    /// Shift of the unknowns when the parameters grow by these steps.
    pub(super) fn moved(&self, steps: &Numbers) -> Gradient {
        let mut moved = Gradient::default();
        for (response, step) in self.response.iter().zip(steps) {
            moved.iter_mut().zip(response).for_each(|(moved, by)| *moved -= step * by);
        }
        moved
    }

    /// The score that a fit with sharp corners would have, to first order.
    pub(super) fn of_sharp(&self, used: &Numbers) -> Numbers {
        let mut score = self.times(used);
        score.iter_mut().zip(self.normal.right).for_each(|(score, right)| *score += right);
        score
    }

    /// The information matrix times the parameters.
    pub(super) fn times(&self, numbers: &Numbers) -> Numbers {
        let mut product = Numbers::default();
        for (i, sum) in product.iter_mut().enumerate() {
            for (j, number) in numbers.iter().enumerate() {
                *sum += self.normal.matrix[[i.max(j), i.min(j)]] * number;
            }
        }
        product
    }
}

/// The three parameters as the first unknowns of a fit, the other three zero.
pub(super) fn with_zeros([smoothing, missing_n, range]: &Numbers) -> Gradient {
    [*smoothing, *missing_n, *range, 0.0, 0.0, 0.0]
}

/// The parameters that solve the normal equations.
pub(super) fn numbers_of(factor: &Factor, right: &Numbers) -> Numbers {
    let [smoothing, missing_n, range, ..] = factor.solve(&with_zeros(right));
    [smoothing, missing_n, range]
}
