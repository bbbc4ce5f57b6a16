//! A simulated programme of 25 tests, drawn from the published trends.
//!
//! Weights 0.3 to 3.3 kN, pull rates 8 to 40 mm/s, 13 tests on snow and 12 on bare ice,
//! every third up a slope of 2° to 6° (rafting). The coefficients follow the published
//! sizes: heavy blocks (3 kN) a third lower than light ones (0.3 kN); snow adds a
//! quarter on light blocks (0.75 kN) and nothing on heavy ones (2.25 kN); no trend
//! with the pull rate; group means that print as the published ones, see [`MEANS`].
//! Between tests they scatter by 10 %, between events of a test by 3 %.

use floe_core::{Config, Event, Newtons, Pipeline, RawSample, Reading};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use rand_distr::{Distribution, StandardNormal, StandardUniform};

use crate::error::InputError;
use crate::replay::quantities::Quantities;
use crate::replay::result::EventSummary;
use crate::replay::without_losses;
use crate::sim::terms::{Snow, Variation};
use crate::sim::write::said_of;
use crate::sim::{Measurement, Run, Scene, TrueEvent};

use super::{EventRecord, TestRecord};

/// Tests in one programme.
pub const TESTS: u32 = 25;

/// Published means `(mu_s, mu)` without snow, with snow, and of all tests; 1.0 is printed with one
/// decimal.
pub const PUBLISHED: [(f64, f64); 3] = [(0.76, 0.51), (1.0, 0.62), (0.91, 0.56)];

/// Means `(mu_s, mu)` without and with snow that round to [`PUBLISHED`], as does their mean over 12
/// and 13 tests: 0.906 and 0.564.
pub const MEANS: [(f64, f64); 2] = [(0.76, 0.507), (1.04, 0.617)];

const LIGHTEST_N: f64 = 300.0;
const HEAVIEST_N: f64 = 3300.0;
const SNOW_MM: f64 = 10.0;
const BETWEEN_TESTS: f64 = 0.10;
const BETWEEN_EVENTS: f64 = 0.03;

/// Dependence of the coefficients on weight and snow, before the group mean.
fn trend(weight_n: f64, snow: bool) -> f64 {
    let heavy = 1.0 - (weight_n - 300.0) / (3000.0 - 300.0) / 3.0;
    let light = ((2250.0 - weight_n) / (2250.0 - 750.0)).max(0.0);
    if snow { heavy * (1.0 + 0.25 * light) } else { heavy }
}

/// Mean of [`trend`] over the distribution of weights, which is uniform in the logarithm.
fn mean_trend(snow: bool) -> f64 {
    let steps = 200;
    let at = |i: i32| (f64::from(i) + 0.5) / f64::from(steps);
    (0..steps).map(|i| trend(weight_n(at(i)), snow)).sum::<f64>() / f64::from(steps)
}

fn weight_n(u: f64) -> f64 {
    LIGHTEST_N * (HEAVIEST_N / LIGHTEST_N).powf(u)
}

/// The scene of one test and the seed of its simulation.
#[must_use]
pub fn scene(seed: u64, campaign: u32, test: u32) -> (Scene, u64) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    random.set_stream(u64::from(campaign) * u64::from(TESTS) + u64::from(test));
    let uniform = |random: &mut ChaCha8Rng| -> f64 { StandardUniform.sample(random) };
    let normal = |random: &mut ChaCha8Rng| -> f64 { StandardNormal.sample(random) };

    // Weights are spread over their range within each group.
    let snow = test.is_multiple_of(2);
    let in_group = f64::from(if snow { TESTS.div_ceil(2) } else { TESTS / 2 });
    let weight_n = weight_n((f64::from(test / 2) + uniform(&mut random)) / in_group).round();
    let level = trend(weight_n, snow) / mean_trend(snow);
    let scatter = (1.0 + BETWEEN_TESTS * normal(&mut random)).max(0.5);
    let ratio = (1.0 + 0.5 * BETWEEN_TESTS * normal(&mut random)).max(0.8);
    let [without, with] = MEANS;
    let (mean_mu_s, mean_mu) = if snow { with } else { without };
    let mu = mean_mu * level * scatter;
    let winch_m_per_s = 0.008 + 0.032 * uniform(&mut random).powi(2);
    let slope_deg = if test % 3 == 2 { 2.0 + 4.0 * uniform(&mut random) } else { 0.0 };
    let scene = Scene {
        test_id: Some(format!("S{campaign:04}-{test:02}")),
        weight_n,
        mu_s: mu * (mean_mu_s / mean_mu * ratio).max(1.1),
        mu,
        winch_m_per_s,
        slope_deg,
        snow: snow.then_some(Snow { depth_mm: SNOW_MM, mu_s_offset: 0.0, mu_offset: 0.0 }),
        variation: Some(Variation { mu_s_fraction: BETWEEN_EVENTS, mu_fraction: BETWEEN_EVENTS }),
        measurement: Measurement { white_n: 2.0, ..Measurement::default() },
        ..Scene::default()
    };
    (scene, random.next_u64())
}

/// Simulates and evaluates one test.
///
/// # Errors
/// A scene cannot be simulated or evaluated.
pub fn evaluate(seed: u64, campaign: u32, test: u32) -> Result<TestRecord, InputError> {
    let (scene, seed_of_test) = scene(seed, campaign, test);
    let mut run = Run::new(&scene, seed_of_test).map_err(InputError::new)?;
    let config = config(&scene);
    let mut pipeline = Pipeline::new(&config).map_err(InputError::new)?;
    let events = found(&mut pipeline, &mut run);
    if let Some(failure) = run.failure() {
        return Err(InputError::new(failure));
    }
    let report = pipeline.report();
    let seconds =
        |t: floe_core::SampleTime| (t.index as f64 + f64::from(t.fraction)) / scene.rate_hz;
    let quantities = Quantities::new(&config, &report, report.omega_rad_per_s);
    let measured = |event: &Event| {
        let mut measured = EventSummary::new(event, seconds(event.onset), seconds(event.stop));
        quantities.complete(&mut measured);
        with_truth(measured, run.events())
    };
    let events: Vec<EventRecord> = events.iter().map(measured).collect();
    let raised = scene.slope_deg > 0.0;
    Ok(TestRecord {
        kind: Some(if raised { "rafting" } else { "sliding" }.to_owned()),
        hold_s: TestRecord::mean_hold_s(&events),
        campaign,
        test,
        test_id: scene.test_id.clone().unwrap_or_default(),
        weight_n: scene.weight_n,
        winch_m_per_s: Some(scene.winch_m_per_s),
        slope_rad: scene.slope_rad(),
        snow_mm: Some(scene.snow.map_or(0.0, |s| s.depth_mm)),
        mu_s: report.mu_s.into(),
        mu: report.mu.into(),
        event_count: events.len(),
        synthetic: Some(said_of(seed)),
        events,
        ..TestRecord::default()
    })
}

/// The events that the core finds in a run.
fn found(pipeline: &mut Pipeline, run: &mut Run) -> Vec<Event> {
    let mut events = Vec::new();
    for sample in run {
        let reading = Reading::Force(Newtons(sample.force_n as f32));
        let step = pipeline.step(RawSample { index: sample.index, reading });
        events.extend(step.event.map(|event| without_losses(pipeline, event)));
    }
    while let Some(event) = pipeline.finish() {
        events.push(without_losses(pipeline, event));
    }
    events
}

fn config(scene: &Scene) -> Config {
    Config {
        rate_hz: scene.rate_hz as f32,
        weight_n: scene.weight_n as f32,
        slope_rad: scene.slope_rad() as f32,
        winch_m_per_s: Some(scene.winch_m_per_s as f32),
        ..Config::default()
    }
}

/// Adds the true event whose slip overlaps the measured one.
fn with_truth(measured: EventSummary, truth: &[TrueEvent]) -> EventRecord {
    let after = truth.partition_point(|t| t.stop_s < measured.onset_s);
    let same = truth.get(after).filter(|t| t.onset_s <= measured.stop_s);
    EventRecord { true_mu_s: same.map(|t| t.mu_s), true_mu: same.map(|t| t.mu), measured }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::{Log, LogOptions};
    use crate::replay::replay;
    use crate::replay::test::{TestOptions, configure};
    use crate::sim::write;

    #[test]
    fn the_programme_has_the_published_means_and_trends() {
        let mut sums = [(0.0, 0.0, 0.0); 2];
        for campaign in 0..400 {
            for test in 0..TESTS {
                let scene = scene(1, campaign, test).0;
                scene.validate().unwrap();
                assert!((300.0..=3300.0).contains(&scene.weight_n));
                assert!((0.008..=0.040).contains(&scene.winch_m_per_s));
                let sum = &mut sums[usize::from(scene.snow.is_some())];
                *sum = (sum.0 + scene.mu_s, sum.1 + scene.mu, sum.2 + 1.0);
            }
        }
        for (sum, mean) in sums.iter().zip(MEANS) {
            assert!((sum.0 / sum.2 - mean.0).abs() < 0.015, "{}", sum.0 / sum.2);
            assert!((sum.1 / sum.2 - mean.1).abs() < 0.01, "{}", sum.1 / sum.2);
        }
        assert!((sums[1].2 / sums[0].2 - 13.0 / 12.0).abs() < 1e-12);
        assert!((trend(3000.0, false) / trend(300.0, false) - 2.0 / 3.0).abs() < 1e-12);
        assert!((trend(750.0, true) / trend(750.0, false) - 1.25).abs() < 1e-12);
        assert!((trend(2250.0, true) / trend(2250.0, false) - 1.0).abs() < 1e-12);
    }

    /// Tolerance of half a unit of the last printed digit: with 13 tests on snow and 12 on bare ice
    /// all six printed means are consistent.
    #[test]
    fn the_published_means_hold_together() {
        let all = |of: fn((f64, f64)) -> f64| (12.0 * of(MEANS[0]) + 13.0 * of(MEANS[1])) / 25.0;
        let (mu_s, mu) = (all(|m| m.0), all(|m| m.1));
        for (mean, printed, half) in [
            (MEANS[0].0, PUBLISHED[0].0, 0.005),
            (MEANS[0].1, PUBLISHED[0].1, 0.005),
            (MEANS[1].0, PUBLISHED[1].0, 0.05),
            (MEANS[1].1, PUBLISHED[1].1, 0.005),
            (mu_s, PUBLISHED[2].0, 0.005),
            (mu, PUBLISHED[2].1, 0.005),
        ] {
            assert!((mean - printed).abs() < half, "{mean} {printed}");
        }
    }

    /// Each test is evaluated as a replay of its log would be.
    #[test]
    fn an_event_has_all_that_a_replay_gives() {
        let (scene, seed_of_test) = scene(1, 0, 4);
        let mut bytes = Vec::new();
        write::csv_head(&mut bytes, &scene, seed_of_test, "").unwrap();
        for sample in Run::new(&scene, seed_of_test).unwrap() {
            write::csv_line(&mut bytes, write::force_decimals(&scene), &sample).unwrap();
        }
        let input = Box::new(std::io::Cursor::new(bytes));
        let mut log = Log::from_reader(input, &LogOptions::default()).unwrap();
        let config = configure(&log, &TestOptions::default()).unwrap();
        let replayed = replay("", &mut log, &config, |_, _| {}).unwrap().events;
        let events = evaluate(1, 0, 4).unwrap().events;
        assert_eq!(events.len(), replayed.found());
        for (event, other) in events.iter().zip(replayed.iter()) {
            let [mut own, other] =
                [&event.measured, other].map(|it| serde_json::to_value(it).unwrap());
            // The forces in the log are rounded.
            own["onset_time"] = other["onset_time"].clone();
            for (key, other) in other.as_object().unwrap() {
                let near = |other: f64| {
                    let own = own[key].as_f64().unwrap_or(f64::NAN);
                    (own - other).abs() <= 1e-3 * other.abs()
                };
                let is_same = other.as_f64().map_or(other.is_null() == own[key].is_null(), near);
                assert!(is_same, "{key}: {} {other}", own[key]);
            }
        }
    }

    #[test]
    fn a_test_is_evaluated_against_its_truth() {
        let record = evaluate(1, 0, 4).unwrap();
        let known = record.events.iter().filter(|e| e.true_mu.is_some()).count();
        assert!(record.events.len() > 20 && known * 10 >= record.events.len() * 9);
        for event in &record.events {
            if let (Some(mu), Some(truth)) = (event.measured.mu, event.true_mu) {
                assert!((mu / truth - 1.0).abs() < 0.1, "{mu} {truth}");
            }
        }
    }
}
