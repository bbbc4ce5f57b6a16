//! The one entry point: a sample in, all results out.
//!
//! A sample passes these stages: it is received (calibrated, counted: `receive`), tested for a
//! spike, examined by the detector and followed by the cycles. An event that results from it is
//! counted (`tally`); the results of all events make the report (`findings`), with the effects that
//! they show (`found`).

mod findings;
mod found;
mod receive;
mod tally;

use crate::coefficient::Site;
use crate::config::{Config, ConfigError};
use crate::cycle::{Answers, CycleTracker};
use crate::detector::{Detector, Transition};
use crate::effect::{Effect, Kept};
use crate::effects::level_shift::Change;
use crate::effects::zero_drift::Drift;
use crate::estimator::Estimator;
use crate::event::{Event, Provisional};
use crate::num::math;
use crate::report::Counters;
use crate::sample::{ForcePoint, ForceSample, Phase, RawSample, SampleFlag, SampleTime};
use crate::signal::calibrate::Calibrator;
use crate::signal::decimate::Decimator;
use crate::signal::derivative::{Central, Rate};
use crate::signal::spike::{Judged, SpikeFilter};
use crate::stretch::{Stretch, Stretches};

/// What one sample led to.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Step {
    /// The sample after calibration. The next sample may still show that it is a spike, see
    /// [`Step::spike`].
    pub sample: ForceSample,
    /// Index of an earlier sample that is now known to be a spike.
    pub spike: Option<u32>,
    /// Rate of the force, by the paper's central difference; two samples late.
    pub rate: Option<Rate>,
    /// What the block is doing. A slip shows at the first sample that is clearly below the stick
    /// line; if that turns out to be a spike, for this sample only.
    pub phase: Phase,
    /// A first answer on the slip that is going on or has just ended.
    pub provisional: Option<Provisional>,
    /// An event that is now complete.
    pub event: Option<Event>,
    /// A change of the block or of its friction that an event has shown.
    pub change: Option<Change>,
    /// A stretch without events that is now complete.
    pub stretch: Option<Stretch>,
}

impl Step {
    /// For a sample that leads to nothing.
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
// Field order: first what every sample touches, which the board reaches in one instruction.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Pipeline {
    /// The next index; before the first sample any index may come.
    next: u32,
    counters: Counters,
    spikes: SpikeFilter,
    decimator: Decimator,
    derivative: Central,
    calibrator: Calibrator,
    /// Standard deviation of the noise of a sample over that of a block: the root of its length.
    block_root: f32,
    stretches: Stretches,
    detector: Detector,
    cycles: CycleTracker,
    config: Config,
    /// Block of the newest saturated sample.
    last_hidden: Option<u32>,
    mu_s: Estimator,
    mu: Estimator,
    /// Statistics for a drift of the zero.
    drift: Kept<Drift, { Effect::Drift.room() }>,
    /// Largest force of the events with a coefficient, N: a knock's says nothing of the zero.
    largest_n: f32,
    /// Relative standard deviation of the weight due to changes of the block, mean over the events.
    weight_std: Kept<f32, { Effect::Mass.room() }>,
    /// The newest change.
    change: Option<Change>,
    /// Onset of the newest event, unless a stretch without an event follows it; number of the
    /// intervals between events that hide no slip, and their mean. In blocks.
    last_onset: Option<SampleTime>,
    intervals: u32,
    recurrence: f32,
}

impl Pipeline {
    /// Starts a test.
    ///
    /// # Errors
    /// A configuration value out of its range.
    // Not inlined: built field by field by the caller it takes some hundred bytes of flash more.
    #[inline(never)]
    pub fn new(config: &Config) -> Result<Self, ConfigError> {
        config.validate()?;
        let decimator = Decimator::new(config.rate_hz);
        let rate_hz = config.rate_hz / decimator.factor();
        let site = Site {
            weight_n: config.weight_n,
            momentum: config.winch_m_per_s.map_or(f32::NAN, |w| w * config.mass_kg() * rate_hz),
            slope: math::sin_cos(config.slope_rad),
            rate_hz,
        };
        Ok(Self {
            config: *config,
            calibrator: Calibrator::new(config),
            counters: Counters::default(),
            next: 0,
            last_hidden: None,
            spikes: SpikeFilter::default(),
            decimator,
            block_root: math::sqrt(decimator.factor()),
            derivative: Central::new(config.rate_hz),
            detector: Detector::new(rate_hz, config.effects),
            cycles: CycleTracker::new(site, config.effects),
            mu_s: Estimator::default(),
            mu: Estimator::default(),
            drift: Kept::default(),
            largest_n: 0.0,
            weight_std: Kept::default(),
            change: None,
            stretches: Stretches::new(rate_hz, config.weight_n, config.winch_m_per_s.is_some()),
            last_onset: None,
            intervals: 0,
            recurrence: 0.0,
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

    /// Takes a received sample through all stages. `step` is filled in place, since it is large.
    // Not inlined: `cargo xtask test` looks for panics from here on.
    #[inline(never)]
    fn take(&mut self, step: &mut Step) {
        if let Some(force_n) = step.sample.force_n {
            let newest = ForcePoint { index: step.sample.index, force_n };
            // The noise of a sample is the root of a block's length times that of the block.
            let noise_n = self.detector.std_n * self.block_root;
            match self.spikes.step(newest, noise_n, self.detector.usual_drop_n) {
                Judged::Nothing => {}
                Judged::Spike(spike) => {
                    self.counters.rejected += 1;
                    step.spike = Some(spike.index);
                }
                Judged::Good(good) => {
                    step.rate = self.derivative.step(good.index, good.force_n);
                    self.good(good, step);
                }
            }
        }
        if let Some(stretch) = self.stretches.next() {
            step.stretch = Some(self.in_samples(stretch));
        }
        step.phase = self.phase(step.sample);
    }

    /// Takes a good sample into its block.
    fn good(&mut self, good: ForcePoint, step: &mut Step) {
        if let Some(block) = self.decimator.step(good) {
            self.block(block, step);
        }
    }

    /// Takes a block of good samples through the detector and the cycles.
    fn block(&mut self, block: ForcePoint, step: &mut Step) {
        if self.stretches.take(block) {
            self.detector.stays_below(self.stretches.ceiling_n());
        }
        let transition = self.detector.step(block.index, block.force_n, self.cycles.is_full());
        // For most samples nothing has happened, and no fit is under way.
        if transition.is_none() && self.cycles.is_idle() {
            return;
        }
        self.follow(transition, step);
        if transition == Some(Transition::Onset) && !self.decimator.averages() {
            step.provisional = self.cycles.onset(&self.detector);
        }
        if let Some(Provisional { mu_s, mu }) = &mut step.provisional {
            self.add_systematic(Some(mu_s), mu.as_mut());
        }
    }

    /// Passes the detector's transition to the cycles; their first answer and their event go into
    /// the step.
    fn follow(&mut self, transition: Option<Transition>, step: &mut Step) {
        // A cancelled fall does not end a constant force.
        if let Some(Transition::Restick { .. } | Transition::Lost) = transition {
            let highest = self.detector.ended.highest;
            let is_new = !self.detector.is_behind;
            self.stretches.interrupt(is_new.then(|| highest.index.saturating_sub(1)));
            self.detector.stays_below(None);
        }
        let mut answers = Answers::default();
        self.cycles.follow(&self.detector, transition, self.last_hidden, &mut answers);
        step.provisional = answers.first;
        if let Some(finished) = answers.finished {
            self.count(finished, step);
        }
    }

    /// Marks that the winch turns, or is held, from the next sample on, as seen by somebody beside
    /// it. In a constant force this decides whether the block moved, whatever the configuration
    /// says. Gives that sample's index.
    pub fn mark_winch(&mut self, turns: bool) -> u32 {
        self.stretches.mark_winch(turns);
        self.next
    }

    /// What the block is doing, by a first look at a sample that may still turn out to be a spike.
    fn phase(&self, ForceSample { index, force_n, .. }: ForceSample) -> Phase {
        match force_n.filter(|_| !self.decimator.averages()) {
            Some(force_n) if self.detector.foresees_slip(ForcePoint { index, force_n }) => {
                Phase::Slip
            }
            _ => self.detector.phase(),
        }
    }

    /// Ends the test: completes what is pending, one event a call, until `None`.
    pub fn finish(&mut self) -> Option<Event> {
        let flag = SampleFlag::Duplicate;
        let mut step = Step::of(ForceSample { index: self.next, force_n: None, flag, gap: 0 });
        if let Some(held) = self.spikes.finish() {
            self.good(held, &mut step);
        }
        while step.event.is_none()
            && let Some(block) = self.decimator.finish()
        {
            self.block(block, &mut step);
        }
        while step.event.is_none()
            && let Some(transition) = self.detector.catch_up(u32::MAX, false)
        {
            self.follow(Some(transition), &mut step);
        }
        while step.event.is_none()
            && let Some(finished) = self.cycles.finish(&self.detector)
        {
            self.count(finished, &mut step);
        }
        step.event
    }

    /// Completes what is left of a test whose events have all been given, one stretch a call, until
    /// `None`.
    pub fn finish_stretch(&mut self) -> Option<Stretch> {
        self.stretches.interrupt(Some(u32::MAX));
        self.stretches.close();
        self.stretches.next().map(|stretch| self.in_samples(stretch))
    }

    /// A stretch with times in samples, from one with times in blocks.
    fn in_samples(&self, stretch: Stretch) -> Stretch {
        let [start, stop] = [stretch.start, stretch.stop].map(|it| self.decimator.moment(it));
        Stretch { start, stop, ..stretch }
    }
}
