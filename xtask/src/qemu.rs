//! The emulator, QEMU 10 or newer: before that, `-icount` together with a
//! sleeping processor is wrong and not repeatable.

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

/// Major version of the installed program.
fn version() -> Option<u32> {
    let text = output(Command::new(PROGRAM).arg("--version"))?;
    let after = text.split("version ").nth(1)?;
    after.split('.').next()?.parse().ok()
}
