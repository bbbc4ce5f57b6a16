//! Evaluates the core on scenes: detection of events, and errors of the coefficients.

use floe::bench::Found;
use floe::bench::matching::{Detection, matched};
use floe::bench::scenes::{Truth, at_phase};
use floe::sim::{Scene, Simulation, TrueEvent, bound, simulate};
use floe_core::{Coefficient, Config, Effects, Event, Fault, RawSample, Reading, Report, Stretch};

use crate::{both, feed};

/// Number of an event from which a record counts as settled: the shared parameters are known.
pub const SETTLED: usize = 3;

/// A test: its true events and the core's results.
#[derive(Clone, Debug)]
pub struct Tried {
    /// The judged events: all except the last, whose line is cut by the end of the record.
    pub truths: Vec<TrueEvent>,
    /// The events that the core found.
    pub found: Vec<Event>,
    /// Stretches that the core reports as without events.
    pub stretches: Vec<Stretch>,
    /// The report of the test.
    pub report: Report,
    /// Pairs of indices into `truths` and `found` that belong together.
    pub pairs: Vec<(usize, usize)>,
    /// Detection of the events.
    pub detection: Detection,
}

/// Simulates a scene and evaluates it. The sampling phase depends on the seed.
///
/// # Panics
/// The scene cannot be simulated.
#[must_use]
pub fn run(scene: &Scene, seed: u64) -> Tried {
    run_with(scene, seed, |_| 0.0)
}

/// Simulates a scene with a zero, N, that depends on the time, s, and evaluates it.
///
/// # Panics
/// The scene cannot be simulated.
#[must_use]
pub fn run_with(scene: &Scene, seed: u64, zero_n: impl Fn(f64) -> f64) -> Tried {
    run_as(&both::config(scene), scene, seed, zero_n)
}

/// Simulates a scene and evaluates it with some effects only.
///
/// # Panics
/// The scene cannot be simulated.
#[must_use]
pub fn run_looking_for(effects: Effects, scene: &Scene, seed: u64) -> Tried {
    run_as(&Config { effects, ..both::config(scene) }, scene, seed, |_| 0.0)
}

fn run_as(config: &Config, scene: &Scene, seed: u64, zero_n: impl Fn(f64) -> f64) -> Tried {
    Record::of(scene, seed, zero_n).read(config)
}

/// A simulated record, which can be evaluated with several configurations.
#[derive(Clone, Debug)]
pub struct Record {
    /// The judged events: all except the last, whose line is cut by the end of the record.
    pub truths: Vec<TrueEvent>,
    /// The core's input.
    pub samples: Vec<RawSample>,
    /// Samples per second.
    pub rate_hz: f64,
}

impl Record {
    /// Simulates a scene. The sampling phase depends on the seed.
    ///
    /// # Panics
    /// The scene cannot be simulated.
    #[must_use]
    pub fn of(scene: &Scene, seed: u64, zero_n: impl Fn(f64) -> f64) -> Self {
        let scene = at_phase(scene, seed);
        let Simulation { samples, events: mut truths } = simulate(&scene, seed).expect("a scene");
        bound::set_bounds(&scene, &mut truths);
        truths.pop();
        let raw = |index, force_n: f64| {
            if force_n.is_finite() {
                feed::force(index, force_n)
            } else {
                RawSample { index, reading: Reading::Bad(Fault::Sentinel) }
            }
        };
        let samples = samples.iter().map(|s| raw(s.index, s.force_n + zero_n(s.time_s)));
        Self { truths, samples: samples.collect(), rate_hz: scene.rate_hz }
    }

    /// Evaluates the record with the core.
    #[must_use]
    pub fn read(&self, config: &Config) -> Tried {
        let samples = self.samples.iter().copied();
        let feed::Outcome { events: found, stretches, report } = feed::replay(config, samples);
        let (pairs, detection) = pair(&self.truths, &found, self.rate_hz);
        Tried { truths: self.truths.clone(), found, stretches, report, pairs, detection }
    }
}

/// Matches true events with found ones: pairs of indices, and detection counts.
pub(crate) fn pair(
    truths: &[TrueEvent],
    found: &[Event],
    hz: f64,
) -> (Vec<(usize, usize)>, Detection) {
    let truths = truths.iter().map(|e| Truth {
        onset_s: e.onset_s,
        stop_s: e.stop_s,
        mu_s: e.mu_s,
        mu: e.mu,
        bound: None,
    });
    let onset = |e: &Event| both::periods(e) / hz;
    let found = found.iter().map(|e| Found { onset_s: onset(e), mu_s: None, mu: None });
    matched(&truths.collect::<Vec<_>>(), &found.collect::<Vec<_>>(), hz)
}

/// Errors of one coefficient over many events.
#[derive(Clone, Debug, Default)]
pub struct Errors {
    relative: Vec<f64>,
    /// Errors in stated combined standard deviations, and in bounds.
    stated: Vec<f64>,
    bounds: Vec<f64>,
    /// Stated standard deviations.
    stds: Vec<f64>,
}

impl Errors {
    /// Adds a coefficient, if there is one, with its truth and its bound.
    pub fn add(&mut self, got: Option<Coefficient>, truth: f64, bound: Option<f64>) {
        let Some(got) = got else { return };
        let error = f64::from(got.value) - truth;
        self.relative.push(error / truth);
        self.stated.push(off(&got, truth));
        self.stds.push(f64::from(got.std) / truth);
        self.bounds.extend(bound.map(|bound| error / bound));
    }

    /// Number of errors.
    #[must_use]
    pub fn count(&self) -> usize {
        self.relative.len()
    }

    /// Mean error, percent.
    #[must_use]
    pub fn bias(&self) -> f64 {
        100.0 * self.relative.iter().sum::<f64>() / self.count().max(1) as f64
    }

    /// Root-mean-square error, percent.
    #[must_use]
    pub fn rms(&self) -> f64 {
        100.0 * rms(&self.relative)
    }

    /// 95th percentile of the absolute errors, percent.
    #[must_use]
    pub fn p95(&self) -> f64 {
        100.0 * quantile(self.relative.iter().map(|e| e.abs()), 0.95)
    }

    /// Median of the stated standard deviations, percent.
    #[must_use]
    pub fn median_std(&self) -> f64 {
        100.0 * quantile(self.stds.iter().copied(), 0.5)
    }

    /// Fraction of errors within the stated 95 % interval.
    #[must_use]
    pub fn coverage(&self) -> f64 {
        let inside = self.stated.iter().filter(|z| z.abs() <= 1.96).count();
        inside as f64 / self.count().max(1) as f64
    }

    /// Root mean square of the errors relative to the Cramér-Rao bound of each single event.
    #[must_use]
    pub fn over_bound(&self) -> Option<f64> {
        (!self.bounds.is_empty()).then(|| rms(&self.bounds))
    }
}

/// Error of a coefficient, in its combined standard deviations.
#[must_use]
pub fn off(got: &Coefficient, truth: f64) -> f64 {
    (f64::from(got.value) - truth) / f64::from(got.combined_std())
}

/// Quantile of values; zero if there are none.
#[must_use]
pub fn quantile(values: impl Iterator<Item = f64>, share: f64) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get((share * values.len() as f64) as usize).copied().unwrap_or(0.0)
}

/// Root mean square; zero without values.
#[must_use]
pub fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|x| x * x).sum::<f64>() / values.len().max(1) as f64).sqrt()
}

/// Mean `mu_s` and `mu` of true events.
#[must_use]
pub fn average<'a>(events: impl Iterator<Item = &'a TrueEvent>) -> [f64; 2] {
    let sums = events.fold([0.0; 3], |[n, mu_s, mu], e| [n + 1.0, mu_s + e.mu_s, mu + e.mu]);
    let count = sums[0].max(1.0);
    [sums[1] / count, sums[2] / count]
}

/// Score of a scene over many tests.
#[derive(Clone, Debug, Default)]
pub struct Score {
    /// Detection of the events.
    pub detection: Detection,
    /// Errors of `mu_s` and of `mu`, including first events.
    pub errors: [Errors; 2],
    /// Errors of the events from [`SETTLED`] on.
    pub settled: [Errors; 2],
    /// Number of true events with both coefficients.
    pub read: usize,
}

impl Score {
    /// Score of records with seeds 1, 2, ... until a number of events or of records is reached.
    #[must_use]
    pub fn of(scene: &Scene, events: usize, records: u64) -> Self {
        Self::looking_for(Effects::default(), scene, events, records)
    }

    /// Score of a scene with some effects only; records as in [`Score::of`].
    #[must_use]
    pub fn looking_for(effects: Effects, scene: &Scene, events: usize, records: u64) -> Self {
        let mut score = Self::default();
        for seed in 1..=records {
            score.add(&run_looking_for(effects, scene, seed));
            if score.detection.hits + score.detection.misses >= events {
                break;
            }
        }
        score
    }

    /// Adds a test.
    pub fn add(&mut self, tried: &Tried) {
        self.detection.add(tried.detection);
        for &(t, f) in &tried.pairs {
            let (truth, found) = (&tried.truths[t], &tried.found[f]);
            self.read += usize::from(found.mu_s.is_some() && found.mu.is_some());
            self.errors[0].add(found.mu_s, truth.mu_s, truth.mu_s_bound);
            self.errors[1].add(found.mu, truth.mu, truth.mu_bound);
            if t >= SETTLED {
                self.settled[0].add(found.mu_s, truth.mu_s, truth.mu_s_bound);
                self.settled[1].add(found.mu, truth.mu, truth.mu_bound);
            }
        }
    }

    /// Fraction of true events with both coefficients.
    #[must_use]
    pub fn share_read(&self) -> f64 {
        self.read as f64 / self.events().max(1) as f64
    }

    /// Number of judged true events.
    #[must_use]
    pub fn events(&self) -> usize {
        self.detection.hits + self.detection.misses
    }
}
