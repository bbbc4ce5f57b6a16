//! How fast a long CSV log is replayed, next to the `csv` crate only cutting it
//! into cells (and turning the cells into numbers), and how much memory that takes.
//!
//! `cargo run --release -p floe --example replay_speed`

use std::error::Error;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use floe::log::{Log, LogOptions};
use floe::replay::{self, test::TestOptions};

type Method = (&'static str, fn(&Path) -> Outcome);
type Outcome = Result<u64, Box<dyn Error>>;

const SAMPLES: [u64; 2] = [1_000_000, 10_000_000];
const METHODS: [Method; 6] = [
    ("csv crate, ByteRecord", csv_bytes),
    ("csv crate, StringRecord", csv_strings),
    ("csv crate, two numbers", csv_numbers),
    ("log reader", reader),
    ("reader and core, 1 thread", reader_and_core),
    ("whole replay", whole_replay),
];

/// Without arguments runs every method in a process of its own, so that each
/// has its own peak memory; with a method and a file runs that.
fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.as_slice() {
        [name, path] => measure(name, Path::new(path)),
        _ => compare(),
    }
}

fn compare() -> Result<(), Box<dyn Error>> {
    println!("{:<26}{:>10}{:>14}{:>16}", "", "samples", "samples/s", "peak memory");
    for samples in SAMPLES {
        let path = written(samples)?;
        for (name, _) in METHODS {
            Command::new(std::env::current_exe()?).arg(name).arg(&path).status()?;
        }
    }
    Ok(())
}

fn measure(name: &str, path: &Path) -> Result<(), Box<dyn Error>> {
    let (_, method) = METHODS.iter().find(|method| method.0 == name).ok_or("no such method")?;
    let mut best_s = f64::INFINITY;
    let mut samples = 0;
    for _ in 0..3 {
        let begin = Instant::now();
        samples = method(path)?;
        best_s = best_s.min(begin.elapsed().as_secs_f64());
    }
    let per_s = samples as f64 / best_s / 1e6;
    println!("{name:<26}{samples:>10}{per_s:>11.1} M/s{:>13} KiB", peak_kib()?);
    Ok(())
}

/// The block of test DFF8-13 at 16 Hz with noise of 2 N, forces to the
/// millinewton.
fn written(samples: u64) -> Result<PathBuf, Box<dyn Error>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join(format!("../target/replay_speed_{}k.csv", samples / 1000));
    let mut file = BufWriter::new(File::create(&path)?);
    writeln!(file, "# weight_n: 630\ntime_s,force_n")?;
    let mut state = 1_u64;
    for index in 0..samples {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        let uniform = (state >> 40) as f64 / f64::from(1 << 24) - 0.5;
        let time_s = index as f64 / 16.0;
        writeln!(file, "{time_s:.4},{:.3}", force_n(time_s) + 2.0 * 12_f64.sqrt() * uniform)?;
    }
    file.flush()?;
    Ok(path)
}

/// Stick line and ellipse (equations 4, 7, 16, 22 and 25), over and over.
fn force_n(time_s: f64) -> f64 {
    const STATIC_N: f64 = 781.2;
    const DYNAMIC_N: f64 = 491.4;
    const RATE_N_PER_S: f64 = 360.0;
    const OMEGA: f64 = 18.92;
    let half_n = STATIC_N - DYNAMIC_N;
    let stick_s = 2.0 * half_n / RATE_N_PER_S;
    let slip_s = 2.0 / OMEGA * (std::f64::consts::PI - (half_n * OMEGA / RATE_N_PER_S).atan());
    let in_cycle_s = time_s % (stick_s + slip_s);
    if in_cycle_s < stick_s {
        return DYNAMIC_N - half_n + RATE_N_PER_S * in_cycle_s;
    }
    let (sine, cosine) = (OMEGA * (in_cycle_s - stick_s)).sin_cos();
    DYNAMIC_N + half_n * cosine + RATE_N_PER_S / OMEGA * sine
}

fn cells(path: &Path) -> Result<csv::Reader<File>, Box<dyn Error>> {
    Ok(csv::ReaderBuilder::new().comment(Some(b'#')).from_path(path)?)
}

fn csv_bytes(path: &Path) -> Outcome {
    let (mut reader, mut record, mut rows) = (cells(path)?, csv::ByteRecord::new(), 0);
    while reader.read_byte_record(&mut record)? {
        rows += 1;
    }
    Ok(rows)
}

fn csv_strings(path: &Path) -> Outcome {
    let (mut reader, mut record, mut rows) = (cells(path)?, csv::StringRecord::new(), 0);
    while reader.read_record(&mut record)? {
        rows += 1;
    }
    Ok(rows)
}

fn csv_numbers(path: &Path) -> Outcome {
    let (mut reader, mut record, mut rows, mut sum) =
        (cells(path)?, csv::StringRecord::new(), 0, 0.0);
    while reader.read_record(&mut record)? {
        for cell in &record {
            sum += cell.parse::<f64>()?;
        }
        rows += 1;
    }
    std::hint::black_box(sum);
    Ok(rows)
}

fn open(path: &Path) -> Result<Log, Box<dyn Error>> {
    Ok(Log::from_reader(Box::new(File::open(path)?), &LogOptions::default())?)
}

fn reader(path: &Path) -> Outcome {
    let (mut log, mut rows) = (open(path)?, 0);
    while log.next_sample()?.is_some() {
        rows += 1;
    }
    Ok(rows)
}

/// Without keeping the events: shows what the memory of a replay is made of.
fn reader_and_core(path: &Path) -> Outcome {
    let mut log = open(path)?;
    let config = replay::test::configure(&log, &TestOptions::default())?;
    let mut pipeline = floe_core::Pipeline::new(&config)?;
    while let Some(sample) = log.next_sample()? {
        std::hint::black_box(pipeline.step(sample.raw));
    }
    Ok(pipeline.report().counters.samples)
}

fn whole_replay(path: &Path) -> Outcome {
    let mut log = open(path)?;
    let config = replay::test::configure(&log, &TestOptions::default())?;
    Ok(replay::replay("speed.csv", &mut log, &config, |_, _| {})?.log.samples)
}

/// Largest resident memory of this process so far (Linux).
fn peak_kib() -> Result<u64, Box<dyn Error>> {
    let status = std::fs::read_to_string("/proc/self/status")?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).ok_or("no VmHWM")?;
    Ok(line.trim().trim_end_matches("kB").trim().parse()?)
}
