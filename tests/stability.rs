//! scratch
use std::fs;
use std::path::{Path, PathBuf};

use floe::sim::{Run, Scene};
use floe_core::{Calibration, Config, Event};
use floe_tests::both::Both;
use floe_tests::wide;

fn config(scene: &Scene) -> Config {
    Config {
        rate_hz: scene.rate_hz as f32,
        weight_n: scene.weight_n as f32,
        slope_rad: scene.slope_rad() as f32,
        range_n: (scene.measurement.range_n > 0.0).then_some((scene.measurement.range_n - scene.measurement.tare_n.abs()) as f32),
        ..Config::default()
    }
}

fn scenes() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../host-sim/scenes");
    let mut scenes = Vec::new();
    for folder in [folder.clone(), folder.join("linear"), folder.join("hard"), folder.join("paper")] {
        let files = fs::read_dir(folder).unwrap().map(|f| f.unwrap().path());
        let mut files: Vec<_> = files.filter(|f| f.extension().is_some_and(|e| e == "toml")).collect();
        files.sort();
        scenes.extend(files);
    }
    scenes
}

fn time(e: &Event) -> f64 { e.onset.index as f64 + f64::from(e.onset.fraction) }
fn wtime(e: &wide::Event) -> f64 { e.onset.index as f64 + e.onset.fraction }

#[derive(Default)]
struct Table { mu_s: Vec<f64>, mu: Vec<f64>, onset: Vec<f64>, alone: usize, matched: usize, odd: usize, who: Vec<(f64, String)>,
  bias: f64 }

fn compare(both: &Both, table: &mut Table, name: &str) {
    let (single, double) = &both.events;
    let mut used = 0;
    for d in double {
        let near = single.iter().find(|s| (time(s) - wtime(d)).abs() < 1.0);
        let Some(s) = near else { table.alone += 1; 
            table.who.push((99.0, format!("{name} lost {} onset {} q {:?} {:?} {:?}", d.index, wtime(d), d.quality, d.mu_s, d.reason)));
            continue };
        used += 1;
        if let (Some(a), Some(b), Some(c), Some(e)) = (s.mu_s, d.mu_s, s.mu, d.mu) {
            let z = (f64::from(a.value) - b.value) / b.std;
            let y = (f64::from(c.value) - e.value) / e.std;
            table.mu_s.push(z); table.mu.push(y);
            table.onset.push(time(s) - wtime(d));
            table.matched += 1;
            table.who.push((z.abs().max(y.abs()), format!("{name} {} t {:.2} z {z:.4} {y:.4} mu_s {:?} {:?} slip {} {:?}", d.index, wtime(d), b, a, d.slip_s, d.quality)));
        } else if s.mu_s.is_some() != d.mu_s.is_some() || s.mu.is_some() != d.mu.is_some() {
            table.odd += 1;
            table.who.push((98.0, format!("{name} odd {:?} {:?}", s, d)));
        }
    }
    table.alone += single.len() - used;
}

fn rms(v: &[f64]) -> f64 { (v.iter().map(|x| x * x).sum::<f64>() / v.len().max(1) as f64).sqrt() }
fn q(v: &[f64], p: f64) -> f64 { let mut v: Vec<f64> = v.iter().map(|x| x.abs()).collect(); v.sort_by(f64::total_cmp); if v.is_empty() { return 0.0 } v[((v.len() - 1) as f64 * p) as usize] }

fn row(name: &str, t: &mut Table) {
    println!("{name:22} n {:5} alone {:3} odd {:3} | mu_s rms {:.4} p99 {:.4} max {:.4} mean {:+.5} | mu rms {:.4} p99 {:.4} max {:.4} mean {:+.5}| onset rms {:.1e} max {:.1e}", t.matched, t.alone, t.odd,
        rms(&t.mu_s), q(&t.mu_s, 0.99), q(&t.mu_s, 1.0), t.mu_s.iter().sum::<f64>() / t.matched.max(1) as f64,
        rms(&t.mu), q(&t.mu, 0.99), q(&t.mu, 1.0), t.mu.iter().sum::<f64>() / t.matched.max(1) as f64, rms(&t.onset), q(&t.onset, 1.0));
    if std::env::var("WHO").is_ok() {
        t.who.sort_by(|a, b| b.0.total_cmp(&a.0));
        for (_, w) in t.who.iter().take(6) { println!("      {w}"); }
    }
}

#[test]
fn scenes_agree() {
    let only = std::env::var("ONLY").ok();
    for path in scenes() {
        let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
        if only.as_ref().is_some_and(|o| !o.split(',').any(|o| o == name)) { continue }
        let mut scene = Scene::from_toml(&fs::read_to_string(&path).unwrap()).unwrap();
        scene.duration_s = scene.duration_s.max(120.0);
        let mut kinds = vec![("", 0)];
        if name == "tare" { kinds = vec![("", 0), (" counts", 1), (" gross", 2)] }
        for (kind, how) in kinds {
            let mut table = Table::default();
            for seed in 1..=10 {
                let mut config = config(&scene);
                if how == 1 { config.calibration = Calibration { tare_counts: 4_166_667, counts_per_n: 416.6667, ..Calibration::default() }; config.range_n = None; }
                if how == 2 { config.range_n = None; }
                let mut both = Both::new(&config);
                for s in Run::new(&scene, seed).unwrap() {
                    match how {
                        1 => both.counts(s.index, ((s.force_n + 10000.0) * 416.6667).round() as i32),
                        2 => both.force(s.index, s.force_n + 10000.0),
                        _ => both.force(s.index, s.force_n),
                    }
                }
                both.finish();
                compare(&both, &mut table, &format!("seed {seed}"));
            }
            row(&format!("{name}{kind}"), &mut table);
        }
    }
}

fn tokens(s: &str) -> Vec<(String, String)> {
    // pairs of (path-ish label, number)
    let mut out = Vec::new(); let mut label = String::new(); let mut cur = String::new();
    for c in s.chars() {
        if c.is_alphanumeric() || c == '_' || c == '.' || (c == '-' ) { cur.push(c) } else {
            if !cur.is_empty() {
                if cur.parse::<f64>().is_ok() || cur == "true" || cur == "false" || cur == "None" { out.push((label.clone(), cur.clone())); } else if c == ':' || c == ' ' { if cur != "Some" { label = cur.clone(); } }
                cur.clear();
            }
        }
    }
    out
}

#[test]
fn diagnose() {
    let Ok(name) = std::env::var("DIAG") else { return };
    let seed: u64 = std::env::var("SEED").unwrap().parse().unwrap();
    let upto: usize = std::env::var("UPTO").unwrap().parse().unwrap();
    let path = scenes().into_iter().find(|p| p.file_stem().unwrap().to_str().unwrap() == name).unwrap();
    let scene = Scene::from_toml(&fs::read_to_string(&path).unwrap()).unwrap();
    let mut both = Both::new(&config(&scene));
    let mut seen = 0;
    for s in Run::new(&scene, seed).unwrap() {
        both.force(s.index, s.force_n);
        if both.events.0.len() != both.events.1.len() { println!("@{} EVENTS {} {}", s.index, both.events.0.len(), both.events.1.len()); }
        if both.events.0.len() > seen {
            seen = both.events.0.len();
            let strip = |mut t: String| { while let Some(a) = t.find("points: [") { let b = t[a..].find(']').unwrap() + a; t.replace_range(a..=b, "points_"); } while let Some(a) = t.find("window: ") { let b = t[a..].find('}').unwrap() + a; t.replace_range(a..=b, "win_"); } t };
            let (a, b) = (strip(format!("{:?}", both.single)), strip(format!("{:?}", both.double)));
            let (a, b) = (tokens(&a), tokens(&b));
            if a.len() != b.len() { println!("event {seen} LENGTH {} {}", a.len(), b.len()); }
            let mut shown = 0;
            for ((l, x), (_, y)) in a.iter().zip(&b) {
                let d = match (x.parse::<f64>(), y.parse::<f64>()) { (Ok(x), Ok(y)) => (x - y).abs() / (x.abs().max(y.abs()) + 1e-30), _ => if x == y { 0.0 } else { 1.0 } };
                if d > 3e-3 && shown < 14 { shown += 1; println!("event {} {l}: {x} {y}", seen - 1); }
            }
        }
        if seen > upto { break }
    }
}

#[test]
fn offsets() {
    for (name, w) in [("dff8-13", 630.0), ("heavy", 3000.0), ("snow", 900.0)] {
        let path = scenes().into_iter().find(|p| p.file_stem().unwrap().to_str().unwrap() == name).unwrap();
        let mut scene = Scene::from_toml(&fs::read_to_string(&path).unwrap()).unwrap();
        scene.duration_s = 86400.0;
        let mut both = Both::new(&config(&scene));
        for s in Run::new(&scene, 1).unwrap() { both.force(s.index, s.force_n); }
        let (mut a, mut b, mut c, mut d, mut r, mut o, mut n) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        for (x, y) in both.events.0.iter().zip(&both.events.1) {
            let (Some(m), Some(_)) = (x.mu, y.mu) else { continue };
            if (time(x) - wtime(y)).abs() > 0.1 { continue }
            n += 1.0;
            a += f64::from(x.static_force_n) - y.static_force_n;
            b += f64::from(x.dynamic_force_n) - y.dynamic_force_n;
            c += f64::from(m.value) - f64::from(x.dynamic_force_n) / w;
            d += f64::from(x.peak_force_n) - y.peak_force_n;
            r += f64::from(x.loading_rate_n_per_s) - y.loading_rate_n_per_s;
            o += time(x) - wtime(y);
        }
        println!("{name} n {n} Fs {:.2e} Fp {:.2e} coef {:.2e} peak {:.2e} rate {:.2e} onset {:.2e}", a / n, b / n, c / n, d / n, r / n, o / n);
        println!("{:?} {:?}", both.single.report().mu, both.double.report().mu);
    }
}
