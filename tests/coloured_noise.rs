//! Oscillations around the stick lines, either in the force (a winch that cogs) or in the
//! measurement (mains hum, correlated noise). The lines alone do not distinguish them. The events
//! do; until then no answer may be much worse than one from the lines alone.

use floe::sim::Scene;
use floe::sim::terms::WinchProfile;
use floe_core::{Effect, Effects};
use floe_tests::scenes::stored;
use floe_tests::score::{Score, rms, run_looking_for};

const RECORDS: u64 = 8;
/// Smallest number of events of a scene whose coverage is checked.
const EVENTS: usize = 200;

/// The same with brief rests, of which each tells less.
const BRIEF_EVENTS: usize = 1500;

/// Root-mean-square errors of `mu_s` and `mu` over all events, including the first ones, and their
/// numbers.
fn errors(name: &str, effects: Effects) -> ([f64; 2], [usize; 2]) {
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
    (off.each_ref().map(|off| rms(off)), off.map(|off| off.len()))
}

/// Ratios of the errors with all effects to those without the effect `Ripple`.
fn ratios(name: &str) -> [f64; 2] {
    let lines = Effect::ALL.into_iter().filter(|it| *it != Effect::Ripple);
    let lines = lines.fold(Effects::NONE, |set, it| set.with(it, true));
    let ((all, read), (alone, read_alone)) =
        (errors(name, Effects::default()), errors(name, lines));
    // An answer that is refused has no error.
    let is_read = |(all, alone): (&usize, &usize)| *alone > EVENTS && all * 20 > alone * 19;
    assert!(read.iter().zip(&read_alone).all(is_read), "{name}: {read:?} {read_alone:?}");
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

/// Noise with a correlation of .9 between neighbours is not taken for a slow oscillation in long
/// rests: 95 % intervals cover the truth with half the winch speed, and with twice the sampling
/// rate.
#[test]
fn slow_noise_in_long_rests_is_no_swing() {
    let noise = stored("honesty/ar1_90");
    let slow = Scene { winch_m_per_s: 0.5 * noise.winch_m_per_s, ..noise.clone() };
    let dense = Scene { rate_hz: 2.0 * noise.rate_hz, ..noise };
    for (name, scene) in [("half as fast", slow), ("32 Hz", dense)] {
        let score = Score::of(&scene, EVENTS, RECORDS);
        assert!(score.share_read() > 0.9, "{name}: {} read", score.share_read());
        let coverage = score.errors.each_ref().map(|it| it.coverage());
        println!("{name}: mu_s and mu covered {coverage:.3?}");
        assert!(coverage.iter().all(|it| *it > 0.87), "{name}: {coverage:?}");
    }
}

/// Rests of nine and twelve samples show correlated noise and a winch that cogs as well: 95 %
/// intervals cover the truth.
#[test]
fn brief_rests_show_what_is_not_white() {
    let noise = |weight_n: f64, correlation: f64| {
        let mut scene = Scene { weight_n, ..stored("honesty/ar1_50") };
        scene.measurement.white_n = 0.0;
        if let Some(coloured) = &mut scene.measurement.coloured {
            (coloured.correlation, coloured.std_n) = (correlation, 2.0);
        }
        (format!("{weight_n} N, noise correlated by {correlation}"), scene)
    };
    let cogs = |weight_n: f64, period_s: f64| {
        let winch_profile = Some(WinchProfile::Ripple { fraction: 0.2, period_s });
        let mut scene = Scene { weight_n, winch_profile, ..stored("honesty/cogging_5") };
        scene.measurement.white_n = 1.0;
        (format!("{weight_n} N, cogging in {period_s} s"), scene)
    };
    let scenes = [noise(225.0, 0.3), noise(225.0, 0.5), noise(300.0, 0.3), noise(300.0, 0.5)]
        .into_iter()
        .chain([cogs(225.0, 0.6), cogs(300.0, 0.4), cogs(300.0, 0.6)]);
    for (name, scene) in scenes {
        let score = Score::of(&scene, BRIEF_EVENTS, RECORDS);
        let coverage = score.errors.each_ref().map(|it| it.coverage());
        println!("{name}: {:.3} read, mu_s and mu covered {coverage:.3?}", score.share_read());
        assert!(score.share_read() > 0.9, "{name}: {} read", score.share_read());
        assert!(coverage.iter().all(|it| *it > 0.87), "{name}: {coverage:?}");
    }
}
