//! `cargo xtask defmt`: decodes the firmware's log of an emulated test, from the MPS2 board through
//! semihosting, from the NUCLEO out of its RTT buffer.

use std::path::Path;
use std::process::Stdio;

use crate::Result;
use crate::arm::Route;
use crate::emulate::machine::{Machine, Run, Setup};
use crate::emulate::nucleo::Nucleo;
use crate::emulate::outcome;
use crate::emulate::record::Record;
use crate::shell::{cargo, target};

/// Runs a test with a converter that once fails to answer, on both boards, decodes every frame and
/// checks for the expected ones.
///
/// # Errors
/// A frame cannot be decoded or is missing.
pub fn run(forced: Option<Route>) -> Result<()> {
    let mut record = Record::stick_slip();
    if let Some(code) = record.codes.get_mut(500) {
        *code = None;
    }
    let machine = Machine::with_features(forced, "mps2-an386,defmt")?;
    let setup = Setup { samples: record.has_gaps(), ..Setup::default() };
    let run = machine.run(&record, setup)?;
    same("mps2-an386", &record, &run)?;
    check("mps2-an386", &decode(machine.firmware(), &run.logged)?, &[])?;
    let nucleo = Nucleo::with_features(forced, "nucleo-l476,defmt")?;
    let run = nucleo.run(&record, setup)?;
    same("nucleo-l476", &record, &run)?;
    let own = ["tick by the crystal", "card: ", "stack: "];
    check("nucleo-l476", &decode(nucleo.firmware(), &run.logged)?, &own)
}

/// Checks that an image with a log computes the same as this PC.
fn same(board: &str, record: &Record, run: &Run) -> Result<()> {
    let outcome = outcome::decode(&run.shown)?;
    let same = outcome.compare(record, &run.delivered).map_err(|e| format!("{board}: {e}"))?;
    println!("defmt: {board}: {same}");
    outcome.check_ticks()
}

/// Checks for the cause of the start, start and end of the test, each event, the converter's fault,
/// and the board's own frames.
fn check(board: &str, frames: &[String], own: &[&str]) -> Result<()> {
    let count = |words: &str| frames.iter().filter(|frame| frame.contains(words)).count();
    for frame in frames.iter().take(3).chain(frames.last()) {
        println!("defmt: {board}: {frame}");
    }
    let found = (count("boot: "), count("starts"), count("ends"), count("Event"), count("Silent"));
    println!("defmt: {board}: {} frames, {} events among them", frames.len(), found.3);
    if let Some(missing) = own.iter().find(|words| count(words) == 0) {
        return Err(format!("{board}: nothing was logged of '{missing}'"));
    }
    match found {
        (1, 1, 1, 20.., 1..) => Ok(()),
        _ => Err(format!("{board}: boots, starts, ends, events, silences: {found:?}")),
    }
}

/// Decodes the frames with a separate program, whose dependencies would change features of this
/// build.
fn decode(firmware: &Path, logged: &[u8]) -> Result<Vec<String>> {
    let file = target().join("defmt.bin");
    std::fs::write(&file, logged).map_err(|e| format!("{}: {e}", file.display()))?;
    let mut decoder = cargo();
    decoder.args(["run", "--quiet", "--package", "floe-defmt", "--features", "decode", "--"]);
    let decoded = decoder.arg(firmware).arg(&file).stderr(Stdio::inherit()).output();
    let decoded = decoded.map_err(|e| e.to_string())?;
    let frames = String::from_utf8_lossy(&decoded.stdout).lines().map(String::from).collect();
    if decoded.status.success() { Ok(frames) } else { Err("the log was not decoded".into()) }
}
