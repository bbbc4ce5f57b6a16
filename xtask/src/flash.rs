//! `cargo xtask flash`: the firmware onto the real board.

use std::process::Command;

use crate::Result;
use crate::arm::Route;
use crate::shell::{self, output, say};

const CHIP: &str = "STM32L476RG";
const INSTALL: &str = "https://probe.rs/docs/getting-started/installation";

/// Looks for tool and board before it builds anything.
///
/// # Errors
/// The tool, the board or the firmware is missing.
pub fn run(forced: Option<Route>) -> Result<()> {
    let Some(probes) = output(Command::new("probe-rs").arg("list")) else {
        return Err(format!("probe-rs is not installed: see {INSTALL}"));
    };
    if !probes.contains("[0]") {
        return Err("no board found: connect the NUCLEO-L476RG's ST-LINK by USB".into());
    }
    let firmware = Route::find(forced)?.build_firmware("nucleo-l476", "nucleo-l476")?;
    shell::run(Command::new("probe-rs").args(["download", "--chip", CHIP]).arg(&firmware))?;
    shell::run(Command::new("probe-rs").args(["reset", "--chip", CHIP]))?;
    say("done; the console is the board's USB serial port at 115 200 baud");
    Ok(())
}
