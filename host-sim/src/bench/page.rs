//! The page `speed-vs-error.md`: picture, summary, and a table for each scene.

use std::fmt::Write;

use super::result::{BenchResult, Row};
use super::table::{Table, blocks, board, heading, scene, short, summary};

const INTRODUCTION: &str = "\
Every method gets the same simulated samples in the same order and is told the same: rate, weight,
slope, range of the cell. `cargo xtask bench --docs` runs them all and writes this page.

| method | what it does |
|---|---|
| max/min | largest and smallest force of a cycle as `mu_s Mg` and `mu Mg` |
| phase plane | `F'` by central difference; where the trajectory leaves the stick line and comes back (`Fs`, `Fe`); `Fp = (Fs + Fe)/2` |
| ellipse fit | least squares of an ellipse to the slip's points in the (F, F') plane |
| Kalman filter | two modes, stick and slip, extended Kalman filter with six states |
| least squares (offline) | line, ellipse, line fitted to each whole event; keeps all samples, answers at the end |
| floe | `floe_core::Pipeline`, as on the board |
";

const NOTES: &str = "\
- *Bound*: Cramér-Rao bound of each event by itself, with its five unknowns (onset, `k w`, `Fs`, `Fp`,
  omega) free and white noise. A method that carries `k w` and omega from event to event can be below 1.
  `-`: the model does not hold in that scene. In scenes with other errors than white noise it is only a measure.
- *rms, bias, 95 %*: root-mean-square and mean of the error, and the size that 95 % of the errors do not
  exceed, in percent of the mean coefficient. Every event of a record counts, the first ones too, but for the
  last, which the end of the record cuts.
- *F1*: harmonic mean of precision and recall; an event is found when its onset is within two samples and
  half the slip's length. *read*: share of the true events that got both coefficients.
- *delay*: from the true onset until the method says that the block slips. *ns/sample*: shortest of seven warm
  runs, so that what else the computer did is left out. *worst ns*: longest single sample, each the shortest of seven runs. *state B*: bytes kept between
  samples; the offline method's grow with the record.
- *hard* scenes are in `host-sim/scenes/hard`; the truth is the coefficient of the ice. The weight that the
  methods are told is the one at the start: where the block breaks they have to find that out.
";

const BOARD: &str = "\
Instructions of a step of `floe_core::Pipeline` with all effects on a Cortex-M4F, counted by the emulator over the first
record of the scene; errors are those of the tables below. The rivals compute in double precision, which this processor
has no unit for, and are not on the board.
";

/// The text of the page; `picture` is the file next to it.
#[must_use]
pub fn markdown(result: &BenchResult, picture: &str) -> String {
    let processor = result.host.processor.as_deref().unwrap_or("unknown processor");
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = writeln!(out, "# Speed against error\n\n![Speed against error]({picture})\n");
    let _ = writeln!(out, "{INTRODUCTION}");
    for (kind, linear) in [("Linear", true), ("Hard", false)] {
        let _ = writeln!(out, "## {kind} scenes: median over the scenes (worst)\n");
        table(&mut out, "method", &summary(result, linear));
        out.push('\n');
    }
    let _ = writeln!(
        out,
        "Host: {processor}. One look at each sample takes {} ns. Seeds {}, 2, ... in every \
         scene.{}\n\n{NOTES}",
        short(result.one_pass_ns),
        result.first_seed,
        if result.host.debug_build {
            " Built without optimisation: times mean little."
        } else {
            ""
        }
    );
    if result.rows.iter().any(|row| row.board.is_some()) {
        let _ = writeln!(out, "## On the board\n\n{BOARD}");
        table(&mut out, "scene, noise", &board(result));
        out.push('\n');
    }
    section(&mut out, "Linear scenes", &result.rows, true);
    section(&mut out, "Hard scenes", &result.rows, false);
    out
}

fn section(out: &mut String, title: &str, rows: &[Row], linear: bool) {
    let _ = writeln!(out, "## {title}");
    let own = |block: &&[Row]| block.iter().all(|row| row.linear == linear);
    for block in blocks(rows).filter(own) {
        let _ = writeln!(out, "\n### {}\n", heading(block));
        table(out, "method", &scene(block));
    }
    out.push('\n');
}

fn table(out: &mut String, of: &str, Table { titles, rows }: &Table) {
    let _ = writeln!(out, "| {of} | {} |", titles.join(" | "));
    let _ = writeln!(out, "|---|{}", "---:|".repeat(titles.len()));
    for (name, cells) in rows {
        let _ = writeln!(out, "| {name} | {} |", cells.join(" | "));
    }
}
