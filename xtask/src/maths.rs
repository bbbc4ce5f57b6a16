//! `cargo xtask maths`: comparison of the elementary functions, as the table in `docs/maths.md`.

use std::fs;

use floe_tests::maths::{EMPTY, FUNCTIONS, Function, columns};

use crate::Result;
use crate::arm::Route;
use crate::shell::{cargo, output, root, say};
use crate::target::Tests;

const HEAD: &str = "| function | arguments | library | used | largest error | / bearable \
                    | PC, ns | board, instructions: mean | worst |\n\
                    |---|---|---|---|---:|---:|---:|---:|---:|\n";

/// Measures, and replaces the table on the page.
///
/// # Errors
/// The firmware or the timing program does not build or run; the page has no table.
pub fn run(forced: Option<Route>) -> Result<()> {
    let path = root().join("docs/maths.md");
    let page = fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
    let table = table(&host()?, &Tests::prepare(forced)?.bench("maths-bench")?)?;
    let start = page.find("| function |").ok_or("docs/maths.md: no table '| function | ...'")?;
    let end = page[start..].find("\n\n").map_or(page.len(), |length| start + length + 1);
    let new = format!("{}{table}{}", &page[..start], &page[end..]);
    fs::write(&path, new).map_err(|e| format!("{}: {e}", path.display()))?;
    print!("{table}");
    Ok(())
}

fn table(host: &str, board: &[(String, u64, u64)]) -> Result<String> {
    let counts = |function: &Function| {
        let found = board.iter().find(|(name, ..)| *name == function.to_string());
        found.map(|&(_, mean, worst)| (mean, worst)).ok_or(format!("no count of {function}"))
    };
    let (empty, _) = counts(&EMPTY)?;
    let mut table = HEAD.to_string();
    for function in FUNCTIONS {
        let name = format!("{function} ");
        let ns = host.lines().find_map(|line| line.strip_prefix(&name));
        let ns = ns.ok_or(format!("no time of {function}"))?;
        let (mean, worst) = counts(&function)?;
        let (mean, worst) = (mean.saturating_sub(empty), worst.saturating_sub(empty));
        table += &format!("{} {ns} | {mean} | {worst} |\n", columns(&function));
    }
    Ok(table)
}

/// Times on this PC, one line `NAME/LIBRARY NS` each.
fn host() -> Result<String> {
    say("times on this PC: example maths_speed");
    let mut command = cargo();
    command.args(["run", "--quiet", "--release", "--package", "floe-tests"]);
    output(command.args(["--example", "maths_speed"])).ok_or("maths_speed failed".into())
}
