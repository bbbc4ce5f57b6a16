//! The reports in a real browser: headless Chromium.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde::Deserialize;

use crate::shell::{self, output, root, run, say};
use crate::{Result, apt};

/// A good log, a drifting one, one without an event, one of a day: scene and length, s.
const LOGS: [(&str, &str, Option<&str>); 4] = [
    ("good", "fig6-7.toml", None),
    ("drifting", "hard/drift.toml", None),
    ("nothing", "honesty/noise_only.toml", None),
    ("day", "dff8-13.toml", Some("86400")),
];
/// Widths of the window, px.
const WIDTHS: [u32; 2] = [400, 1400];
/// Looks at the page as a person does, and writes down what it saw.
const PROBE: &str = include_str!("browser/probe.js");

/// What the probe saw.
#[derive(Debug, Deserialize)]
struct Seen {
    /// Width of the page, px.
    window: u32,
    /// Errors and refusals.
    errors: Vec<String>,
    /// Rows of events, those that opened a closer look, and what was wrong with a look.
    rows: u32,
    opened: u32,
    wrong: Vec<String>,
    /// What reaches over the edge of the window.
    torn: Vec<String>,
    /// What a figure says of the data point under the pointer.
    hover: Option<String>,
}

/// Chromium without a window; installed when it is missing.
///
/// # Errors
/// It cannot be installed.
pub fn chromium() -> Result<Command> {
    if output(Command::new("chromium").arg("--version")).is_none() {
        apt::install(&["chromium", "fonts-dejavu"])?;
    }
    let mut chromium = Command::new("chromium");
    // A container's root has no sandbox of its own; the pages are ours.
    chromium.args(["--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars"]);
    Ok(chromium)
}

/// Every kind of report, narrow and wide: no error on the console, nothing over the edge, and
/// a click on an event shows its fit and its residuals.
///
/// # Errors
/// The first report that is not as it should be.
pub fn check() -> Result<()> {
    let floe = shell::floe()?;
    let folder = shell::target().join("browser");
    std::fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    for (name, scene, duration_s) in LOGS {
        let page = report(&floe, &folder, name, scene, duration_s)?;
        for width in WIDTHS {
            console_is_silent(&page, width)?;
            let seen = look(&page, width)?;
            judge(name, width, &seen)?;
            say(&format!("{name}, {width} px: {} of {} rows opened", seen.opened, seen.rows));
        }
    }
    Ok(())
}

fn report(
    floe: &Path,
    folder: &Path,
    name: &str,
    scene: &str,
    duration_s: Option<&str>,
) -> Result<PathBuf> {
    let (log, page) = (folder.join(format!("{name}.csv")), folder.join(format!("{name}.html")));
    let mut simulate = Command::new(floe);
    simulate.arg("simulate").arg(root().join("host-sim/scenes").join(scene)).arg("-o").arg(&log);
    simulate.args(duration_s.into_iter().flat_map(|duration| ["--duration-s", duration]));
    run(simulate.args(["--seed", "1"]))?;
    run(Command::new(floe).arg("replay").arg(log).arg("--quiet").arg("--report").arg(&page))?;
    Ok(page)
}

/// A page in a frame of this width: a window of its own is 500 px wide at least.
fn framed(page: &Path, width: u32) -> Result<Command> {
    let frame = page.with_extension("frame.html");
    let text = format!(
        "<iframe style=\"width:{width}px;height:1600px;border:0\" src=\"{}\"></iframe>\
         <script>onmessage = (event) => {{ document.body.dataset.seen = event.data; }};</script>",
        page.file_name().unwrap_or_default().display()
    );
    std::fs::write(&frame, text).map_err(|e| format!("{}: {e}", frame.display()))?;
    let mut chromium = chromium()?;
    chromium.args(["--window-size=1600,1700", "--virtual-time-budget=20000", "--dump-dom"]);
    chromium.arg(format!("file://{}", frame.display()));
    Ok(chromium)
}

/// The page as it is, with its own policy.
fn console_is_silent(page: &Path, width: u32) -> Result<()> {
    let shown = framed(page, width)?.arg("--enable-logging=stderr").output();
    let said = String::from_utf8_lossy(&shown.map_err(|e| e.to_string())?.stderr).into_owned();
    match said.lines().find(|line| line.contains("CONSOLE")) {
        Some(line) => Err(format!("{}, {width} px: {line}", page.display())),
        None => Ok(()),
    }
}

/// A copy of the page with the probe in it, which its policy would not let run.
fn look(page: &Path, width: u32) -> Result<Seen> {
    let text = std::fs::read_to_string(page).map_err(|e| format!("{}: {e}", page.display()))?;
    let (before, policy) = text.split_once("<meta http-equiv=").ok_or("a page without a policy")?;
    let (_, after) = policy.split_once("/>").ok_or("a policy without an end")?;
    let probed = page.with_extension("probed.html");
    let text = format!("{before}<script>{PROBE}</script>{after}");
    std::fs::write(&probed, text).map_err(|e| format!("{}: {e}", probed.display()))?;
    let dom = output(&mut framed(&probed, width)?).ok_or("chromium: failed")?;
    let seen = dom.split_once("data-seen=\"").and_then(|(_, rest)| rest.split_once('"'));
    let seen = seen.ok_or_else(|| format!("{}: the probe saw nothing", probed.display()))?.0;
    let seen = seen.replace("&quot;", "\"").replace("&lt;", "<").replace("&amp;", "&");
    serde_json::from_str(&seen).map_err(|e| format!("{}: {e}: {seen}", probed.display()))
}

fn judge(name: &str, width: u32, seen: &Seen) -> Result<()> {
    let no_events = name == "nothing";
    let fine = seen.window == width
        && seen.errors.is_empty()
        && seen.wrong.is_empty()
        && seen.torn.is_empty()
        && seen.opened == seen.rows
        && (no_events == (seen.rows == 0))
        && seen.hover.as_ref().is_some_and(|said| said.starts_with("sample "));
    if fine { Ok(()) } else { Err(format!("report {name} at {width} px: {seen:?}")) }
}
