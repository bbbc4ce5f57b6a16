//! Varies the classes of trouble and compares the results with the aims of the classes.
//!
//! `cargo run --release -p floe-tests --example variations [-- RECORDS [FIRST PART OF A CLASS'S NAME]]`
//! runs each class with another rate, noise, scatter, weight, cable and pull, and with a weaker,
//! stronger or different trouble, 8 records each (of the shortest 100), and prints the missed aims.
//! The output is for information: it shows how the aims hold beyond the scenes of the table.

use floe::sim::Scene;
use floe_tests::classes::{self, CLASSES};
use floe_tests::honesty::Kind;
use floe_tests::sweep::{self, Case};

type Variation = (&'static str, fn(&mut Scene));

/// Variations of a scene. The last three change the recurrence, so an alias may disappear.
const VARIATIONS: [Variation; 9] = [
    ("8 Hz", |scene| scene.rate_hz = 8.0),
    ("32 Hz", |scene| scene.rate_hz = 32.0),
    ("noise of .5 N", |scene| scene.measurement.white_n = 0.5),
    ("noise of 5 N", |scene| scene.measurement.white_n = 5.0),
    ("scatter of .2 %", |scene| scatter(scene, 0.002)),
    ("scatter of 4 %", |scene| scatter(scene, 0.04)),
    ("five times as heavy", |scene| scene.weight_n *= 5.0),
    ("half as stiff", |scene| scene.stiffness_n_per_m *= 0.5),
    ("half as fast", |scene| scene.winch_m_per_s *= 0.5),
];

const PULLED_ALIKE: usize = 6;

fn scatter(scene: &mut Scene, fraction: f64) {
    if let Some(variation) = &mut scene.variation {
        (variation.mu_s_fraction, variation.mu_fraction) = (fraction, fraction);
    }
}

/// Name of a class, text in its scene file, and its replacement by another strength, place or time.
const STRENGTHS: [(&str, &str, &str); 77] = [
    ("tightened_held", "[[1.2, 0.0], [21.2, 1.0]]", "[[2.0, 0.0], [22.0, 1.0]]"),
    ("tightened_held", "[[1.2, 0.0], [21.2, 1.0]]", "[[0.8, 0.0], [60.8, 1.0]]"),
    ("tightened_held", "[[1.2, 0.0], [21.2, 1.0]]", "[[1.2, 0.0], [6.2, 1.0]]"),
    ("tightened_low", "[[0.4, 0.0], [3.4, 1.0]]", "[[0.8, 0.0], [1.4, 1.0]]"),
    ("held_only", "[[0.7, 0.0]]", "[[1.9, 0.0]]"),
    ("pauses", "every_s = 12.0", "every_s = 7.0"),
    ("pauses", "least_s = 0.5", "least_s = 4.0"),
    ("many_pauses", "every_s = 4.0", "every_s = 2.5"),
    ("many_pauses", "most_s = 2.0", "most_s = 0.6"),
    ("first_rate_20", "factor = 0.833333", "factor = 0.9"),
    ("first_rate_20", "factor = 0.833333", "factor = 1.2"),
    ("first_rate_70", "factor = 0.588235", "factor = 0.4"),
    ("one_event", "_fraction = 0.05", "_fraction = 0.1"),
    ("two_events", "_fraction = 0.05", "_fraction = 0.1"),
    ("two_events", "_fraction = 0.05", "_fraction = 0.01"),
    ("three_events", "_fraction = 0.05", "_fraction = 0.1"),
    ("three_events", "_fraction = 0.05", "_fraction = 0.01"),
    ("damping_1", "critical_fraction = 0.01", "critical_fraction = 0.005"),
    ("damping_5", "critical_fraction = 0.05", "critical_fraction = 0.03"),
    ("damping_5", "critical_fraction = 0.05", "critical_fraction = 0.1"),
    ("drag_10", "n_s_per_m = 10.0", "n_s_per_m = 25.0"),
    ("drag_50", "n_s_per_m = 50.0", "n_s_per_m = 100.0"),
    ("drag_quadratic", "n_s2_per_m2 = 200.0", "n_s2_per_m2 = 500.0"),
    ("drift_1", "zero_n_per_s = 0.125", "zero_n_per_s = 0.04"),
    ("drift_1", "zero_n_per_s = 0.125", "zero_n_per_s = -0.4"),
    ("drift_1", "span_per_s = 4.1667e-5", "span_per_s = -4.1667e-5"),
    ("wandering", "[wander]\nfraction = 0.05", "[wander]\nfraction = 0.1"),
    ("wandering", "events = 10.0", "events = 3.0"),
    ("wandering", "events = 10.0", "events = 40.0"),
    ("ar1_50", "std_n = 5.0", "std_n = 15.0"),
    ("ar1_50", "correlation = 0.5", "correlation = 0.7"),
    ("ar1_50", "correlation = 0.5", "correlation = -0.5"),
    ("ar1_90", "std_n = 5.0", "std_n = 2.0"),
    ("ar1_90", "std_n = 5.0", "std_n = 15.0"),
    ("ar1_90", "correlation = 0.9", "correlation = 0.98"),
    ("hum_5", "amplitude_n = 5.0", "amplitude_n = 10.0"),
    ("hum_5", "hz = 50.0", "hz = 60.0"),
    ("hum_5", "hz = 50.0", "hz = 50.1"),
    ("hum_20", "hz = 50.0", "hz = 49.9"),
    ("jitter_2", "std_s = 0.002", "std_s = 0.005"),
    ("lag_30", "time_s = 0.03", "time_s = 0.01"),
    ("lag_30", "time_s = 0.03", "time_s = 0.02"),
    ("lag_30", "time_s = 0.03", "time_s = 0.045"),
    ("rocking", "fraction = 0.05", "fraction = 0.02"),
    ("rocking", "fraction = 0.05", "fraction = 0.1"),
    ("rocking", "ratio = 1.7", "ratio = 1.3"),
    ("rocking", "ratio = 1.7", "ratio = 2.3"),
    ("cogging_2_5", "fraction = 0.2", "fraction = 0.1"),
    ("cogging_2_5", "fraction = 0.2", "fraction = 0.35"),
    ("cogging_2_5", "period_s = 0.4", "period_s = 0.333"),
    ("cogging_5", "fraction = 0.2", "fraction = 0.1"),
    ("cogging_5", "fraction = 0.2", "fraction = 0.35"),
    ("cogging_5", "period_s = 0.2", "period_s = 0.25"),
    ("along_slip", "fraction = 0.05", "fraction = 0.1"),
    ("along_slip", "fraction = 0.05", "fraction = -0.05"),
    ("along_slip", "length_m = 0.05", "length_m = 0.02"),
    ("creep_quiet", "range_n = 30.0", "range_n = 60.0"),
    ("creep_quiet", "onset_fraction = 0.5", "onset_fraction = 0.2"),
    ("coarse_steps", "step_n = 5.0", "step_n = 10.0"),
    ("short_slips", "138000.0", "92000.0"),
    ("short_slips", "138000.0", "276000.0"),
    ("short_sticks", "winch_m_per_s = 0.06", "winch_m_per_s = 0.09"),
    ("short_sticks", "winch_m_per_s = 0.06", "winch_m_per_s = 0.12"),
    ("slack", "mu = 0.4", "mu = 0.3"),
    ("slack", "mu = 0.4", "mu = 0.48"),
    ("winding_back", "[9.5, 1.0]", "[10.0, 1.0]"),
    ("winding_back", "[9.0, -1.0], [9.5, 1.0]", "[9.0, -0.3], [10.0, 1.0]"),
    ("hand_released", "[0.0, 1.0], [1.0, -50.0], [1.02,", "[0.0, 0.16], [6.4, -10.24], [6.5,"),
    ("hand_released", "[0.0, 1.0], [1.0, -50.0], [1.02,", "[0.0, 0.16], [7.9, -21.07], [7.96,"),
    ("falling", "per_decade = -0.05", "per_decade = -0.1"),
    ("falling", "per_decade = -0.05", "per_decade = -0.02"),
    ("stribeck", "falling_m_per_s = 0.01", "falling_m_per_s = 0.003"),
    ("stribeck", "falling_m_per_s = 0.01", "falling_m_per_s = 0.02"),
    ("stribeck", "falling_m_per_s = 0.01", "falling_m_per_s = 0.04"),
    ("rate_and_state", "evolving = 0.045", "evolving = 0.07"),
    ("rate_and_state", "renewal_m = 2.0e-5", "renewal_m = 1.0e-4"),
    ("rate_and_state", "renewal_m = 2.0e-5", "renewal_m = 5.0e-6"),
];

/// A case with a class's scene file changed, described by the new text.
fn otherwise(&(name, from, to): &(&str, &str, &str)) -> Case {
    let file = classes::folder().join(format!("{name}.toml"));
    let text = std::fs::read_to_string(file).expect("a class");
    let other = text.replace(from, to);
    assert_ne!(text, other, "{name} has no {from}");
    let kind = CLASSES.iter().find(|class| class.0 == name).expect("a class").1;
    let scene = Scene::from_toml(&other).expect(to);
    Case { row: name.to_owned(), how: to.replace('\n', " "), kind, scene }
}

/// A case with a variation of a class.
fn varied(&(name, kind): &(&str, Kind), &(how, vary): &Variation) -> Case {
    let (mut scene, _) = classes::scene(name);
    vary(&mut scene);
    Case { row: name.to_owned(), how: how.to_owned(), kind, scene }
}

fn main() {
    let (records, begins) = sweep::arguments();
    let of = |kind: Kind| if kind == Kind::Refused { PULLED_ALIKE } else { VARIATIONS.len() };
    let all = CLASSES
        .iter()
        .flat_map(|class| VARIATIONS.iter().take(of(class.1)).map(|how| varied(class, how)));
    let cases: Vec<_> = all
        .chain(STRENGTHS.iter().map(otherwise))
        .filter(|case| case.row.starts_with(&begins))
        .collect();
    sweep::print_misses(&cases, records);
}
