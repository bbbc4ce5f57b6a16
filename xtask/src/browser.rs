//! Tests of the reports in a real browser: headless Chromium.

use std::path::{Path, PathBuf};
use std::process::Command;

use serde::Deserialize;

use crate::shell::{self, output, root, run, say};
use crate::{Result, apt};

/// Name, scene and length (s) of the logs: a good one, one with drift, one with a constant force,
/// one with two events, one of a day.
const LOGS: [(&str, &str, Option<&str>); 5] = [
    ("good", "fig6-7.toml", None),
    ("drifting", "hard/drift.toml", None),
    (CONSTANT, "honesty/steady_sliding.toml", None),
    ("two", "honesty/two_events.toml", None),
    ("day", "dff8-13.toml", Some("86400")),
];
const CONSTANT: &str = "constant";
/// Widths of the window, px.
const WIDTHS: [u32; 2] = [400, 1400];
/// A page of US letter within its margins of 12 mm, px.
const PAPER: [u32; 2] = [725, 965];
/// Largest number of pages of a report without its table, and fewest table rows per page.
const PAGES: usize = 4;
const ROWS: usize = 60;
/// Script that inspects a page and records its findings.
const PROBE: &str = include_str!("browser/probe.js");

/// Findings of the probe.
#[derive(Debug, Deserialize)]
struct Seen {
    /// Width of the page, px.
    window: u32,
    /// Whether the reader prefers dark pages.
    dark: bool,
    /// Errors and blocked requests.
    errors: Vec<String>,
    /// Table rows of events, rows that opened a zoomed view, and errors of those views.
    rows: usize,
    opened: usize,
    wrong: Vec<String>,
    /// Elements that extend beyond the edge of the window.
    torn: Vec<String>,
    /// Texts with too little contrast to their background.
    faint: Vec<String>,
    /// Number of figures, figures without a tooltip on a data point, and height of the tallest
    /// figure that paper keeps in one piece, px; `None` if paper may split figures.
    figures: usize,
    mute: Vec<String>,
    highest: Option<f64>,
}

/// Headless Chromium, installed if it is missing.
///
/// # Errors
/// The installation fails.
pub fn chromium() -> Result<Command> {
    if output(Command::new("chromium").arg("--version")).is_none() {
        apt::install(&["chromium", "fonts-dejavu"])?;
    }
    let mut chromium = Command::new("chromium");
    // Root in a container has no sandbox of its own, and the pages are trusted.
    chromium.args(["--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars"]);
    Ok(chromium)
}

/// Checks every kind of report, narrow, wide and on paper, light and dark: no error on the console,
/// nothing beyond the edge, no faint text, a tooltip on every data point of a figure, and fit and
/// residuals of an event after a click on it.
///
/// # Errors
/// The first report that fails.
pub fn check() -> Result<()> {
    let floe = shell::floe()?;
    let folder = shell::target().join("browser");
    std::fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    for (name, scene, duration_s) in LOGS {
        let page = report(&floe, &folder, name, scene, duration_s)?;
        for width in WIDTHS {
            console_is_silent(&page, width)?;
            let rows = look(name, &probed(&page, false)?, width)?;
            say(&format!("{name}, {width} px, light and dark: {rows} rows opened"));
        }
        let rows = look(name, &probed(&page, true)?, PAPER[0])?;
        let pages = printed(&page)?;
        say(&format!("{name}, on paper: {pages} pages"));
        if pages == 0 || pages > PAGES + rows / ROWS {
            return Err(format!("report {name}: {pages} pages for {rows} events"));
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

/// Chromium with a page in two frames of a width, light and dark. Frames are used because a window
/// is at least 500 px wide, and because a page takes the colour scheme of its frame.
fn framed(page: &Path, width: u32) -> Result<Command> {
    let frame = page.with_extension("frame.html");
    let source = page.file_name().unwrap_or_default().display();
    let frames = ["light", "dark"].map(|scheme| {
        format!(
            "<iframe style=\"color-scheme:{scheme};width:{width}px;height:1600px;border:0\" \
             src=\"{source}\"></iframe>"
        )
    });
    let script = "const seen = []; onmessage = (event) => { seen.push(JSON.parse(event.data)); \
                  document.body.dataset.seen = JSON.stringify(seen); };";
    let text = format!("<script>{script}</script>{}", frames.concat());
    std::fs::write(&frame, text).map_err(|e| format!("{}: {e}", frame.display()))?;
    let mut chromium = chromium()?;
    chromium.args(["--window-size=3000,1700", "--virtual-time-budget=20000", "--dump-dom"]);
    chromium.arg(format!("file://{}", frame.display()));
    Ok(chromium)
}

/// Checks that the unchanged page, with its content security policy, prints no error.
fn console_is_silent(page: &Path, width: u32) -> Result<()> {
    let shown = framed(page, width)?.arg("--enable-logging=stderr").output();
    let shown = shown.map_err(|e| e.to_string())?;
    let said = String::from_utf8_lossy(&shown.stderr).into_owned();
    if !shown.status.success() {
        return Err(format!("{}, {width} px: chromium failed: {said}", page.display()));
    }
    match said.lines().find(|line| line.contains("CONSOLE")) {
        Some(line) => Err(format!("{}, {width} px: {line}", page.display())),
        None => Ok(()),
    }
}

/// Writes a copy of the page with the probe and without the content security policy, which would
/// block the probe; in the style for the screen or for paper.
fn probed(page: &Path, on_paper: bool) -> Result<PathBuf> {
    let text = std::fs::read_to_string(page).map_err(|e| format!("{}: {e}", page.display()))?;
    let (before, policy) = text.split_once("<meta http-equiv=").ok_or("a page without a policy")?;
    let (_, after) = policy.split_once("/>").ok_or("a policy without an end")?;
    let mut text = format!("{before}<script>{PROBE}</script>{after}");
    if on_paper {
        text = text.replace("@media print", "@media all").replace("@media screen", "@media print");
    }
    let probed = page.with_extension(if on_paper { "paper.html" } else { "probed.html" });
    std::fs::write(&probed, text).map_err(|e| format!("{}: {e}", probed.display()))?;
    Ok(probed)
}

/// Checks the findings of the probe, light and dark; returns the number of events.
fn look(name: &str, probed: &Path, width: u32) -> Result<usize> {
    let dom = output(&mut framed(probed, width)?).ok_or("chromium: failed")?;
    let seen = dom.split_once("data-seen=\"").and_then(|(_, rest)| rest.split_once('"'));
    let seen = seen.ok_or_else(|| format!("{}: the probe saw nothing", probed.display()))?.0;
    let seen = seen.replace("&quot;", "\"").replace("&lt;", "<").replace("&amp;", "&");
    let seen: Vec<Seen> =
        serde_json::from_str(&seen).map_err(|e| format!("{}: {e}: {seen}", probed.display()))?;
    if let Some(wrong) = seen.iter().find(|seen| !is_fine(name, width, seen)) {
        return Err(format!("report {name} at {width} px: {wrong:?}"));
    }
    match &seen[..] {
        [a, b] if a.dark != b.dark => Ok(a.rows),
        _ => Err(format!("report {name} at {width} px: not one light and one dark: {seen:?}")),
    }
}

fn is_fine(name: &str, width: u32, seen: &Seen) -> bool {
    seen.window == width
        && [&seen.errors, &seen.wrong, &seen.torn, &seen.faint, &seen.mute]
            .iter()
            .all(|it| it.is_empty())
        && seen.opened == seen.rows
        && ((name == CONSTANT) == (seen.rows == 0))
        && seen.figures > 1
        && (width != PAPER[0] || seen.highest.is_some_and(|px| px < PAPER[1].into()))
}

/// Number of pages of the report as a PDF.
fn printed(page: &Path) -> Result<usize> {
    let paper = page.with_extension("pdf");
    let mut chromium = chromium()?;
    chromium.arg(format!("--print-to-pdf={}", paper.display())).arg("--no-pdf-header-footer");
    output(chromium.arg(format!("file://{}", page.display()))).ok_or("chromium: no PDF")?;
    let pdf = std::fs::read(&paper).map_err(|e| format!("{}: {e}", paper.display()))?;
    let pdf = String::from_utf8_lossy(&pdf);
    Ok(pdf.matches("/Type /Page").count() - pdf.matches("/Type /Pages").count())
}
