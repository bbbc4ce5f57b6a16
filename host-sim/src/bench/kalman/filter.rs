//! State of the filter, and its prediction in both modes.

use nalgebra::{SMatrix, SVector};

use super::super::method::Setup;

const STATES: usize = 6;
pub(super) const FORCE: usize = 0;
pub(super) const RATE: usize = 1;
pub(super) const LOADING: usize = 2;
pub(super) const CENTRE: usize = 3;
pub(super) const OMEGA: usize = 4;
pub(super) const STATIC: usize = 5;

pub(super) type Vector = SVector<f64, STATES>;
pub(super) type Matrix = SMatrix<f64, STATES, STATES>;

/// `omega` before the first slip, rad/s, and its relative uncertainty.
const OMEGA_GUESS: (f64, f64) = (18.0, 0.4);

/// State and covariance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Filter {
    pub x: Vector,
    pub p: Matrix,
}

impl Filter {
    /// State before the first sample.
    pub fn new(setup: &Setup) -> Self {
        let omega = OMEGA_GUESS.0 / setup.rate_hz;
        let x = Vector::from([0.0, 0.0, 0.0, 0.0, omega, 0.0]);
        let mut filter = Self { x, p: Matrix::zeros() };
        filter.widen(FORCE, setup.weight_n);
        filter.widen(LOADING, 0.1 * setup.weight_n);
        filter.widen(OMEGA, OMEGA_GUESS.1 * omega);
        filter
    }

    /// Predicts by `motion`, linearized by central differences.
    pub fn predict(&mut self, motion: impl Fn(&Vector) -> Vector) {
        let mut jacobian = Matrix::zeros();
        for i in 0..STATES {
            let mut step = Vector::zeros();
            step[i] = 1e-5 * (1.0 + self.x[i].abs());
            let change = motion(&(self.x + step)) - motion(&(self.x - step));
            jacobian.set_column(i, &(change / (2.0 * step[i])));
        }
        self.x = motion(&self.x);
        self.p = jacobian * self.p * jacobian.transpose();
    }

    /// Predicts at rest, which is linear.
    pub fn rest(&mut self, periods: f64) {
        self.x = rest(&self.x, periods);
        let mut p = self.p;
        let row = p.row(FORCE) + p.row(LOADING) * periods;
        p.set_row(FORCE, &row);
        p.set_row(RATE, &self.p.row(LOADING));
        let column = p.column(FORCE) + p.column(LOADING) * periods;
        p.set_column(FORCE, &column);
        let loading = p.column(LOADING).into_owned();
        p.set_column(RATE, &loading);
        self.p = p;
    }

    /// Innovation, and its variance without the noise of the sample.
    pub fn innovation(&self, force_n: f64) -> (f64, f64) {
        (force_n - self.x[FORCE], self.p[(FORCE, FORCE)])
    }

    pub fn correct(&mut self, force_n: f64, noise_n2: f64) {
        let (innovation, variance) = self.innovation(force_n);
        let gain = self.p.column(FORCE) / (variance + noise_n2);
        self.x += gain * innovation;
        let row = self.p.row(FORCE).into_owned();
        self.p.ger(-1.0, &gain, &row.transpose(), 1.0);
    }

    pub fn widen(&mut self, state: usize, std: f64) {
        self.p[(state, state)] += std * std;
    }
}

/// State after a time at rest.
pub(super) fn rest(x: &Vector, periods: f64) -> Vector {
    let mut next = *x;
    next[FORCE] += x[LOADING] * periods;
    next[RATE] = x[LOADING];
    next
}

/// Time until a sliding block stops, periods.
fn time_to_stop(x: &Vector) -> f64 {
    let (across, along) = (x[FORCE] - x[CENTRE], x[RATE] / x[OMEGA]);
    let angle = (-along).atan2(across);
    let angle = if across < 0.0 && along > 0.0 { angle + std::f64::consts::TAU } else { angle };
    let sine = (x[LOADING] / x[OMEGA] / across.hypot(along)).clamp(-1.0, 1.0);
    (std::f64::consts::PI + sine.asin() - angle) / x[OMEGA]
}

/// State after a time of sliding, and of rest after the stop.
pub(super) fn slide(x: &Vector, periods: f64) -> Vector {
    let moving = periods.min(time_to_stop(x).max(0.0));
    let (sin, cos) = (x[OMEGA] * moving).sin_cos();
    let across = x[FORCE] - x[CENTRE];
    let mut next = *x;
    next[FORCE] = x[CENTRE] + across * cos + x[RATE] / x[OMEGA] * sin;
    next[RATE] = x[RATE] * cos - x[OMEGA] * across * sin;
    if moving < periods { rest(&next, periods - moving) } else { next }
}

/// State after rest, an onset at `onset`, and sliding.
pub(super) fn moved(x: &Vector, onset: f64, periods: f64) -> Vector {
    if onset >= periods {
        return rest(x, periods);
    }
    let mut start = rest(x, onset);
    start[STATIC] = start[FORCE];
    slide(&start, periods - onset)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// DFF8-13 at rest, in sampling periods.
    fn filter() -> Filter {
        let x = Vector::from([600.0, 22.5, 22.5, 491.4, 1.1828, 781.2]);
        let mut filter = Filter { x, p: Matrix::identity() };
        filter.p[(FORCE, LOADING)] = 0.3;
        filter.p[(LOADING, FORCE)] = 0.3;
        filter
    }

    #[test]
    fn resting_is_the_linearized_motion() {
        let (mut direct, mut general) = (filter(), filter());
        direct.rest(2.0);
        general.predict(|x| rest(x, 2.0));
        assert!((direct.x - general.x).norm() < 1e-9);
        assert!((direct.p - general.p).norm() < 1e-6, "{} {}", direct.p, general.p);
    }

    #[test]
    fn a_slip_ends_where_the_model_ends_it() {
        // The stop is at Fe = 2 Fp - Fs after 2.767 periods; then the stick line follows.
        let x = Vector::from([781.2, 22.5, 22.5, 491.4, 1.1828, 781.2]);
        let stop = time_to_stop(&x);
        assert!((stop / 16.0 - 0.173).abs() < 0.001);
        assert!((slide(&x, stop)[FORCE] - 201.6).abs() < 1e-6);
        assert!((slide(&x, stop + 2.0)[FORCE] - 246.6).abs() < 1e-6);
        let later = moved(&rest(&x, -1.0), 1.0, 1.0 + stop);
        assert!((later[FORCE] - 201.6).abs() < 1e-6 && (later[STATIC] - 781.2).abs() < 1e-6);
    }
}
