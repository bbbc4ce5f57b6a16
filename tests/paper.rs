//! Checks of the paper, section by section, on the scenes in `host-sim/scenes/paper`.
//! `docs/paper.md` has a line for each; the tests print its figures
//! (`cargo test -p floe-tests --test paper -- --nocapture`).

use std::f64::consts::{FRAC_PI_2, PI};

use floe::sim::motion::Segments;
use floe::sim::state::End;
use floe::sim::{Method, Phase, Sample, Scene, Simulation, TrueEvent, paper, simulate};
use floe::stiffness::{Measured, Pull, stiffness};
use floe_core::units::STANDARD_GRAVITY_M_PER_S2 as GRAVITY;
use floe_tests::scenes;

fn scene(name: &str) -> Scene {
    scenes::stored(&format!("paper/{name}"))
}

fn run(name: &str) -> (Scene, Simulation) {
    let scene = scene(name);
    let simulation = simulate(&scene, 1).unwrap();
    (scene, simulation)
}

fn omega(scene: &Scene) -> f64 {
    (scene.stiffness_n_per_m / (scene.weight_n / GRAVITY)).sqrt()
}

/// The paper's rate of the force: central difference over one sample to each side.
fn rates(samples: &[Sample], rate_hz: f64) -> Vec<(f64, f64, Phase)> {
    let rate = |w: &[Sample]| (w[2].force_n - w[0].force_n) * 0.5 * rate_hz;
    samples.windows(3).map(|w| (w[1].force_n, rate(w), w[1].phase)).collect()
}

#[test]
fn fig_5_slips_lie_on_the_ellipse() {
    let (scene, simulation) = run("fig5-ellipse");
    let (fp, omega) = (0.78 * 630.0, omega(&scene));
    let a = (0.46_f64 * 630.0).hypot(scene.stiffness_n_per_m * scene.winch_m_per_s / omega);
    let points = rates(&simulation.samples, scene.rate_hz);
    // Both neighbours must slip too, or the difference crosses the corner.
    let inside = points.windows(3).filter(|w| w.iter().all(|p| p.2 == Phase::Slip));
    let radii: Vec<f64> =
        inside.map(|w| ((w[1].0 - fp) / a).powi(2) + (w[1].1 / (omega * a)).powi(2)).collect();
    let worst = radii.iter().map(|r| (r - 1.0).abs()).fold(0.0, f64::max);
    println!("Fig. 5: a = {a:.1} N, omega a = {:.2} kN/s", omega * a / 1e3);
    println!("        {} points on the ellipse, worst {worst:.1e}", radii.len());
    assert!(radii.len() > 1000 && worst < 1e-4);
}

#[test]
fn figs_6_and_7_dff8_13_is_reproduced() {
    let (scene, simulation) = run("fig6-7-dff8-13");
    let forces: Vec<f64> = simulation.samples.iter().map(|s| s.force_n).collect();
    let loading_n_per_s = scene.stiffness_n_per_m * scene.winch_m_per_s;
    let (low, high) = forces.iter().fold((f64::MAX, f64::MIN), |(l, h), &f| (l.min(f), h.max(f)));
    let event = &simulation.events[0];
    // 3.3125 s is sample 53.
    let falling = (53..56).all(|i| forces[i] < forces[i - 1]) && forces[52] > forces[51];
    println!("Figs 6, 7: k w = {loading_n_per_s:.0} N/s, forces {low:.0} to {high:.0} N");
    println!("           onset {:.4} s, falls at 3.3125 s for three samples", event.onset_s);
    println!("           T_slide {:.4} s = {:.2} samples", event.slip_s, event.slip_s * 16.0);
    assert!(falling && forces[56] >= forces[55]);
    assert!((loading_n_per_s - 360.0).abs() < 0.5);
    assert!((190.0..250.0).contains(&low) && (750.0..800.0).contains(&high));
    assert!((event.slip_s * 16.0 - 2.77).abs() < 0.01);
}

/// Properties that Figs 6 and 7 have in common, and those of the log.
#[test]
fn figs_6_and_7_fit_together() {
    let scene = scenes::stored("fig6-7");
    let Simulation { samples, events } = simulate(&scene, 39).unwrap();
    let forces: Vec<f64> = samples.iter().map(|s| s.force_n).collect();
    let loading_n_per_s = scene.stiffness_n_per_m * scene.winch_m_per_s;
    let recurrences = events.windows(2).map(|w| w[1].onset_s - w[0].onset_s);
    let recurrence_s = recurrences.sum::<f64>() / (events.len() - 1) as f64;
    // Seven seconds, as in the figures.
    let shown = &forces[16..112];
    let (low, high) = shown.iter().fold((f64::MAX, f64::MIN), |(l, h), &f| (l.min(f), h.max(f)));
    let rates: Vec<f64> = forces.windows(3).map(|w| (w[2] - w[0]) * 0.5 * 16.0).collect();
    let (steepest, fastest) =
        rates.iter().fold((f64::MAX, f64::MIN), |(l, h), &f| (l.min(f), h.max(f)));
    let slip = events.iter().position(|e| (3.25..3.3125).contains(&e.onset_s)).unwrap();
    println!("Figs 6, 7 together: k w = {loading_n_per_s:.0} N/s, recurrence {recurrence_s:.3} s");
    println!("           forces {low:.0} to {high:.0} N, F' {steepest:.0} to {fastest:.0} N/s");
    println!(
        "           onsets {:.3} and {:.3} s, lowest at {:.4} s",
        events[slip].onset_s,
        events[slip + 1].onset_s,
        (53..60).min_by(|a, b| forces[*a].total_cmp(&forces[*b])).unwrap() as f64 / 16.0
    );
    // 3.3125 s is sample 53: the maximum, followed by three falling samples.
    assert!((54..57).all(|i| forces[i] < forces[i - 1]) && forces[57] > forces[56]);
    assert!(forces[53] > forces[52] && (events[slip + 1].onset_s - 4.5).abs() < 0.0625);
    assert!((recurrence_s - 1.19).abs() < 0.02 && (loading_n_per_s - 600.0).abs() < 30.0);
    assert!((190.0..230.0).contains(&low) && (760.0..800.0).contains(&high));
    assert!(steepest > -5000.0 && fastest < 5000.0);
}

fn over_a_grid(mut check: impl FnMut(&Scene, &[TrueEvent])) -> u32 {
    let base = scene("eq22-25-recurrence");
    let mut cases = 0;
    for winch_m_per_s in [0.002, 0.01565, 0.04] {
        for stiffness_n_per_m in [5e3, 23e3, 230e3] {
            for weight_n in [300.0, 630.0, 3000.0] {
                for difference in [0.01, 0.1, 0.46] {
                    let scene = Scene {
                        winch_m_per_s,
                        stiffness_n_per_m,
                        weight_n,
                        mu_s: base.mu + difference,
                        rate_hz: 1.0,
                        duration_s: 10_000.0,
                        ..base.clone()
                    };
                    check(&scene, &simulate(&scene, 1).unwrap().events[..2]);
                    cases += 1;
                }
            }
        }
    }
    cases
}

#[test]
fn eqs_22_and_25_give_the_recurrence() {
    let mut worst = 0.0_f64;
    let cases = over_a_grid(|scene, events| {
        let drop_n = (scene.mu_s - scene.mu) * scene.weight_n;
        let loading = scene.stiffness_n_per_m * scene.winch_m_per_s;
        let omega = omega(scene);
        let a = drop_n.hypot(loading / omega);
        let stick_s = 2.0 * drop_n / loading;
        let slide_s = 2.0 / omega * ((drop_n / a).acos() + FRAC_PI_2);
        let recurrence_s = events[1].onset_s - events[0].onset_s;
        worst = worst.max((recurrence_s / (stick_s + slide_s) - 1.0).abs());
    });
    println!("Eqs 22, 25: {cases} cases, worst relative difference {worst:.1e}");
    assert!(worst < 1e-9);
}

#[test]
fn eq_31_the_block_always_sticks() {
    let (scene, simulation) = run("eq31-always-sticks");
    let lowest = paper::lowest_speed_m_per_s(scene.mu_s - scene.mu, omega(&scene), 0.5);
    let rests: Vec<f64> = simulation.events.iter().skip(1).map(|e| e.stick_s).collect();
    let longest = rests.iter().fold(0.0_f64, |a, &b| a.max(b));
    println!(
        "Eq. 31: lowest speed {lowest:.4} m/s; at 0.5 m/s {} rests of {longest:.3} s",
        rests.len()
    );
    assert!(lowest < 0.0 && rests.len() > 50 && rests.iter().all(|&s| s > 0.0));
    // At speeds up to 5 m/s, and for differences of the coefficients down to 1e-4.
    for w in [1e-4, 0.04, 1.0, 5.0] {
        for difference in [1e-4, 0.01, 1.0] {
            assert!(paper::lowest_speed_m_per_s(difference, omega(&scene), w) < 0.0);
            let mu_s = scene.mu + difference;
            let fast = Scene { winch_m_per_s: w, mu_s, ..scene.clone() };
            let ends = Segments::new(&fast, 1, Method::ClosedForm).take(12);
            assert!(ends.filter(|s| s.end == End::Stop).count() >= 2, "{w} {difference}");
        }
    }
}

#[test]
fn fig_8_the_stiffness_comes_back() {
    let (scene, simulation) = run("fig8-stiffness");
    let samples: Vec<_> = simulation.samples.iter().map(|s| (s.time_s, s.force_n)).collect();
    let winch_m_per_s = Measured { value: scene.winch_m_per_s, std_error: 0.0 };
    let cable_length_m = Some(Measured { value: 15.0, std_error: 0.0 });
    let found = stiffness(&samples, &Pull { winch_m_per_s, cable_length_m }).unwrap();
    let (k, ae) = (found.stiffness_n_per_m, found.ae_n.unwrap());
    println!(
        "Fig. 8: k = {:.0} ± {:.0} N/m, AE = {:.0} ± {:.0} N",
        k.value, k.std_error, ae.value, ae.std_error
    );
    assert!((k.value - 23_000.0).abs() < 3.0 * k.std_error && k.std_error < 200.0);
}

#[test]
fn slope_left_out_reads_both_coefficients_too_high() {
    let (scene, simulation) = run("slope");
    for event in &simulation.events {
        let without = |force_n: f64| force_n / scene.weight_n;
        let (mu_s, mu) = (without(event.static_force_n), without(event.dynamic_force_n));
        assert!((event.mu_s - 0.91).abs() < 1e-12 && (event.mu - 0.56).abs() < 1e-12);
        assert!((mu / 0.56 - 1.17).abs() < 0.005 && (mu_s / 0.91 - 1.10).abs() < 0.005);
    }
    // The paper's second example.
    let gentle = Scene { slope_deg: 0.06_f64.atan().to_degrees(), ..scene.clone() };
    let event = &simulate(&gentle, 1).unwrap().events[0];
    let rise = |force_n: f64, true_value: f64| force_n / gentle.weight_n / true_value - 1.0;
    let (mu, mu_s) = (rise(event.dynamic_force_n, 0.56), rise(event.static_force_n, 0.91));
    println!("Slope: tan 0.06: mu +{:.1} %, mu_s +{:.1} %", 100.0 * mu, 100.0 * mu_s);
    assert!((mu - 0.105).abs() < 0.003 && (mu_s - 0.064).abs() < 0.003);
    let event = &simulation.events[0];
    println!(
        "Slope: without it mu reads {:.3} (+{:.1} %), mu_s {:.3} (+{:.1} %)",
        event.dynamic_force_n / scene.weight_n,
        (event.dynamic_force_n / scene.weight_n / 0.56 - 1.0) * 100.0,
        event.static_force_n / scene.weight_n,
        (event.static_force_n / scene.weight_n / 0.91 - 1.0) * 100.0,
    );
}

/// Mean of a weighing, with its uncertainty from blocks of 10 s.
#[test]
fn weighing_a_swinging_block() {
    let (scene, simulation) = run("weighing");
    let blocks: Vec<f64> = simulation
        .samples
        .chunks(160)
        .map(|c| c.iter().map(|s| s.force_n).sum::<f64>() / c.len() as f64)
        .collect();
    let n = blocks.len() as f64;
    let mean = blocks.iter().sum::<f64>() / n;
    let spread = (blocks.iter().map(|b| (b - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt();
    println!("Weighing: {mean:.2} ± {:.2} N for {} N", spread / n.sqrt(), scene.weight_n);
    assert!((mean / scene.weight_n - 1.0).abs() < 0.002);

    // Without damping and noise, over whole swings, the mean is 1 + A²/4.
    let mut still = scene;
    still.measurement.white_n = 0.0;
    still.rate_hz = 200.0;
    if let Some(weighing) = &mut still.weighing {
        weighing.damping_per_s = 0.0;
    }
    let amplitude = 5.0_f64.to_radians();
    let period_s = 2.0 * PI * (3.0_f64 / GRAVITY).sqrt() * (1.0 + amplitude * amplitude / 16.0);
    still.duration_s = 17.0 * period_s;
    let samples = simulate(&still, 1).unwrap().samples;
    let ratio = samples.iter().map(|s| s.force_n).sum::<f64>() / samples.len() as f64 / 630.0;
    println!("          a swing of 5 degrees weighs {:.3} % too much", (ratio - 1.0) * 100.0);
    assert!((ratio - paper::swinging_mean(amplitude)).abs() < 2e-5, "{ratio}");
}

#[test]
fn large_scale_stress_of_rafting() {
    // mu is the average over all tests; 0.3 m of ice over 10 m.
    let resultant = paper::rafting_resultant_n_per_m(0.56, 0.3, 10.0);
    println!("Rafting: mu 0.56, h 0.3 m, l 10 m: {:.1} kN/m", resultant / 1e3);
    assert!((resultant - 0.56 * 910.0 * GRAVITY * 0.3 * 10.0).abs() < 1e-6);
    let one_more_metre = paper::rafting_resultant_n_per_m(0.56, 0.3, 11.0);
    assert!((one_more_metre / resultant - 1.1).abs() < 1e-12);
}

#[test]
fn rist_shear_grows_with_the_two_thirds_power() {
    let ((_, light), (_, heavy)) = (run("rist-light"), run("rist-heavy"));
    let (light, heavy) = (&light.events[0], &heavy.events[0]);
    let power = (heavy.dynamic_force_n / light.dynamic_force_n).log10();
    let fall = heavy.mu / light.mu;
    println!("Rist: force grows with N^{power:.3}; mu at 3 kN is {fall:.2} of that at 0.3 kN");
    assert!((power - 2.0 / 3.0).abs() < 1e-9);
    assert!((fall - paper::rist_coefficient(1.0, 300.0, 3000.0)).abs() < 1e-9);
}
