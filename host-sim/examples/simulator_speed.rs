//! Speed against error of the simulator itself, on linear scenes where the closed
//! form is the truth: `cargo run --release --example simulator_speed`.

use std::time::Instant;

use floe::sim::{Measurement, Method, Run, Scene, Simulation, simulate_by};

/// Error of the forces relative to the weight, and of the event times in s.
fn errors(a: &Simulation, b: &Simulation, weight_n: f64) -> (f64, f64) {
    let force = a.samples.iter().zip(&b.samples).map(|(a, b)| a.true_force_n - b.true_force_n);
    let time = a.events.iter().zip(&b.events).map(|(a, b)| a.stop_s - b.stop_s);
    let largest =
        |differences: &mut dyn Iterator<Item = f64>| differences.map(f64::abs).fold(0.0, f64::max);
    (largest(&mut force.map(|f| f / weight_n)), largest(&mut { time }))
}

/// Seconds for one run, the best of a few.
fn best(runs: u32, mut run: impl FnMut()) -> f64 {
    let one = |_| {
        let start = Instant::now();
        run();
        start.elapsed().as_secs_f64()
    };
    (0..runs).map(one).fold(f64::INFINITY, f64::min)
}

fn table(name: &str, scene: &Scene) {
    let exact = simulate_by(scene, 0, Method::ClosedForm).expect("the scene is valid");
    println!("\n{name}: {} s, {} events", scene.duration_s, exact.events.len());
    println!("method              force error  event error  time per simulated second");
    let line = |name: String, method: Method| {
        let result = simulate_by(scene, 0, method).expect("the scene is valid");
        let (force, time_s) = errors(&exact, &result, scene.weight_n);
        let seconds = best(5, || {
            let _ = simulate_by(scene, 0, method);
        });
        let per_second_us = seconds / scene.duration_s * 1e6;
        println!("{name:<18}  {force:>11.1e}  {time_s:>9.1e} s  {per_second_us:>10.2} us");
    };
    line("closed form".into(), Method::ClosedForm);
    for tolerance in [1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-13, 1e-14] {
        line(format!("integrator {tolerance:.0e}"), Method::Integrator { tolerance });
    }
}

fn main() {
    table("DFF8-13", &Scene::default());
    table("slack cable", &Scene { mu_s: 1.0, mu: 0.4, ..Scene::default() });
    let fast = Scene { mu_s: 0.8, mu: 0.5, winch_m_per_s: 0.3, ..Scene::default() };
    table("slack and taut again, 0.3 m/s", &fast);

    let white = Measurement { white_n: 2.0, ..Measurement::default() };
    for (name, measurement) in [("without noise", Measurement::default()), ("with noise", white)] {
        let hour = Scene { duration_s: 3600.0, measurement, ..Scene::default() };
        let seconds = best(5, || {
            let run = Run::new(&hour, 1).expect("the scene is valid");
            let sum: f64 = run.map(|sample| sample.force_n).sum();
            assert!(sum > 0.0);
        });
        println!("\none hour at 16 Hz, closed form, {name}: {:.2} ms", seconds * 1e3);
    }
}
