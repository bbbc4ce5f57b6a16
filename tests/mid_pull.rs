//! Records that begin during a pull: cut from a longer record, or from a logger switched on late.
//! There is no quiet start, and the first sample may be within a slip.

use floe::sim::terms::Variation;
use floe::sim::{Measurement, Scene, TrueEvent, simulate};
use floe_core::{Config, Event};
use floe_tests::{both, feed};

const HZ: f64 = 16.0;
const CUTS: usize = 24;

/// Blocks with rests of 9 to 40 samples.
fn scenes() -> [Scene; 4] {
    let measurement = Measurement { white_n: 2.0, ..Measurement::default() };
    let variation = Some(Variation { mu_s_fraction: 0.01, mu_fraction: 0.01 });
    let paper = Scene { duration_s: 240.0, measurement, variation, ..Scene::default() };
    let ice = Scene { mu_s: 0.78, mu: 0.57, ..paper.clone() };
    let large = Scene { weight_n: 5e3, stiffness_n_per_m: 2e5, ..ice.clone() };
    let fast = Scene { winch_m_per_s: 0.03, ..large.clone() };
    let slow = Scene { winch_m_per_s: 0.01, ..large };
    [paper, ice, fast, slow]
}

/// For the slips within a part of a record, without the first: number of slips, number with
/// coefficients, and number with an error of five standard deviations.
fn cut(
    scene: &Scene,
    forces_n: &[f64],
    slips: &[TrueEvent],
    first: usize,
    last: usize,
) -> [usize; 3] {
    let config = Config { weight_n: scene.weight_n as f32, ..Config::default() };
    let events = feed::replay(&config, feed::in_a_row(&forces_n[first..last])).events;
    let (from_s, to_s) = ((first as f64 + 4.0) / HZ, last as f64 / HZ - 0.75);
    let inside = |slip: &&TrueEvent| slip.onset_s > from_s && slip.stop_s < to_s;
    let mut counts = [0; 3];
    for slip in slips.iter().filter(inside).skip(1) {
        let read = events.iter().find(|event| is_at(event, slip.onset_s - first as f64 / HZ));
        let values = read.and_then(|event| event.mu_s.zip(event.mu));
        let is_off = values.is_some_and(|(mu_s, mu)| {
            [(mu_s, slip.mu_s), (mu, slip.mu)].iter().any(|(got, truth)| {
                (f64::from(got.value) - truth).abs() > 5.0 * f64::from(got.combined_std())
            })
        });
        let more = [1, usize::from(values.is_some()), usize::from(is_off)];
        counts.iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
    }
    counts
}

fn is_at(event: &Event, onset_s: f64) -> bool {
    (both::periods(event) / HZ - onset_s).abs() < 2.5 / HZ
}

/// Evaluates evenly spaced parts of `recurrences` recurrences. In every scene at least the fraction
/// `share` of the slips must have coefficients, and at most 1 % of these may be far from the truth.
fn parts_are_read(recurrences: f64, share: f64) {
    for scene in scenes() {
        let simulation = simulate(&scene, 3).expect("a scene");
        let forces_n: Vec<f64> = simulation.samples.iter().map(|sample| sample.force_n).collect();
        let slips = &simulation.events;
        let all_s = slips[slips.len() - 1].onset_s - slips[0].onset_s;
        let length = (recurrences * all_s / (slips.len() - 1) as f64 * HZ) as usize;
        let mut sum = [0; 3];
        for place in 0..CUTS {
            let first = 640 + place * (forces_n.len() - 640 - length) / CUTS;
            let counts = cut(&scene, &forces_n, slips, first, first + length);
            sum.iter_mut().zip(counts).for_each(|(sum, more)| *sum += more);
        }
        let [there, read, off] = sum;
        println!("{} N, {} m/s: {read} of {there}, {off} off", scene.weight_n, scene.winch_m_per_s);
        assert!(there as f64 > (recurrences - 4.0) * CUTS as f64, "{there} slips");
        assert!(read as f64 >= share * there as f64, "{} N: {read} of {there}", scene.weight_n);
        assert!(off * 100 <= read, "{} N: {off} of {read} off", scene.weight_n);
    }
}

#[test]
fn a_part_of_six_slips_is_read() {
    parts_are_read(6.5, 0.9);
}

#[test]
fn a_part_of_fifteen_slips_is_read() {
    parts_are_read(15.5, 0.95);
}

/// The first sample is higher than all later ones, and the block rests for four samples only.
#[test]
fn a_first_sample_that_falls_hides_no_slip() {
    let stiff = Scene { stiffness_n_per_m: 138e3, duration_s: 60.0, ..scenes()[0].clone() };
    for seed in 1..=6 {
        let simulation = simulate(&stiff, seed).expect("a scene");
        let samples = simulation.samples.iter().map(|sample| sample.force_n);
        let forces_n: Vec<f64> = [1051.0, 0.0].into_iter().chain(samples).collect();
        let config = Config { weight_n: stiff.weight_n as f32, ..Config::default() };
        let found = feed::replay(&config, feed::in_a_row(&forces_n)).events.len();
        let there = simulation.events.len();
        println!("seed {seed}: {found} of {there}");
        assert!(found * 10 > there * 9, "seed {seed}: {found} of {there}");
    }
}

/// Records that begin at any sample of a slip: the first event after it.
#[test]
fn a_record_that_begins_in_a_slip_reads_the_next_one_right() {
    let scene = Scene { duration_s: 12.0, ..scenes()[0].clone() };
    let config = Config { weight_n: scene.weight_n as f32, ..Config::default() };
    let (mut read, mut covered, mut records) = (0, [0; 2], 0);
    for seed in 1..=60 {
        let simulation = simulate(&scene, seed).expect("a scene");
        let forces_n: Vec<f64> = simulation.samples.iter().map(|sample| sample.force_n).collect();
        let [slip, next] = [&simulation.events[0], &simulation.events[1]];
        for first in (slip.onset_s * HZ).ceil() as usize..=(slip.stop_s * HZ) as usize {
            records += 1;
            let events = feed::replay(&config, feed::in_a_row(&forces_n[first..])).events;
            let onset_s = next.onset_s - first as f64 / HZ;
            let Some(event) = events.iter().find(|event| is_at(event, onset_s)) else { continue };
            let Some(values) = event.mu_s.zip(event.mu) else { continue };
            read += 1;
            for (count, (got, truth)) in
                covered.iter_mut().zip([(values.0, next.mu_s), (values.1, next.mu)])
            {
                *count +=
                    usize::from((f64::from(got.value) - truth).abs() < 2.0 * f64::from(got.std));
            }
        }
    }
    println!("{read} of {records} read, {covered:?} covered");
    assert!(read * 20 > records * 19, "{read} of {records}");
    assert!(covered.iter().all(|it| it * 100 > read * 88), "{covered:?} of {read}");
}
