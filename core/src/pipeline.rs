//! The one entry point: a sample in, what is known out.

use crate::budget::{Known, overshoot_n};
use crate::coefficient::{Coefficient, Estimate, Site};
use crate::config::{Config, ConfigError};
use crate::cycle::{CycleTracker, Finished};
use crate::detector::{Detector, Transition};
use crate::effect::{Effect, Finding};
use crate::effects::level_shift::{Cause, Change};
use crate::effects::zero_drift::Drift;
use crate::estimator::Estimator;
use crate::event::{Event, Provisional, Quality};
use crate::num::math;
use crate::report::{Counters, Report};
use crate::sample::{ForcePoint, ForceSample, Phase, RawSample, SampleFlag, SampleTime, since};
use crate::signal::calibrate::Calibrator;
use crate::signal::decimate::Decimator;
use crate::signal::derivative::{Central, Rate};
use crate::signal::spike::{Judged, SpikeFilter, Usual};
use crate::stats::quantity::Quantity;
use crate::stretch::{Stretch, Stretches};

/// Standard gravity, m/s²: turns a weight into a mass.
const GRAVITY: f32 = crate::units::STANDARD_GRAVITY_M_PER_S2 as f32;

/// Indices beyond this one are refused as duplicates: it takes a billion years.
const LAST_INDEX: u64 = u64::MAX / 2;

/// What one sample led to.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Step {
    /// The sample after calibration. It may still be declared a spike by the
    /// next one, see [`Step::spike`].
    pub sample: ForceSample,
    /// Index of an earlier sample that is now known to be a spike.
    pub spike: Option<u64>,
    /// Rate of the force, by the paper's central difference; two samples late.
    pub rate: Option<Rate>,
    /// What the block is doing. An onset is told by the first sample that is clearly
    /// below the stick line; if that turns out to be a spike, for this sample only.
    pub phase: Phase,
    /// A first answer on the slip that is going on or has just ended.
    pub provisional: Option<Provisional>,
    /// An event that is now complete.
    pub event: Option<Event>,
    /// A change of the block or of its friction that the event told.
    pub change: Option<Change>,
    /// A stretch without events that is now complete.
    pub stretch: Option<Stretch>,
}

impl Step {
    /// Of a sample that led to nothing.
    #[must_use]
    pub fn of(sample: ForceSample) -> Self {
        Self {
            sample,
            spike: None,
            rate: None,
            phase: Phase::Unknown,
            provisional: None,
            event: None,
            change: None,
            stretch: None,
        }
    }
}

/// The whole computation for one test.
#[derive(Clone, Debug)]
pub struct Pipeline {
    config: Config,
    calibrator: Calibrator,
    counters: Counters,
    /// Next index, once there was one.
    next: Option<u64>,
    /// Block of the newest saturated sample.
    last_hidden: Option<u64>,
    spikes: SpikeFilter,
    decimator: Decimator,
    /// Noise of a sample over that of a block.
    block_root: f32,
    derivative: Central,
    detector: Detector,
    cycles: CycleTracker,
    mu_s: Estimator,
    mu: Estimator,
    /// What the zero may have moved by.
    drift: Drift,
    /// Largest force of the events, N.
    largest_n: f32,
    /// Relative standard deviation of the weight by changes of the block: mean over events.
    weight_std: f32,
    events: u32,
    /// The newest change, and whether a step has told it.
    change: Option<Change>,
    told: bool,
    stretches: Stretches,
    onsets: Option<(SampleTime, SampleTime)>,
}

impl Pipeline {
    /// Starts a test.
    ///
    /// # Errors
    /// A configuration value out of its range.
    pub fn new(config: &Config) -> Result<Self, ConfigError> {
        config.validate()?;
        let decimator = Decimator::new(config.rate_hz);
        let rate_hz = config.rate_hz / decimator.factor();
        let site = Site {
            weight_n: config.weight_n,
            slope: math::sin_cos(config.slope_rad),
            rate_hz,
            effects: config.effects,
        };
        Ok(Self {
            config: *config,
            calibrator: Calibrator::new(config),
            counters: Counters::default(),
            next: None,
            last_hidden: None,
            spikes: SpikeFilter::new(),
            decimator,
            block_root: math::sqrt(decimator.factor()),
            derivative: Central::new(config.rate_hz),
            detector: Detector::new(rate_hz, config.effects),
            cycles: CycleTracker::new(site),
            mu_s: Estimator::default(),
            mu: Estimator::default(),
            drift: Drift::default(),
            largest_n: 0.0,
            weight_std: 0.0,
            events: 0,
            change: None,
            told: true,
            stretches: Stretches::new(rate_hz, config.weight_n, config.winch_m_per_s.is_some()),
            onsets: None,
        })
    }

    /// Takes one sample. Bounded in time and memory; never panics.
    ///
    /// Indices must increase: one that was there already is counted as a duplicate
    /// and changes nothing else.
    #[inline]
    pub fn step(&mut self, raw: RawSample) -> Step {
        let mut step = Step::of(self.receive(raw));
        self.take(&mut step);
        step
    }

    /// Takes a received sample. A step is long: it is filled where it lies.
    #[inline(never)]
    fn take(&mut self, step: &mut Step) {
        if let Some(force_n) = step.sample.force_n {
            let newest = ForcePoint { index: step.sample.index, force_n };
            let (detector, root) = (&self.detector, self.block_root);
            match self.spikes.step(newest, || Usual::of(detector, root)) {
                Judged::Nothing => {}
                Judged::Spike(spike) => {
                    self.counters.rejected += 1;
                    step.spike = Some(spike.index);
                }
                Judged::Good(good) => {
                    step.rate = self.derivative.step(good.index, good.force_n);
                    self.good(good, newest, step);
                }
            }
        }
        if !self.told {
            (step.change, self.told) = (self.change, true);
        }
        step.stretch = self.next_stretch();
        if let Some(Provisional { mu_s, mu }) = &mut step.provisional {
            self.add_systematic(Some(mu_s), mu.as_mut());
        }
        step.phase = self.phase(step.sample);
    }

    /// What the block is doing, with a first look at a sample that may still be a spike.
    fn phase(&self, ForceSample { index, force_n, .. }: ForceSample) -> Phase {
        let each = self.block_root <= 1.0;
        match force_n.filter(|_| each) {
            Some(force_n) if self.detector.foresees_slip(ForcePoint { index, force_n }) => {
                Phase::Slip
            }
            _ => self.detector.phase(),
        }
    }

    /// Ends the test: completes what is pending, one event a call, until `None`.
    pub fn finish(&mut self) -> Option<Event> {
        let held = self.spikes.finish().and_then(|held| self.decimator.step(held));
        let event = held.and_then(|block| self.advance(block));
        let event = event.or_else(|| self.decimator.finish().and_then(|block| self.advance(block)));
        event.or_else(|| self.catch_up()).or_else(|| self.last_event())
    }

    /// Ends what is left of a test whose events are all given, one stretch a call, until `None`.
    pub fn finish_stretch(&mut self) -> Option<Stretch> {
        self.stretches.interrupt(Some(u64::MAX));
        self.stretches.close();
        self.next_stretch()
    }

    /// A complete stretch, in samples.
    fn next_stretch(&mut self) -> Option<Stretch> {
        let stretch = self.stretches.next()?;
        let [start, stop] = [stretch.start, stretch.stop].map(|it| self.decimator.moment(it));
        Some(Stretch { start, stop, ..stretch })
    }

    /// The next event of fits that are under way or have to be made.
    fn last_event(&mut self) -> Option<Event> {
        while let Some(finished) = self.cycles.finish(&self.detector) {
            let event = self.count(finished);
            if event.is_some() {
                return event;
            }
        }
        None
    }

    /// The result so far.
    #[must_use]
    pub fn report(&self) -> Report {
        let (loading_rate, omega) = self.cycles.shared();
        let known = Known {
            weight_ratio: (self.cycles.weight_ratio().0, self.weight_std),
            drift_n: self.cycles.force_n(self.drift.mean_std()),
            ..self.known()
        };
        let (mu_s, mu) = self.estimates(&known);
        Report {
            counters: self.counters,
            events: self.events,
            mu_s,
            mu,
            noise_n: self.noise_n().map(|noise_n| noise_n * self.block_root),
            loading_rate_n_per_s: loading_rate,
            omega_rad_per_s: omega,
            stiffness_n_per_m: self.stiffness(loading_rate, omega),
            recurrence_s: self.recurrence_s(),
            zero_n: self.zero_n(),
            zero_std_n: known.zero_n,
            zero_drift_n: known.drift_n,
            damping_std: known.damping_std,
            weight_ratio: known.weight_ratio.0,
            weight_ratio_std: known.weight_ratio.1,
            change: self.change.map(|change| {
                let (weight_ratio, relative) = self.cycles.weight_ratio();
                Change { weight_ratio, weight_ratio_std: relative * weight_ratio, ..change }
            }),
        }
    }

    /// What the test says of each effect, in the order of [`Effect::ALL`].
    #[must_use]
    pub fn findings(&self) -> [Finding; Effect::ALL.len()] {
        Effect::ALL.map(|effect| {
            let enabled = self.config.effects.has(effect);
            let parameters = self.cycles.parameters(effect);
            let found = match effect {
                Effect::Level => self.change.is_some_and(|change| change.cause != Cause::Mass),
                Effect::Drift => self.zero_n().is_some(),
                Effect::Flop | Effect::Ripple | Effect::Forgetting => self.detector.shows(effect),
                Effect::Corner
                | Effect::Sag
                | Effect::Stiffening
                | Effect::Mass
                | Effect::Damping => parameters.iter().any(Option::is_some),
            };
            Finding { effect, enabled, found: enabled && found, parameters }
        })
    }

    /// The means with what is systematic about them.
    fn estimates(&self, known: &Known<'_>) -> (Option<Estimate>, Option<Estimate>) {
        let (mut mu_s, mut mu) = (self.mu_s.estimate(), self.mu.estimate());
        let means = [mu_s.or(mu), mu.or(mu_s)].map(|it| it.map_or(0.0, |it| it.mean));
        for (estimate, std) in [&mut mu_s, &mut mu].into_iter().zip(known.std(means)) {
            if let Some(it) = estimate {
                it.systematic_std = math::hypotenuse(it.common_std, std);
            }
        }
        (mu_s, mu)
    }

    /// The inputs as they are known now.
    fn known(&self) -> Known<'_> {
        let (loading_rate, omega) = self.cycles.shared();
        Known {
            config: &self.config,
            weight_ratio: self.cycles.weight_ratio(),
            zero_n: self.config.std.zero_n(self.largest_n),
            drift_n: self.cycles.force_n(self.drift.std()),
            damping_std: self.cycles.damping_std(self.config.std.damping),
            overshoot_n: overshoot_n(loading_rate, omega),
        }
    }

    /// What is systematic about the coefficients of an event.
    fn add_systematic(&self, mu_s: Option<&mut Coefficient>, mu: Option<&mut Coefficient>) {
        let value = |it: &Option<&mut Coefficient>| it.as_ref().map(|it| it.value);
        let (a, b) = (value(&mu_s), value(&mu));
        let values = [a.or(b), b.or(a)].map(Option::unwrap_or_default);
        let stds = self.known().std(values);
        for (coefficient, std) in [mu_s, mu].into_iter().zip(stds) {
            if let Some(it) = coefficient {
                it.systematic_std = std;
            }
        }
    }

    /// Calibrates, counts and flags.
    fn receive(&mut self, raw: RawSample) -> ForceSample {
        let index = raw.index;
        let mut sample = ForceSample { index, force_n: None, flag: SampleFlag::Duplicate, gap: 0 };
        let expected = self.next.unwrap_or(index);
        if index < expected || index > LAST_INDEX {
            self.counters.duplicates += 1;
            return sample;
        }
        self.next = Some(index + 1);
        self.counters.samples += 1;
        if index > expected {
            let missing = index - expected;
            self.counters.missing = self.counters.missing.saturating_add(missing);
            sample.gap = u32::try_from(missing).unwrap_or(u32::MAX);
        }
        match self.calibrator.force_n(raw.reading) {
            Ok(force_n) => (sample.force_n, sample.flag) = (Some(force_n), SampleFlag::Good),
            Err(flag) => {
                sample.flag = flag;
                self.refuse(index, flag);
            }
        }
        sample
    }

    /// Counts a reading that is no force.
    fn refuse(&mut self, index: u64, flag: SampleFlag) {
        if flag == SampleFlag::Saturated {
            self.counters.saturated += 1;
            self.last_hidden = Some(self.decimator.block(index));
        } else {
            self.counters.rejected += 1;
        }
    }

    /// Takes a good sample on; `newest` is the one that may yet be a spike.
    fn good(&mut self, good: ForcePoint, newest: ForcePoint, step: &mut Step) {
        let Some(block) = self.decimator.step(good) else { return };
        let slips = self.detector.phase() == Phase::Slip;
        // A sample of a block is no block: there the answer comes with the block itself.
        let is_block = self.block_root > 1.0;
        if is_block && slips {
            step.provisional = self.turned(block);
        }
        let transition = self.detect(block);
        if transition.is_some() || !self.cycles.is_idle() {
            step.event = self.follow(transition);
        }
        if !is_block && self.detector.phase() == Phase::Slip {
            step.provisional =
                if slips { self.turned(newest) } else { self.cycles.onset(&self.detector) };
        }
    }

    fn detect(&mut self, sample: ForcePoint) -> Option<Transition> {
        if self.stretches.take(sample) {
            self.detector.stays_below(self.stretches.ceiling_n());
        }
        self.detector.step(sample.index, sample.force_n)
    }

    /// A first answer if the slip is over with the next sample.
    fn turned(&mut self, next: ForcePoint) -> Option<Provisional> {
        if self.detector.turns_with(next) { self.cycles.turned(&self.detector) } else { None }
    }

    /// Takes a good sample through the detector and on.
    fn advance(&mut self, sample: ForcePoint) -> Option<Event> {
        let transition = self.detect(sample);
        if transition.is_none() && self.cycles.is_idle() {
            return None;
        }
        self.follow(transition)
    }

    /// The next event of samples that the detector has yet to look at.
    fn catch_up(&mut self) -> Option<Event> {
        while let Some(transition) = self.detector.catch_up(u32::MAX) {
            let event = self.follow(Some(transition));
            if event.is_some() {
                return event;
            }
        }
        None
    }

    fn follow(&mut self, transition: Option<Transition>) -> Option<Event> {
        if transition.is_some() {
            let (peak, _) = self.detector.extremes();
            let is_new = self.detector.is_up_to_date();
            self.stretches.interrupt(is_new.then(|| peak.index.saturating_sub(1)));
        }
        let finished = match transition {
            None | Some(Transition::Onset | Transition::Cancelled) => self.cycles.work(),
            Some(Transition::Restick { peak, low }) => {
                self.cycles.restick(&self.detector, (peak, low), self.last_hidden)
            }
            Some(Transition::Lost) => self.cycles.lose(&self.detector),
        };
        finished.and_then(|finished| self.count(finished))
    }

    /// Counts an event, unless nothing slipped.
    fn count(&mut self, finished: Finished) -> Option<Event> {
        if let Some(reason) = finished.event.reason.filter(|reason| reason.is_no_slip()) {
            self.stretches.refuse(finished.event.onset, finished.event.stop, reason);
            return None;
        }
        self.stretches.end_before(finished.event.onset);
        let onset = self.stretches.onset(&finished.event);
        let Finished { mut event, alone, common, change } = finished;
        event.onset = self.decimator.moment(onset);
        event.stop = self.decimator.moment(event.stop);
        if let Some(noise_n) = self.cycles.noise_n() {
            self.detector.fitted_noise(noise_n);
            self.detector.creeps(self.cycles.creep_periods());
        }
        self.events = self.events.saturating_add(1);
        if let Some(change) = change {
            let onset = self.decimator.moment(change.onset);
            self.change = Some(Change { onset, ..change });
            self.told = false;
        }
        let (mu_s, mu) = alone.map_or((event.mu_s, event.mu), |(mu_s, mu)| (Some(mu_s), Some(mu)));
        let drifts = self.config.effects.has(Effect::Drift);
        if let Some((mu_s, mu)) = event.mu_s.zip(event.mu).filter(|_| drifts) {
            self.drift.take(mu_s, mu);
        }
        if let Some(mu_s) = mu_s {
            self.mu_s.add_with_common(mu_s, in_common(event.quality, mu_s, common.0));
        }
        if let Some(mu) = mu {
            self.mu.add_with_common(mu, in_common(event.quality, mu, common.1));
        }
        self.largest_n = math::larger(self.largest_n, event.peak_force_n.abs());
        if mu_s.or(mu).is_some() {
            let events = self.mu_s.count().max(self.mu.count()) as f32;
            self.weight_std += (self.cycles.weight_ratio().1 - self.weight_std) / events;
        }
        self.add_systematic(event.mu_s.as_mut(), event.mu.as_mut());
        self.onsets = Some((self.onsets.map_or(event.onset, |(first, _)| first), event.onset));
        Some(event)
    }

    /// `k` from `F' = k w` where the winch speed is known, else from `ω² = k / M`.
    fn stiffness(&self, rate: Option<Quantity>, omega: Option<Quantity>) -> Option<f32> {
        let (ratio, _) = self.cycles.weight_ratio();
        let mass_kg = ratio * self.config.weight_n / GRAVITY;
        match self.config.winch_m_per_s {
            Some(winch) => rate.map(|rate| rate.value / winch),
            None => omega.map(|omega| omega.value * omega.value * mass_kg),
        }
    }

    /// Noise of a block, N: of the fits so far, else the detector's.
    fn noise_n(&self) -> Option<f32> {
        self.cycles.noise_n().or(self.detector.noise_n())
    }

    /// Force of the zero's drift, if it is more than the noise.
    fn zero_n(&self) -> Option<f32> {
        let zero_n = self.cycles.force_n(self.drift.std());
        self.noise_n().filter(|&noise_n| zero_n > noise_n).map(|_| zero_n)
    }

    fn recurrence_s(&self) -> Option<f32> {
        let (first, last) = self.onsets?;
        let periods = since(first.index, last.index) + last.fraction - first.fraction;
        let intervals = self.events.saturating_sub(1);
        (intervals > 0).then(|| periods / (intervals as f32 * self.config.rate_hz))
    }
}

/// Part of an event's standard deviation that is the same in all of them. Where the slip is
/// too short for the sampling, or hidden by a slack cable, all take the same things for
/// granted: a third of it, so that no number of such events makes a mean sharper than that.
fn in_common(quality: Quality, event: Coefficient, common_std: f32) -> f32 {
    const TAKEN_FOR_GRANTED: f32 = 1.0 / 3.0;
    match quality {
        Quality::Good | Quality::Clipped => common_std,
        Quality::Unresolved | Quality::Slack => {
            math::hypotenuse(common_std, TAKEN_FOR_GRANTED * event.std)
        }
    }
}

impl Usual {
    /// Of samples whose noise is so many times that of a block.
    fn of(detector: &Detector, block_root: f32) -> Self {
        let noise_n = detector.noise_n().map(|noise_n| noise_n * block_root);
        Self { noise_n, drop_n: detector.usual_drop_n() }
    }
}
