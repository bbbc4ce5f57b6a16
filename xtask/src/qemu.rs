//! The emulator, QEMU 10 or newer: before that, `-icount` together with a
//! sleeping processor is wrong and not repeatable.

use std::path::Path;
use std::process::Command;

use crate::shell::{output, say};
use crate::{Result, apt};

const PROGRAM: &str = "qemu-system-arm";
const OLDEST: u32 = 10;

/// The emulator's program, installed if it is missing or too old.
///
/// # Errors
/// It is not there and cannot be installed.
pub fn find() -> Result<&'static str> {
    if version().is_some_and(|v| v >= OLDEST) {
        return Ok(PROGRAM);
    }
    if !apt::present() {
        return Err(format!("{PROGRAM} {OLDEST} or newer is needed: install QEMU"));
    }
    say(&format!("installing {PROGRAM} {OLDEST} or newer"));
    apt::install_newest("qemu-system-arm", OLDEST)?;
    match version() {
        Some(v) if v >= OLDEST => Ok(PROGRAM),
        found => Err(format!("{PROGRAM}: got version {found:?}, need {OLDEST}")),
    }
}

/// The emulated board with a program in it, whose files are those of a directory.
/// An instruction takes 2 to the power of `shift` ns, and a sleep no time at all.
/// Somebody may be at its UART 0, by way of `socket`.
///
/// What would be recorded goes nowhere: recording keeps QEMU's two threads out of
/// each other's way. Without it a sleep now and then begins before the instructions
/// that led to it have been counted, and ends that much too late (seen twice in a
/// million ticks). With it nothing that is typed would arrive.
pub fn board(
    program: &str,
    shift: u32,
    socket: Option<&str>,
    firmware: &Path,
    directory: &Path,
) -> Command {
    let recorded = if socket.is_none() { ",rr=record,rrfile=/dev/null" } else { "" };
    let icount = format!("shift={shift},sleep=off{recorded}");
    let mut command = Command::new(program);
    command.args(["-M", "mps2-an386", "-display", "none", "-monitor", "none"]);
    command.args(["-serial", socket.unwrap_or("none"), "-icount", &icount]);
    command.args(["-semihosting-config", "enable=on,target=native"]);
    command.arg("-kernel").arg(firmware).current_dir(directory);
    command
}

/// The user's board: a machine with the same processor, and a plugin that lays the
/// board's own peripherals over it. 15.6 million instructions a second, as with 16 MHz.
pub fn nucleo(program: &str, plugin: &Path, firmware: &Path, directory: &Path) -> Command {
    let mut command = Command::new(program);
    command.args(["-M", "b-l475e-iot01a", "-display", "none", "-monitor", "none"]);
    command.args(["-serial", "null", "-serial", "null"]);
    command.args(["-icount", "shift=6,sleep=off,rr=record,rrfile=/dev/null"]);
    command.arg("-plugin").arg(plugin).arg("-kernel").arg(firmware).current_dir(directory);
    command
}

/// Major version of the installed program.
fn version() -> Option<u32> {
    let text = output(Command::new(PROGRAM).arg("--version"))?;
    let after = text.split("version ").nth(1)?;
    after.split('.').next()?.parse().ok()
}
