//! Constant forces before and after the block broke.

use std::fmt::Write as _;

use floe::log::{Log, LogOptions};
use floe::replay::replay;
use floe::replay::result::ReplayResult;
use floe::replay::test::{TestOptions, configure};
use floe::sim::{Sample, Scene, simulate};

const HZ: f64 = 16.0;
const WEIGHT_N: f64 = 630.0;
const MU: f64 = 0.78;
/// Seconds of a constant force on either side of the slips.
const SLIDE_S: f64 = 30.0;

const SCENE: &str = "duration_s = 120.0\nweight_n = 630.0\nmu_s = 1.24\nmu = 0.78\n\
    stiffness_n_per_m = 23000.0\nwinch_m_per_s = 0.0157\nstart_force_n = 491.4\n\
    [breaking]\nat_s = 60.0\nweight_n = 441.0\n[measurement]\nwhite_n = 2.0\n";

/// A block that slides evenly, sticks and slips, breaks, and slides evenly again.
fn log() -> String {
    let samples = simulate(&Scene::from_toml(SCENE).unwrap(), 1).unwrap().samples;
    let sliding = |weight_n: f64| {
        let noisy = move |it: &Sample| MU * weight_n + it.force_n - it.true_force_n;
        samples.iter().take((SLIDE_S * HZ) as usize).map(noisy)
    };
    // The last sample of the slips is one at which the force rises to that of the slide.
    let after = MU * 0.7 * WEIGHT_N;
    let rises = |two: &[Sample]| two[0].true_force_n < after && two[1].true_force_n >= after;
    let last = samples.windows(2).rposition(rises).unwrap();
    let slips = samples[..=last].iter().map(|it| it.force_n);
    let forces_n = sliding(WEIGHT_N).chain(slips).chain(sliding(0.7 * WEIGHT_N));
    let mut text = format!("# weight_n: {WEIGHT_N}\n# winch_m_per_s: 0.0157\nt,force_n\n");
    for (index, force_n) in forces_n.enumerate() {
        writeln!(text, "{},{force_n:.3}", index as f64 / HZ).unwrap();
    }
    text
}

fn replayed(text: String) -> ReplayResult {
    let input = std::io::Cursor::new(text.into_bytes());
    let mut log = Log::from_reader(Box::new(input), &LogOptions::default()).unwrap();
    let config = configure(&log, &TestOptions::default()).unwrap();
    replay("log.csv", &mut log, &config, |_, _| {}).unwrap()
}

/// The slide before the break has the given weight, and the one after it the weight that is left:
/// both have the friction of the slips.
#[test]
fn a_slide_has_the_weight_of_its_own_time() {
    let result = replayed(log());
    let [change] = &result.changes[..] else { panic!("{:?}", result.changes) };
    assert_eq!(change.cause, "mass");
    let [before, after] = &result.stretches.steady[..] else { panic!("{:?}", result.stretches) };
    assert!(before.stop_s < change.onset_s && after.start_s > change.onset_s);
    for slide in [before, after] {
        let (mu, std) = (f64::from(slide.sliding.0), f64::from(slide.sliding.1));
        println!("mu {mu:.4} ± {std:.4}, F/W {:.4}", slide.force_over_weight);
        assert!((mu - MU).abs() < 4.0 * std && std < 0.05, "{mu} ± {std}");
        assert!((slide.force_over_weight - mu).abs() < 1e-4, "{slide:?}");
    }
    // The weight after the break is less well known than the given one.
    assert!(after.sliding.1 > 1.5 * before.sliding.1, "{before:?} {after:?}");
}
