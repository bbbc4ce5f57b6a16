//! Estimates from the events of a test so far, as expectations (priors) for the next one.

use crate::cycle::slip_record::SlipRecord;
use crate::effect::{Effect, Effects, Kept};
use crate::effects::corner::CornerEstimator;
use crate::effects::damping::Damping;
use crate::effects::mass_change::{Evidence, Mass, Verdict};
use crate::effects::onset::Onset;
use crate::effects::oscillation::Oscillation;
use crate::effects::sag::Sag;
use crate::effects::scatter::SlipScatter;
use crate::fit::posterior::{CLEAR, Posterior};
use crate::fit::residuals::Residuals;
use crate::fit::{Data, Fit, Priors, rounding_n2};
use crate::num::math::{self, larger};
use crate::stats::fading_trend::FadingTrend;
use crate::stats::in_a_row::InARow;
use crate::stats::line::Line;
use crate::stats::normal_equations::UNKNOWNS;
use crate::stats::prior::{LEAST_OWN, Prior, without_prior};
use crate::stats::significance::SIGNIFICANT;

/// Estimates that the events share (loading rate, swing, rate change), the noise, and the state of
/// each effect.
#[derive(Clone, Debug, Default)]
pub(crate) struct Expectations {
    pub(super) effects: Effects,
    pub(crate) rate: FadingTrend,
    /// The swing, since the last change of the mass.
    pub(crate) inverse_omega: FadingTrend,
    pub(super) rate_change: FadingTrend,
    pub(crate) mass: Kept<Mass, { Effect::Mass.room() }>,
    pub(crate) corner: Kept<CornerEstimator, { Effect::Corner.room() }>,
    pub(crate) sag: Kept<Sag, { Effect::Sag.room() }>,
    pub(crate) residuals: Residuals,
    pub(crate) scatter: Kept<SlipScatter, { Effect::Scatter.room() }>,
    pub(crate) damping: Kept<Damping, { Effect::Damping.room() }>,
    pub(crate) onset: Kept<Onset, { Effect::Onset.room() }>,
    pub(crate) oscillation: Kept<Oscillation, { Effect::Ripple.room() }>,
    /// Events that contradict the expectations.
    pub(super) contradictions: InARow,
    /// First events whose winch may have stood while the cable hung slack.
    pub(super) stood: InARow,
    /// The residuals include samples with flop weights.
    pub(super) weighted: bool,
    /// Speed of the winch times the mass of the given weight, N periods; NaN where the speed is
    /// unknown.
    momentum: f32,
}

/// Least own part of a fitted precision for the test of the mass: another block differs by much.
const LEAST_JUDGED: f32 = 0.003;
/// Standard deviation of a rough loading rate, relative: it is known to within a factor of two.
const ROUGH: f32 = 0.7;
/// Fewest samples of both lines that determine the first event's rate change.
const LINE: u32 = 8;

impl Expectations {
    /// Before the first event.
    pub(crate) fn new(effects: Effects, momentum: f32) -> Self {
        Self { effects, momentum, ..Self::default() }
    }

    /// Variance of the white noise, N²: from the fits so far, else the detector's; at least the
    /// variance of rounding in single precision.
    pub(crate) fn noise_n2(&self, slip: &SlipRecord) -> f32 {
        let noise_n2 = self.residuals.variance_n2().unwrap_or(slip.noise_n2);
        larger(slip.white_share() * noise_n2, rounding_n2(slip.peak.force_n))
    }

    /// Variance of the white noise from the fits alone, N². Before the first fit it is nearly zero,
    /// so that rough priors get almost no weight.
    pub(crate) fn fitted_noise_n2(&self, slip: &SlipRecord) -> f32 {
        const HARDLY: f32 = 1e-3;
        match self.residuals.variance_n2() {
            Some(_) => self.noise_n2(slip),
            None => HARDLY * slip.noise_n2,
        }
    }

    /// The priors of an event with this line after it.
    pub(crate) fn of(&self, slip: &SlipRecord, after: &Line, noise_n2: f32) -> Priors {
        let (rough, wander) = (slip.rough(after), slip.wander);
        let has_lines = slip.before.count.min(after.count) >= LINE && slip.wander.level <= 0.0;
        let rate = expected(self.rate.prior(noise_n2), rough.rate, ROUGH * rough.rate, noise_n2);
        let known_swing =
            if self.knows_omega() { self.inverse_omega.prior(noise_n2) } else { Prior::default() };
        let (guess, spread) = rough.swing(self.swing_by_winch(rate.mean));
        let inverse_omega = expected(known_swing, guess, spread, noise_n2);
        Priors {
            noise_n2,
            rate: rate.loosened(wander.slope),
            inverse_omega,
            rate_change: self
                .rate_change_prior(rough.rate, has_lines, noise_n2)
                .loosened(4.0 * wander.slope),
            onset: rough.onset(noise_n2),
            corner: self.corner.read(|corner| corner.expected(rate.mean, inverse_omega.mean)),
        }
    }

    /// Prior of the rate change: zero until the events determine one, since the winch turns
    /// steadily.
    fn rate_change_prior(&self, rough_rate: f32, has_lines: bool, noise_n2: f32) -> Prior {
        const STEADY: f32 = 0.003;
        // The first slip may tighten the cable, and the winch may yet have to come up to speed.
        const FIRST: f32 = 0.3;
        let learnt = self.rate_change.prior_around_zero(noise_n2);
        if learnt.weight > 0.0 {
            return learnt;
        }
        let first = if has_lines { FIRST } else { STEADY };
        let spread = self.rate.mean().map_or(first * rough_rate, |rate| STEADY * rate);
        Prior { mean: 0.0, weight: noise_n2 / (spread * spread) }
    }

    /// Variances of `Fs` and `Fp`, N², due to the unknown time at which the rate changed by `b`:
    /// during the slip, or in the samples next to it that no line has.
    ///
    /// A step at the angle `ωt` of the slip lifts `Fe` by `b sin(ωt) / ω`; the model has the mean
    /// over an even change, `2/π` of the largest. With odds of one half for any time in the slip
    /// and one half for either end, the standard deviation about that is `0.5 b/ω`, and half of it
    /// in `Fp`. A step at a time `t` before the onset lifts `Fs` by `b t`, one after the stop
    /// lowers `Fe` by as much, and half of either is in `Fp`. On a slack cable the winch may take
    /// up the slack at either rate: `T` at zero is proportional to `(Fs - 2 Fp) / (r Fp)`
    /// (`model/slack.rs`, without `q`), which moves `Fp` by `Fp (Fs - 2 Fp) b / (r Fs)`. Zero where
    /// the force wanders: `b` may then come from that.
    pub(crate) fn unsteady_n2(&self, slip: &SlipRecord, posterior: &Posterior) -> (f32, f32) {
        // Root mean square of `t`, periods, for a uniform `t` within the four samples by which the
        // lines lag, `4/√3`.
        const BESIDE: f32 = 2.3;
        let Posterior { cycle, variances: [.., variance, _], .. } = posterior;
        if slip.wander.level > 0.0 {
            return (0.0, 0.0);
        }
        let own = cycle.rate_change - self.rate_change.prior_around_zero(1.0).mean;
        let own2 = larger(own * own - variance, 0.0);
        let restick_n = cycle.dynamic_n() - cycle.half_drop_n;
        let within = if restick_n < 0.0 {
            cycle.dynamic_n() * restick_n / (cycle.static_n * cycle.rate)
        } else {
            0.25 * cycle.inverse_omega()
        };
        let beside = BESIDE * BESIDE;
        (beside * own2, (0.25 * beside + within * within) * own2)
    }

    /// The swing that weight and winch give at a loading rate, N per period, periods: `1/ω² = M / k`,
    /// where the winch loads the cable by `k w`. NaN where its speed is unknown.
    pub(super) fn swing_by_winch(&self, rate: f32) -> f32 {
        math::sqrt(self.weight_ratio() * self.momentum / rate)
    }

    /// Is the swing known from earlier events? If few of them determine it, those are the ones that
    /// came out long by chance.
    #[inline(never)]
    pub(crate) fn knows_omega(&self) -> bool {
        self.inverse_omega.is_well_known(&self.rate)
    }

    /// The swing, periods, where it is known from earlier events.
    pub(crate) fn swing(&self) -> Option<f32> {
        self.inverse_omega.mean().filter(|_| self.knows_omega())
    }

    /// Trend of the swing, periods; while the mass may have changed, the one from before that.
    pub(crate) fn usual_swing(&self) -> &FadingTrend {
        self.mass.get().and_then(Mass::before_suspect).unwrap_or(&self.inverse_omega)
    }

    /// Weight in use over the given one.
    pub(crate) fn weight_ratio(&self) -> f32 {
        self.mass.get().map_or(1.0, Mass::weight_ratio)
    }

    /// Updates loading rate, swing and rate change with the event's own values, unless it is
    /// suspect. `dynamic_n` is `Fp`, of a sagging cable not in elongation, whose zero differs from
    /// event to event. `strained` is from [`is_strained`]; `excess` is the factor by which the
    /// misfit multiplied the variances.
    pub(crate) fn learn(
        &mut self,
        data: &Data<'_>,
        posterior: &Posterior,
        dynamic_n: f32,
        noise_n2: f32,
        (strained, excess): (bool, f32),
    ) -> Verdict {
        let Posterior { cycle, variances: [_, rate, _, _, inverse_omega, rate_change, _], .. } =
            *posterior;
        self.rate.forget();
        self.rate_change.forget();
        self.sag.update(Sag::forget);
        self.inverse_omega.forget();
        let own =
            |value, variance, prior, least| without_prior(value, variance, prior, noise_n2, least);
        // The loading rate and the swing are above zero; the rate change may have any sign.
        let positive = |own: &(f32, f32)| own.0 > 0.0;
        // A slip that is hardly resolved only returns the prior of its swing.
        let own_swing = |variance, least| {
            let own = own(cycle.inverse_omega(), variance, data.priors.inverse_omega, least)
                .filter(positive);
            own.filter(|own| posterior.determines_swing(own.1))
        };
        let mut evidence = Evidence {
            // A small own part suffices for the test: the prior hides a changed swing. Without
            // `excess`, since with the right mass the model would fit. Not on a slack cable, which
            // cannot push.
            inverse_omega: own_swing(inverse_omega / excess, LEAST_JUDGED)
                .filter(|_| cycle.restick_n() > 0.0),
            dynamic_n,
            // Without a line before it the event's rate is only the prior.
            same_cable: data.before.count > 0 && self.is_usual_rate(cycle.rate),
            strained: strained && cycle.restick_n() > 0.0,
        };
        let watches = self.effects.has(Effect::Mass);
        let judge = |mass: &mut Mass| mass.judge(&mut self.inverse_omega, &evidence);
        let verdict = if watches { self.mass.update(judge) } else { Verdict::Same };
        let on_trial = self.mass.read(Mass::is_on_trial);
        let own_rate = own(cycle.rate, rate, data.priors.rate, LEAST_OWN).filter(positive);
        if strained || (verdict == Verdict::Suspect && !on_trial) {
            return verdict;
        }
        // A rate that changed in the first event is not that of the next ones, nor is its change
        // theirs.
        let change = cycle.rate_change;
        let steady =
            self.rate.mean().is_some() || change * change < SIGNIFICANT * SIGNIFICANT * rate_change;
        if let Some((value, variance)) = own_rate.filter(|_| steady) {
            self.rate.add(value, variance);
        }
        let own_change = own(cycle.rate_change, rate_change, data.priors.rate_change, LEAST_OWN);
        if let Some((value, variance)) = own_change.filter(|_| steady) {
            self.rate_change.add(value, variance);
        }
        evidence.inverse_omega =
            own_swing(inverse_omega, LEAST_OWN).filter(|_| !on_trial || is_clear(posterior));
        if let Some((value, variance)) = evidence.inverse_omega {
            self.inverse_omega.add(value, variance);
        }
        self.mass.update(|mass| mass.learn(&evidence)).unwrap_or(verdict)
    }

    /// Is the loading rate near the mean of the earlier events, as a steady winch gives it?
    fn is_usual_rate(&self, rate: f32) -> bool {
        const STEADY: f32 = 0.1;
        self.rate.mean().is_none_or(|usual| (rate - usual).abs() < STEADY * usual)
    }
}

/// Is the slip long enough to resolve a small change of the swing in spite of the sampling?
pub(crate) fn is_clear(posterior: &Posterior) -> bool {
    posterior.fall_time > CLEAR && posterior.cycle.restick_n() > 0.0
}

/// Are the squared residuals of samples and lines around the slip, N², far above the noise?
pub(crate) fn is_strained(data: &Data<'_>, around_n2: f32, noise_n2: f32) -> bool {
    const STRAINED: f32 = 10.0;
    // The lines are two observations each.
    let observations = data.samples.count() as f32 + 4.0;
    around_n2 > STRAINED * observations * noise_n2
}

/// The prior learnt from earlier events, else a guess with its standard deviation.
fn expected(learnt: Prior, guess: f32, spread: f32, noise_n2: f32) -> Prior {
    if learnt.weight > 0.0 {
        return learnt;
    }
    Prior { mean: guess, weight: noise_n2 / (spread * spread) }
}

/// Squared residuals of an event without the priors' part, N², and their degrees of freedom:
/// observations less unknowns, each unknown counted as far as the event and not its prior
/// determines it.
pub(crate) fn own_residuals(data: &Data<'_>, fit: &Fit) -> (f32, f32) {
    let (mut squares, mut unknowns) = (fit.cost + data.after.residual_n2, UNKNOWNS as f32);
    for ((prior, value), variance) in
        data.priors.with_values(fit.cycle()).into_iter().zip(fit.variances)
    {
        squares -= prior.weight * (prior.mean - value) * (prior.mean - value);
        unknowns -= prior.weight * variance;
    }
    let lines = data.before.count.min(2) as f32 + data.after.weight;
    (larger(squares, 0.0), data.samples.count() as f32 + lines - unknowns)
}
