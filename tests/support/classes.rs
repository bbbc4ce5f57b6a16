//! The classes of trouble in `host-sim/scenes/honesty` and their aims.

use std::fs;
use std::path::{Path, PathBuf};

use floe::sim::Scene;

use crate::aims::{COVERAGE, Check, share_limits};
use crate::honesty::{Class, Judged, Kind};

/// All classes in the order of the table.
pub const CLASSES: [(&str, Kind); 53] = [
    ("base", Kind::Events),
    ("tightened_held", Kind::Events),
    ("tightened_low", Kind::Events),
    ("held_hum", Kind::Events),
    ("held_only", Kind::Nothing),
    ("noise_only", Kind::Nothing),
    ("steady_sliding", Kind::Nothing),
    ("pauses", Kind::Events),
    ("many_pauses", Kind::Events),
    ("first_rate_5", Kind::Events),
    ("first_rate_20", Kind::Events),
    ("first_rate_70", Kind::Events),
    ("one_event", Kind::Events),
    ("two_events", Kind::Events),
    ("three_events", Kind::Events),
    ("damping_1", Kind::Unseen),
    ("damping_2", Kind::Unseen),
    ("damping_5", Kind::Unseen),
    ("drag_10", Kind::Unseen),
    ("drag_50", Kind::Unseen),
    ("drag_quadratic", Kind::Unseen),
    ("drift_1", Kind::Unseen),
    ("drift_5", Kind::Unseen),
    ("wandering", Kind::Events),
    ("ar1_50", Kind::Events),
    ("ar1_90", Kind::Events),
    ("hum_5", Kind::Events),
    ("hum_20", Kind::Events),
    ("jitter_2", Kind::Events),
    ("jitter_10", Kind::Events),
    ("lag_30", Kind::Events),
    ("rocking", Kind::Events),
    ("cogging_2_5", Kind::Events),
    ("cogging_5", Kind::Events),
    ("along_slip", Kind::Events),
    ("creep_quiet", Kind::Events),
    ("coarse_steps", Kind::Events),
    ("short_slips", Kind::Events),
    ("slack", Kind::Events),
    ("slack_creep", Kind::Events),
    ("slack_lag", Kind::Events),
    ("slack_pauses", Kind::Events),
    ("short_sticks", Kind::Events),
    ("aliased", Kind::Refused),
    ("aliased_stiff", Kind::Refused),
    ("aliased_fast", Kind::Refused),
    ("winding_back", Kind::Events),
    ("hand_released", Kind::Refused),
    ("breakaway", Kind::Refused),
    ("falling", Kind::Events),
    ("stribeck", Kind::Events),
    ("rate_and_state", Kind::Events),
    ("rate_and_state_64", Kind::Events),
];

const COEFFICIENTS: [&str; 2] = ["mu_s", "mu"];

/// Folder with the scenes of the classes.
#[must_use]
pub fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../host-sim/scenes/honesty")
}

/// The scene of a class, and its description.
///
/// # Panics
/// The scene does not exist, or cannot be read.
#[must_use]
pub fn scene(name: &str) -> (Scene, String) {
    let file = folder().join(format!("{name}.toml"));
    let text = fs::read_to_string(file).unwrap_or_else(|e| panic!("{name}: {e}"));
    let scene = Scene::from_toml(&text).unwrap_or_else(|e| panic!("{name}: {e}"));
    let about = text.lines().next().unwrap_or_default().trim_matches(['#', ' ']).to_owned();
    (scene, about)
}

/// Number of records for a class: `usual`, or 100 for a scene shorter than 10 s.
#[must_use]
pub fn records(scene: &Scene, usual: u64) -> u64 {
    const OF_A_SHORT_ONE: u64 = 100;
    if scene.duration_s < 10.0 { OF_A_SHORT_ONE } else { usual }
}

/// The figures of a class with their aims.
#[must_use]
pub fn checks(name: &str, kind: Kind, class: &Class) -> Vec<Check> {
    let Class { exact, drawn } = class;
    let invented = exact.invented(kind) as f64;
    if !kind.is_judged() {
        return vec![Check::most(name, "invented", invented, 0.0)];
    }
    let n = exact.true_events() as f64;
    let answered = (exact.read + exact.reasoned) as f64 / n;
    let mut checks = vec![
        Check::least(name, "F1", exact.detection.f1(), 0.98),
        Check::least(name, "share with coefficients or a reason", answered, 0.95),
    ];
    checks.extend(interval_checks(name, exact, "", kind == Kind::Events));
    checks.extend(interval_checks(name, drawn, "; drawn inputs", false));
    checks
}

fn interval_checks(name: &str, judged: &Judged, when: &str, sharp: bool) -> Vec<Check> {
    let mut checks = Vec::new();
    for (i, coefficient) in COEFFICIENTS.into_iter().enumerate() {
        let (events, means) = (&judged.events[i], &judged.means[i]);
        let mut check = |what: &str, value: f64, limits: (f64, f64)| {
            let what = format!("{what} of {coefficient}{when}");
            checks.push(Check::between(name, &what, value, limits));
        };
        // Drawn errors of the inputs are equal for all events of a record.
        let draws = if when.is_empty() { events.count() } else { means.count() };
        check("coverage", events.coverage(), share_limits(COVERAGE, draws));
        // A record without an interval for its mean is accepted.
        if means.count() > 0 {
            check("coverage of the mean", means.coverage(), share_limits(COVERAGE, means.count()));
        }
        if when.is_empty() {
            check("share beyond five", events.beyond_five(), (0.0, 0.005));
        }
        if sharp {
            check("std over rms error", events.width(), (0.0, 2.0));
        }
    }
    checks
}

/// Coverages with exact inputs that miss their aim by no more than chance explains, with the number
/// of intervals. Of the means only low ones are listed, since twelve of twelve may well be covered.
#[must_use]
pub fn within_chance(name: &str, class: &Class) -> Vec<(Check, usize)> {
    let Judged { events, means, .. } = &class.exact;
    let mut found = Vec::new();
    for (i, coefficient) in COEFFICIENTS.into_iter().enumerate() {
        let kinds =
            [("coverage", &events[i], COVERAGE.1), ("coverage of the mean", &means[i], 1.0)];
        for (what, intervals, most) in kinds {
            let what = format!("{what} of {coefficient}");
            let check = |limits| Check::between(name, &what, intervals.coverage(), limits);
            let beyond = check((COVERAGE.0, most));
            let allowed = check(share_limits(COVERAGE, intervals.count()));
            if beyond.miss > 0.0 && allowed.miss <= 0.0 {
                found.push((beyond, intervals.count()));
            }
        }
    }
    found
}
