//! Evaluates the classes of trouble, each in two ways.
//!
//! (a) With exact inputs; (b) with weight, slope, zero and span drawn for each record from their
//! stated standard deviations.

use floe::bench::matching::Detection;
use floe::bench::scenes::at_phase;
use floe::replay::known::Zero;
use floe::sim::{Scene, Simulation, TrueEvent, simulate};
use floe_core::{Coefficient, Config, Effect, Estimate, Event, InputStd, Report};

use crate::normal::Normal;
use crate::score::{average, pair, quantile, rms};
use crate::{both, feed};

/// Time after a stop that an event needs to be judged, s, for a part of the following line.
const AFTER_S: f64 = 0.6;

/// Stated standard deviations of the inputs, the core's defaults: relative weight, slope in
/// degrees, zero as a fraction of the largest force, relative span.
const INPUTS: [f64; 4] = [0.003, 0.2, 0.001, 0.001];

/// Expected result for a class.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Coefficients with intervals that cover the truth and are not unnecessarily wide.
    Events,
    /// Coefficients with intervals that cover the truth. The samples do not reveal the cause, so
    /// the intervals have the width of the stated prior. A drifting zero is measured after the test
    /// as well.
    Unseen,
    /// No event.
    Nothing,
    /// Events without coefficients, or none.
    Refused,
}

impl Kind {
    /// Whether true events with coefficients are judged.
    #[must_use]
    pub fn is_judged(self) -> bool {
        matches!(self, Self::Events | Self::Unseen)
    }
}

/// The judged quantities: combined standard deviation and 95 % interval.
mod stated {
    use super::{Coefficient, Estimate};

    pub fn event(c: &Coefficient) -> (f64, (f64, f64)) {
        let (low, high) = c.ci95();
        (c.combined_std().into(), (low.into(), high.into()))
    }

    /// `None` if the core states no standard deviation.
    pub fn mean(e: &Estimate) -> Option<(f64, (f64, f64))> {
        let (std, (low, high)) = e.combined_std().zip(e.ci95())?;
        Some((std.into(), (low.into(), high.into())))
    }
}

/// Errors and intervals of one coefficient.
#[derive(Clone, Debug, Default)]
pub struct Intervals {
    errors: Vec<f64>,
    stds: Vec<f64>,
    covered: usize,
}

impl Intervals {
    fn add(&mut self, value: f32, truth: f64, (std, (low, high)): (f64, (f64, f64))) {
        self.errors.push(f64::from(value) - truth);
        self.stds.push(std);
        self.covered += usize::from((low..=high).contains(&truth));
    }

    /// Number of intervals.
    #[must_use]
    pub fn count(&self) -> usize {
        self.errors.len()
    }

    /// Fraction that covers the truth.
    #[must_use]
    pub fn coverage(&self) -> f64 {
        self.covered as f64 / self.count() as f64
    }

    /// Absolute errors in standard deviations.
    pub fn scaled(&self) -> impl Iterator<Item = f64> + '_ {
        self.errors.iter().zip(&self.stds).map(|(e, s)| (e / s).abs())
    }

    /// Largest error in standard deviations.
    #[must_use]
    pub fn worst(&self) -> f64 {
        self.scaled().fold(0.0, f64::max)
    }

    /// Fraction of errors above five standard deviations.
    #[must_use]
    pub fn beyond_five(&self) -> f64 {
        self.scaled().filter(|z| *z > 5.0).count() as f64 / self.count() as f64
    }

    /// Ratio of the median standard deviation to the root-mean-square error.
    #[must_use]
    pub fn width(&self) -> f64 {
        quantile(self.stds.iter().copied(), 0.5) / rms(&self.errors)
    }
}

/// Results of a class; pairs are of `mu_s` and `mu`.
#[derive(Clone, Debug, Default)]
pub struct Judged {
    /// Detection of the events.
    pub detection: Detection,
    /// Number of found events with a coefficient that match no true event.
    pub wrong_coefficients: usize,
    /// Number of true events with both coefficients.
    pub read: usize,
    /// Number of true events without coefficients whose event states a reason.
    pub reasoned: usize,
    /// Intervals of the events.
    pub events: [Intervals; 2],
    /// Intervals of the means, for each record that states one.
    pub means: [Intervals; 2],
}

impl Judged {
    /// Number of true events.
    #[must_use]
    pub fn true_events(&self) -> usize {
        self.detection.hits + self.detection.misses
    }

    /// Number of false results: events, or for `Refused` events with coefficients.
    #[must_use]
    pub fn invented(&self, kind: Kind) -> usize {
        if kind == Kind::Refused { self.wrong_coefficients } else { self.detection.false_alarms }
    }

    /// Adds a record, of which the first `judged` true events and the events found there count.
    fn add(&mut self, truths: &[TrueEvent], judged: usize, found: &[Event], hz: f64) {
        let (mut pairs, Detection { false_alarms, .. }) = pair(truths, found, hz);
        let is_paired = |f: usize, pairs: &[(usize, usize)]| pairs.iter().any(|p| p.1 == f);
        let paired: Vec<bool> = (0..found.len()).map(|f| is_paired(f, &pairs)).collect();
        pairs.retain(|(t, _)| *t < judged);
        let hits = pairs.len();
        self.detection.add(Detection { hits, false_alarms, misses: judged - hits });
        let has_value = |e: &Event| e.mu_s.is_some() || e.mu.is_some();
        let wrong = found.iter().enumerate().filter(|(f, e)| !paired[*f] && has_value(e));
        self.wrong_coefficients += wrong.count();
        for &(t, f) in &pairs {
            let (truth, found) = (&truths[t], &found[f]);
            let both = found.mu_s.is_some() && found.mu.is_some();
            self.read += usize::from(both);
            self.reasoned += usize::from(!both && found.reason.is_some());
            let values = [(found.mu_s, truth.mu_s), (found.mu, truth.mu)];
            for (intervals, (got, truth)) in self.events.iter_mut().zip(values) {
                if let Some(got) = got {
                    intervals.add(got.value, truth, stated::event(&got));
                }
            }
        }
    }

    fn add_means(&mut self, report: &Report, truth: [f64; 2]) {
        let means = [report.mu_s, report.mu];
        for (intervals, (mean, truth)) in self.means.iter_mut().zip(means.into_iter().zip(truth)) {
            let Some(mean) = mean else { continue };
            if let Some(interval) = stated::mean(&mean) {
                intervals.add(mean.mean, truth, interval);
            }
        }
    }
}

/// Results of a class: (a) with exact inputs, (b) with drawn ones.
#[derive(Clone, Debug, Default)]
pub struct Class {
    /// Exact inputs.
    pub exact: Judged,
    /// Drawn inputs.
    pub drawn: Judged,
}

/// A record and the number of its first events that are judged.
struct Record {
    simulation: Simulation,
    judged: usize,
}

impl Class {
    /// Runs a scene with the seeds 1, 2, ...
    ///
    /// # Panics
    /// The scene cannot be simulated.
    #[must_use]
    pub fn of(scene: &Scene, kind: Kind, seeds: u64) -> Self {
        let records: Vec<Record> = (1..=seeds).map(|seed| record(scene, kind, seed)).collect();
        let population = population(scene, &records);
        let mut class = Self::default();
        for (seed, record) in (1..).zip(&records) {
            // The prior of the losses applies to scenes with losses only.
            let damping = if kind == Kind::Unseen { InputStd::default().damping } else { 0.0 };
            for (judged, errors, std) in [
                (&mut class.exact, [0.0; 4], InputStd { damping, ..InputStd::EXACT }),
                (&mut class.drawn, input_errors(seed), InputStd { damping, ..InputStd::default() }),
            ] {
                let (found, report) = read(scene, record, errors, std);
                let truths =
                    if kind == Kind::Refused { &[][..] } else { &record.simulation.events };
                judged.add(truths, record.judged, &found, scene.rate_hz);
                if kind.is_judged() {
                    judged.add_means(&report, population);
                }
            }
        }
        class
    }
}

fn record(scene: &Scene, kind: Kind, seed: u64) -> Record {
    let simulation = simulate(&at_phase(scene, seed), seed).expect("a scene");
    let is_judged = |e: &TrueEvent| e.stop_s + AFTER_S < scene.duration_s;
    let judged = simulation.events.partition_point(is_judged);
    Record { simulation, judged: if kind == Kind::Refused { 0 } else { judged } }
}

/// True values that the mean of a record estimates: the scene's coefficients, or if a law of
/// friction changes them, the average over all records.
fn population(scene: &Scene, records: &[Record]) -> [f64; 2] {
    let lawful = scene.stribeck.is_some()
        || scene.rate_and_state.is_some()
        || scene.rate_dependence.is_some()
        || scene.along_slip.is_some()
        || scene.rocking.is_some();
    if !lawful {
        let (mu_s, mu) = scene.coefficients();
        return [mu_s, mu];
    }
    average(records.iter().flat_map(|r| &r.simulation.events))
}

/// Errors of weight, slope, zero and span in a record, in the units of [`INPUTS`].
fn input_errors(seed: u64) -> [f64; 4] {
    let mut normal = Normal::new(1000 + seed);
    INPUTS.map(|std| std * normal.sample())
}

fn read(scene: &Scene, record: &Record, errors: [f64; 4], std: InputStd) -> (Vec<Event>, Report) {
    let [weight, slope_deg, zero, span] = errors;
    let forces = record.simulation.samples.iter().map(|s| s.force_n.abs());
    let zero_n = zero * forces.fold(0.0, f64::max);
    let mut config = Config { std, ..both::config(scene) };
    config.weight_n *= 1.0 + weight as f32;
    config.slope_rad += slope_deg.to_radians() as f32;
    let moved = scene.measurement.ramp.as_ref().map(|it| it.zero_n_per_s * scene.duration_s);
    let moved = moved.map(|after_n| Zero { before_n: 0.0, after_n });
    if let Some(moved) = moved {
        let left_n = moved.remainder_std_n() as f32;
        config.effects = config.effects.with(Effect::Drift, false);
        config.std.zero_n = Some(config.std.zero_n.map_or(left_n, |std_n| std_n.hypot(left_n)));
    }
    let whole = scene.duration_s * scene.rate_hz;
    let seen = |index: u32, force_n: f64| {
        let moved_n = moved.unwrap_or_default().at(f64::from(index) / whole);
        (1.0 + span) * force_n + zero_n - moved_n
    };
    let samples = record.simulation.samples.iter();
    let samples = samples.map(|s| feed::force(s.index, seen(s.index, s.force_n)));
    let outcome = feed::replay_in_hindsight(&config, samples);
    (outcome.events, outcome.report)
}
