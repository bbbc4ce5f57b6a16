//! Elongation of a sagging cable as a function of the force.
//!
//! With `1/k_eff = (1 + S/F³)/k` (Ernst; `S = k q² L³/12`, `q` the cable's weight per length) a
//! force stretches the cable by `y(F) = F − S/(2 F²)`, in units of force and from any zero. At rest
//! `y` grows at the constant rate `k w`: stick lines are straight in it.

use crate::effect::{Effect, Effects};
use crate::num::math::larger;

/// The elongation of a cable by a force, in N: that of a straight one is the force itself.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Elongation {
    /// `S`, N³; zero for a straight cable.
    pub(crate) softness: f32,
    /// The force that equals its own elongation, N; above zero where the cable sags.
    pub(crate) zero_n: f32,
}

impl Elongation {
    /// Does the cable sag?
    pub(crate) fn sags(&self) -> bool {
        Effects::COMPILED.has(Effect::Sag) && self.softness > 0.0
    }

    /// The elongation by a force, N.
    #[inline(always)]
    pub(crate) fn of(&self, force_n: f32) -> f32 {
        if self.sags() { self.of_sagging(force_n) } else { force_n }
    }

    #[inline(never)]
    fn of_sagging(&self, force_n: f32) -> f32 {
        force_n + self.slack_n(self.zero_n) - self.slack_n(force_n)
    }

    /// `S/(2 F²)`; for forces below half of the zero force its value there.
    fn slack_n(&self, force_n: f32) -> f32 {
        let force_n = larger(force_n, 0.5 * self.zero_n);
        0.5 * self.softness / (force_n * force_n)
    }

    /// The force, N, with this elongation: Newton's method, from below.
    pub(crate) fn force_n(&self, elongation_n: f32) -> f32 {
        // One more than the test of this file needs: with two, its 150 N come out .6 N too low.
        const STEPS: u8 = 4;
        if !self.sags() {
            return elongation_n;
        }
        let mut force_n = larger(elongation_n - self.slack_n(self.zero_n), 0.5 * self.zero_n);
        for _ in 0..STEPS {
            force_n += (elongation_n - self.of(force_n)) * self.stiffness(force_n);
        }
        force_n
    }

    /// Derivative of the force by the elongation.
    pub(crate) fn stiffness(&self, force_n: f32) -> f32 {
        1.0 / (1.0 + self.softness / (force_n * force_n * force_n))
    }
}

// Without the feature no cable sags.
#[cfg(test)]
#[cfg(feature = "sag")]
mod tests {
    use super::*;

    #[test]
    fn force_and_elongation_are_each_others_inverse() {
        let cable = Elongation { softness: 5.24e6, zero_n: 226.0 };
        assert!((cable.of(226.0) - 226.0).abs() < 1e-3);
        for force_n in [150.0, 226.0, 300.0, 500.0, 781.0, 2000.0] {
            let back_n = cable.force_n(cable.of(force_n));
            assert!((back_n - force_n).abs() < 0.02, "{force_n} {back_n}");
            let quotient = (cable.of(force_n + 0.5) - cable.of(force_n - 0.5)).recip();
            assert!((cable.stiffness(force_n) - quotient).abs() < 1e-3, "{force_n} {quotient}");
        }
        let straight = Elongation::default();
        assert_eq!((straight.of(-3.0), straight.force_n(-3.0)), (-3.0, -3.0));
    }
}
