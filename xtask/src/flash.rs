//! `cargo xtask flash`: programs the firmware into the real board.

use std::process::Command;

use crate::Result;
use crate::arm::Route;
use crate::shell::{self, output, say};

const CHIP: &str = "STM32L476RG";
const INSTALL: &str = "https://probe.rs/docs/getting-started/installation";

/// Checks for tool and board before building. With `log` it builds another image for use at the
/// desk; the image for the field has no log.
///
/// # Errors
/// The tool, the board or the firmware is missing.
pub fn run(forced: Option<Route>, log: bool) -> Result<()> {
    let Some(probes) = output(Command::new("probe-rs").arg("list")) else {
        return Err(format!("probe-rs is not installed: see {INSTALL}"));
    };
    if !probes.contains("[0]") {
        return Err("no board found: connect the NUCLEO-L476RG's ST-LINK by USB".into());
    }
    let features = if log { "nucleo-l476,defmt" } else { "nucleo-l476" };
    let firmware = Route::find(forced)?.build_firmware("nucleo-l476", features)?;
    if log {
        say("Ctrl-C ends the log; the board goes on with the firmware that logs");
        return shell::run(Command::new("probe-rs").args(["run", "--chip", CHIP]).arg(&firmware));
    }
    shell::run(Command::new("probe-rs").args(["download", "--chip", CHIP]).arg(&firmware))?;
    shell::run(Command::new("probe-rs").args(["reset", "--chip", CHIP]))?;
    say("done; the console is the board's USB serial port at 115 200 baud");
    Ok(())
}
