//! Prints a hash of all output of the core, step by step, for every scene and bundled log.
//!
//! Run `cargo run --release -p floe-tests --example event_stream > before.txt` before and after a
//! change that must keep every bit (moved files, renamed items), and compare the outputs with
//! `diff`. A change of the answers changes these lines.

use std::path::{Path, PathBuf};

use floe::log::{Log, LogOptions};
use floe::sim::{Scene, simulate};
use floe_core::{Coefficient, Config, Event, Pipeline, RawSample, SampleTime, Step};
use floe_tests::{both, feed};

/// FNV-1a over 64-bit words.
struct Hash(u64);

impl Hash {
    fn word(&mut self, word: u64) {
        for byte in word.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }

    fn number(&mut self, number: Option<f32>) {
        self.word(number.map_or(u64::MAX, |number| number.to_bits().into()));
    }

    fn coefficient(&mut self, coefficient: Option<Coefficient>) {
        self.number(coefficient.map(|it| it.value));
        self.number(coefficient.map(|it| it.std));
    }

    fn moment(&mut self, moment: SampleTime) {
        self.word(moment.index.into());
        self.number(Some(moment.fraction));
    }

    fn event(&mut self, event: &Event) {
        self.word(event.index.into());
        self.moment(event.onset);
        self.moment(event.stop);
        self.coefficient(event.mu_s);
        self.coefficient(event.mu);
        let forces_n = [event.static_force_n, event.dynamic_force_n, event.restick_force_n];
        let others = [event.peak_force_n, event.slip_s, event.loading_rate_n_per_s];
        forces_n.into_iter().chain(others).for_each(|number| self.number(Some(number)));
        self.number(event.stick_s);
        self.number(event.omega_rad_per_s);
        self.word(event.quality as u64);
        self.word(event.reason.map_or(9, |reason| reason as u64));
    }

    fn step(&mut self, step: &Step) {
        self.number(step.sample.force_n);
        self.word(step.sample.flag as u64);
        self.word(step.spike.unwrap_or(0).into());
        self.word(step.phase as u64);
        self.number(step.rate.map(|rate| rate.rate_n_per_s));
        self.coefficient(step.provisional.map(|first| first.mu_s));
        self.coefficient(step.provisional.and_then(|first| first.mu));
        step.event.iter().for_each(|event| self.event(event));
        self.number(step.change.map(|change| change.weight_ratio));
    }
}

/// Hash and number of events of one test.
fn hashed(config: &Config, samples: impl IntoIterator<Item = RawSample>) -> (u64, u32) {
    let mut hash = Hash(0xcbf2_9ce4_8422_2325);
    let mut pipeline = Pipeline::new(config).expect("the configuration is valid");
    for sample in samples {
        hash.step(&pipeline.step(sample));
    }
    for event in feed::finish(&mut pipeline) {
        hash.event(&event);
    }
    let report = pipeline.report();
    [report.mu_s, report.mu].into_iter().flatten().for_each(|mean| {
        hash.number(Some(mean.mean));
        hash.number(mean.std_error);
        hash.number(mean.spread);
    });
    hash.number(report.noise_n);
    hash.number(report.stiffness_n_per_m);
    (hash.0, report.events)
}

fn files(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let entries = std::fs::read_dir(folder).expect("a folder of the project");
    for path in entries.map(|entry| entry.expect("an entry").path()) {
        if path.is_dir() {
            found.extend(files(&path, ending));
        } else if path.extension().is_some_and(|it| it == ending) {
            found.push(path);
        }
    }
    found.sort();
    found
}

fn main() {
    let host = Path::new(env!("CARGO_MANIFEST_DIR")).join("../host-sim");
    for file in files(&host.join("scenes"), "toml") {
        let text = std::fs::read_to_string(&file).expect("a scene's file");
        let Ok(scene) = Scene::from_toml(&text) else { continue };
        for seed in 1..=3 {
            let samples = simulate(&scene, seed).expect("a scene that can be simulated").samples;
            let raw = samples.iter().map(|sample| feed::force(sample.index, sample.force_n));
            let (hash, events) = hashed(&both::config(&scene), raw);
            let name = file.strip_prefix(&host).unwrap_or(&file).display();
            println!("{name} seed {seed}: {events} events, {hash:016x}");
        }
    }
    for file in files(&host.join("logs"), "csv") {
        let input = Box::new(std::fs::File::open(&file).expect("a bundled log"));
        let mut log = Log::from_reader(input, &LogOptions::default()).expect("a log");
        let rate_hz = log.rate_hz() as f32;
        let config = Config { weight_n: 630.0, rate_hz, ..Config::default() };
        let samples = std::iter::from_fn(move || log.next_sample().expect("a good row"));
        let (hash, events) = hashed(&config, samples.map(|sample| sample.raw));
        println!("{}: {events} events, {hash:016x}", file.display());
    }
}
