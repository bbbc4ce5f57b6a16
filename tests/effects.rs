//! Looking for an effect costs nothing where there is none.

use std::path::Path;

use floe::sim::Scene;
use floe_core::{Effect, Effects};
use floe_tests::scenes;
use floe_tests::score::{self, rms};

const RECORDS: u64 = 60;
/// Most that the answers of a linear scene may differ with and without looking for effects:
/// root mean square in stated standard deviations, and relative difference of the median
/// standard deviation.
const MOST: f64 = 0.01;
/// What misses this today, and why: the list shrinks.
const NOT_YET: [(&str, &str); 4] = [
    ("dff8-13", "in four records of 60 a corner enters for a while that is none"),
    ("without corner", "the same four"),
    ("linear/heavy", "a corner that is only possible widens the median by 3 %: few events"),
    ("linear/snow", "the same in one record of 60"),
];

/// Differences of both coefficients in stated standard deviations, and the ratio of the
/// median standard deviations.
fn differences(scene: &Scene, effects: Effects) -> ([f64; 2], [f64; 2], usize) {
    let (mut apart, mut stds, mut lost) =
        ([vec![], vec![]], [[vec![], vec![]], [vec![], vec![]]], 0);
    for seed in 1..=RECORDS {
        let all = score::run_looking_for(Effects::default(), scene, seed).found;
        let some = score::run_looking_for(effects, scene, seed).found;
        lost += all.len().abs_diff(some.len());
        for (a, b) in all.iter().zip(&some) {
            for (i, pair) in [(a.mu_s, b.mu_s), (a.mu, b.mu)].into_iter().enumerate() {
                let (Some(a), Some(b)) = pair else { continue };
                apart[i].push(f64::from(a.value - b.value) / f64::from(b.std));
                stds[i][0].push(f64::from(a.std));
                stds[i][1].push(f64::from(b.std));
            }
        }
    }
    let ratios = stds.map(|[all, some]| {
        let median = |of: Vec<f64>| score::quantile(of.into_iter(), 0.5);
        median(all) / median(some)
    });
    (apart.map(|them| rms(&them)), ratios, lost)
}

/// What is wrong with the answers of a scene with some effects, told by its name: too large differences
/// from those with all of them where none are known, or none where some are.
fn fault(name: &str, scene: &Scene, effects: Effects) -> Option<String> {
    let (apart, ratios, lost) = differences(scene, effects);
    println!("{name}: rms {apart:.4?} stated std, median std {ratios:.4?}, {lost} events lost");
    let far = apart.iter().any(|it| *it > MOST) || ratios.iter().any(|it| (it - 1.0).abs() > MOST);
    let known = NOT_YET.iter().any(|(it, _)| *it == name);
    let wrong = known != far || lost > 0;
    wrong.then(|| format!("{name}: {apart:.4?} {ratios:.4?}, {lost} lost; on NOT_YET: {known}"))
}

#[test]
fn on_linear_scenes_auto_is_none() {
    let names = ["dff8-13", "linear/heavy", "linear/fast", "linear/snow", "linear/light"];
    let fault = |name| fault(name, &scenes::stored(name), Effects::NONE);
    let faults: Vec<_> = names.into_iter().filter_map(fault).collect();
    assert!(faults.is_empty(), "{faults:#?}");
}

#[test]
fn one_effect_left_out_changes_no_linear_scene() {
    let scene = scenes::stored("dff8-13");
    let without = |effect: Effect| {
        let others = Effect::ALL.into_iter().filter(|other| *other != effect);
        let set = others.fold(Effects::NONE, |set, other| set.with(other, true));
        fault(&format!("without {effect}"), &scene, set)
    };
    let faults: Vec<_> = Effect::ALL.into_iter().filter_map(without).collect();
    assert!(faults.is_empty(), "{faults:#?}");
}

#[test]
fn the_page_of_effects_has_every_one() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/effects.md");
    let page = std::fs::read_to_string(page).expect("cargo xtask effects writes it");
    for effect in Effect::ALL {
        assert!(page.lines().any(|line| line.starts_with(&format!("| {effect} |"))), "{effect}");
    }
}
