//! Error of the newest event relative to the joint Cramér-Rao bound of all events so far.
//!
//! `cargo test -p floe-tests --test joint_bound -- --nocapture` prints the table shown in
//! `docs/method.md`. Figures that miss their aims are listed in
//! `tests/golden/joint-bound-not-yet.csv`.

use std::fs;
use std::path::Path;

use floe::sim::bound::ForceBound;
use floe::sim::joint::Joint;
use floe::sim::{Scene, TrueEvent};
use floe_core::{Event, Quality};
use floe_tests::aims::{self, Check};
use floe_tests::scenes;
use floe_tests::score::{rms, run};

/// Records per scene, and events per record, of which some are not judged.
const RECORDS: u64 = 800;
const EVENTS: usize = 52;
/// Numbers of the judged events, from 1.
const NUMBERS: [usize; 3] = [3, 10, 50];
/// Smallest plausible error in bounds; a smaller one shows that the bound is wrong.
const LEAST: f64 = 0.8;
/// Three relative standard errors of the difference of two root mean squares over the records.
const SCATTER: f64 = 0.11;

const SCENES: [&str; 5] = ["dff8-13", "linear/heavy", "linear/fast", "linear/snow", "linear/light"];

/// A stored scene with a duration that suffices for the events.
fn scene(name: &str) -> Scene {
    let mut scene = scenes::stored(name);
    let first = &run(&scene, 1).truths[1];
    scene.duration_s = (EVENTS as f64 + 1.0) * (first.stick_s + first.slip_s);
    scene
}

/// Joint bounds of the events in a record.
fn bounds(scene: &Scene, events: &[TrueEvent]) -> Vec<Option<ForceBound>> {
    let mut joint = Joint::default();
    let bound = |(i, event): (usize, &TrueEvent)| {
        let from_s = if i == 0 { 0.0 } else { event.onset_s };
        let to_s = events.get(i + 1).map_or(scene.duration_s, |next| next.onset_s);
        let first = (from_s * scene.rate_hz).ceil() as u32;
        let last = (to_s * scene.rate_hz).ceil() as u32;
        let times_s = (first..last.min(scene.sample_count())).map(|n| f64::from(n) / scene.rate_hz);
        joint.bound(&event.into(), times_s, scene.measurement.white_n)
    };
    events.iter().enumerate().map(bound).collect()
}

/// Errors of `mu_s` and `mu` of the events of one number, in joint bounds. Events marked as hardly
/// resolved are only counted.
#[derive(Default)]
struct Errors {
    joint: [Vec<f64>; 2],
    unresolved: u32,
    /// Records without this event, or without a bound for it: where no sample of the first slip
    /// tells its friction, no event of the record has one.
    missing: u64,
}

impl Errors {
    fn add(&mut self, scene: &Scene, truth: &TrueEvent, found: &Event, bound: &ForceBound) {
        let (Some(mu_s), Some(mu), Quality::Good) = (found.mu_s, found.mu, found.quality) else {
            self.unresolved += 1;
            return;
        };
        let newtons = scene.weight_n * scene.slope_rad().cos();
        let error =
            |got: f32, truth: f64, bound_n: f64| (f64::from(got) - truth) * newtons / bound_n;
        self.joint[0].push(error(mu_s.value, truth.mu_s, bound.static_n));
        self.joint[1].push(error(mu.value, truth.mu, bound.dynamic_n));
    }

    /// Checks with the aim: the bound plus three standard errors of a root mean square.
    fn checks(&self, scene: &str, number: usize) -> [Check; 2] {
        let check = |(coefficient, off): (&str, &Vec<f64>)| {
            let chance = 3.0 / (2.0 * off.len() as f64).sqrt();
            let what = format!("joint bounds of {coefficient} of event {number}");
            Check::between(scene, &what, rms(off), (LEAST, 1.0 + chance))
        };
        [("mu_s", &self.joint[0]), ("mu", &self.joint[1])].map(check)
    }

    fn ratios(&self) -> [f64; 2] {
        [rms(&self.joint[0]), rms(&self.joint[1])]
    }
}

fn errors(scene: &Scene) -> [Errors; NUMBERS.len()] {
    let mut errors: [Errors; NUMBERS.len()] = Default::default();
    for seed in 1..=RECORDS {
        let tried = run(scene, seed);
        let bounds = bounds(scene, &tried.truths);
        for (number, errors) in NUMBERS.iter().zip(&mut errors) {
            let pair = tried.pairs.iter().find(|(t, _)| t + 1 == *number);
            let Some((&(t, f), bound)) = pair.and_then(|p| Some((p, bounds[p.0].as_ref()?))) else {
                errors.missing += 1;
                continue;
            };
            errors.add(scene, &tried.truths[t], &tried.found[f], bound);
        }
    }
    errors
}

/// The figures of a scene on the page.
fn told(name: &str) -> Vec<f64> {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/method.md");
    let page = fs::read_to_string(page).unwrap();
    let row = page.lines().find_map(|line| line.strip_prefix(&format!("| {name} |")));
    let row = row.unwrap_or_else(|| panic!("docs/method.md has no row for {name}"));
    row.split([',', '|']).filter_map(|cell| cell.trim().parse().ok()).collect()
}

#[test]
fn the_newest_event_is_near_the_joint_bound_of_all_so_far() {
    let mut checks = Vec::new();
    for name in SCENES {
        let errors = errors(&scene(name));
        let missing = errors.each_ref().map(|e| e.missing);
        assert!(missing.iter().all(|it| *it < RECORDS / 40), "{name}: {missing:?} are missing");
        let ratios: Vec<f64> = errors.iter().flat_map(Errors::ratios).collect();
        let short = name.rsplit('/').next().unwrap();
        let cells: Vec<String> =
            ratios.chunks(2).map(|pair| format!("{:.2}, {:.2}", pair[0], pair[1])).collect();
        let unresolved = errors.each_ref().map(|e| e.unresolved);
        println!("| {short} | {} | unresolved {unresolved:?}", cells.join(" | "));
        checks.extend(errors.iter().zip(NUMBERS).flat_map(|(it, number)| it.checks(short, number)));
        let told = told(short);
        assert!(told.len() == ratios.len(), "docs/method.md, {short}: {told:?}");
        let agrees = told.iter().zip(&ratios).all(|(told, now)| (told / now - 1.0).abs() < SCATTER);
        assert!(agrees, "docs/method.md, {short}: {told:?} is now {ratios:?}");
        let last = unresolved[NUMBERS.len() - 1];
        assert!(u64::from(last) < RECORDS / 100, "{name}: {last} unresolved after fifty events");
    }
    aims::hold("joint-bound", &checks);
}
