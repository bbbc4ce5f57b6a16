//! Swings of the events and the mass ratio from them: `M'/M = (s'/s)²`, `s = 1/ω`.

use crate::stats::prior::Prior;

/// Standard deviations beyond which the swing of one event is off: of normal variables one in 5e8,
/// since a suspect gives no coefficients.
const FAR: f32 = 6.0;
/// Standard deviations beyond which the swing of one event is off where `Fp` deviates in the same
/// way: of normal variables one in 400.
const LIKELY: f32 = 3.0;
/// Least relative change of the mass that is reported: sag and wear change the stiffness by as
/// much.
pub(super) const LEAST: f32 = 0.05;

/// An event's evidence on the mass.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Evidence {
    /// The event's swing, periods, and its variance, without the prior.
    pub inverse_omega: Option<(f32, f32)>,
    /// `Fp`, N.
    pub dynamic_n: f32,
    /// The loading rate has not changed, so neither have cable and winch.
    pub same_cable: bool,
    /// The model, with the prior of the swing, is far from the samples.
    pub strained: bool,
}

/// The weight in use over the given one.
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

    /// The mean `Fp`, N, or `before_n` where no swing was seen since.
    pub(super) fn dynamic_n_or(&self, before_n: f32) -> f32 {
        if self.count > 0 { self.dynamic_n } else { before_n }
    }
}

impl Evidence {
    /// Does the swing imply a mass that has changed significantly, and by more than [`LEAST`]? The
    /// limit is lower where `forces`, the ratio of `Fp` to its mean, is nearer to that mass ratio
    /// than to one.
    pub(super) fn is_off(&self, expected: Prior, forces: f32) -> bool {
        let masses = self.mass_ratio(expected);
        let agree = is_nearer(forces, masses);
        self.is_far(expected, 1.0, if agree { LIKELY } else { FAR }) && (masses - 1.0).abs() > LEAST
    }

    /// Is the event as those before? One without a swing of its own is if its force is.
    pub(super) fn is_usual(&self, expected: Prior, forces: f32) -> bool {
        let has_swing = self.inverse_omega.is_some();
        if has_swing { !self.is_off(expected, forces) } else { (forces - 1.0).abs() <= 0.0 }
    }

    /// Does the swing exclude a mass of `ratio` times the one with the expected swing?
    pub(super) fn excludes(&self, expected: Prior, ratio: f32) -> bool {
        self.is_far(expected, ratio, LIKELY)
    }

    /// Is the mass ratio more than `far` standard deviations from `ratio`? Its variance is four
    /// times the ratio, times the variances of both swings over the square of the expected one.
    fn is_far(&self, expected: Prior, ratio: f32, far: f32) -> bool {
        let own = self.inverse_omega.filter(|_| expected.weight > 0.0);
        own.is_some_and(|(_, variance)| {
            let masses = self.mass_ratio(expected);
            let off = (masses - ratio) * expected.mean;
            off * off > 4.0 * far * far * masses * (variance + 1.0 / expected.weight)
        })
    }

    /// Does a change of the mass explain the event: the cable is the same, and `Fp` changed as the
    /// mass?
    pub(super) fn explains(&self, before: Prior, dynamic_before_n: f32) -> bool {
        let forces = self.dynamic_n / dynamic_before_n;
        self.inverse_omega.is_some()
            && self.same_cable
            && is_nearer(forces, self.mass_ratio(before))
    }

    /// Ratio of the mass to the one with the expected swing.
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
