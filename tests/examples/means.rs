//! Is the error of a whole test's mean what it says? Many seeds of every linear and hard
//! scene.
//!
//! `cargo run --release -p floe-tests --example means -- [SEEDS]` (400 unless given)

use floe::sim::Scene;
use floe_core::Estimate;
use floe_tests::score::{rms, run};

/// Errors of the means of a scene in their standard errors: of `mu_s` and of `mu`.
fn errors(scene: &Scene, seeds: u64) -> [Vec<f64>; 2] {
    let mut errors = [Vec::new(), Vec::new()];
    let (mu_s, mu) = scene.coefficients();
    for seed in 1..=seeds {
        let report = run(scene, seed).report;
        let add = |errors: &mut Vec<f64>, got: Option<Estimate>, truth: f64| {
            errors.extend(got.map(|e| (f64::from(e.mean) - truth) / f64::from(e.std_error)));
        };
        add(&mut errors[0], report.mu_s, mu_s);
        add(&mut errors[1], report.mu, mu);
    }
    errors
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let seeds = std::env::args().nth(1).map_or(Ok(400), |n| n.parse())?;
    let scenes = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../host-sim/scenes");
    let mut files = vec![scenes.join("dff8-13.toml")];
    for folder in ["linear", "hard"] {
        let own = std::fs::read_dir(scenes.join(folder))?.flatten().map(|f| f.path());
        let mut own: Vec<_> = own.filter(|f| f.extension().is_some_and(|e| e == "toml")).collect();
        own.sort();
        files.extend(own);
    }
    println!("| scene | tests | rms z: mu_s | mu | coverage: mu_s | mu |");
    println!("|---|---:|---:|---:|---:|---:|");
    for file in files {
        let scene = Scene::from_toml(&std::fs::read_to_string(&file)?)?;
        let [mu_s, mu] = errors(&scene, seeds);
        let covered =
            |z: &[f64]| z.iter().filter(|z| z.abs() <= 1.96).count() as f64 / z.len().max(1) as f64;
        println!(
            "| {} | {} | {:.2} | {:.2} | {:.3} | {:.3} |",
            file.file_stem().unwrap_or_default().display(),
            mu_s.len(),
            rms(&mu_s),
            rms(&mu),
            covered(&mu_s),
            covered(&mu)
        );
    }
    Ok(())
}
