//! Draws scenes over the plane of weight, stiffness, winch speed and noise, and checks for means
//! far from the truth and for refused events.
//!
//! `cargo run -p floe-tests --example plane -- [SCENES [SEED [RECURRENCES]]]` (defaults 300, 1 and
//! 20); `docs/plane.md` is the output of the default.

use std::collections::BTreeMap;

use floe::sim::{STANDARD_GRAVITY_M_PER_S2, Scene};
use floe_core::{Estimate, StretchKind};
use floe_tests::normal::Normal;
use floe_tests::score::{Tried, run};

/// First part of the page.
const HEAD: &str = "\
# Over the plane of weight, stiffness and speed

Written by `cargo run -p floe-tests --example plane`. Scenes drawn evenly in the logarithm: weight 100 N to 20 kN,
stiffness 5 kN/m to 1 MN/m, winch 1 mm/s to 0.4 m/s, noise .02 to 5 % of the weight; `mu` .3 to .9, `mu_s` above it by .05 to .5.
Combined standard deviations are those of the report, everything but the force given exactly. Slips, rests and
recurrences of less than a sample are drawn too: those are to be refused, with the reason.
";

/// Longest duration of a record, s.
const LONGEST_S: f64 = 20_000.0;

/// A value with a uniform logarithm.
fn drawn(random: &mut Normal, low: f64, high: f64) -> f64 {
    low * (high / low).powf(random.uniform())
}

/// A scene, samples per slip and per recurrence, and noise relative to the weight.
struct Case {
    scene: Scene,
    slip: f64,
    recurrence: f64,
    noise: f64,
}

fn case(random: &mut Normal, recurrences: f64) -> Case {
    let weight_n = drawn(random, 100.0, 20_000.0);
    let k = drawn(random, 5e3, 1e6);
    let w = drawn(random, 1e-3, 0.4);
    let noise = drawn(random, 2e-4, 0.05);
    let mu = 0.3 + 0.6 * random.uniform();
    let drop = 0.05 + 0.45 * random.uniform();
    // Equations (22) and (25).
    let omega = (k * STANDARD_GRAVITY_M_PER_S2 / weight_n).sqrt();
    let half = drop * weight_n;
    let stick_s = 2.0 * half / (k * w);
    let turn = (half / half.hypot(k * w / omega)).acos() + std::f64::consts::FRAC_PI_2;
    let slip_s = 2.0 * turn / omega;
    let first_s = (mu + drop) * weight_n / (k * w);
    let wanted_s = first_s + recurrences * (stick_s + slip_s);
    let mut scene = Scene {
        weight_n,
        mu_s: mu + drop,
        mu,
        stiffness_n_per_m: k,
        winch_m_per_s: w,
        duration_s: wanted_s.clamp(10.0, LONGEST_S),
        ..Scene::default()
    };
    scene.measurement.white_n = noise * weight_n;
    let hz = scene.rate_hz;
    Case { scene, slip: slip_s * hz, recurrence: (stick_s + slip_s) * hz, noise }
}

/// Error of a mean, in its combined standard deviations.
fn off(got: Option<Estimate>, truth: f64) -> Option<f64> {
    let mean = got?;
    Some((f64::from(mean.mean) - truth) / f64::from(mean.combined_std()?))
}

/// Most frequent reason of the events without a mean.
fn reason(tried: &Tried) -> String {
    let mut reasons = BTreeMap::new();
    for event in &tried.found {
        let reason = event.reason.map_or("no reason".to_owned(), |r| r.to_string());
        *reasons.entry(reason).or_insert(0) += 1;
    }
    let most = reasons.into_iter().max_by_key(|(_, count)| *count);
    most.map_or("no event".to_owned(), |(reason, count)| format!("{reason} ({count})"))
}

/// Description of a record without events.
fn stretch(tried: &Tried) -> String {
    match tried.stretches.first().map(|stretch| stretch.kind) {
        Some(StretchKind::NotUnderstood(reason)) => reason.to_string(),
        Some(StretchKind::Steady { .. }) => "a constant force".to_owned(),
        None => "no event".to_owned(),
    }
}

/// Numbers and percentage of a share.
fn share(what: &str, [read, all]: [usize; 2]) -> String {
    format!("{read} of {all} {what} ({:.1} %)", 100.0 * read as f64 / all.max(1) as f64)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut args = std::env::args().skip(1);
    let scenes: u32 = args.next().map_or(Ok(300), |n| n.parse())?;
    let seed: u64 = args.next().map_or(Ok(1), |n| n.parse())?;
    let recurrences: f64 = args.next().map_or(Ok(20.0), |n| n.parse())?;
    let mut random = Normal::new(seed);
    let (mut far, mut refused) = (Vec::new(), Vec::new());
    // Counts for the clear scenes: both means and all; events with both coefficients and all.
    let (mut clear, mut clear_events) = ([0, 0], [0, 0]);
    for number in 1..=scenes {
        let case = case(&mut random, recurrences);
        let tried = run(&case.scene, u64::from(number));
        let Case { scene: s, slip, recurrence, noise } = &case;
        let about = format!(
            "{number}: {:.0} N, {:.0} kN/m, {:.1} mm/s, noise {:.2} %, mu_s {:.2}, mu {:.2}; slip {slip:.1}, \
             recurrence {recurrence:.1} samples",
            s.weight_n,
            s.stiffness_n_per_m / 1e3,
            1e3 * s.winch_m_per_s,
            100.0 * noise,
            s.mu_s,
            s.mu
        );
        let offs = [off(tried.report.mu_s, s.mu_s), off(tried.report.mu, s.mu)];
        if offs.iter().flatten().any(|z| z.abs() > 5.0) {
            far.push(format!(
                "{about}: {:.1?} standard deviations off",
                offs.map(|z| z.unwrap_or(0.0))
            ));
        }
        if offs.iter().any(Option::is_none) {
            let why = if tried.found.is_empty() { stretch(&tried) } else { reason(&tried) };
            refused.push(format!("{about}: {why}"));
        }
        if *slip >= 1.0 && *recurrence >= 4.0 && *noise <= 0.02 {
            clear[0] += usize::from(offs.iter().all(Option::is_some));
            clear[1] += 1;
            let read = |&&(_, f): &&(usize, usize)| {
                tried.found[f].mu_s.is_some() && tried.found[f].mu.is_some()
            };
            clear_events[0] += tried.pairs.iter().filter(read).count();
            clear_events[1] += tried.truths.len();
        }
    }
    println!("{HEAD}");
    println!("{scenes} scenes of {recurrences} recurrences, seed {seed}.");
    println!("\n{} with a mean more than 5 combined standard deviations off:", far.len());
    far.iter().for_each(|line| println!("- {line}"));
    println!("\n{} without a mean of both coefficients:", refused.len());
    refused.iter().for_each(|line| println!("- {line}"));
    println!(
        "\nWith slips of a sample or more, a recurrence of four or more and noise of 2 % or less: means of \
         both coefficients in {}, both coefficients of {}",
        share("scenes", clear),
        share("events", clear_events)
    );
    Ok(())
}
