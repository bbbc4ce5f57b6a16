//! `cargo xtask test`: all checks, those that fail soonest first.

use std::process::Command;
use std::time::Instant;

use floe_tests::in_ci;

use crate::Result;
use crate::arm::Route;
use crate::shell::{self, cargo, run_within, say};
use crate::target::Tests;
use crate::{browser, budgets, defmt, emulate, host_tests, libraries, python, qemu, size};

/// Names of the steps that passed, failed, or were skipped.
#[derive(Default)]
struct Tally {
    passed: Vec<&'static str>,
    failed: Vec<String>,
    skipped: Vec<String>,
}

impl Tally {
    fn step(&mut self, name: &'static str, job: impl FnOnce() -> Result<()>) {
        say(&format!("== {name}"));
        let start = Instant::now();
        match job() {
            Ok(()) => {
                say(&format!("== {name}: ok, {:.0} s", start.elapsed().as_secs_f32()));
                self.passed.push(name);
            }
            Err(reason) => {
                say(&format!("== {name}: FAILED: {reason}"));
                self.failed.push(format!("{name}: {reason}"));
            }
        }
    }

    fn skip(&mut self, name: &str, reason: &str) {
        say(&format!("== {name}: left out: {reason}"));
        self.skipped.push(format!("{name}: {reason}"));
    }

    fn summary(&self) -> String {
        let (passed, failed) = (self.passed.len(), self.failed.len());
        let skipped: String = self.skipped.iter().map(|it| format!("\nskipped: {it}")).collect();
        format!("steps: {passed} passed, {failed} failed, {} skipped{skipped}", self.skipped.len())
    }
}

/// Runs every step, even after a failure, and prints a summary line.
///
/// # Errors
/// A step failed.
pub fn run(forced: Option<Route>, firmware_only: bool) -> Result<()> {
    let mut tally = Tally::default();
    if !firmware_only {
        host(&mut tally);
    }
    firmware(&mut tally, forced);
    println!("{}", tally.summary());
    if tally.failed.is_empty() { Ok(()) } else { Err(tally.failed.join("\n       ")) }
}

fn host(tally: &mut Tally) {
    tally.step("format", || component("rustfmt", cargo().args(["fmt", "--all", "--check"])));
    tally.step("clippy", || component("clippy", &mut clippy()));
    tally.step("libraries", libraries::check);
    if python::is_to_be_had() || in_ci() {
        tally.step("Python examples", python::check);
    } else {
        tally.skip("Python examples", "no python3, and no apt to install it");
    }
    tally.step("reports in a browser", browser::check);
    // The tests of power cuts check the file system with it.
    tally.step("fsck.fat", || emulate::tool("fsck.fat").map(drop));
    tally.step("host tests", host_tests::run);
}

fn firmware(tally: &mut Tally, forced: Option<Route>) {
    let mut route = None;
    tally.step("ARM compiler", || {
        route = Some(Route::find(forced)?);
        Ok(())
    });
    tally.step("QEMU", || qemu::find().map(drop));
    let Some(route) = route else { return };
    tally.step("core on ARM", || {
        let mut build = route.cargo("build");
        build.args(["-p", "floe-core", "--no-default-features", "--release"]);
        shell::run(&mut build)
    });
    tally.step("tests on target", || Tests::prepare(Some(route))?.run_all());
    tally.step("core's budget", || budgets::run(Some(route), false));
    tally.step("logs through the firmware", || {
        emulate::check_bundled(emulate::Board::Mps2, Some(route))
    });
    tally.step("converter troubles", || emulate::check_troubles(route));
    tally.step("card and power cuts", || emulate::check_card(route));
    tally.step("the board's image", || emulate::check_board(route));
    tally.step("live console", || emulate::check_live(route));
    tally.step("firmware's log", || defmt::run(Some(route)));
    tally.step("board image", || size::run(Some(route)));
}

fn clippy() -> Command {
    let mut command = cargo();
    command.args(["clippy", "--workspace", "--all-targets"]);
    // A lint added in a newer compiler must not stop a user.
    if in_ci() {
        command.args(["--", "-D", "warnings"]);
    }
    command
}

/// Runs a job that needs a component of the toolchain, which is added if missing.
fn component(name: &str, job: &mut Command) -> Result<()> {
    let program = if name == "rustfmt" { "cargo-fmt" } else { "cargo-clippy" };
    if shell::output(Command::new(program).arg("--version")).is_none() {
        let limit = std::time::Duration::from_secs(90);
        run_within(Command::new("rustup").args(["component", "add", name]), limit)?;
    }
    shell::run(job)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_left_out_has_not_passed() {
        let mut tally = Tally::default();
        tally.step("a", || Ok(()));
        tally.step("b", || Err("broken".into()));
        tally.skip("c", "no tool");
        assert_eq!(tally.summary(), "steps: 1 passed, 1 failed, 1 skipped\nskipped: c: no tool");
    }
}
