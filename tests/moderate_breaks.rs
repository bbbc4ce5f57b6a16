//! Blocks that lose a third to an eighth of their weight: the first slip of the new block must not
//! be taken for a slip of the old one with less friction.

use floe::sim::Scene;
use floe_core::Cause;
use floe_tests::score::{off, run};

/// Time of the break.
const BREAK_S: f64 = 60.0;

fn scene(weight_n: f64) -> Scene {
    let text = format!(
        "duration_s = 120.0\nweight_n = 630.0\nmu_s = 1.24\nmu = 0.78\nstiffness_n_per_m = 23000.0\n\
         winch_m_per_s = 0.0157\n[variation]\nmu_s_fraction = 0.01\nmu_fraction = 0.01\n\
         [breaking]\nat_s = {BREAK_S:.1}\nweight_n = {weight_n:.1}\n[measurement]\nwhite_n = 2.0\n"
    );
    Scene::from_toml(&text).expect("a scene")
}

#[test]
fn no_event_after_a_break_is_wrong_and_sure() {
    for weight_n in [420.0, 441.0, 504.0, 550.0] {
        for seed in 1..=6 {
            let tried = run(&scene(weight_n), seed);
            let mut after = (0, tried.truths.iter().filter(|it| it.onset_s > BREAK_S).count());
            for &(truth, found) in &tried.pairs {
                let (truth, found) = (&tried.truths[truth], &tried.found[found]);
                let both = found.mu_s.is_some() && found.mu.is_some();
                after.0 += usize::from(both && truth.onset_s > BREAK_S);
                for (got, truth) in [(found.mu_s, truth.mu_s), (found.mu, truth.mu)] {
                    let far = got.map_or(0.0, |got| off(&got, truth));
                    assert!(far.abs() < 5.0, "{weight_n} N, seed {seed}: {far} {found:?}");
                }
            }
            let (read, due) = after;
            println!("{weight_n} N, seed {seed}: {read} of {due} read after the break");
            assert!(due > 20 && read * 10 > due * 8, "{weight_n} N, seed {seed}: {read} of {due}");
            let change = tried.report.change.expect("a change");
            assert_eq!(change.cause, Cause::Mass, "{weight_n} N, seed {seed}");
            let ratio = f64::from(change.weight_ratio);
            assert!((ratio / (weight_n / 630.0) - 1.0).abs() < 0.04, "{weight_n} N: {ratio}");
            // The change names number and onset of the new block's first slip.
            let first = tried.found.iter().find(|event| event.index == change.event);
            assert_eq!(first.map(|event| event.onset), Some(change.onset), "{weight_n} N, {seed}");
        }
    }
}
