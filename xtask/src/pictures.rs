//! `cargo xtask pictures`: the pictures of the README, from the programs' output.

use std::process::Command;

use crate::Result;
use crate::browser::chromium;
use crate::shell::{self, cargo, root, run, say, target};

/// Visible part of the report, px.
const WINDOW: [&str; 2] = ["--window-size=1240,1900", "--force-device-scale-factor=0.75"];

/// Draws a report of the bundled log in headless Chromium, and the live view of a test.
///
/// # Errors
/// Chromium is missing, or a program fails.
pub fn run_all() -> Result<()> {
    let docs = root().join("docs");
    let report = target().join("pictures-report.html");
    let mut replay = Command::new(shell::floe()?);
    replay.current_dir(root()).args(["replay", "host-sim/logs/fig6-7.csv", "--quiet"]);
    run(replay.arg("--report").arg(&report))?;
    let mut chromium = chromium()?;
    chromium.args(WINDOW);
    chromium.arg(format!("--screenshot={}", docs.join("report.png").display()));
    run(chromium.arg(format!("file://{}", report.display())))?;
    let mut live = cargo();
    live.args(["test", "--package", "floe", "--lib", "--"]);
    run(live.args(["--ignored", "live::tests::picture"]))?;
    let drawn = target().join("live.svg");
    std::fs::copy(&drawn, docs.join("live.svg"))
        .map_err(|e| format!("{}: {e}", drawn.display()))?;
    say("written docs/report.png and docs/live.svg");
    Ok(())
}
