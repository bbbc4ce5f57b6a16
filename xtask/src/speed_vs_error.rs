//! `cargo xtask bench --docs`: the host's comparison together with the board's instruction counts,
//! written to `docs/speed-vs-error.md` and its picture.

use std::fs;
use std::process::{Command, Stdio};

use floe::bench::method::Method;
use floe::bench::ours::Floe;
use floe::bench::result::{BenchResult, Instructions};
use floe::bench::scenes::{self, Effort, Trial};
use floe::bench::{page, picture};

use crate::arm::Route;
use crate::budgets::{self, Record};
use crate::shell::{cargo, root, say};
use crate::{Result, qemu};

const PAGE: &str = "speed-vs-error.md";
const PICTURE: &str = "speed-vs-error.svg";

/// Measures, and writes page and picture.
///
/// # Errors
/// A build or a run fails.
pub fn run(forced: Option<Route>) -> Result<()> {
    let mut result = host()?;
    let program = Route::find(forced)?.build_firmware("mps2-budget", "mps2-an386")?;
    let qemu = qemu::find()?;
    say("board: counting");
    // One record per scene suffices for counting.
    let plans = scenes::plans(Effort::QUICK).map_err(|e| e.to_string())?;
    for (place, plan) in plans.iter().enumerate() {
        let trial = plan.run().map_err(|e| e.to_string())?;
        let counted = budgets::count(qemu, &program, &record(&trial, place))?;
        let noise_percent = 100.0 * trial.noise;
        let own = result.rows.iter_mut().filter(|row| {
            row.method == Floe::NAME
                && row.scene == trial.name
                && (row.noise_percent - noise_percent).abs() < 1e-9
        });
        let (mean, worst) = (counted.cost.mean, counted.cost.worst);
        own.for_each(|row| row.board = Some(Instructions { mean, worst }));
    }
    let docs = root().join("docs");
    for (name, text) in [(PAGE, page::markdown(&result, PICTURE)), (PICTURE, picture::svg(&result))]
    {
        let place = docs.join(name);
        fs::write(&place, text).map_err(|e| format!("{}: {e}", place.display()))?;
        say(&format!("written {}", place.display()));
    }
    Ok(())
}

/// Runs `floe bench` in a release build.
fn host() -> Result<BenchResult> {
    say("host: floe bench, some minutes");
    let mut command: Command = cargo();
    command.args(["run", "--release", "--package", "floe", "--", "bench", "--json"]);
    // Progress goes to the terminal.
    let said = command.stderr(Stdio::inherit()).output().map_err(|e| e.to_string())?;
    if !said.status.success() {
        return Err(format!("floe bench: failed ({})", said.status));
    }
    serde_json::from_slice(&said.stdout).map_err(|e| format!("floe bench --json: {e}"))
}

/// First record of a scene in the form that the board's program reads.
fn record(trial: &Trial, place: usize) -> Record {
    let setup = &trial.setup;
    let range_n = setup.range_n.unwrap_or(0.0);
    let head = [setup.rate_hz, setup.weight_n, setup.slope_rad, range_n].map(|it| it as f32);
    let samples = trial.records.first().map_or(&[][..], |record| &record.samples);
    let samples = samples.iter().map(|sample| (sample.index, sample.force_n));
    Record::new(format!("{} {place}", trial.name), head, samples)
}
