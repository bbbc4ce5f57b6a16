//! How fast logs are read, replayed and simulated, next to what others need only to read
//! the same file: the `csv` crate, polars and pandas.
//!
//! `cargo xtask performance` runs it and writes `docs/performance.md`. Every measurement is
//! a process of its own, the methods take turns, and a ratio is taken within one turn.

use std::error::Error;
use std::ffi::{OsStr, OsString};
use std::fs::File;
use std::io::{BufRead, BufReader, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use floe::campaign::programme;
use floe::log::{Log, LogOptions};
use floe::replay::{self, test::TestOptions};
use floe::sim::{Run, Sample, Scene, write};

type Outcome = Result<u64, Box<dyn Error>>;
type Method = (&'static str, fn(&Path) -> Outcome);

const SCENE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/dff8-13.toml");
const SAMPLES: u64 = 10_000_000;
const TURNS: usize = 5;
/// Compared with the first; each gives the number of rows it saw.
const METHODS: [Method; 10] = [
    ("csv crate, records", csv_records),
    ("csv crate, two numbers", csv_numbers),
    ("floe, reader", reader),
    ("floe, reader and core, 1 thread", reader_and_core),
    ("floe replay LOG --summary --json FILE", whole_replay),
    ("floe, simulator", simulator),
    ("floe, simulator, CSV by `format!`", formatted_csv),
    ("floe, simulator and its CSV", simulated_csv),
    ("floe simulate SCENE -o FILE.csv", simulate_command),
    ("floe campaign --repeat 1000 --parquet FILE", campaign),
];
/// The same file with others, if the interpreter has them.
const PYTHON: [(&str, &str); 3] = [
    (
        "polars, read_csv",
        "import polars as pl; f = lambda p: pl.read_csv(p, comment_prefix='#').height",
    ),
    ("pandas, read_csv", "import pandas as pd; f = lambda p: len(pd.read_csv(p, comment='#'))"),
    (
        "pandas and scipy, find_peaks",
        "import pandas as pd, scipy.signal as s; f = lambda p: \
         len(s.find_peaks(pd.read_csv(p, comment='#').force_n, prominence=100)[0]) and 10_000_000",
    ),
];
const CLOCK: &str = "
import sys, time, resource
wall, cpu = time.perf_counter(), time.process_time()
rows = f(sys.argv[1])
print(rows, time.perf_counter() - wall, time.process_time() - cpu,
      resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)";

/// Seconds on the clock, of processors, and largest memory.
#[derive(Clone, Copy, Debug)]
struct Cost {
    rows: u64,
    wall_s: f64,
    cpu_s: f64,
    peak_kib: u64,
}

/// With a method and a file measures that; else all, with `--python PATH` those too.
fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.as_slice() {
        [option, python] if option == "--python" => compare(Some(python)),
        [name, path] => measure(name, Path::new(path)),
        _ => compare(None),
    }
}

fn compare(python: Option<&str>) -> Result<(), Box<dyn Error>> {
    let path = written(SAMPLES)?;
    let python_methods = PYTHON.iter().filter(|_| python.is_some());
    let names: Vec<&str> = METHODS.iter().map(|m| m.0).chain(python_methods.map(|m| m.0)).collect();
    let mut turns: Vec<Vec<Option<Cost>>> = Vec::new();
    for turn in 1..=TURNS {
        eprintln!("turn {turn} of {TURNS}");
        turns.push(names.iter().map(|name| cost(name, python, &path)).collect());
    }
    print!("{}", table(&names, &turns));
    Ok(())
}

/// `None` for what is not installed.
fn cost(name: &str, python: Option<&str>, path: &Path) -> Option<Cost> {
    let script = PYTHON.iter().find(|method| method.0 == name);
    let mut command = match (script, python) {
        (Some((_, code)), Some(python)) => {
            let mut command = Command::new(python);
            command.arg("-c").arg(format!("{code}{CLOCK}"));
            command
        }
        _ => {
            let mut command = Command::new(std::env::current_exe().ok()?);
            command.arg(name);
            command
        }
    };
    let output = command.arg(path).output().ok()?;
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    // A command has said its own before.
    let mut parts = said.lines().last()?.split_whitespace();
    Some(Cost {
        rows: parts.next()?.parse().ok()?,
        wall_s: parts.next()?.parse().ok()?,
        cpu_s: parts.next()?.parse().ok()?,
        peak_kib: parts.next()?.parse().ok()?,
    })
}

fn measure(name: &str, path: &Path) -> Result<(), Box<dyn Error>> {
    let (_, method) = METHODS.iter().find(|method| method.0 == name).ok_or("no such method")?;
    std::fs::create_dir_all(made(path))?;
    let begin = Instant::now();
    let rows = method(path)?;
    println!("{rows} {} {} {}", begin.elapsed().as_secs_f64(), cpu_s()?, peak_kib()?);
    Ok(std::fs::remove_dir_all(made(path))?)
}

/// Folder of the files that a method makes; to remove them takes no part in the measurement.
fn made(path: &Path) -> PathBuf {
    path.with_extension("made")
}

/// Medians over the turns; what a ratio varied by over them behind it.
fn table(names: &[&str], turns: &[Vec<Option<Cost>>]) -> String {
    let mut text =
        "| what | rows | wall, s | processor, s | wall over csv's records | processor over \
                    csv's records | peak memory, MB |\n|---|---|---|---|---|---|---|\n"
            .to_string();
    for (place, name) in names.iter().enumerate() {
        let costs: Vec<(Cost, Cost)> = turns
            .iter()
            .filter_map(|turn| turn.get(place).copied().flatten().zip(*turn.first()?))
            .collect();
        let Some((first, _)) = costs.first() else {
            text += &format!("| {name} | not installed | | | | | |\n");
            continue;
        };
        let over = |of: fn(&(Cost, Cost)) -> f64| Spread::of(costs.iter().map(of));
        let wall = over(|(own, _)| own.wall_s).middle;
        let cpu = over(|(own, _)| own.cpu_s).middle;
        let (wall_ratio, cpu_ratio) =
            (over(|(a, b)| a.wall_s / b.wall_s), over(|(a, b)| a.cpu_s / b.cpu_s));
        let megabytes = first.peak_kib as f64 / 1024.0;
        text += &format!(
            "| {name} | {} | {wall:.2} | {cpu:.2} | {} | {} | {megabytes:.0} |\n",
            first.rows,
            wall_ratio.text(),
            cpu_ratio.text()
        );
    }
    text
}

/// Least, median and largest.
struct Spread {
    least: f64,
    middle: f64,
    largest: f64,
}

impl Spread {
    fn of(values: impl Iterator<Item = f64>) -> Self {
        let mut all: Vec<f64> = values.collect();
        all.sort_by(f64::total_cmp);
        let at = |place: usize| all.get(place).copied().unwrap_or(f64::NAN);
        Self { least: at(0), middle: at(all.len() / 2), largest: at(all.len().saturating_sub(1)) }
    }

    fn text(&self) -> String {
        format!("{:.2} ({:.2} to {:.2})", self.middle, self.least, self.largest)
    }
}

/// The block of test DFF8-13 at 16 Hz with noise of 2 N, forces to the
/// millinewton.
fn written(samples: u64) -> Result<PathBuf, Box<dyn Error>> {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let target = workspace.join(std::env::var_os("CARGO_TARGET_DIR").unwrap_or("target".into()));
    let path = target.join(format!("performance_{}k.csv", samples / 1000));
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

fn csv_records(path: &Path) -> Outcome {
    let (mut reader, mut record, mut rows) = (cells(path)?, csv::ByteRecord::new(), 0);
    while reader.read_byte_record(&mut record)? {
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
    Ok(pipeline.report().counters.samples.into())
}

fn whole_replay(path: &Path) -> Outcome {
    let json = made(path).join("result.json");
    command(&[&"replay", &path, &"--summary", &"--json", &json])?;
    let lines = BufReader::new(File::open(&json)?).lines();
    let samples = lines.map_while(Result::ok).find_map(|line| {
        let (_, count) = line.split_once("\"samples\": ")?;
        count.trim_end_matches(',').parse().ok()
    });
    Ok(samples.ok_or("no samples")?)
}

/// A command of `floe` in this process.
fn command(arguments: &[&dyn AsRef<OsStr>]) -> Result<(), floe::error::InputError> {
    let arguments = arguments.iter().map(|it| it.as_ref().to_os_string());
    floe::cli::run(std::iter::once(OsString::from("floe")).chain(arguments))
}

/// Nothing is written.
fn simulator(_: &Path) -> Outcome {
    simulate(|_| Ok(()))
}

fn simulated_csv(_: &Path) -> Outcome {
    let (mut out, decimals) = (std::io::sink(), write::force_decimals(&scene()?));
    simulate(|sample| write::csv_line(&mut out, decimals, sample))
}

/// The same bytes by way of the standard library.
fn formatted_csv(_: &Path) -> Outcome {
    let (mut out, decimals) = (std::io::sink(), write::force_decimals(&scene()?));
    simulate(|sample| {
        let time_s = format!("{:.6}", sample.time_s);
        let time_s = time_s.trim_end_matches('0').trim_end_matches('.');
        writeln!(out, "{time_s},{:.decimals$}", sample.force_n)
    })
}

fn scene() -> Result<Scene, Box<dyn Error>> {
    Ok(Scene::from_toml(&std::fs::read_to_string(SCENE)?)?)
}

fn simulate(mut put: impl FnMut(&Sample) -> std::io::Result<()>) -> Outcome {
    let scene = Scene { duration_s: SAMPLES as f64 / 16.0, ..scene()? };
    let mut rows = 0;
    for sample in Run::new(&scene, 1)? {
        put(std::hint::black_box(&sample))?;
        rows += 1;
    }
    Ok(rows)
}

fn simulate_command(path: &Path) -> Outcome {
    let log = made(path).join("log.csv");
    let seconds = (SAMPLES as f64 / 16.0).to_string();
    command(&[&"simulate", &SCENE, &"-o", &log, &"--duration-s", &seconds])?;
    Ok(SAMPLES)
}

/// Rows are tests.
fn campaign(path: &Path) -> Outcome {
    const PROGRAMMES: u32 = 1000;
    let (repeat, parquet) = (PROGRAMMES.to_string(), made(path).join("events.parquet"));
    command(&[&"campaign", &"--repeat", &repeat, &"--parquet", &parquet])?;
    Ok((PROGRAMMES * programme::TESTS).into())
}

/// Time of processors that this process has used, s, to a hundredth (Linux).
fn cpu_s() -> Result<f64, Box<dyn Error>> {
    const TICKS_PER_S: f64 = 100.0;
    let stat = std::fs::read_to_string("/proc/self/stat")?;
    let fields: Vec<&str> = stat.rsplit(')').next().unwrap_or_default().split(' ').collect();
    let ticks = |place: usize| fields.get(place).and_then(|field| field.parse::<f64>().ok());
    // utime and stime are fields 14 and 15 of all, the name in brackets is the second.
    let ticks = ticks(12).zip(ticks(13)).ok_or("no times in /proc/self/stat")?;
    Ok((ticks.0 + ticks.1) / TICKS_PER_S)
}

/// Largest resident memory of this process so far (Linux).
fn peak_kib() -> Result<u64, Box<dyn Error>> {
    let status = std::fs::read_to_string("/proc/self/status")?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).ok_or("no VmHWM")?;
    Ok(line.trim().trim_end_matches("kB").trim().parse()?)
}
