//! Tests on the emulated board.

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output};
use std::time::{Duration, Instant};

use floe_tests::maths::{FUNCTIONS, Function};

use crate::Result;
use crate::arm::Route;
use crate::qemu;
use crate::shell::{self, say};

/// Binary logarithm of the virtual time of an instruction, ns: fast runs, and runs that count.
const FAST: u32 = 4;
const COUNTING: u32 = 8;
const LIMIT: Duration = Duration::from_secs(120);
/// QEMU's name of the fault status bit for a failed push of an exception frame.
const STACKING_FAILED: &str = "CFSR.MSTKERR";

/// The emulator, and the program with the tests.
#[derive(Debug)]
pub struct Tests {
    qemu: &'static str,
    program: PathBuf,
}

/// Expected end of a test.
enum End {
    Passed,
    Code(i32),
    /// The processor found no room on the stack for the frame of an exception.
    Overflow,
}

impl End {
    /// Options of the emulator for its messages on standard error.
    fn options(&self) -> &'static [&'static str] {
        if matches!(self, Self::Overflow) { &["-d", "int"] } else { &[] }
    }

    fn is_of(&self, output: &Output) -> bool {
        let code = output.status.code();
        match self {
            Self::Passed => code == Some(0),
            Self::Code(expected) => code == Some(*expected),
            Self::Overflow => code != Some(0) && said(&output.stderr).contains(STACKING_FAILED),
        }
    }
}

impl Tests {
    /// Builds the program and finds the emulator.
    ///
    /// # Errors
    /// The build fails, or the emulator cannot be installed.
    pub fn prepare(forced: Option<Route>) -> Result<Self> {
        let program = Route::find(forced)?.build_firmware("mps2-test", "mps2-an386")?;
        Ok(Self { qemu: qemu::find()?, program })
    }

    /// Runs all tests.
    ///
    /// # Errors
    /// The tests that failed.
    pub fn run_all(&self) -> Result<()> {
        let tests = [
            ("tick", FAST, End::Passed),
            ("wake", COUNTING, End::Passed),
            ("queue", FAST, End::Passed),
            ("maths", FAST, End::Passed),
            ("bytes", FAST, End::Passed),
            ("panic", FAST, End::Code(101)),
            ("fault", FAST, End::Code(102)),
            ("overflow", FAST, End::Overflow),
        ];
        let check = |(name, shift, end): &(&str, u32, End)| self.check(name, *shift, end).err();
        let failed: Vec<String> = tests.iter().filter_map(check).collect();
        println!("on target: {} passed, {} failed", tests.len() - failed.len(), failed.len());
        if failed.is_empty() { Ok(()) } else { Err(failed.join("; ")) }
    }

    /// Instruction counts of `bench` or `maths-bench`: name, mean, worst.
    ///
    /// # Errors
    /// The program failed.
    pub fn bench(&self, name: &str) -> Result<Vec<(String, u64, u64)>> {
        let output = self.run(name, COUNTING, &[])?;
        let text = String::from_utf8_lossy(&output.stdout);
        let counts = text.lines().filter_map(|line| {
            let mut words = line.strip_prefix("count ")?.split(' ');
            let name = words.next()?.to_string();
            Some((name, words.next()?.parse().ok()?, words.next()?.parse().ok()?))
        });
        let counts: Vec<_> = counts.collect();
        if output.status.success() { Ok(counts) } else { Err(report(name, &output)) }
    }

    fn check(&self, name: &str, shift: u32, end: &End) -> Result<()> {
        let output = self.run(name, shift, end.options())?;
        let said = said(&output.stdout);
        if !end.is_of(&output) || (name == "maths" && said.trim() != hashes()) {
            let failure = report(name, &output);
            say(&failure);
            return Err(failure);
        }
        println!("on target: {name} ok  {}", said.trim().replace('\n', ", "));
        Ok(())
    }

    fn run(&self, name: &str, shift: u32, more: &[&str]) -> Result<Output> {
        let directory = shell::target().join(format!("on-target-{}", std::process::id()));
        fs::create_dir_all(&directory).map_err(|e| e.to_string())?;
        fs::write(directory.join("test.name"), name).map_err(|e| e.to_string())?;
        let mut command = qemu::board(self.qemu, shift, None, &self.program, &directory);
        command.args(more);
        let output = within(&mut command, LIMIT);
        let _ = fs::remove_dir_all(&directory);
        output.map_err(|e| format!("{name}: {e}"))
    }
}

fn said(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn report(name: &str, output: &Output) -> String {
    let said = [&output.stdout, &output.stderr].map(|bytes| said(bytes));
    format!("on target: {name} FAILED ({}): {}", output.status, said.join(" ").trim())
}

fn within(command: &mut Command, limit: Duration) -> Result<Output> {
    use std::process::Stdio;
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().map_err(|e| e.to_string())?;
    let end = Instant::now() + limit;
    while child.try_wait().map_err(|e| e.to_string())?.is_none() {
        if Instant::now() > end {
            let _ = child.kill();
            return Err(format!("no end after {limit:?}"));
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    child.wait_with_output().map_err(|e| e.to_string())
}

/// Hashes of the elementary functions that the board must find.
fn hashes() -> String {
    let line = |f: &Function| format!("{f} {:08x}", f.hash());
    FUNCTIONS.iter().map(line).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::process::ExitStatusExt;
    use std::process::ExitStatus;

    #[test]
    fn a_stack_that_runs_over_is_not_any_failure() {
        let output = |code: i32, stderr: &str| Output {
            status: ExitStatus::from_raw(code << 8),
            stdout: Vec::new(),
            stderr: stderr.into(),
        };
        let ran_over = "Taking exception 4 [Data Abort]\n...MemManageFault with CFSR.MSTKERR\n";
        assert!(End::Overflow.is_of(&output(1, ran_over)));
        for other in [
            output(101, "panicked at main.rs:51:22:\nno test overflw"),
            output(102, "...with CFSR.PRECISERR"),
            output(1, "qemu-system-arm: could not load kernel"),
            output(0, ran_over),
        ] {
            assert!(!End::Overflow.is_of(&other), "{other:?}");
        }
    }
}
