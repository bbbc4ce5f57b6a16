//! `cargo xtask effects`: what each effect costs on the board and brings in the scenes, into
//! `docs/effects.md`.

use std::fs;
use std::path::Path;

use floe::sim::Scene;
use floe_core::{Effect, Effects};
use floe_tests::parallel;
use floe_tests::score::{Errors, Score};

use crate::Result;
use crate::arm::Route;
use crate::budgets::{self, Counted};
use crate::qemu;
use crate::shell::{root, say};
use crate::size::Image;

/// Events of a scene, and most records to have them from.
const EVENTS: usize = 400;
const RECORDS: u64 = 12;
/// A scene needs an effect if without it an error is larger by this factor, or the coverage
/// smaller by so much.
const LARGER: f64 = 1.05;
const UNCOVERED: f64 = 0.02;
/// Scenes that are named in a row.
const NAMED: usize = 5;

/// The core on the board with some effects.
struct Board {
    core: u64,
    counted: Counted,
}

impl Board {
    fn with(route: Route, effects: &[Effect], reference: &Path) -> Result<Self> {
        let features = effects.iter().map(|effect| format!(",floe-core/{effect}"));
        let features = "mps2-an386".to_owned() + &features.collect::<String>();
        let program = route.build_with("mps2-budget", &features, &["--no-default-features"])?;
        let core = Image::read(&program)?.crates.get("floe_core").copied().unwrap_or(0);
        let record = budgets::scene_record(reference)?;
        Ok(Self { core, counted: budgets::count(qemu::find()?, &program, &record)? })
    }
}

/// Scores of a scene with all effects, and without each of them.
struct Tried {
    name: String,
    with: Score,
    without: Vec<Score>,
}

/// Writes the table.
///
/// # Errors
/// The firmware does not build or run.
pub fn run(forced: Option<Route>) -> Result<()> {
    let route = Route::find(forced)?;
    let reference = root().join("host-sim/scenes/dff8-13.toml");
    let all = Board::with(route, &Effect::ALL, &reference)?;
    let none = Board::with(route, &[], &reference)?;
    say("every scene with all effects and without each of them");
    let tried = tried()?;
    let mut rows = String::new();
    for (place, effect) in Effect::ALL.into_iter().enumerate() {
        let others: Vec<Effect> = Effect::ALL.into_iter().filter(|it| *it != effect).collect();
        let without = Board::with(route, &others, &reference)?;
        let (needed, better) = needs(&tried, place);
        let cost = cost(&all, &without);
        rows += &format!("| {effect} | {} | {cost} | {needed} | {better} |\n", lines(effect)?);
    }
    let text = page(&rows, &all, &none);
    let place = root().join("docs/effects.md");
    fs::write(&place, &text).map_err(|e| format!("{}: {e}", place.display()))?;
    print!("{text}");
    Ok(())
}

fn page(rows: &str, all: &Board, none: &Board) -> String {
    format!(
        "# Effects: what each costs and brings

What makes an event depart from line, ellipse, line. Each is a cargo feature of `floe-core` and an effect of
`floe replay --effects`; what is compiled in and enabled still has to show in the data before it changes a
number. This page is written by `cargo xtask effects`.

*Lines*: of product code in files of its own. *Instructions* and *flash*: what DFF8-13 (2 minutes) costs the core alone
on the emulated board with all effects, less what it costs without this one, mean of a step; *state*: bytes of the
pipeline. *Needed by*: scenes of `host-sim/scenes` (first {EVENTS} events, the first ones too) in which without it
the root-mean-square error of a coefficient is larger by 5 %, or the coverage of its 95 % intervals smaller by .02:
the worst first. *Better without*: the same, the other way round.

| effect | lines | instructions | flash, bytes | state, bytes | needed by | better without |
|---|---:|---:|---:|---:|---|---|
{rows}
All of them: {} instructions a step (quiet {}, worst {}), {} bytes of flash, {} of state. None, the paper's linear
model alone: {} (quiet {}, worst {}), {} bytes of flash, {} of state: no effect keeps its state out of the pipeline yet.

`level` changes no coefficient: it says when friction changed (`changes` in the JSON). `damping` widens intervals, and
only where its prior is not stated to be 0, as it is in these scenes: `docs/honesty.md` shows what it does. The scenes
that would be better off without an effect are those that it mistakes: mains hum for a ripple of the winch, a flopping
cable for a sagging one.
",
        all.counted.cost.mean,
        all.counted.cost.quiet,
        all.counted.cost.worst,
        all.core,
        all.counted.state_bytes,
        none.counted.cost.mean,
        none.counted.cost.quiet,
        none.counted.cost.worst,
        none.core,
        none.counted.state_bytes,
    )
}

/// Instructions, flash and state that an effect adds.
fn cost(all: &Board, without: &Board) -> String {
    let less = |of: fn(&Board) -> u64| of(all) as i64 - of(without) as i64;
    let costs: [fn(&Board) -> u64; 3] =
        [|it| it.counted.cost.mean, |it| it.core, |it| it.counted.state_bytes];
    costs.map(|of| less(of).to_string()).join(" | ")
}

/// Files of an effect's own, product lines: neither empty, nor comment, nor test.
fn lines(effect: Effect) -> Result<String> {
    let files: &[&str] = match effect {
        Effect::Corner => &["effects/corner/mod.rs", "effects/corner/score.rs", "model/corner.rs"],
        Effect::Sag => &["effects/sag.rs"],
        Effect::Stiffening => return Ok("few".into()),
        Effect::Mass => &["effects/mass_change/mod.rs", "effects/mass_change/swings.rs"],
        Effect::Level => &["effects/level_shift.rs"],
        Effect::Drift => &["effects/zero_drift.rs"],
        Effect::Flop => &["noise/flop.rs"],
        Effect::Ripple => &["noise/ripple.rs"],
        Effect::Forgetting => &["noise/forgetting.rs"],
        Effect::Damping => &["effects/damping.rs"],
    };
    let mut count = 0;
    for file in files {
        let place = root().join("core/src").join(file);
        let text = fs::read_to_string(&place).map_err(|e| format!("{}: {e}", place.display()))?;
        let product = text.split("#[cfg(test)]").next().unwrap_or_default();
        let counts = |line: &&str| !line.trim().is_empty() && !line.trim().starts_with("//");
        count += product.lines().filter(counts).count();
    }
    Ok(count.to_string())
}

/// Every scene with events, on all processors.
fn tried() -> Result<Vec<Tried>> {
    let files = budgets::scenes(&["linear", "hard", "honesty"])?;
    parallel::each(&files, |file| scores(file)).into_iter().collect()
}

fn scores(file: &Path) -> Result<Tried> {
    let text = fs::read_to_string(file).map_err(|e| format!("{}: {e}", file.display()))?;
    let scene = Scene::from_toml(&text).map_err(|e| format!("{}: {e}", file.display()))?;
    let score = |effects| Score::looking_for(effects, &scene, EVENTS, RECORDS);
    let all_but = |left_out: Effect| {
        let others = Effect::ALL.into_iter().filter(|it| *it != left_out);
        others.fold(Effects::NONE, |set, effect| set.with(effect, true))
    };
    let without = Effect::ALL.map(|effect| score(all_but(effect)));
    let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    Ok(Tried { name, with: score(Effects::COMPILED), without: without.into() })
}

/// The scenes that need an effect, and those that would be better off without.
fn needs(tried: &[Tried], place: usize) -> (String, String) {
    let named = |of: fn(&Errors, &Errors) -> Option<(f64, String)>, swapped: bool| {
        let mut found = Vec::new();
        for Tried { name, with, without } in tried {
            let Some(without) = without.get(place) else { continue };
            for (what, i) in [("mu_s", 0), ("mu", 1)] {
                let (a, b) = (&with.errors[i], &without.errors[i]);
                let pair = if swapped { (b, a) } else { (a, b) };
                found.extend(
                    of(pair.0, pair.1).map(|(size, text)| (size, format!("{name} {what} {text}"))),
                );
            }
        }
        found.sort_by(|a, b| b.0.total_cmp(&a.0));
        let more = found.len().saturating_sub(NAMED);
        let mut names: Vec<String> = found.into_iter().take(NAMED).map(|it| it.1).collect();
        if more > 0 {
            names.push(format!("{more} more"));
        }
        if names.is_empty() { "-".to_owned() } else { names.join(", ") }
    };
    (named(worse, false), named(worse, true))
}

/// How much worse the second is, and how to say it.
fn worse(with: &Errors, without: &Errors) -> Option<(f64, String)> {
    if with.count() == 0 || without.count() == 0 {
        return None;
    }
    let (ratio, lost) = (without.rms() / with.rms(), with.coverage() - without.coverage());
    let is_larger = ratio > LARGER;
    // Intervals that hold more than they say lose nothing by holding less.
    let is_uncovered = lost > UNCOVERED && without.coverage() < 0.95;
    let text = match (is_larger, is_uncovered) {
        (false, false) => return None,
        (true, false) => format!("x{ratio:.2}"),
        (false, true) => format!("cover {:.2} -> {:.2}", with.coverage(), without.coverage()),
        (true, true) => {
            format!("x{ratio:.2}, cover {:.2} -> {:.2}", with.coverage(), without.coverage())
        }
    };
    Some((ratio + 10.0 * lost.max(0.0), text))
}
