//! `cargo xtask budgets`: cost of the core on the board, counted in the emulator and compared with
//! `xtask/budgets.toml`.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use floe::sim::{Scene, simulate};
use serde::{Deserialize, Serialize};

use crate::Result;
use crate::arm::Route;
use crate::qemu;
use crate::shell::{self, output, root};

/// Binary logarithm of the duration of an instruction, ns of the emulator's clock.
const COUNTING: u32 = 8;
/// Largest accepted relative increase.
const RISE: f64 = 0.02;
/// The scene whose mean has a limit.
const REFERENCE: &str = "dff8-13";

/// Contents of `xtask/budgets.toml`.
#[derive(Debug, Default, Deserialize, Serialize)]
struct Budgets {
    limits: Limits,
    /// Costs by compiler, then by record.
    #[serde(default)]
    measured: BTreeMap<String, BTreeMap<String, Cost>>,
}

/// Absolute limits, in instructions and bytes.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize)]
struct Limits {
    quiet: u64,
    mean_reference: u64,
    worst: u64,
    state_bytes: u64,
}

/// Instructions per step over one record.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize)]
pub(crate) struct Cost {
    pub(crate) quiet: u64,
    pub(crate) mean: u64,
    pub(crate) worst: u64,
}

/// A record in the form that the board's program reads.
pub(crate) struct Record {
    name: String,
    bytes: Vec<u8>,
}

/// Counts of the board's program for one record.
pub(crate) struct Counted {
    name: String,
    samples: u64,
    events: u64,
    pub(crate) cost: Cost,
    worst_at: u64,
    pub(crate) state_bytes: u64,
}

/// Prints the table; `write` stores it as the budget of this compiler.
///
/// # Errors
/// A limit is exceeded, or a cost rose by more than 2 %.
pub fn run(forced: Option<Route>, write: bool) -> Result<()> {
    let route = Route::find(forced)?;
    let program = route.build_firmware("mps2-budget", "mps2-an386")?;
    let qemu = qemu::find()?;
    let records = records()?;
    let counted: Result<Vec<Counted>> =
        records.iter().map(|record| count(qemu, &program, record)).collect();
    let counted = counted?;
    print(&counted);
    let place = root().join("xtask/budgets.toml");
    let text = fs::read_to_string(&place).map_err(|e| format!("{}: {e}", place.display()))?;
    let mut budgets: Budgets =
        toml::from_str(&text).map_err(|e| format!("{}: {e}", place.display()))?;
    let compiler = compiler(route);
    let mut over = beyond(&budgets.limits, &counted);
    if write {
        let costs = counted.iter().map(|c| (c.name.clone(), c.cost)).collect();
        budgets.measured.insert(compiler, costs);
        let head: String =
            text.lines().take_while(|line| line.starts_with('#')).collect::<Vec<_>>().join("\n");
        let table = toml::to_string(&budgets).map_err(|e| e.to_string())?;
        let text = format!("{head}\n{table}");
        fs::write(&place, text).map_err(|e| format!("{}: {e}", place.display()))?;
    } else if let Some(before) = budgets.measured.get(&compiler) {
        over.extend(risen(before, &counted));
    } else {
        println!("no budget for {compiler}: absolute limits alone");
    }
    if over.is_empty() { Ok(()) } else { Err(over.join("\n       ")) }
}

/// Scene DFF8-13 and all scenes of some folders, in order.
pub(crate) fn scenes(folders: &[&str]) -> Result<Vec<PathBuf>> {
    let scenes = root().join("host-sim/scenes");
    let mut files = vec![scenes.join("dff8-13.toml")];
    for folder in folders {
        let entries = fs::read_dir(scenes.join(folder)).map_err(|e| e.to_string())?;
        let mut found: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
        found.sort();
        files.extend(found);
    }
    Ok(files)
}

/// Records of every linear and hard scene, of those outside the model, and adversarial ones.
fn records() -> Result<Vec<Record>> {
    let files = scenes(&["linear", "hard", "honesty"])?;
    let mut records: Vec<Record> = Vec::new();
    for file in &files {
        let mut record = scene_record(file)?;
        // The budget's key is the name; a second scene of a name gets its folder added.
        if records.iter().any(|other| other.name == record.name) {
            let scenes = root().join("host-sim/scenes");
            let place = file.strip_prefix(scenes).unwrap_or(file).with_extension("");
            record.name = place.to_string_lossy().into_owned();
        }
        records.push(record);
    }
    records.extend(quick()?);
    records.extend(adversarial());
    Ok(records)
}

/// Records of slips that follow each other as fast as they can be fitted, and faster, so that
/// samples wait: stiff cables whose slips last and recur these numbers of samples; without gaps,
/// and with some of up to 29 samples.
fn quick() -> Result<Vec<Record>> {
    const RECURRENCES: [f64; 7] = [2.8, 3.4, 4.2, 5.1, 6.2, 7.6, 9.0];
    const SLIPS: [f64; 4] = [0.6, 1.0, 1.5, 2.1];
    let pairs = RECURRENCES.into_iter().flat_map(|recurrence| SLIPS.map(|slip| (recurrence, slip)));
    let each = pairs.flat_map(|pair| [(pair, ""), (pair, ", gaps")]);
    each.map(|(pair, gaps)| quick_record(pair, gaps)).collect()
}

/// Two minutes of such slips.
fn quick_record((recurrence, slip): (f64, f64), gaps: &str) -> Result<Record> {
    let name = format!("recurrence {recurrence}, slip {slip}{gaps}");
    let is_kept = |index: u32| gaps.is_empty() || index % 61 >= index / 61 * 7 % 30;
    let mut scene = floe_tests::scenes::quick(recurrence, slip);
    scene.measurement.white_n = 1.0;
    of_scene(name.clone(), &scene, is_kept).map_err(|e| format!("{name}: {e}"))
}

pub(crate) fn scene_record(file: &Path) -> Result<Record> {
    let text = fs::read_to_string(file).map_err(|e| format!("{}: {e}", file.display()))?;
    let scene = Scene::from_toml(&text).map_err(|e| format!("{}: {e}", file.display()))?;
    let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    of_scene(name, &scene, |_| true).map_err(|e| format!("{}: {e}", file.display()))
}

/// The record of a scene, with the samples whose index is kept.
fn of_scene(name: String, scene: &Scene, is_kept: impl Fn(u32) -> bool) -> Result<Record> {
    let samples = simulate(scene, 2).map_err(|e| e.to_string())?.samples;
    let measurement = &scene.measurement;
    let range_n = (measurement.range_n - measurement.tare_n.abs()).max(0.0) as f32;
    let head = [scene.rate_hz as f32, scene.weight_n as f32, scene.slope_rad() as f32, range_n];
    let kept = samples.iter().filter(|sample| is_kept(sample.index));
    let samples = kept.map(|sample| (sample.index, sample.force_n as f32));
    Ok(Record::new(name, head, samples))
}

impl Record {
    /// A record from rate, weight, slope, range or 0, and forces by index, N.
    pub(crate) fn new(
        name: String,
        head: [f32; 4],
        samples: impl Iterator<Item = (u32, f32)>,
    ) -> Self {
        let mut forces_n = Vec::new();
        for (index, force_n) in samples {
            let place = index as usize;
            forces_n.resize(forces_n.len().max(place + 1), f32::NAN);
            forces_n[place] = force_n;
        }
        Self { name, bytes: bytes(head, &forces_n) }
    }
}

/// Records that no block produces, which search for steps that take long.
fn adversarial() -> Vec<Record> {
    let record = |name: &str, force_n: &dyn Fn(u32) -> f32| {
        let forces_n: Vec<f32> = (0..1920).map(force_n).collect();
        Record { name: name.into(), bytes: bytes([16.0, 630.0, 0.0, 0.0], &forces_n) }
    };
    // Linear congruential generator by Knuth; its upper bits are random enough.
    let random = |i: u32| (i.wrapping_mul(1_664_525).wrapping_add(1_013_904_223) >> 16) as f32;
    vec![
        record("saw of 3", &|i| 300.0 + 100.0 * (i % 3) as f32),
        record("saw of 5", &|i| 300.0 + 60.0 * (i % 5) as f32),
        record("saw of 200", &|i| 300.0 + 2.0 * (i % 200) as f32),
        record("triangle", &|i| 300.0 + 4.0 * (i % 100).abs_diff(50) as f32),
        record("random", &|i| random(i.wrapping_mul(2_654_435_761)) / 65.536),
        record("gaps", &|i| if i % 7 == 3 { f32::NAN } else { 300.0 + 20.0 * (i % 29) as f32 }),
        record("constant", &|_| 500.0),
    ]
}

fn bytes(head: [f32; 4], forces_n: &[f32]) -> Vec<u8> {
    head.iter().chain(forces_n).flat_map(|number| number.to_le_bytes()).collect()
}

pub(crate) fn count(qemu: &str, program: &Path, record: &Record) -> Result<Counted> {
    let directory = shell::target().join(format!("budget-{}", std::process::id()));
    fs::create_dir_all(&directory).map_err(|e| e.to_string())?;
    fs::write(directory.join("samples"), &record.bytes).map_err(|e| e.to_string())?;
    let said = qemu::board(qemu, COUNTING, None, program, &directory).output();
    let _ = fs::remove_dir_all(&directory);
    let said = said.map_err(|e| format!("{}: {e}", record.name))?;
    let text = String::from_utf8_lossy(&said.stdout);
    let failed = || format!("{}: {text}{}", record.name, String::from_utf8_lossy(&said.stderr));
    let line = text.lines().find_map(|line| line.strip_prefix("budget ")).ok_or_else(failed)?;
    let numbers: Vec<u64> = line.split(' ').filter_map(|word| word.parse().ok()).collect();
    let &[samples, events, quiet, mean, worst, worst_at, state_bytes] = numbers.as_slice() else {
        return Err(failed());
    };
    let cost = Cost { quiet, mean, worst };
    Ok(Counted { name: record.name.clone(), samples, events, cost, worst_at, state_bytes })
}

fn print(counted: &[Counted]) {
    println!("core alone on the board: instructions a step, counted by the emulator");
    println!(
        "{:14} {:>7} {:>6} {:>6} {:>6} {:>7}  at sample",
        "record", "samples", "events", "quiet", "mean", "worst"
    );
    for Counted { name, samples, events, cost: Cost { quiet, mean, worst }, worst_at, .. } in
        counted
    {
        println!("{name:14} {samples:7} {events:6} {quiet:6} {mean:6} {worst:7}  {worst_at}");
    }
    let state = counted.first().map_or(0, |c| c.state_bytes);
    println!("state of the pipeline: {state} bytes");
}

/// Costs above an absolute limit.
fn beyond(limits: &Limits, counted: &[Counted]) -> Vec<String> {
    let mut over = Vec::new();
    if counted.iter().all(|it| it.name != REFERENCE) {
        over.push(format!("{REFERENCE}: is no record, and its limits hold for nothing"));
    }
    let mut check = |what: String, value: u64, limit: u64| {
        if value > limit {
            over.push(format!("{what}: {value}, the limit is {limit}"));
        }
    };
    for Counted { name, cost, state_bytes, .. } in counted {
        check(format!("{name}: worst step"), cost.worst, limits.worst);
        if name == REFERENCE {
            check(format!("{name}: quiet step"), cost.quiet, limits.quiet);
            check(format!("{name}: mean step"), cost.mean, limits.mean_reference);
            check("state of the pipeline, bytes".into(), *state_bytes, limits.state_bytes);
        }
    }
    over
}

/// Costs that have risen, records without a budget, and budgets without a record.
fn risen(before: &BTreeMap<String, Cost>, counted: &[Counted]) -> Vec<String> {
    let mut over = Vec::new();
    for Counted { name, cost, .. } in counted {
        let Some(was) = before.get(name) else {
            over.push(format!("{name}: has no budget, which --write gives it"));
            continue;
        };
        let figures = [
            ("quiet", was.quiet, cost.quiet),
            ("mean", was.mean, cost.mean),
            ("worst", was.worst, cost.worst),
        ];
        for (what, was, is) in figures {
            if is as f64 > (1.0 + RISE) * was as f64 {
                over.push(format!("{name}: {what} rose from {was} to {is}"));
            }
        }
    }
    let is_counted = |name: &String| counted.iter().any(|it| it.name == *name);
    let stale = before.keys().filter(|name| !is_counted(name));
    over.extend(stale.map(|name| format!("{name}: has a budget and is no record")));
    over
}

/// Version of the compiler that built the program.
fn compiler(route: Route) -> String {
    let rustc = if route == Route::Debian { "/usr/bin/rustc".into() } else { rustc() };
    let said = output(Command::new(rustc).arg("--version")).unwrap_or_default();
    said.split(" (").next().unwrap_or_default().trim().to_owned()
}

fn rustc() -> std::ffi::OsString {
    std::env::var_os("RUSTC").unwrap_or("rustc".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counted(name: &str, mean: u64) -> Counted {
        let cost = Cost { quiet: 1, mean, worst: 1 };
        Counted { name: name.into(), samples: 1, events: 1, cost, worst_at: 0, state_bytes: 1 }
    }

    #[test]
    fn what_rose_or_is_not_compared_is_said() {
        let before = |names: &[&str]| -> BTreeMap<String, Cost> {
            names.iter().map(|name| ((*name).into(), counted(name, 100).cost)).collect()
        };
        let over = |names: &[&str], mean| risen(&before(names), &[counted("a", mean)]);
        assert_eq!(over(&["a"], 102), Vec::<String>::new());
        assert_eq!(over(&["a"], 103), ["a: mean rose from 100 to 103"]);
        assert_eq!(over(&[], 100), ["a: has no budget, which --write gives it"]);
        assert_eq!(over(&["a", "b"], 100), ["b: has a budget and is no record"]);
        let limits = Limits { quiet: 9, mean_reference: 9, worst: 9, state_bytes: 9 };
        assert_eq!(beyond(&limits, &[counted(REFERENCE, 9)]), Vec::<String>::new());
        assert_eq!(beyond(&limits, &[counted(REFERENCE, 10)]).len(), 1);
        assert_eq!(beyond(&limits, &[counted("a", 1)]).len(), 1);
    }
}
