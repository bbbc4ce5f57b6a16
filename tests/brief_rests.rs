//! Scenes with very short rests, with slips that are long at their noise level, or with slips
//! shorter than a sample, where stick lines could wrongly end within slips. The model holds in all
//! of them, so their means must be right.

use floe::sim::Scene;
use floe_core::{Coefficient, Estimate, Event};
use floe_tests::scenes::stored;
use floe_tests::score::{self, Score, Tried, run};

/// A scene of a duration that gives 200 to 300 recurrences.
fn scene(
    [weight_n, stiffness_n_per_m, winch_m_per_s]: [f64; 3],
    [mu_s, mu]: [f64; 2],
    noise_n: f64,
    duration_s: f64,
) -> Scene {
    let mut scene = Scene {
        weight_n,
        stiffness_n_per_m,
        winch_m_per_s,
        mu_s,
        mu,
        duration_s,
        ..Scene::default()
    };
    scene.measurement.white_n = noise_n;
    scene
}

/// Fraction of the events with both coefficients.
fn read(tried: &Tried) -> f64 {
    let both =
        |&&(_, f): &&(usize, usize)| tried.found[f].mu_s.is_some() && tried.found[f].mu.is_some();
    tried.pairs.iter().filter(both).count() as f64 / tried.truths.len() as f64
}

fn off(mean: Option<Estimate>, truth: f64) -> f64 {
    let mean = mean.unwrap();
    (f64::from(mean.mean) - truth) / f64::from(mean.combined_std().unwrap())
}

fn check(name: &str, scene: &Scene, least_read: f64) {
    for seed in 1..=4 {
        let tried = run(scene, seed);
        let (read, report) = (read(&tried), &tried.report);
        let offs = [off(report.mu_s, scene.mu_s), off(report.mu, scene.mu)];
        println!("{name} {seed}: read {read:.3}, off {:.1} {:.1}", offs[0], offs[1]);
        assert!(read > least_read, "{name} {seed}: {read} read");
        assert!(offs.iter().all(|z| z.abs() < 5.0), "{name} {seed}: off {offs:?}");
    }
}

#[test]
fn rests_of_three_samples_between_long_slips() {
    for noise_n in [1.0, 7.0, 28.0] {
        let scene = scene([6300.0, 48e3, 0.078], [0.45, 0.385], noise_n, 160.0);
        check("long slips", &scene, 0.97);
    }
}

#[test]
fn rests_of_less_than_a_sample() {
    check("no rest", &scene([5700.0, 206e3, 0.21], [0.99, 0.795], 4.0, 70.0), 0.97);
}

#[test]
fn a_small_drop_in_much_noise_slips_for_long() {
    check("small drop", &scene([4900.0, 9e3, 0.074], [0.48, 0.41], 44.0, 400.0), 0.97);
}

/// The few samples of this scene also fit a cable that goes slack in every slip, at half the
/// loading rate; the winch's speed excludes this. On a cable of half the stiffness every event is
/// read; here each is right or refused with a reason.
#[test]
fn a_taut_cable_that_looks_slack() {
    let on_cable =
        |stiffness_n_per_m| scene([8047.0, stiffness_n_per_m, 0.381], [0.77, 0.39], 24.0, 10.0);
    check("softer cable", &on_cable(120e3), 0.97);
    let (mut found, mut due) = (0, 0);
    for seed in 1..=40 {
        let tried = run(&on_cable(264e3), seed);
        let means = [(tried.report.mu_s, 0.77), (tried.report.mu, 0.39)];
        let offs = means
            .map(|(mean, truth)| mean.filter(|it| it.events > 1).map(|it| off(Some(it), truth)));
        assert!(offs.iter().flatten().all(|z| z.abs() < 5.0), "{seed}: off {offs:?}");
        (found, due) = (found + tried.pairs.len(), due + tried.truths.len());
        for event in tried.pairs.iter().map(|pair| &tried.found[pair.1]) {
            let is_right = |got: Option<Coefficient>, truth| {
                got.map_or(event.reason.is_some(), |got| score::off(&got, truth).abs() < 5.0)
            };
            assert!(is_right(event.mu_s, 0.77) && is_right(event.mu, 0.39), "{seed}: {event:?}");
        }
    }
    assert!(due > 600 && found * 10 > due * 9, "{found} of {due}");
}

/// A slip contains one sample at most: the events are uncertain, and the intervals include this.
#[test]
fn slips_of_less_than_a_sample_between_brief_rests() {
    for weight_n in [213.0, 360.0, 533.0] {
        let scene = scene([weight_n, 139e3, 0.0034], [1.15, 0.74], 0.2, 100.0);
        check("short slips", &scene, 0.85);
    }
}

/// A cell with a lag departs from the model, and the next event cuts most fits short. Such fits
/// must get the same additional uncertainty as complete ones.
#[test]
fn fits_that_the_next_event_cuts_short_are_as_unsure_as_the_others() {
    let scene = Scene { winch_m_per_s: 0.12, ..stored("honesty/lag_30") };
    let score = Score::of(&scene, 900, 4);
    let coverage = score.errors.each_ref().map(|errors| errors.coverage());
    assert!(score.share_read() > 0.95, "{}", score.share_read());
    assert!(coverage.iter().all(|&share| share > 0.9), "{coverage:?}");
}

/// Fraction of the events with an error above five standard deviations, in `records` records with
/// the first `most` events of each.
fn far(scene: &Scene, records: u64, most: usize) -> f64 {
    let (mut far, mut all) = (0, 0);
    for seed in 1..=records {
        let tried = run(scene, seed);
        for &(_, f) in tried.pairs.iter().take(most) {
            let Event { mu_s: Some(mu_s), mu: Some(mu), .. } = tried.found[f] else { continue };
            let off = |got: Coefficient, truth| (f64::from(got.value) - truth) / f64::from(got.std);
            far += u32::from(off(mu_s, scene.mu_s).abs() > 5.0 || off(mu, scene.mu).abs() > 5.0);
            all += 1;
        }
    }
    println!("{far} of {all} events beyond five");
    assert!(all as u64 * 4 > records, "{all} events in {records} records");
    f64::from(far) / f64::from(all)
}

/// Before a slip has a first answer, its loading rate shows that the samples before the next
/// maximum belong to the ellipse of that slip, not to the stick line.
#[test]
fn the_first_event_ends_before_the_next_slip() {
    for ([weight_n, stiffness_n_per_m, winch_m_per_s], [mu_s, mu]) in [
        ([1241.0, 36e3, 0.2913], [0.70, 0.63]),
        ([633.0, 8e3, 0.286], [0.43, 0.38]),
        ([5400.0, 230e3, 0.31], [0.78, 0.66]),
    ] {
        let pull = [weight_n, stiffness_n_per_m, winch_m_per_s];
        assert!(far(&scene(pull, [mu_s, mu], 3e-4 * weight_n, 12.0), 40, 1) < 0.02, "{pull:?}");
    }
}

/// A sample at the edge of a fall to zero leaves open whether the cable went slack long before.
#[test]
fn the_last_sample_of_a_fall_to_nothing_is_not_sure_of_its_end() {
    let scene = scene([1150.0, 100e3, 0.0253], [0.66, 0.31], 0.35, 12.0);
    // With 40 records a single event would exceed the limit.
    assert!(far(&scene, 200, usize::MAX) < 1e-3);
}
