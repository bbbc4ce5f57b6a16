//! Tests on the emulated board.

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output};
use std::time::{Duration, Instant};

use floe_tests::maths::{FUNCTIONS, Function};

use crate::Result;
use crate::arm::Route;
use crate::qemu;
use crate::shell::{root, say};

/// Virtual time of an instruction is 2 to this power in ns.
const FAST: u32 = 4;
const COUNTING: u32 = 8;
const LIMIT: Duration = Duration::from_secs(120);

/// The program with the tests in it.
#[derive(Debug)]
pub struct Tests {
    qemu: &'static str,
    program: PathBuf,
}

/// How a test has to end.
enum End {
    Passed,
    Code(i32),
    /// Not by itself: its fault handler finds no stack to say more.
    Stopped,
}

impl Tests {
    /// Builds the program and finds the emulator.
    ///
    /// # Errors
    /// One of them is not to be had.
    pub fn prepare(forced: Option<Route>) -> Result<Self> {
        let program = Route::find(forced)?.build_firmware("mps2-test", "mps2-an386")?;
        Ok(Self { qemu: qemu::find()?, program })
    }

    /// Runs all of them.
    ///
    /// # Errors
    /// Which failed.
    pub fn run_all(&self) -> Result<()> {
        let tests = [
            ("tick", FAST, End::Passed),
            ("wake", COUNTING, End::Passed),
            ("queue", FAST, End::Passed),
            ("maths", FAST, End::Passed),
            ("bytes", FAST, End::Passed),
            ("panic", FAST, End::Code(101)),
            ("fault", FAST, End::Code(102)),
            ("overflow", FAST, End::Stopped),
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
        let output = self.run(name, COUNTING)?;
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
        let output = self.run(name, shift)?;
        let code = output.status.code();
        let as_expected = match end {
            End::Passed => code == Some(0),
            End::Code(expected) => code == Some(*expected),
            End::Stopped => code != Some(0) && output.stdout.is_empty(),
        };
        let said = String::from_utf8_lossy(&output.stdout);
        if !as_expected || (name == "maths" && said.trim() != hashes()) {
            let failure = report(name, &output);
            say(&failure);
            return Err(failure);
        }
        println!("on target: {name} ok  {}", said.trim().replace('\n', ", "));
        Ok(())
    }

    fn run(&self, name: &str, shift: u32) -> Result<Output> {
        let directory = root().join("target").join(format!("on-target-{}", std::process::id()));
        fs::create_dir_all(&directory).map_err(|e| e.to_string())?;
        fs::write(directory.join("test.name"), name).map_err(|e| e.to_string())?;
        let mut command = qemu::board(self.qemu, shift, None, &self.program, &directory);
        let output = within(&mut command, LIMIT);
        let _ = fs::remove_dir_all(&directory);
        output.map_err(|e| format!("{name}: {e}"))
    }
}

fn report(name: &str, output: &Output) -> String {
    let said = [&output.stdout, &output.stderr].map(|s| String::from_utf8_lossy(s).into_owned());
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

/// Results of the elementary functions as the board has to find them.
fn hashes() -> String {
    let line = |f: &Function| format!("{f} {:08x}", f.hash());
    FUNCTIONS.iter().map(line).collect::<Vec<_>>().join("\n")
}
