//! The Python examples, in an environment of their own.

use std::path::PathBuf;
use std::process::Command;

use crate::Result;
use crate::shell::{self, root, run, say};

/// Runs the examples on simulated logs.
///
/// Without Python there is nothing to run: said here, and a failure in CI.
///
/// # Errors
/// An example failed, or CI has no Python.
pub fn check() -> Result<()> {
    if shell::output(Command::new("python3").arg("--version")).is_none() {
        let missing = "no python3: the Python examples were not run";
        let ci = std::env::var("CI").is_ok_and(|ci| ci == "true");
        say(missing);
        return if ci { Err(missing.to_string()) } else { Ok(()) };
    }
    let python = environment()?;
    let floe = shell::floe()?;
    let target = root().join("target");
    let (logs, out) = (target.join("python-logs"), target.join("python-out"));
    simulate(&floe, &logs)?;
    if out.exists() {
        std::fs::remove_dir_all(&out).map_err(|e| format!("{}: {e}", out.display()))?;
    }
    let example = |name: &str| root().join("host-sim/examples/python").join(name);
    let log = root().join("host-sim/logs/dff8-13.csv");
    run(Command::new(&python).arg(example("one_log.py")).args([&floe, &log, &out]))?;
    let mut many = Command::new(&python);
    many.arg(example("many_logs.py")).args([&floe, &logs, &out.join("events")]);
    run(many.arg("--lose-a-worker"))
}

/// The interpreter of the environment, made when it is missing.
pub fn environment() -> Result<PathBuf> {
    let folder = root().join("target/python");
    let python = folder.join("bin/python");
    if !python.exists() {
        run(Command::new("python3").args(["-m", "venv"]).arg(&folder))?;
    }
    let list = root().join("host-sim/examples/python/requirements.txt");
    let mut install = Command::new(&python);
    install.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "-r"]);
    run(install.arg(list))?;
    Ok(python)
}

/// Two tests each of blocks that differ in weight and snow.
fn simulate(floe: &PathBuf, logs: &PathBuf) -> Result<()> {
    const SCENES: [&str; 3] = ["dff8-13", "linear/heavy", "terms/snow"];
    std::fs::create_dir_all(logs).map_err(|e| format!("{}: {e}", logs.display()))?;
    for (seed, scene) in (1_u32..).zip(SCENES.into_iter().cycle().take(2 * SCENES.len())) {
        let scene = root().join("host-sim/scenes").join(scene).with_extension("toml");
        let log = logs.join(format!("pull-{seed}.csv"));
        let mut command = Command::new(floe);
        command.arg("simulate").arg(scene).arg("-o").arg(log);
        run(command.args(["--duration-s", "60", "--seed", &seed.to_string()]))?;
    }
    Ok(())
}
