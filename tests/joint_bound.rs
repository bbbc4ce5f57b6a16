//! How near the newest event comes to the joint bound of all events so far.
//!
//! `cargo test -p floe-tests --test joint_bound -- --nocapture` prints the table of
//! docs/method.md.

use std::fs;
use std::path::Path;

use floe::sim::bound::{ForceBound, LinearEvent};
use floe::sim::joint::Joint;
use floe::sim::{Scene, TrueEvent};
use floe_tests::score::{rms, run};

/// Records of a scene, and events of each: room for one that is not judged.
const RECORDS: u64 = 800;
const EVENTS: usize = 52;
/// Events, from 1, that are looked at.
const NUMBERS: [usize; 3] = [3, 10, 50];

const SCENES: [&str; 5] = ["dff8-13", "linear/heavy", "linear/fast", "linear/snow", "linear/light"];

fn scene(name: &str) -> Scene {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../host-sim/scenes");
    let text = fs::read_to_string(folder.join(name).with_extension("toml")).unwrap();
    let mut scene = Scene::from_toml(&text).unwrap();
    // Long enough for the events.
    let first = &run(&scene, 1).truths[1];
    scene.duration_s = (EVENTS as f64 + 1.0) * (first.stick_s + first.slip_s);
    scene
}

/// Joint bounds of the events of a record.
fn bounds(scene: &Scene, events: &[TrueEvent]) -> Vec<Option<ForceBound>> {
    let mut joint = Joint::default();
    let bound = |(i, event): (usize, &TrueEvent)| {
        let from_s = if i == 0 { 0.0 } else { event.onset_s };
        let to_s = events.get(i + 1).map_or(scene.duration_s, |next| next.onset_s);
        let first = (from_s * scene.rate_hz).ceil() as u64;
        let last = (to_s * scene.rate_hz).ceil() as u64;
        let times_s = (first..last.min(scene.sample_count())).map(|n| n as f64 / scene.rate_hz);
        let linear = LinearEvent {
            onset_s: event.onset_s,
            loading_rate_n_per_s: event.loading_rate_n_per_s,
            static_force_n: event.static_force_n,
            dynamic_force_n: event.dynamic_force_n,
            omega_rad_per_s: event.omega_rad_per_s,
        };
        joint.bound(&linear, times_s, scene.measurement.white_n)
    };
    events.iter().enumerate().map(bound).collect()
}

/// Errors of `mu_s` and `mu` of events of one number, in joint bounds and in bounds of
/// the event alone.
#[derive(Default)]
struct Errors {
    joint: [Vec<f64>; 2],
    alone: [Vec<f64>; 2],
}

impl Errors {
    /// Over the joint bound: `mu_s`, `mu`; over that of the event alone likewise.
    fn ratios(&self) -> [f64; 4] {
        let [[a, b], [c, d]] = [&self.joint, &self.alone].map(|e| [rms(&e[0]), rms(&e[1])]);
        [a, b, c, d]
    }
}

fn errors(scene: &Scene) -> [Errors; NUMBERS.len()] {
    let per_newton = 1.0 / (scene.weight_n * scene.slope_rad().cos());
    let mut errors: [Errors; NUMBERS.len()] = Default::default();
    for seed in 1..=RECORDS {
        let tried = run(scene, seed);
        let bounds = bounds(scene, &tried.truths);
        for (number, errors) in NUMBERS.iter().zip(&mut errors) {
            let pair = tried.pairs.iter().find(|(t, _)| t + 1 == *number);
            let Some(&(t, f)) = pair else { continue };
            let (truth, found, Some(bound)) = (&tried.truths[t], &tried.found[f], bounds[t]) else {
                continue;
            };
            for (i, (got, truth, joint_n, alone)) in [
                (found.mu_s, truth.mu_s, bound.static_n, truth.mu_s_bound),
                (found.mu, truth.mu, bound.dynamic_n, truth.mu_bound),
            ]
            .into_iter()
            .enumerate()
            {
                let error = got.map(|got| f64::from(got.value) - truth);
                errors.joint[i].extend(error.map(|error| error / (joint_n * per_newton)));
                errors.alone[i].extend(error.zip(alone).map(|(error, alone)| error / alone));
            }
        }
    }
    errors
}

#[test]
fn the_newest_event_is_near_the_joint_bound_of_all_so_far() {
    println!("| scene | event | mu_s over joint | mu over joint | mu_s over own | mu over own |");
    for name in SCENES {
        let errors = errors(&scene(name));
        for (number, errors) in NUMBERS.iter().zip(&errors) {
            let [a, b, c, d] = errors.ratios();
            println!(
                "| {name} | {number} | {a:.2} | {b:.2} | {c:.2} | {d:.2} | {}",
                errors.joint[0].len()
            );
        }
    }
}
