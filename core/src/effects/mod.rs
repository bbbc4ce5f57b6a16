//! Effects: departures of an event from the model of line, ellipse, line, and changes between
//! events.

pub(crate) mod corner;
pub(crate) mod damping;
pub(crate) mod level_shift;
pub(crate) mod mass_change;
pub(crate) mod onset;
pub(crate) mod oscillation;
pub(crate) mod sag;
pub(crate) mod scatter;
pub(crate) mod score;
pub(crate) mod stiffening;
pub(crate) mod zero_drift;

#[cfg(test)]
mod synthetic {
    //! Events of DFF8-13 with noise and an effect that the model lacks.

    use crate::fit::levenberg_marquardt::Pass;
    use crate::fit::{Alone, Data, Fit, Priors, Samples};
    use crate::model::CycleParams;
    use crate::noise::ripple::ColoredNoise;
    use crate::stats::line::Line;
    use crate::stats::prior::Prior;
    use crate::tests::Random;

    pub(super) const NOISE_N: f32 = 2.0;

    /// The factored normal equations at a fit; these events have no priors.
    pub(super) fn alone(fit: &Fit, data: &Data<'_>) -> Option<Alone> {
        let mut pass = Pass::at(*fit.cycle());
        while !pass.advance(data, &fit.shape) {}
        pass.alone()
    }

    /// Generates `count` events with sharp corners, their onsets spread over a period; `force_n` is
    /// the force, N, of a cycle at a time.
    pub(super) fn events(
        count: u16,
        force_n: impl Fn(&CycleParams, f32) -> f32,
        mut take: impl FnMut(Data<'_>, &CycleParams),
    ) {
        let mut random = Random(1);
        for event in 0..count {
            let cycle = CycleParams {
                onset: (0.618_034 * f32::from(event)).fract() - 1.0,
                rate: 22.5,
                static_n: 781.2,
                half_drop_n: 289.8,
                omega: 1.1828,
                rate_change: 0.0,
            };
            let mut sample_n = |time: f32| force_n(&cycle, time) + NOISE_N * random.normal();
            let mut line = |from: i16, to: i16| {
                let mut line = Line::default();
                (from..to).for_each(|t| line.add(t.into(), sample_n(t.into()), 1.0, 1.0));
                line
            };
            let (before, after) = (line(-30, -8), line(6, 24));
            let forces_n: [f32; 14] = core::array::from_fn(|i| sample_n(i as f32 - 8.0));
            let rate_change = Prior { mean: 0.0, weight: 1e3 };
            let noise_n2 = NOISE_N * NOISE_N;
            let data = Data {
                before: &before,
                samples: Samples::new(-8.0, &forces_n),
                after: &after,
                wander: ColoredNoise::NONE.into(),
                priors: &Priors { noise_n2, rate_change, ..Priors::default() },
            };
            take(data, &cycle);
        }
    }
}
