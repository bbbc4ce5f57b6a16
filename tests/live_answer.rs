//! The live answer, which a user at the winch sees before the event is complete, and the parameters
//! of the pull from the events: loading rate, omega, stiffness, recurrence. Figures that miss their
//! aims are listed in `tests/golden/live-answer-not-yet.csv`.

use floe::bench::scenes::at_phase;
use floe::sim::{Scene, Simulation, simulate};
use floe_core::units::STANDARD_GRAVITY_M_PER_S2;
use floe_core::{Coefficient, Config, Pipeline, Provisional, Report};
use floe_tests::aims::{self, COVERAGE, Check};
use floe_tests::normal::Normal;
use floe_tests::score::{Errors, rms};
use floe_tests::{both, feed, parallel, scenes};

const SEEDS: u64 = 8;
/// Smallest fraction of true events with a first answer.
const ANSWERED: f64 = 0.95;
/// Scenes with properties that the model must learn.
const HARD: [&str; 22] = [
    "all",
    "aperture",
    "breaking",
    "coarse",
    "creep",
    "downhill",
    "drift",
    "dropped",
    "flop",
    "no_flat_top",
    "noisy",
    "partial",
    "ripple",
    "sag_flop",
    "shortening",
    "slack",
    "small_drop",
    "spikes",
    "tare",
    "unresolved",
    "uphill",
    "varying",
];
/// Scenes in which the linear model holds.
const LINEAR: [&str; 5] = ["dff8-13", "linear/fast", "linear/heavy", "linear/light", "linear/snow"];

/// A record of a scene with a sampling phase that depends on the seed.
fn record(scene: &Scene, seed: u64) -> Simulation {
    simulate(&at_phase(scene, seed), seed).expect("a record")
}

/// All first answers of a record with their times, s, and the report.
fn live(config: &Config, simulation: &Simulation) -> (Vec<(f64, Provisional)>, Report) {
    let mut pipeline = Pipeline::new(config).expect("a configuration");
    let mut answers = Vec::new();
    for sample in &simulation.samples {
        let step = pipeline.step(feed::force(sample.index, sample.force_n));
        let time_s = sample.index as f64 / f64::from(config.rate_hz);
        answers.extend(step.provisional.map(|answer| (time_s, answer)));
    }
    feed::finish(&mut pipeline);
    (answers, pipeline.report())
}

fn assert_finite(got: Coefficient) {
    let std = got.combined_std();
    assert!(got.value.is_finite() && std.is_finite() && std > 0.0, "{got:?}");
}

/// Errors of the first answers in a scene.
#[derive(Default)]
struct Live {
    mu_s: Errors,
    mu: Errors,
    /// Number of true events, and of those with a first answer.
    events: usize,
    answered: usize,
}

impl Live {
    fn of(scene: &Scene) -> Self {
        let mut all = Self::default();
        (1..=SEEDS).for_each(|seed| all.add(scene, seed));
        all
    }

    /// The figures with their aims.
    fn checks(&self, name: &str) -> Vec<Check> {
        let Self { mu_s, mu, events, answered } = self;
        let share = *answered as f64 / *events as f64;
        println!("{name}: {answered} of {events} answered");
        let mut checks = vec![Check::least(name, "share answered", share, ANSWERED)];
        for (coefficient, e) in [("mu_s", mu_s), ("mu", mu)] {
            let (count, rms, coverage) = (e.count(), e.rms(), e.coverage());
            println!("    {coefficient} {count} times, rms {rms:.3} %, coverage {coverage:.3}");
            let given = format!("answers with {coefficient}");
            checks.push(Check::least(name, &given, count as f64, 1.0));
            if count > 0 {
                let what = format!("coverage of {coefficient}");
                checks.push(Check::between(name, &what, coverage, COVERAGE));
            }
        }
        checks
    }

    fn add(&mut self, scene: &Scene, seed: u64) {
        let simulation = record(scene, seed);
        self.events += simulation.events.len();
        let mut last = None;
        for (time_s, answer) in live(&both::config(scene), &simulation).0 {
            // The answer belongs to the last slip that has begun.
            let begun = simulation.events.iter().rposition(|event| event.onset_s < time_s);
            let Some(begun) = begun else { continue };
            let truth = &simulation.events[begun];
            self.answered += usize::from(last.replace(begun) != Some(begun));
            [Some(answer.mu_s), answer.mu].into_iter().flatten().for_each(assert_finite);
            self.mu_s.add(Some(answer.mu_s), truth.mu_s, None);
            self.mu.add(answer.mu, truth.mu, None);
        }
    }
}

#[test]
fn the_first_answer_is_finite_and_honest() {
    let names = LINEAR.map(str::to_owned).into_iter();
    let names = names.chain(HARD.map(|name| format!("hard/{name}"))).collect::<Vec<_>>();
    let checks = parallel::each(&names, |name| Live::of(&scenes::stored(name)).checks(name));
    aims::hold("live-answer", &checks.concat());
}

#[test]
fn rate_omega_stiffness_and_recurrence_are_those_of_the_pull() {
    for name in LINEAR {
        let scene = scenes::stored(name);
        let (k, w) = (scene.stiffness_n_per_m, scene.winch_m_per_s);
        let omega = (k * STANDARD_GRAVITY_M_PER_S2 / scene.weight_n).sqrt();
        let mut off = Vec::new();
        for seed in 1..=SEEDS {
            let simulation = record(&scene, seed);
            let config = both::config(&scene);
            let with_winch = Config { winch_m_per_s: Some(w as f32), ..config };
            let [plain, with_winch] = [config, with_winch].map(|it| live(&it, &simulation).1);
            let known = [(plain.loading_rate_n_per_s, k * w), (plain.omega_rad_per_s, omega)];
            for (got, truth) in known {
                let got = got.expect("known after so many events");
                off.push((f64::from(got.value) - truth) / f64::from(got.std));
            }
            let stiffness = |report: &Report| f64::from(report.stiffness_n_per_m.expect("known"));
            // `k = ω² W / g` without a winch speed: its relative error is twice that of omega.
            let ratio = stiffness(&plain) / k;
            assert!((ratio - 1.0).abs() < 0.02, "{name}, {seed}: {ratio}");
            let ratio = stiffness(&with_winch) / k;
            assert!((ratio - 1.0).abs() < 0.005, "{name}, {seed}: {ratio}");
            let onsets: Vec<_> = simulation.events.iter().map(|event| event.onset_s).collect();
            let mean_s = (onsets[onsets.len() - 1] - onsets[0]) / (onsets.len() - 1) as f64;
            let recurrence_s = f64::from(plain.recurrence_s.expect("known"));
            assert!((recurrence_s / mean_s - 1.0).abs() < 1e-3, "{name}, {seed}: {recurrence_s}");
        }
        let (worst, rms) = (off.iter().map(|z| z.abs()).fold(0.0, f64::max), rms(&off));
        println!("{name}: rate and omega off by {rms:.2} standard deviations, {worst:.2} at most");
        assert!(rms < 1.5 && worst < 4.0, "{name}");
    }
}

/// The winch turns back before the first slip and between two others, and stands for a minute in two
/// rests, one after the other.
#[test]
fn a_rest_with_a_stretch_without_an_event_is_no_recurrence() {
    const DISTURBED: [usize; 4] = [0, 10, 11, 20];
    let scene = Scene { duration_s: 60.0, ..scenes::stored(LINEAR[0]) };
    for seed in 1..=8 {
        let simulation = record(&scene, seed);
        let pulled: Vec<f64> = simulation.samples.iter().map(|sample| sample.force_n).collect();
        let onsets: Vec<_> = simulation.events.iter().map(|event| event.onset_s).collect();
        let (mut noise, mut forces) = (Normal::new(seed), Vec::new());
        for (at, force_n) in pulled.iter().enumerate() {
            forces.push(*force_n);
            let begins = |event: &&usize| at == ((onsets[**event] - 0.6) * scene.rate_hz) as usize;
            let by_n: Vec<f64> = match DISTURBED.iter().find(begins) {
                Some(10 | 11) => vec![0.0; 960],
                Some(_) => (0..80).map(|i| 9.0 * f64::from((i - 40_i32).abs() - 40)).collect(),
                None => Vec::new(),
            };
            forces.extend(by_n.iter().map(|by_n| force_n + by_n + 2.0 * noise.sample()));
        }
        let outcome = feed::replay(&both::config(&scene), feed::in_a_row(&forces));
        assert_eq!(outcome.events.len(), onsets.len(), "{seed}: {:?}", outcome.stretches);
        let is_whole = |event: &usize| !DISTURBED.contains(event);
        let whole = (0..onsets.len()).filter(is_whole).map(|it| onsets[it] - onsets[it - 1]);
        let mean_s = whole.sum::<f64>() / (onsets.len() - DISTURBED.len()) as f64;
        let recurrence_s = f64::from(outcome.report.recurrence_s.expect("known"));
        assert!((recurrence_s / mean_s - 1.0).abs() < 2e-3, "{seed}: {recurrence_s} {mean_s}");
    }
}
