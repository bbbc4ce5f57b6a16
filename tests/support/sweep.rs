//! Evaluates many scenes like classes of trouble, and prints missed aims without failing.

use floe::sim::{Scene, simulate};

use crate::aims::Check;
use crate::classes;
use crate::honesty::{Class, Kind};
use crate::parallel;

/// A scene and its expected result.
#[derive(Debug)]
pub struct Case {
    /// Name of the class with similar trouble.
    pub row: String,
    /// Difference from that class.
    pub how: String,
    /// Expected result for the class.
    pub kind: Kind,
    /// The scene.
    pub scene: Scene,
}

/// Command line: records per scene (default 8), and a part of the names of the classes to run.
///
/// # Panics
/// The first argument is not a number.
#[must_use]
pub fn arguments() -> (u64, String) {
    let mut arguments = std::env::args().skip(1);
    let records = arguments.next().map_or(8, |it| it.parse().expect("a number of records"));
    (records, arguments.next().unwrap_or_default())
}

/// Prints the missed aims after `records` records per scene (100 for the shortest).
pub fn print_misses(cases: &[Case], records: u64) {
    let missed = parallel::each(cases, |case| misses(case, records));
    for (Case { how, .. }, missed) in cases.iter().zip(&missed) {
        for Check { row, what, value, miss } in missed {
            println!("{row:16} {how:26} {what:40} {value:7.3} {miss:7.3} from its aim");
        }
    }
    let scenes = missed.iter().filter(|missed| !missed.is_empty()).count();
    println!("{scenes} of {} scenes miss an aim", missed.len());
}

fn misses(Case { row, how, kind, scene }: &Case, records: u64) -> Vec<Check> {
    if let Err(error) = simulate(scene, 1) {
        println!("{row:16} {how:26} cannot be simulated: {error}");
        return Vec::new();
    }
    let judged = Class::of(scene, *kind, classes::records(scene, records));
    if kind.is_judged() && judged.exact.true_events() == 0 {
        println!("{row:16} {how:26} nothing slips");
        return Vec::new();
    }
    let checks = classes::checks(row, *kind, &judged);
    checks.into_iter().filter(|check| check.miss > 0.0).collect()
}
