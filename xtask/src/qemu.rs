//! QEMU 10 or newer: in older versions `-icount` with a sleeping processor is wrong and not
//! repeatable.

use std::path::Path;
use std::process::Command;

use crate::shell::{output, say};
use crate::{Result, apt};

const PROGRAM: &str = "qemu-system-arm";
const OLDEST: u32 = 10;

/// The emulator's program, installed if it is missing or too old.
///
/// # Errors
/// The installation fails.
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

/// The MPS2 board with a program, in a working directory. An instruction takes `2^shift` ns, a
/// sleep no time. `socket` connects its UART 0.
///
/// Without a socket the run is recorded (to /dev/null), because recording synchronizes QEMU's two
/// threads. Otherwise a sleep sometimes begins before the preceding instructions have been counted,
/// and ends too late by their time (seen twice in a million ticks). Recording blocks input on a
/// socket.
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

/// The user's board: a machine with the same processor, and a plugin that adds the board's
/// peripherals. 15.6 million instructions a second, as at 16 MHz.
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
