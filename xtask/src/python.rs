//! The Python examples, in a virtual environment.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::shell::{self, remove, root, run, target};
use crate::{Result, apt};

/// Whether Python is installed, or can be.
pub fn is_to_be_had() -> bool {
    has(&["--version"]) || apt::present()
}

/// Runs the examples on simulated logs.
///
/// # Errors
/// An example failed, or Python is missing.
pub fn check() -> Result<()> {
    let python = environment()?;
    let floe = shell::floe()?;
    let (logs, out) = (target().join("python-logs"), target().join("python-out"));
    simulate(&floe, &logs)?;
    remove(&out)?;
    let example = |name: &str| root().join("host-sim/examples/python").join(name);
    let log = root().join("host-sim/logs/dff8-13.csv");
    run(Command::new(&python).arg(example("one_log.py")).args([&floe, &log, &out]))?;
    let mut many = Command::new(&python);
    many.arg(example("many_logs.py")).args([&floe, &logs, &out.join("events")]);
    run(many.arg("--lose-a-worker"))
}

/// Whether `python3` succeeds with these arguments.
fn has(arguments: &[&str]) -> bool {
    shell::output(Command::new("python3").args(arguments)).is_some()
}

/// Interpreter of the virtual environment, which is created with its packages if missing.
pub fn environment() -> Result<PathBuf> {
    let folder = target().join("python");
    let python = folder.join("bin/python");
    if !python.exists() {
        // Debian's Python lacks `ensurepip`.
        if !has(&["-c", "import venv, ensurepip"]) {
            apt::install(&["python3", "python3-venv"])?;
        }
        make(Command::new("python3").args(["-m", "venv"]), &folder)?;
    }
    let list = root().join("host-sim/examples/python/requirements.txt");
    let mut install = Command::new(&python);
    install.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "-r"]);
    run(install.arg(list))?;
    Ok(python)
}

/// Creates a folder completely or not at all: a later run would take a partial one for complete.
fn make(command: &mut Command, folder: &Path) -> Result<()> {
    let made = run(command.arg(folder));
    if made.is_err() {
        remove(folder)?;
    }
    made
}

/// Simulates two tests of each of several blocks, which differ in weight and snow.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_environment_that_failed_is_not_left_behind() {
        let folder = std::env::temp_dir().join(format!("floe-python-{}", std::process::id()));
        let half = "mkdir -p $0/bin && touch $0/bin/python";
        let try_with = |script: &str| make(Command::new("sh").args(["-c", script]), &folder);
        assert!(try_with(&format!("{half} && false")).is_err() && !folder.exists());
        assert!(try_with(half).is_ok() && folder.exists());
        remove(&folder).expect("removed");
    }
}
