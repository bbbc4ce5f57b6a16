//! Rounding of the corners between stick line and slip, by creep and by the aperture of the
//! converter.
//!
//! *Creep*: the block already moves before it slips, at the speed `f w exp((F − Fs)/c)`. On the
//! stick line then, with `h = −c ln(1 − f)` and the time `t ≤ 0` to the onset,
//!
//! `F = Fs + r t + h − c ln(1 + y)`, `y = (exp(h/c) − 1) exp(r t / c)`
//!
//! so the line, continued to the onset, is `h` above `Fs`, and the slip begins with the force rate
//! `(1 − f) r`. *Aperture*: the converter averages over a time `τ`. It shows `F + κ F''`,
//! `κ = τ²/24`: lines are unchanged, and the ellipse shrinks by `κ ω²`.

use crate::effect::{Effect, Effects};
use crate::model::Shape;
use crate::num::math::{self, larger, smaller};

/// Number of parameters of the corners: `κ`, `h` and `ln c`.
pub(crate) const NUMBERS: usize = 3;
pub(crate) type Numbers = [f32; NUMBERS];

/// Without the effect all corners are sharp, which is known at compile time.
pub(crate) const MAY_BE_ROUND: bool = Effects::COMPILED.has(Effect::Corner);

/// Parameters of the rounded corners; sharp by default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Corner {
    /// `κ`, periods².
    pub smoothing: f32,
    /// `h`, N: the force missing at the onset.
    pub missing_n: f32,
    /// `c`, N: creep is slower by the factor `e` where the force is lower by `c`. Above zero,
    /// unless all three are zero.
    pub range_n: f32,
}

/// Shift of the force by the corners at one time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shift {
    /// Force, N.
    pub force_n: f32,
    /// Its rate, N per period.
    pub(crate) rate: f32,
    /// Derivatives of the force by `κ`, `h` and `ln c`.
    pub(crate) by: Numbers,
}

impl Corner {
    /// Are the corners sharp?
    pub(crate) fn is_sharp(&self) -> bool {
        !MAY_BE_ROUND || self.smoothing <= 0.0 && self.missing_n <= 0.0
    }

    /// The corners of a cycle, with the terms that all times share.
    #[must_use]
    pub fn at<'a>(&self, shape: &'a Shape) -> Rounded<'a> {
        // Half of τ = √(24 κ), and at least that of a common converter.
        const LEAST: f32 = 0.3;
        let half = larger(math::sqrt(6.0 * self.smoothing), LEAST);
        // Most events do not creep.
        let rise =
            if self.missing_n > 0.0 { math::exp(self.missing_n / self.range_n) } else { 1.0 };
        Rounded { corner: *self, shape, half, rise }
    }
}

/// The corners of one cycle.
#[derive(Clone, Copy, Debug)]
pub struct Rounded<'a> {
    corner: Corner,
    shape: &'a Shape,
    /// Half of τ, periods.
    half: f32,
    /// `exp(h/c)`.
    rise: f32,
}

impl Rounded<'_> {
    /// Shift of the force at a time since the onset, periods.
    #[must_use]
    pub fn shift(&self, since_onset: f32) -> Shift {
        if since_onset <= -self.half {
            return self.creep(since_onset);
        }
        let (cycle, slide_time) = (self.shape.cycle(), self.shape.slide_time());
        // Where the cable is slack the force does not depend on the corners.
        if self.shape.is_slack() && since_onset > self.shape.fall_time() {
            return Shift::default();
        }
        let slipping = smaller(larger(since_onset, 0.0), slide_time);
        let (sin, cos) = math::sin_cos(cycle.omega * slipping);
        let q_sin_n = cycle.rate / cycle.omega * sin;
        let by_smoothing = -cycle.omega
            * cycle.omega
            * (cycle.half_drop_n * cos + q_sin_n)
            * seen(since_onset / self.half)
            * seen((slide_time - since_onset) / self.half);
        let mut shift = if since_onset <= 0.0 {
            self.creep(since_onset)
        } else {
            // The slip begins with the rate (1 − f) r, so the ellipse's q is smaller by the part f;
            // after the stop the shift keeps the value that it has there.
            let Corner { missing_n: h, range_n: c, .. } = self.corner;
            let f = 1.0 - 1.0 / self.rise;
            let rate = if since_onset < slide_time { -f * cycle.rate * cos } else { 0.0 };
            let by_missing = -q_sin_n / (c * self.rise);
            Shift { force_n: -f * q_sin_n, rate, by: [0.0, by_missing, -h * by_missing] }
        };
        shift.force_n += self.corner.smoothing * by_smoothing;
        shift.by[0] = by_smoothing;
        shift
    }

    /// Shift by creep on the stick line before the slip.
    fn creep(&self, since_onset: f32) -> Shift {
        let (Corner { missing_n: h, range_n: c, .. }, rise) = (self.corner, self.rise);
        let rate_n = self.shape.cycle().rate;
        let growth = math::exp(rate_n * since_onset / c);
        if h <= 0.0 {
            return Shift { by: [0.0, 1.0 - growth, 0.0], ..Shift::default() };
        }
        let y = (rise - 1.0) * growth;
        let missing_n = c * math::ln(1.0 + y);
        let by_missing = rise * growth / (1.0 + y);
        let rate = -rate_n * y / (1.0 + y);
        let by_range = h * by_missing - rate * since_onset - missing_n;
        Shift { force_n: h - missing_n, rate, by: [0.0, 1.0 - by_missing, by_range] }
    }
}

/// Part of `κ F''` in a mean over `τ` at a time since `F''` jumped from zero, in units of `τ/2`: 0
/// up to −1, and 1 from 1 on.
fn seen(halves: f32) -> f32 {
    let z = halves.clamp(-1.0, 1.0);
    let inside = larger(z, 0.0);
    0.5 * (1.0 + z) * (1.0 + z) * (1.0 + z) - 3.0 * inside * inside
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::CycleParams;

    #[test]
    fn the_derivatives_are_difference_quotients() {
        let (static_n, half_drop_n) = (781.2, 289.8);
        let cycle = CycleParams {
            onset: 0.0,
            rate: 22.5,
            static_n,
            half_drop_n,
            omega: 1.18,
            rate_change: 0.0,
        };
        let shape = cycle.shape();
        let corner = Corner { smoothing: 0.02, missing_n: 20.0, range_n: 30.0 };
        let more = [
            Corner { smoothing: 0.0202, ..corner },
            Corner { missing_n: 20.2, ..corner },
            Corner { range_n: 30.3, ..corner },
        ];
        // Away from the corners, where kappa changes which part of it is seen.
        for time in [-4.0, -2.0, -0.8, 1.0, 1.4, 4.0] {
            let shift = corner.at(&shape).shift(time);
            for (k, (more, step)) in more.iter().zip([2e-4, 0.2, 0.01]).enumerate() {
                let quotient = (more.at(&shape).shift(time).force_n - shift.force_n) / step;
                let error = (quotient - shift.by[k]).abs();
                assert!(error < 0.02 * quotient.abs() + 0.02, "{time} {k} {quotient} {shift:?}");
            }
            let later = corner.at(&shape).shift(time + 1e-2).force_n;
            let rate = (later - shift.force_n) / 1e-2;
            let blurred = 22.5 * corner.smoothing * 1.18 * 1.18 * 15.0;
            assert!((rate - shift.rate).abs() < 0.3 + blurred, "{time} {rate} {shift:?}");
        }
        assert!(Corner::default().is_sharp());
        assert_eq!(!corner.is_sharp(), Effects::COMPILED.has(Effect::Corner));
    }
}
