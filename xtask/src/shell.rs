//! Runs other programs and prints their command lines.

use std::collections::VecDeque;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::Result;

/// Variable with cargo's target directory.
const TARGET: &str = "CARGO_TARGET_DIR";
/// Lines quoted from a failed program.
const QUOTED: usize = 20;

/// Root directory of the workspace.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap_or(Path::new(".")).to_path_buf()
}

/// Directory for build results and outputs: cargo's target directory if set, else `target`.
pub fn target() -> PathBuf {
    root().join(std::env::var_os(TARGET).unwrap_or("target".into()))
}

/// The cargo that runs this program, building into [`target`].
pub fn cargo() -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or("cargo".into()));
    command.current_dir(root()).env(TARGET, target());
    command
}

/// Builds `floe` and returns its file. Features are those of a common build with this program, so
/// that nothing is built twice.
///
/// # Errors
/// The build fails.
pub fn floe() -> Result<PathBuf> {
    let packages = ["--package", "floe", "--package", "xtask"];
    run(cargo().arg("build").args(packages).args(["--bin", "floe"]))?;
    Ok(target().join("debug/floe"))
}

/// Removes a folder if it exists.
///
/// # Errors
/// It cannot be removed.
pub fn remove(folder: &Path) -> Result<()> {
    match std::fs::remove_dir_all(folder) {
        Err(e) if e.kind() != std::io::ErrorKind::NotFound => {
            Err(format!("cannot remove {}: {e}", folder.display()))
        }
        _ => Ok(()),
    }
}

/// Prints the command line, runs the command, and fails if the command fails.
pub fn run(command: &mut Command) -> Result<()> {
    say(&format!("$ {}", line(command)));
    let status = command.status().map_err(|e| format!("cannot start {}: {e}", line(command)))?;
    if status.success() { Ok(()) } else { Err(format!("failed ({status}): {}", line(command))) }
}

/// Runs a command like [`run`]; the error of a failure quotes the command's last lines, because a
/// log is read from its end.
pub fn run_quoted(command: &mut Command) -> Result<()> {
    let line = line(command);
    say(&format!("$ {line}"));
    let started = command.stderr(Stdio::piped()).spawn();
    let mut child = started.map_err(|e| format!("cannot start {line}: {e}"))?;
    let mut last = VecDeque::new();
    for text in child
        .stderr
        .take()
        .into_iter()
        .flat_map(|it| BufReader::new(it).lines().map_while(std::result::Result::ok))
    {
        eprintln!("{text}");
        last.push_back(text);
        if last.len() > QUOTED {
            last.pop_front();
        }
    }
    let status = child.wait().map_err(|e| e.to_string())?;
    let quoted = || last.iter().map(|text| format!("\n    {text}")).collect::<String>();
    if status.success() { Ok(()) } else { Err(format!("failed ({status}): {line}{}", quoted())) }
}

/// Runs a command like [`run`] with a time limit, and hides its output unless it fails.
pub fn run_within(command: &mut Command, limit: Duration) -> Result<()> {
    say(&format!("$ {}", line(command)));
    let mut child = command
        .stdin(Stdio::null())
        .spawn()
        .map_err(|e| format!("cannot start {}: {e}", line(command)))?;
    let end = Instant::now() + limit;
    loop {
        match child.try_wait().map_err(|e| e.to_string())? {
            Some(status) if status.success() => return Ok(()),
            Some(status) => return Err(format!("failed ({status}): {}", line(command))),
            None if Instant::now() > end => {
                let _ = child.kill();
                let _ = child.wait();
                return Err(format!("no result after {limit:?}: {}", line(command)));
            }
            None => std::thread::sleep(Duration::from_millis(50)),
        }
    }
}

/// Standard output of a command; `None` if it cannot run or fails.
pub fn output(command: &mut Command) -> Option<String> {
    let out = command.stderr(Stdio::null()).output().ok()?;
    out.status.success().then(|| String::from_utf8_lossy(&out.stdout).into_owned())
}

/// Prints a progress line to standard error, apart from results on standard output.
pub fn say(text: &str) {
    eprintln!("xtask: {text}");
}

fn line(command: &Command) -> String {
    let mut words = vec![command.get_program().to_string_lossy().into_owned()];
    words.extend(command.get_args().map(|a| a.to_string_lossy().into_owned()));
    words.join(" ")
}
