//! Scenes for trials of effects: simulated once, evaluated with and without each effect.

use std::fs;
use std::path::Path;

use floe::bench::scenes::at_phase;
use floe::replay::known::Zero;
use floe::sim::{Scene, TrueEvent, simulate};
use floe_core::{Config, Effect, Effects, Estimate, InputStd, Report};
use floe_tests::score::{Record, Tried};
use floe_tests::{both, feed, parallel};

use crate::Result;
use crate::budgets;
use crate::shell::{root, say};

/// Number of events per scene, and largest number of records for them.
const EVENTS: usize = 1500;
const RECORDS: u64 = 24;
/// The slowest scene, 10 s per record, and its number of records: it starts first.
const SLOW: (&str, u64) = ("rate_and_state", 5);
/// Scenes that are also run for an hour, and their number of records.
const LONG: [&str; 4] = ["dff8-13", "hard/drift", "honesty/wandering", "honesty/many_pauses"];
const LONG_RECORDS: u64 = 8;
const LONG_S: f64 = 3600.0;
/// Ratio of both coefficients after a change of friction to those before.
const CHANGE: f64 = 0.85;

/// Errors of one coefficient's estimates.
#[derive(Clone, Debug, Default)]
pub(super) struct Errors {
    percent: Vec<f64>,
    covered: usize,
}

impl Errors {
    fn add(&mut self, value: f32, (low, high): (f32, f32), truth: f64) {
        self.percent.push(100.0 * (f64::from(value) / truth - 1.0));
        self.covered += usize::from((f64::from(low)..=f64::from(high)).contains(&truth));
    }

    pub(super) fn count(&self) -> usize {
        self.percent.len()
    }

    /// Root mean square, percent of the coefficient.
    pub(super) fn rms(&self) -> f64 {
        floe_tests::score::rms(&self.percent)
    }

    /// Fraction of the 95 % intervals that contain the truth.
    pub(super) fn coverage(&self) -> f64 {
        self.covered as f64 / self.count().max(1) as f64
    }
}

/// Results of a scene with some effects; pairs are of `mu_s` and `mu`.
#[derive(Clone, Debug, Default)]
pub(super) struct Outcome {
    /// Errors of single events, including the first ones.
    pub(super) events: [Errors; 2],
    /// Errors of the means of whole records.
    pub(super) means: [Errors; 2],
    /// Number of records, and of those with a reported change.
    pub(super) records: usize,
    pub(super) changes: usize,
}

impl Outcome {
    fn add(&mut self, tried: &Tried, truth: [f64; 2]) {
        for &(t, f) in &tried.pairs {
            let (truth, found) = (&tried.truths[t], &tried.found[f]);
            for (errors, (got, truth)) in
                self.events.iter_mut().zip([(found.mu_s, truth.mu_s), (found.mu, truth.mu)])
            {
                if let Some(got) = got {
                    errors.add(got.value, got.ci95(), truth);
                }
            }
        }
        let Report { mu_s, mu, change, .. } = tried.report;
        for (errors, (mean, truth)) in self.means.iter_mut().zip([mu_s, mu].into_iter().zip(truth))
        {
            let stated = mean.and_then(|it: Estimate| Some((it.mean, it.ci95()?)));
            if let Some((mean, interval)) = stated {
                errors.add(mean, interval, truth);
            }
        }
        self.records += 1;
        self.changes += usize::from(change.is_some());
    }
}

/// Results of a scene with all effects, and without each of them.
#[derive(Debug)]
pub(super) struct Trial {
    pub(super) name: String,
    /// Whether friction changes in the middle of each record.
    pub(super) changes: bool,
    pub(super) with: Outcome,
    pub(super) without: Vec<Outcome>,
}

/// Settings for the trial of a scene.
struct Plan {
    name: String,
    scene: Scene,
    /// Number of events at which to stop, and largest number of records.
    events: usize,
    records: u64,
    changes: bool,
}

/// Runs every scene with events, some for an hour, and one with changes of friction, on all
/// processors.
///
/// # Errors
/// A scene cannot be read.
pub(super) fn run() -> Result<Vec<Trial>> {
    let plans = plans()?;
    Ok(parallel::each(&plans, |plan| {
        say(&format!("effects: {}", plan.name));
        plan.run()
    }))
}

fn plans() -> Result<Vec<Plan>> {
    let mut plans = Vec::new();
    for file in budgets::scenes(&["linear", "hard", "honesty"])? {
        let (name, scene) = read(&file)?;
        let records = if name == SLOW.0 { SLOW.1 } else { RECORDS };
        plans.push(Plan { name, scene, events: EVENTS, records, changes: false });
    }
    plans.sort_by_key(|plan| plan.name != SLOW.0);
    for name in LONG {
        let (name, scene) = read(&root().join(format!("host-sim/scenes/{name}.toml")))?;
        let scene = Scene { duration_s: LONG_S, ..scene };
        let name = format!("{name}, 1 h");
        let (events, records) = (usize::MAX, LONG_RECORDS);
        plans.push(Plan { name, scene, events, records, changes: false });
    }
    let (name, scene) = read(&root().join("host-sim/scenes/dff8-13.toml"))?;
    let name = format!("{name}, friction changes");
    plans.push(Plan { name, scene, events: EVENTS, records: RECORDS, changes: true });
    Ok(plans)
}

fn read(file: &Path) -> Result<(String, Scene)> {
    let text = fs::read_to_string(file).map_err(|e| format!("{}: {e}", file.display()))?;
    let scene = Scene::from_toml(&text).map_err(|e| format!("{}: {e}", file.display()))?;
    Ok((file.file_stem().unwrap_or_default().to_string_lossy().into_owned(), scene))
}

impl Plan {
    fn run(&self) -> Trial {
        let mut records = Vec::new();
        let mut events = 0;
        for seed in 1..=self.records {
            let record = self.record(seed);
            events += record.truths.len();
            records.push(record);
            if events >= self.events {
                break;
            }
        }
        let truth = population(&records);
        let outcome = |effects| {
            let config = Config { effects, ..self.config() };
            let mut outcome = Outcome::default();
            records.iter().for_each(|record| outcome.add(&record.read(&config), truth));
            outcome
        };
        Trial {
            name: self.name.clone(),
            changes: self.changes,
            with: outcome(Effects::COMPILED),
            without: Effect::ALL.map(|effect| outcome(all_but(effect))).into(),
        }
    }

    fn record(&self, seed: u64) -> Record {
        if self.changes {
            return changing(&self.scene, seed);
        }
        let ramp = self.scene.measurement.ramp.as_ref().map_or(0.0, |ramp| ramp.zero_n_per_s);
        Record::of(&self.scene, seed, |time_s| -ramp * time_s)
    }

    /// Configuration as in `docs/honesty.md`: the damping is uncertain in scenes with losses, and a
    /// zero that drifts was also measured after the test.
    fn config(&self) -> Config {
        let mut config = both::config(&self.scene);
        if self.scene.cable_damping.is_some() || self.scene.drag.is_some() {
            config.std.damping = InputStd::default().damping;
        }
        if let Some(ramp) = &self.scene.measurement.ramp {
            let after_n = ramp.zero_n_per_s * self.scene.duration_s;
            let moved = Zero { before_n: 0.0, after_n };
            config.std.zero_n = Some(moved.remainder_std_n() as f32);
        }
        config
    }
}

fn all_but(left_out: Effect) -> Effects {
    let others = Effect::ALL.into_iter().filter(|it| *it != left_out);
    others.fold(Effects::NONE, |set, effect| set.with(effect, true))
}

/// True values that the mean of a record estimates: means over all events.
fn population(records: &[Record]) -> [f64; 2] {
    let events: Vec<&TrueEvent> = records.iter().flat_map(|record| &record.truths).collect();
    let mean = |of: fn(&TrueEvent) -> f64| {
        events.iter().map(|event| of(event)).sum::<f64>() / events.len().max(1) as f64
    };
    [mean(|event| event.mu_s), mean(|event| event.mu)]
}

/// A record in whose middle both coefficients change while the block rests. The force alone
/// determines the state of a resting block, so a second simulation continues where the first is
/// cut.
fn changing(scene: &Scene, seed: u64) -> Record {
    let scene = at_phase(scene, seed);
    let rate_hz = scene.rate_hz;
    let before = simulate(&scene, seed).expect("a scene");
    let rests = |event: &&TrueEvent| event.stop_s > 0.5 * scene.duration_s;
    let stop_s = before.events.iter().find(rests).map_or(0.0, |event| event.stop_s);
    let cut = (stop_s * rate_hz) as u32 + 2;
    let force_n = |index| before.samples.iter().find(|s| s.index == index).map(|s| s.true_force_n);
    let changed = Scene {
        mu_s: CHANGE * scene.mu_s,
        mu: CHANGE * scene.mu,
        start_force_n: force_n(cut).unwrap_or_default(),
        duration_s: scene.duration_s - f64::from(cut) / rate_hz,
        ..scene.clone()
    };
    let after = simulate(&changed, seed + RECORDS).expect("a scene");
    let cut_s = f64::from(cut) / rate_hz;
    let mut truths = before.events;
    truths.retain(|event| event.stop_s < cut_s);
    truths.extend(after.events.into_iter().map(|event| TrueEvent {
        onset_s: event.onset_s + cut_s,
        stop_s: event.stop_s + cut_s,
        ..event
    }));
    truths.pop();
    let first = before.samples.iter().filter(|s| s.index < cut).map(|s| (s.index, s.force_n));
    let second = after.samples.iter().map(|s| (s.index + cut, s.force_n));
    let samples = first.chain(second).map(|(index, force_n)| feed::force(index, force_n));
    Record { truths, samples: samples.collect(), rate_hz }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_changed_record_goes_on_where_it_was_cut() {
        let file = root().join("host-sim/scenes/dff8-13.toml");
        let (_, mut scene) = read(&file).unwrap();
        scene.measurement.white_n = 0.0;
        let record = changing(&scene, 1);
        assert!(record.samples.iter().zip(0..).all(|(sample, index)| sample.index == index));
        let of = |mu_s: f64| {
            record.truths.iter().filter(|event| (event.mu_s - mu_s).abs() < 1e-9).count()
        };
        let (before, after) = (of(scene.mu_s), of(CHANGE * scene.mu_s));
        assert!(before > 20 && after > 20 && before + after == record.truths.len());
        assert!(record.truths.is_sorted_by(|a, b| a.stop_s < b.onset_s));
        // Every onset but the last is found, and the cut is not taken for a slip.
        let tried = record.read(&both::config(&scene));
        assert_eq!((tried.detection.misses, tried.detection.false_alarms), (0, 0));
    }
}
