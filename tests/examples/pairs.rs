//! Combines the troubles of two classes and compares the results with the aims.
//!
//! `cargo run --release -p floe-tests --example pairs [-- RECORDS [PART OF A CLASS'S NAME]]` adds
//! the trouble of each class to the scene of each other class, 8 records each, and prints the
//! missed aims. The output is for information: it shows interactions of the effects.

use floe::sim::Scene;
use floe_tests::classes;
use floe_tests::honesty::Kind;
use floe_tests::sweep::{self, Case};

/// Name of a class, and the function that transfers its trouble to another scene.
type Trouble = (&'static str, fn(&mut Scene, Scene));

/// Classes with their troubles. Two troubles in the same field cannot be combined. Left out are
/// laws of friction that vary along the slip and also slip by fractions of a millimetre before it,
/// and jitter of stamps with a lagging cell, which the simulator does not have.
const TROUBLES: [Trouble; 17] = [
    ("pauses", |to, from| to.winch_profile = from.winch_profile),
    ("first_rate_20", |to, from| to.winch_profile = from.winch_profile),
    ("cogging_2_5", |to, from| to.winch_profile = from.winch_profile),
    ("cogging_5", |to, from| to.winch_profile = from.winch_profile),
    ("ar1_50", |to, from| to.measurement.coloured = from.measurement.coloured),
    ("hum_5", |to, from| to.measurement.hum = from.measurement.hum),
    ("jitter_2", |to, from| to.measurement.jitter = from.measurement.jitter),
    ("jitter_10", |to, from| to.measurement.jitter = from.measurement.jitter),
    ("lag_30", |to, from| to.measurement.lag = from.measurement.lag),
    ("rocking", |to, from| to.rocking = from.rocking),
    ("along_slip", |to, from| to.along_slip = from.along_slip),
    ("creep_quiet", |to, from| to.creep = from.creep),
    ("stribeck", |to, from| to.stribeck = from.stribeck),
    ("falling", |to, from| to.rate_dependence = from.rate_dependence),
    ("wandering", |to, from| to.wander = from.wander),
    ("coarse_steps", |to, from| to.measurement.step_n = from.measurement.step_n),
    ("slack", |to, from| (to.mu_s, to.mu) = (from.mu_s, from.mu)),
];

/// Base scene: noise of 2 N about a straight line, as in most classes.
fn base() -> Scene {
    classes::scene("base").0
}

fn pair((a, with_a): Trouble, (b, with_b): Trouble) -> Case {
    let mut scene = base();
    with_a(&mut scene, classes::scene(a).0);
    with_b(&mut scene, classes::scene(b).0);
    Case { row: a.to_owned(), how: b.to_owned(), kind: Kind::Events, scene }
}

/// Whether the second trouble replaces the first.
fn exclude(a: Trouble, b: Trouble) -> bool {
    let mut alone = base();
    b.1(&mut alone, classes::scene(b.0).0);
    pair(a, b).scene == alone
}

fn main() {
    let (records, part) = sweep::arguments();
    let pairs = TROUBLES.iter().enumerate().flat_map(|(i, a)| {
        let others = TROUBLES.iter().skip(i + 1).filter(|b| !exclude(*a, **b));
        others.map(|b| pair(*a, *b))
    });
    let named = |case: &Case| case.row.contains(&part) || case.how.contains(&part);
    let cases: Vec<Case> = pairs.filter(named).collect();
    sweep::print_misses(&cases, records);
}
