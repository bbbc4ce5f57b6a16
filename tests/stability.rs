//! Rounding errors: the core in single precision compared with double precision, and the effect of
//! a month of samples. Figures: `docs/stability.md`.

use std::fs;
use std::path::Path;

use floe::sim::{Run, Scene, TrueEvent};
use floe_core::estimator::Estimator;
use floe_core::{Calibration, Coefficient, Config, Event};
use floe_tests::both::{self, Both, Differences, periods};
use floe_tests::normal::Normal;
use floe_tests::scenes;
use floe_tests::score::rms;

/// Largest root-mean-square difference, in stated standard deviations of an event.
const LIMIT: f64 = 0.02;

/// Names of all scenes with noise.
fn names() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../host-sim/scenes");
    let mut names = vec!["dff8-13".to_owned()];
    for part in ["linear", "hard"] {
        let files = fs::read_dir(folder.join(part)).unwrap().map(|f| f.unwrap().path());
        names.extend(files.map(|f| format!("{part}/{}", f.file_stem().unwrap().display())));
    }
    names.sort();
    assert!(names.len() > 25, "{names:?}");
    names
}

/// Quantile of the absolute values.
fn quantile(values: &[f64], part: f64) -> f64 {
    let mut sizes: Vec<f64> = values.iter().map(|x| x.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    sizes.get((part * (sizes.len().max(1) - 1) as f64) as usize).copied().unwrap_or(0.0)
}

/// Differences between the events of a scene's first seeds in both precisions.
fn compared(scene: &Scene, seeds: u64) -> Differences {
    let mut differences = Differences::default();
    for seed in 1..=seeds {
        let mut both = Both::new(&both::config(scene));
        Run::new(scene, seed).unwrap().for_each(|s| both.force(s.index, s.force_n));
        both.finish();
        differences.add(&both.events);
    }
    differences
}

fn row(name: &str, differences: &Differences) {
    let cells = differences
        .coefficients
        .each_ref()
        .map(|d| format!("{:.5} | {:.5} | {:.5}", rms(d), quantile(d, 0.99), quantile(d, 1.0)));
    let (events, onset) = (differences.onset.len(), rms(&differences.onset));
    let alone = differences.alone;
    println!("| {name} | {events} | {alone} | {} | {} | {onset:.0e} |", cells[0], cells[1]);
}

fn check(name: &str, differences: &Differences, limit: f64) {
    row(name, differences);
    for d in &differences.coefficients {
        assert!(2 * d.len() >= differences.onset.len(), "{name}: {} compared", d.len());
        assert!(rms(d) < limit, "{name}: {} standard deviations apart", rms(d));
    }
}

const TABLE: &str =
    "| scene | events | one only | mu_s rms | 99 % | max | mu rms | 99 % | max | onset |";

#[test]
fn rounding_is_small_against_the_error_on_every_scene() {
    println!("{TABLE}");
    for name in names() {
        let differences = compared(&scenes::stored(&name), 10);
        check(&name, &differences, LIMIT);
        // Rounding may move an onset between the same two samples to either end.
        let (alone, events) = (differences.alone, differences.onset.len());
        assert!(200 * alone <= events, "{name}: {alone} of {events} events differ");
    }
}

/// A constant load of 10 kN, removed in codes or not removed.
#[test]
fn a_large_tare_costs_nothing() {
    const COUNTS_PER_N: f32 = 416.67;
    let scene = Scene { duration_s: 600.0, ..scenes::stored("hard/tare") };
    let code = |force_n: f64| (force_n * f64::from(COUNTS_PER_N)).round() as i32;
    let tare_counts = code(10_000.0);
    let calibration =
        Calibration { tare_counts, counts_per_n: COUNTS_PER_N, ..Calibration::default() };
    let net = Config { range_n: None, calibration, ..both::config(&scene) };
    // An unremoved load is part of the weight, since no coefficient above 3 is accepted, and has no
    // mass.
    let gross = Config { weight_n: net.weight_n + 10_000.0, winch_m_per_s: None, ..net };
    println!("{TABLE}");
    for (name, config) in [("taken off in codes", net), ("in the force", gross)] {
        let in_counts = config.weight_n < 10_000.0;
        let mut differences = Differences::default();
        for seed in 1..=5 {
            let mut both = Both::new(&config);
            for sample in Run::new(&scene, seed).unwrap() {
                let gross_n = sample.force_n + 10_000.0;
                if in_counts {
                    both.counts(sample.index, code(gross_n));
                } else {
                    both.force(sample.index, gross_n);
                }
            }
            differences.add(&both.events);
        }
        check(name, &differences, LIMIT);
        assert_eq!(differences.alone, 0, "{name}");
    }
}

/// Rounding matters more with less noise; down to a hundred-thousandth of the weight it has no
/// effect.
#[test]
fn quiet_cells() {
    println!("{TABLE}");
    for (noise_n, limit) in [(2.0, LIMIT), (0.2, LIMIT), (0.02, LIMIT), (0.006, 0.1)] {
        let mut scene = scenes::stored("dff8-13");
        scene.measurement.white_n = noise_n;
        check(&format!("noise {noise_n} N of 630 N"), &compared(&scene, 10), limit);
    }
}

/// A heavy block, a slow winch and a quiet cell: the noise of one of the 3800 samples of a rest
/// moves the mean of its line by about as much as rounding.
#[test]
fn rests_of_minutes() {
    println!("{TABLE}");
    let mut scene = Scene {
        weight_n: 15_587.434_297_8,
        mu_s: 1.169_126_4,
        mu: 0.724_747_05,
        stiffness_n_per_m: 23_043.966_1,
        winch_m_per_s: 0.002_515_903_5,
        duration_s: 2600.0,
        ..Scene::default()
    };
    scene.measurement.white_n = 4.5;
    check("rests of 240 s, noise 4.5 N of 15.6 kN", &compared(&scene, 4), 0.1);
}

/// Errors in stated standard deviations, and of the onset in sampling periods.
#[derive(Default)]
struct Errors {
    coefficients: [Vec<f64>; 2],
    onset: Vec<f64>,
}

impl Errors {
    fn new(events: &[Event], first_index: u32, truths: &[TrueEvent], rate_hz: f64) -> Self {
        let mut errors = Self::default();
        let mut truths = truths.iter().peekable();
        for event in events {
            let onset_s = (periods(event) - f64::from(first_index)) / rate_hz;
            while truths.next_if(|t| t.onset_s < onset_s - 0.3).is_some() {}
            let Some(truth) = truths.peek().filter(|t| t.onset_s < onset_s + 0.3) else { continue };
            let (Some(mu_s), Some(mu)) = (event.mu_s, event.mu) else { continue };
            let over = |c: Coefficient, t: f64| (f64::from(c.value) - t) / f64::from(c.std);
            errors.coefficients[0].push(over(mu_s, truth.mu_s));
            errors.coefficients[1].push(over(mu, truth.mu));
            errors.onset.push((onset_s - truth.onset_s) * rate_hz);
        }
        errors
    }

    fn print(&self, name: &str) {
        let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
        let inside = |v: &[f64]| {
            100.0 * mean(&v.iter().map(|z| f64::from(z.abs() < 1.96)).collect::<Vec<_>>())
        };
        let cells = self
            .coefficients
            .each_ref()
            .map(|z| format!("{:.3} | {:+.3} | {:.1} %", rms(z), mean(z), inside(z)));
        let onset = rms(&self.onset);
        println!("| {name} | {} | {} | {} | {onset:.5} |", self.onset.len(), cells[0], cells[1]);
    }
}

/// Runs days of DFF8-13 without interruption, up to the end of a month.
fn days(days: u32) {
    const MONTH: u32 = 30 * 86_400 * 16;
    let scene = Scene { duration_s: 86_400.0 * f64::from(days), ..scenes::stored("dff8-13") };
    let first_index = MONTH - days * 86_400 * 16;
    let mut both = Both::new(&both::config(&scene));
    let mut run = Run::new(&scene, 1).unwrap();
    run.by_ref().for_each(|s| both.force(first_index + s.index, s.force_n));
    let (events, truths) = (&both.events.0, run.events());
    let part = events.len() / if days > 1 { days as usize } else { 12 };
    let errors = |events: &[Event]| Errors::new(events, first_index, truths, scene.rate_hz);
    // The first events are left out, because the model still learns.
    let (first, last) = (errors(&events[20..part]), errors(&events[events.len() - part..]));
    println!(
        "| part | events | mu_s rms | mean | within 95 % | mu rms | mean | within 95 % | onset |"
    );
    first.print("first");
    last.print("last");
    let lost = truths.len() - events.len();
    assert!(lost < 4, "{lost} events lost");
    for (a, b) in first.coefficients.iter().zip(&last.coefficients) {
        assert!((rms(b) / rms(a) - 1.0).abs() < 0.06, "{} {}", rms(a), rms(b));
    }
    assert!((rms(&last.onset) / rms(&first.onset) - 1.0).abs() < 0.06);

    let mut differences = Differences::default();
    differences.add(&both.events);
    println!("{TABLE}");
    check("single from double", &differences, LIMIT);
    means(&both, &scene);
}

/// Checks the means over all events: deviations from the truth and from double precision, in
/// standard errors.
fn means(both: &Both, scene: &Scene) {
    let (single, double) = (both.single.report(), both.double.report());
    for (name, single, double, truth) in
        [("mu_s", single.mu_s, double.mu_s, scene.mu_s), ("mu", single.mu, double.mu, scene.mu)]
    {
        let (single, double) = (single.unwrap(), double.unwrap());
        let mean = f64::from(single.mean);
        let std_error = double.std_error.unwrap();
        let (error, rounding) = ((mean - truth) / std_error, (mean - double.mean) / std_error);
        println!(
            "{name}: {mean:.8} ± {std_error:.1e} from {} events, {error:+.2} standard errors \
             from the truth, {rounding:+.3} from double precision",
            single.events
        );
        assert!(error.abs() < 4.0);
        // Rounding of the report, plus two hundredths of the error.
        let digit = 0.5 * f64::from(f32::EPSILON) * truth;
        assert!((mean - double.mean).abs() < digit + LIMIT * std_error);
    }
}

#[test]
fn the_last_day_of_a_month() {
    days(1);
}

#[test]
#[ignore = "41 million samples: a minute"]
fn a_month() {
    days(30);
}

#[test]
fn pauses_of_up_to_a_day_cost_nothing() {
    pauses(&[60.0, 3600.0, 86_400.0]);
}

/// A pause of more than 2²⁴ samples.
#[test]
#[ignore = "41 million samples"]
fn a_pause_of_twenty_days_costs_nothing() {
    pauses(&[20.0 * 86_400.0]);
}

/// Pauses of the winch between pulls of a minute.
fn pauses(stops_s: &[f64]) {
    println!("{TABLE}");
    for stop_s in stops_s {
        let text = format!(
            "weight_n = 630.0\nmu_s = 1.24\nmu = 0.78\nstiffness_n_per_m = 23000.0\n\
             winch_m_per_s = 0.01565\nduration_s = {}\n[measurement]\nwhite_n = 2.0\n\
             [winch_profile]\nkind = \"stop_and_go\"\ngo_s = 61.3\nstop_s = {stop_s}\n",
            1.5 * (61.3 + stop_s) + 30.0,
        );
        let scene = Scene::from_toml(&text).unwrap();
        let mut both = Both::new(&both::config(&scene));
        let mut run = Run::new(&scene, 1).unwrap();
        run.by_ref().for_each(|s| both.force(s.index, s.force_n));
        let errors = Errors::new(&both.events.0, 0, run.events(), scene.rate_hz);
        let mut differences = Differences::default();
        differences.add(&both.events);
        check(&format!("pause of {stop_s} s"), &differences, LIMIT);
        assert_eq!(differences.alone, 0);
        for z in &errors.coefficients {
            assert!(z.len() + 4 > run.events().len(), "{} of {}", z.len(), run.events().len());
            assert!(quantile(z, 1.0) < 5.0, "{} standard deviations off", quantile(z, 1.0));
        }
    }
}

/// A winch that doubles its speed: a few events do not fit the learnt parameters, all others do.
#[test]
fn a_change_of_speed_is_followed() {
    let slow = Scene { duration_s: 900.0, ..scenes::stored("dff8-13") };
    for factor in [0.5, 0.95, 1.05, 2.0] {
        let winch_m_per_s = factor * slow.winch_m_per_s;
        let fast = Scene { winch_m_per_s, start_force_n: 201.6, ..slow.clone() };
        let mut both = Both::new(&both::config(&slow));
        Run::new(&slow, 1).unwrap().for_each(|s| both.force(s.index, s.force_n));
        let (before, first_index) = (both.events.0.len(), slow.sample_count());
        let mut run = Run::new(&fast, 2).unwrap();
        run.by_ref().for_each(|s| both.force(first_index + s.index, s.force_n));
        let events = &both.events.0[before..];
        let errors = Errors::new(events, first_index, run.events(), slow.rate_hz);
        errors.print(&format!("speed times {factor}"));
        let (given, due) = (errors.onset.len(), run.events().len());
        assert!(given + 10 > due, "{given} of {due}");
        for z in &errors.coefficients {
            let late = &z[10..];
            assert!(rms(late) < 1.15, "{}", rms(late));
        }
    }
}

/// For a million events, mean, error and spread equal those of two passes over all of them, to the
/// last digit of the report.
#[test]
fn a_million_events() {
    let mut random = Normal::new(1);
    let (mut estimator, mut values) = (Estimator::default(), Vec::new());
    for i in 0..1_000_000_u32 {
        let std = if i % 3 == 0 { 0.001 } else { 0.0005 };
        let value = (0.78 + 0.002 * random.sample() + f64::from(std) * random.sample()) as f32;
        estimator.add(Coefficient::random(value, std));
        values.push((f64::from(value), f64::from(std).powi(2)));
    }
    let n = values.len() as f64;
    let sum = |f: &dyn Fn(&(f64, f64)) -> f64| values.iter().map(f).sum::<f64>();
    // A plain sum of small differences is accurate here.
    let mean = 0.78 + sum(&|v| v.0 - 0.78) / n;
    let between = sum(&|v| (v.0 - mean).powi(2)) / (n - 1.0) - sum(&|v| v.1) / n;
    let weights = sum(&|v| 1.0 / v.1);
    let weighted = 0.78 + sum(&|v| (v.0 - 0.78) / v.1) / weights;
    let lambda = (n / weights) / (n / weights + between);
    let expected = lambda * weighted + (1.0 - lambda) * mean;
    let got = estimator.estimate().unwrap();
    let last_digit = f64::from(f32::EPSILON) * expected;
    assert!((f64::from(got.mean) - expected).abs() < 0.51 * last_digit);
    assert!((f64::from(got.spread.unwrap()) / between.sqrt() - 1.0).abs() < 1e-6);
}
