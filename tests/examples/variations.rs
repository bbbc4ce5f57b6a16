//! The classes of trouble with other numbers, held to the same aims.
//!
//! `cargo run --release -p floe-tests --example variations [-- SEEDS [FIRST PART OF A CLASS'S NAME]]`
//! runs each class at another rate, noise, scatter, weight, cable and pull, 8 records each (of
//! the shortest 100), and prints what misses an aim. Nothing is held to it: it shows how far
//! the aims carry beyond the scenes of the table.

use floe::sim::{Scene, simulate};
use floe_tests::aims::Check;
use floe_tests::classes::{self, CLASSES};
use floe_tests::honesty::{Class, Kind};
use floe_tests::parallel;

type Variation = (&'static str, fn(&mut Scene));

/// The last three make another recurrence: an alias may be none any more.
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

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let seeds = arguments.first().map_or(8, |seeds| seeds.parse().expect("a number of seeds"));
    let begins = arguments.get(1).map_or("", String::as_str);
    let wanted = CLASSES.iter().filter(|class| class.0.starts_with(begins));
    let of = |kind: Kind| if kind == Kind::Refused { PULLED_ALIKE } else { VARIATIONS.len() };
    let jobs: Vec<(&(&str, Kind), &Variation)> = wanted
        .flat_map(|class| VARIATIONS.iter().take(of(class.1)).map(move |varied| (class, varied)))
        .collect();
    let missed = parallel::each(&jobs, |&(&(class, kind), &(name, vary))| {
        let (mut scene, _) = classes::scene(class);
        vary(&mut scene);
        if let Err(error) = simulate(&scene, 1) {
            println!("{class:16} {name:20} cannot be simulated: {error}");
            return (name, Vec::new());
        }
        let judged = Class::of(&scene, kind, classes::records(&scene, seeds));
        if kind.is_judged() && judged.exact.true_events() == 0 {
            println!("{class:16} {name:20} nothing slips");
            return (name, Vec::new());
        }
        let checks = classes::checks(class, kind, &judged);
        let missed: Vec<Check> = checks.into_iter().filter(|check| check.miss > 0.0).collect();
        (name, missed)
    });
    for (name, missed) in &missed {
        for Check { row, what, value, miss } in missed {
            println!("{row:16} {name:20} {what:40} {value:7.3} {miss:7.3} from its aim");
        }
    }
    let scenes = missed.iter().filter(|(_, missed)| !missed.is_empty()).count();
    println!("{scenes} of {} scenes miss an aim", missed.len());
}
