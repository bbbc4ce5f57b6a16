//! Swings of events and what they say of the mass: `M'/M = (s'/s)²`, `s = 1/ω`.

use crate::stats::prior::Prior;

/// Standard deviations by which the swing of one event has to be off: of normal ones one in 5e8, for a
/// suspect has no coefficients.
const FAR: f32 = 6.0;
/// The same where its forces are as far off: what is left is one in 400.
const LIKELY: f32 = 3.0;
/// A smaller change of the mass is not claimed: sag and wear change the stiffness
/// like that.
pub(super) const LEAST: f32 = 0.05;

/// What an event tells of the mass.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Evidence {
    /// Its swing and the variance of that, periods, with nothing from other events.
    pub inverse_omega: Option<(f32, f32)>,
    /// `Fp`, N.
    pub dynamic_n: f32,
    /// The loading rate is what it was: so are cable and winch.
    pub same_cable: bool,
    /// The model, with what is known of the swing, is far from the samples.
    pub strained: bool,
}

/// The weight in use over the one that was given.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ratio {
    pub(super) value: f32,
    /// Relative variance.
    pub(super) variance: f32,
}

impl Default for Ratio {
    fn default() -> Self {
        Self { value: 1.0, variance: 0.0 }
    }
}

/// Weighted mean of the swings since the last change.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Swings {
    pub(super) count: u32,
    pub(super) mean: f32,
    pub(super) weight: f32,
    /// Mean `Fp`, N.
    pub(super) dynamic_n: f32,
}

impl Swings {
    pub(super) fn add(&mut self, (value, variance): (f32, f32), dynamic_n: f32) {
        let weight = 1.0 / variance;
        self.weight += weight;
        self.mean += weight / self.weight * (value - self.mean);
        self.count += 1;
        self.dynamic_n += (dynamic_n - self.dynamic_n) / self.count as f32;
    }

    /// The mean `Fp`, or what it was before where no swing was seen since, N.
    pub(super) fn dynamic_n_or(&self, before_n: f32) -> f32 {
        if self.count > 0 { self.dynamic_n } else { before_n }
    }
}

impl Evidence {
    /// Is the swing off by more than its noise, and by more than a cable may vary? Less is enough where
    /// `Fp` is `forces` times the usual one as that mass would have it.
    #[inline(never)]
    pub(super) fn is_off(&self, expected: Prior, forces: f32) -> bool {
        let masses = self.mass_ratio(expected);
        let agree = is_nearer(forces, masses);
        self.is_far(expected, 1.0, if agree { LIKELY } else { FAR }) && (masses - 1.0).abs() > LEAST
    }

    /// Does the swing tell that the mass is not `ratio` times the one with the expected swing?
    pub(super) fn excludes(&self, expected: Prior, ratio: f32) -> bool {
        self.is_far(expected, ratio, LIKELY)
    }

    /// Is the mass ratio so many standard deviations from `ratio`? Its variance is four times itself,
    /// times the variance of the swing over the square of the expected one.
    #[inline(never)]
    fn is_far(&self, expected: Prior, ratio: f32, far: f32) -> bool {
        let told = self.inverse_omega.filter(|_| expected.weight > 0.0);
        told.is_some_and(|(_, variance)| {
            let masses = self.mass_ratio(expected);
            let off = (masses - ratio) * expected.mean;
            off * off > 4.0 * far * far * masses * (variance + 1.0 / expected.weight)
        })
    }

    /// Has the mass changed: with the same cable, and the force with it?
    pub(super) fn explains(&self, before: Prior, dynamic_before_n: f32) -> bool {
        let forces = self.dynamic_n / dynamic_before_n;
        self.inverse_omega.is_some()
            && self.same_cable
            && is_nearer(forces, self.mass_ratio(before))
    }

    /// Mass over that of the expected swing.
    fn mass_ratio(&self, expected: Prior) -> f32 {
        let ratio =
            self.inverse_omega.map_or(1.0, |(inverse_omega, _)| inverse_omega / expected.mean);
        ratio * ratio
    }
}

/// Is the ratio of the forces nearer to that of the masses than to one?
pub(super) fn is_nearer(forces: f32, masses: f32) -> bool {
    (forces - masses).abs() < (forces - 1.0).abs()
}
