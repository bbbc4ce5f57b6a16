//! Estimates that other modules read: noise, rate, omega, and the site.

use crate::coefficient::Site;
use crate::cycle::CycleTracker;
use crate::num::math;
use crate::stats::quantity::Quantity;

impl CycleTracker {
    /// Standard deviation of the noise, N, from the residuals of all fits.
    pub(crate) fn noise_n(&self) -> Option<f32> {
        self.learnt.residuals.variance_n2().map(math::sqrt)
    }

    /// Number of events so far, with or without coefficients.
    pub(crate) fn events(&self) -> u32 {
        self.count
    }

    /// Loading rate, N/s, and omega, rad/s, expected for the next event, each with its standard
    /// deviation. Omega is `None` where its standard deviation is a third of it or more.
    pub(crate) fn shared(&self) -> (Option<Quantity>, Option<Quantity>) {
        let hz = self.site.rate_hz;
        let omega = |inverse: Quantity| {
            let value = hz / inverse.value;
            Quantity { value, std: value * inverse.std / inverse.value }
        };
        let usual = self.learnt.usual_swing();
        let omega = usual.known().filter(|_| self.determines_omega()).map(omega);
        (self.learnt.rate.known().map(|rate| rate.times(hz)), omega)
    }

    /// Is the standard deviation of omega less than a third of it?
    fn determines_omega(&self) -> bool {
        let (swing, variance) = self.learnt.usual_swing().now;
        9.0 * variance < swing * swing
    }

    /// Loading rate over omega, N; zero while one of them is unknown.
    pub(crate) fn overshoot_n(&self) -> f32 {
        let swing = self.learnt.usual_swing().mean().filter(|_| self.determines_omega());
        self.learnt.rate.mean().zip(swing).map_or(0.0, |(rate, swing)| rate * swing)
    }

    /// The site, with the weight that is now in use.
    pub(super) fn site(&self) -> Site {
        let ratio = self.learnt.weight_ratio();
        let Site { weight_n, momentum, .. } = self.site;
        Site { weight_n: ratio * weight_n, momentum: ratio * momentum, ..self.site }
    }

    /// Sine and cosine of the slope.
    pub(crate) fn slope(&self) -> (f32, f32) {
        self.site.slope
    }

    /// Normal force of the block, N, with the weight in use: the force of a coefficient of one.
    pub(crate) fn normal_n(&self) -> f32 {
        let site = self.site();
        site.weight_n * site.slope.1
    }
}
