//! A swing about the stick lines may be in the force (a winch that cogs) or in the measurement (hum of
//! the mains, noise whose neighbours are alike): on the lines both look the same. The events tell
//! which, and until they do no answer may be far worse than that of the lines as they are.

use floe::sim::Scene;
use floe_core::{Effect, Effects};
use floe_tests::scenes::stored;
use floe_tests::score::{Score, rms, run_looking_for};

const RECORDS: u64 = 8;
/// Least events of a scene whose intervals are looked at.
const EVENTS: usize = 200;

/// Root-mean-square errors of `mu_s` and `mu` over all events, the first ones too.
fn errors(name: &str, effects: Effects) -> [f64; 2] {
    let (scene, mut off) = (stored(name), [vec![], vec![]]);
    for seed in 1..=RECORDS {
        let tried = run_looking_for(effects, &scene, seed);
        for &(t, f) in &tried.pairs {
            let (truth, found) = (&tried.truths[t], &tried.found[f]);
            for (off, (found, truth)) in
                off.iter_mut().zip([(found.mu_s, truth.mu_s), (found.mu, truth.mu)])
            {
                off.extend(found.map(|found| f64::from(found.value) - truth));
            }
        }
    }
    off.map(|off| rms(&off))
}

/// With all effects over that with all but the noise's colour.
fn ratios(name: &str) -> [f64; 2] {
    let lines = Effect::ALL.into_iter().filter(|it| *it != Effect::Ripple);
    let lines = lines.fold(Effects::NONE, |set, it| set.with(it, true));
    let (all, alone) = (errors(name, Effects::default()), errors(name, lines));
    let ratios = [all[0] / alone[0], all[1] / alone[1]];
    println!("{name}: {all:.5?} with all effects, {alone:.5?} by the lines, ratio {ratios:.2?}");
    ratios
}

#[test]
fn what_the_cell_adds_is_never_followed_far() {
    for name in ["hum_5", "hum_20", "ar1_50", "ar1_90"] {
        let ratios = ratios(&format!("honesty/{name}"));
        assert!(ratios.iter().all(|it| *it < 2.0), "{name}: {ratios:?}");
    }
}

#[test]
fn what_the_winch_does_is_followed() {
    let ripple = ratios("hard/ripple");
    assert!(ripple.iter().all(|it| *it < 0.5), "{ripple:?}");
    let [cogging, _] = ratios("honesty/cogging_2_5");
    assert!(cogging < 0.85, "{cogging}");
}

/// Noise whose neighbours are alike by .9 is told from a slow swing in long rests too: 95 % intervals
/// hold the truth where the winch is half as fast, and where there are twice as many samples.
#[test]
fn slow_noise_in_long_rests_is_no_swing() {
    let noise = stored("honesty/ar1_90");
    let slow = Scene { winch_m_per_s: 0.5 * noise.winch_m_per_s, ..noise.clone() };
    let dense = Scene { rate_hz: 2.0 * noise.rate_hz, ..noise };
    for (name, scene) in [("half as fast", slow), ("32 Hz", dense)] {
        let score = Score::of(&scene, EVENTS, RECORDS);
        let coverage = score.errors.each_ref().map(|it| it.coverage());
        println!("{name}: mu_s and mu covered {coverage:.3?}");
        assert!(coverage.iter().all(|it| *it > 0.87), "{name}: {coverage:?}");
    }
}
