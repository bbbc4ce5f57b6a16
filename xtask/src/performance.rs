//! `cargo xtask performance`: speed on the host compared with other tools, in
//! `docs/performance.md`.

use std::process::Command;

use crate::Result;
use crate::python::environment;
use crate::shell::{cargo, output, root, run, say, target};

/// Text of the page around the table.
const PAGE: &str = "\
# Speed on a PC

Written by `cargo xtask performance`. Ten million rows of `time_s,force_n` ({megabytes} MB, the block of DFF8-13 at 16 Hz with
noise), read, replayed or simulated. Every measurement is a process of its own; the methods take turns, five of them;
times are medians, and a ratio is taken within a turn: median (least to largest). Processor time is that of all threads.
Built with {build}. The load of
the machine before the first turn, over 1, 5 and 15 minutes: {load}; where it was shared, the ratios of
processor time are what to look at.

{table}

- *csv crate, records* only cuts the lines into cells: no number is read. *polars* and *pandas* read the table into memory,
  in as many threads as they like; `floe` reads on one thread, computes on another, and keeps the events only.
- A number of at most fifteen digits is read as a whole number over a power of ten, one division that rounds
  correctly; any other goes through `fast-float2` (`host-sim/src/log/plain.rs`). Tests compare both bit for bit.
- *CSV by `format!`* is what the simulator's log cost when the standard library wrote its numbers.
- A command is whole, with the files it writes: the replay's JSON has every event. Rows of the simulator are samples,
  those of the campaign tests.
";

/// Measures, and writes the page.
///
/// # Errors
/// Python is missing, a build fails, or the page cannot be written.
pub fn run_all() -> Result<()> {
    let python = environment()?;
    let mut install = Command::new(&python);
    install.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]);
    run(install.args(["pandas>=2", "scipy>=1.11"]))?;
    run(cargo().args(["build", "--release", "--package", "floe", "--example", "performance"]))?;
    let load = std::fs::read_to_string("/proc/loadavg").unwrap_or_default();
    let load = load.split(' ').take(3).collect::<Vec<_>>().join(", ");
    say("some minutes; leave the machine alone");
    let mut measure = Command::new(target().join("release/examples/performance"));
    let table = output(measure.env("CARGO_TARGET_DIR", target()).arg("--python").arg(&python))
        .ok_or("performance: failed")?;
    let page = root().join("docs/performance.md");
    // The settings of a release, unless link-time optimization is reduced to save time.
    let hurried = std::env::var("CARGO_PROFILE_RELEASE_LTO").is_ok_and(|lto| lto != "fat");
    let build = if hurried {
        "the release profile without link-time optimisation"
    } else {
        "the release profile"
    };
    let text =
        PAGE.replace("{table}", table.trim()).replace("{load}", &load).replace("{build}", build);
    let log = std::fs::metadata(target().join("performance_10000k.csv"));
    let megabytes = log.map_or(0, |log| log.len() / 1_000_000).to_string();
    let text = text.replace("{megabytes}", &megabytes);
    std::fs::write(&page, text).map_err(|e| format!("{}: {e}", page.display()))?;
    say(&format!("written {}", page.display()));
    Ok(())
}
