//! What is said of a slip before its second stick line is there: `mu_s` at the onset, and a
//! first answer when the force has turned.

use crate::cycle::CycleTracker;
use crate::cycle::cycle_fit::iterations_within;
use crate::cycle::slip_record::SlipRecord;
use crate::detector::Detector;
use crate::event::Provisional;
use crate::fit::Variances;
use crate::fit::posterior::Posterior;
use crate::stats::line::Line;

/// Steps of the fit for the first answer, which is wanted at once: two are usual.
const FIRST_STEPS: usize = 5;
/// Samples that all steps together may look at: the time there is.
const FIRST_SAMPLES: usize = 120;

impl CycleTracker {
    /// The slip has begun: a first value of `mu_s`, between the last sample on the line
    /// and the first one off it.
    #[must_use]
    pub fn onset(&mut self, detector: &Detector) -> Option<Provisional> {
        self.early = None;
        let (stick, now) = (detector.stick(), detector.last());
        let line = stick.line_from(now.index);
        let (slope, noise_n, time) = (line.slope()?, detector.noise_n()?, -1.0);
        // Anywhere within the two periods before: a uniform distribution.
        const SPREAD: f32 = 0.577;
        let onset_n = SPREAD * slope;
        let variance_n2 = onset_n * onset_n + noise_n * noise_n * line.leverage(time);
        let mu_s = self.site().coefficient(line.at(time, slope), variance_n2);
        Some(Provisional { mu_s, mu: None })
    }

    /// The force has turned: a first answer from what the other events tell.
    pub fn turned(&mut self, detector: &Detector) -> Option<Provisional> {
        let (stick, extremes) = (detector.stick(), detector.extremes());
        let slip = self.slip(stick, detector, extremes);
        let noise_n2 = self.learnt.fitted_noise_n2(&slip);
        let steps =
            FIRST_STEPS.min(iterations_within(FIRST_SAMPLES, slip.samples().forces_n.len()));
        let none = Line::default();
        let data = self.learnt.of(&slip, &none, noise_n2).data(&slip, &none);
        let mut fitting = slip.guess(&data, self.learnt.knows_omega());
        let mut step = || fitting.step(&data, noise_n2).break_value();
        let mut fit = (0..steps).find_map(|_| step()).flatten();
        let fit = fit.as_mut().filter(|fit| fit.converged && slip.holds(&fit.shape))?;
        self.early = Some((slip.origin, *fit.cycle()));
        let known = self.learnt.residuals.variance_n2().is_some();
        fit.widen_forces(slip.wander.alike);
        fit.widen(&Variances::UNSURE_SWING, self.learnt.unsure_swing(&slip, noise_n2));
        let at = Posterior::at(fit, noise_n2);
        (at.is_resolved() && known && slip.hidden.is_none())
            .then(|| self.first_answer(&slip, &at, noise_n2))
    }

    /// With all that the events so far tell of the cable and of the noise, as the event itself
    /// will have it.
    fn first_answer(&self, slip: &SlipRecord, at: &Posterior, noise_n2: f32) -> Provisional {
        let Posterior { cycle, static_n2, dynamic_n2, .. } = *at;
        let (shift_n, shift_n2) = self.shift(slip, &cycle);
        // The lowest sample may be one of a cable that flops, and makes about a quarter of `Fp`.
        let flop_n2 = (1.0 / slip.rest_weight - 1.0) * noise_n2 / 16.0;
        let mu = || {
            let variance_n2 = dynamic_n2 + shift_n2 + flop_n2;
            self.site().coefficient(cycle.dynamic_n() - shift_n, variance_n2)
        };
        let mu_s = self.site().coefficient(cycle.static_n, static_n2);
        // On a slack cable the time at zero will tell it.
        Provisional { mu_s, mu: cycle.is_taut().then(mu) }
    }
}
