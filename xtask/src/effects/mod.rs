//! `cargo xtask effects`: cost of each effect on the board and its benefit in the scenes, written
//! to `docs/effects.md`.

mod board;
mod page;
mod trial;

use std::fs;
use std::time::Instant;

use crate::Result;
use crate::arm::Route;
use crate::shell::{root, say};

/// Writes the page.
///
/// # Errors
/// The firmware does not build or run.
pub fn run(forced: Option<Route>) -> Result<()> {
    let route = Route::find(forced)?;
    let begin = Instant::now();
    // The compiler uses one processor; the simulation uses the others.
    let (costs, trials) = std::thread::scope(|scope| {
        let costs = scope.spawn(|| board::costs(route));
        let trials = trial::run();
        (costs.join().unwrap_or_else(|_| Err("counting panicked".into())), trials)
    });
    let text = page::markdown(&costs?, &trials?);
    let place = root().join("docs/effects.md");
    fs::write(&place, &text).map_err(|e| format!("{}: {e}", place.display()))?;
    print!("{text}");
    say(&format!("{} s", begin.elapsed().as_secs()));
    Ok(())
}
