//! The page `docs/effects.md`: costs, then benefits and harm of each effect.

use std::fmt::Write;

use floe_core::Effect;

use super::board::{Board, Costs};
use super::trial::{Errors, Outcome, Trial};

/// Limits from which a coefficient counts as worse: ratio of the errors, and loss of coverage; for
/// events, and for means, of which there are fewer.
const OF_EVENTS: Worse = Worse { factor: 1.05, uncovered: 0.02 };
const OF_MEANS: Worse = Worse { factor: 1.15, uncovered: 0.1 };
/// Coverage at or above which a loss of coverage does not count.
const HONEST: f64 = 0.95;
/// Largest number of rows shown for an effect.
const SHOWN: usize = 6;

struct Worse {
    factor: f64,
    uncovered: f64,
}

/// A coefficient in a scene that one of the two variants makes worse.
struct Row {
    scene: String,
    what: String,
    /// Root-mean-square error, percent, and coverage: with and without the effect.
    rms: [f64; 2],
    coverage: [f64; 2],
    size: f64,
}

/// Writes the page.
pub(super) fn markdown(costs: &Costs, trials: &[Trial]) -> String {
    let mut out = format!("{HEAD}\n{COST_HEAD}");
    for cost in &costs.each {
        let (better, worse) = (rows(trials, cost.effect, false), rows(trials, cost.effect, true));
        let scenes = |rows: &[Row]| {
            let mut names: Vec<&str> = rows.iter().map(|row| row.scene.as_str()).collect();
            names.sort_unstable();
            names.dedup();
            names.len()
        };
        let _ = writeln!(
            out,
            "| {} | {} | {} | {} ({}) | {} | {} | {} | {} |",
            cost.effect,
            cost.lines,
            cost.mean,
            cost.own_mean,
            cost.own,
            cost.flash,
            cost.state,
            scenes(&better),
            scenes(&worse),
        );
    }
    let _ = writeln!(out, "\n{}", totals(&costs.all, &costs.none));
    let _ = writeln!(out, "{}", verdict(trials));
    let _ = writeln!(out, "## Needed by\n\n{NEEDED}\n{ERROR_HEAD}");
    table(&mut out, trials, false);
    let _ = writeln!(out, "\n## Better without\n\n{SPOILT}\n{ERROR_HEAD}");
    table(&mut out, trials, true);
    let _ = writeln!(out, "\n## Changes of friction\n\n{}", changes(trials));
    out
}

const HEAD: &str = "\
# Effects: what each costs and brings

What makes an event depart from line, ellipse, line. Each is a cargo feature of `floe-core` and an effect of
`floe replay --effects`; what is compiled in and enabled still has to show in the data before it changes a
number. On a linear scene that costs at most 1 % of the stated standard deviation, but for the few records in which a corner
enters for a while by chance (dff8-13 up to 10 %, snow 6 %, heavy 3 %: `tests/effects.rs`). This page is written
by `cargo xtask effects`.

Costs: *lines* of product code in files of its own. *Instructions*: mean of a step of the core alone on the emulated
Cortex-M4, built with all effects, less that of a build without this one, in DFF8-13 (2 minutes) and in a scene that
has the effect. *Flash* and *state* likewise, bytes of that image and of the pipeline. The last two columns count the
scenes that need it, and those that would be better off without it: tables below.
";

const COST_HEAD: &str = "\
| effect | lines | instructions, dff8-13 | in its own scene | flash, bytes | state, bytes | needed by | better without |
|---|---:|---:|---:|---:|---:|---:|---:|
";

const NEEDED: &str = "\
Every scene of `host-sim/scenes` with events (seeds 1, 2, ... up to 1500 events or 24 records, `rate_and_state` 5; the
first events count), four of them for an hour (8 records), and one whose friction falls by 15 % in the middle. A row
is here if without the effect the root-mean-square error of the events is larger by 5 % or the coverage of their
95 % intervals, below .95, smaller by .02; for *means* of whole records, which are fewer, by 15 % or .1 (two records at least). The worst come
first, at most six of an effect; errors in percent of the coefficient.
";

const SPOILT: &str = "The same, the other way round.\n";

const ERROR_HEAD: &str = "\
| effect | scene | of | rms %, with | without | coverage, with | without |
|---|---|---|---:|---:|---:|---:|";

fn totals(all: &Board, none: &Board) -> String {
    let of = |board: &Board| {
        board.counted.first().map_or_else(String::new, |counted| {
            let cost = counted.cost;
            format!(
                "{} instructions a step in DFF8-13 (quiet {}, worst {}), {} bytes of the core's symbols, {} of state",
                cost.mean, cost.quiet, cost.worst, board.core, counted.state_bytes
            )
        })
    };
    format!("All of them: {}.\n\nNone, the paper's linear model alone: {}.\n", of(all), of(none))
}

/// Sentence that names the effects without a benefit.
fn verdict(trials: &[Trial]) -> String {
    let pays =
        |effect: &Effect| !rows(trials, *effect, false).is_empty() || says_more(trials, *effect);
    let idle: Vec<String> = Effect::ALL
        .into_iter()
        .filter(|effect| !pays(effect))
        .map(|effect| format!("`{effect}`"))
        .collect();
    if idle.is_empty() {
        return "Every effect pays in some row: an error, an interval, or a change that is said.\n"
            .into();
    }
    format!("No row needs {}.\n", idle.join(", "))
}

/// Whether, without the effect, fewer of the actual changes are reported.
fn says_more(trials: &[Trial], effect: Effect) -> bool {
    let there = |trial: &&Trial| trial.changes;
    trials
        .iter()
        .filter(there)
        .any(|it| without(it, effect).is_some_and(|o| o.changes < it.with.changes))
}

fn without(trial: &Trial, effect: Effect) -> Option<&Outcome> {
    let place = Effect::ALL.iter().position(|it| *it == effect)?;
    trial.without.get(place)
}

fn table(out: &mut String, trials: &[Trial], swapped: bool) {
    for effect in Effect::ALL {
        let rows = rows(trials, effect, swapped);
        for row in rows.iter().take(SHOWN) {
            let ([rms, rms_without], [coverage, coverage_without]) = (row.rms, row.coverage);
            let _ = writeln!(
                out,
                "| {effect} | {} | {} | {rms:.3} | {rms_without:.3} | {coverage:.3} | {coverage_without:.3} |",
                row.scene, row.what
            );
        }
        if rows.len() > SHOWN {
            let _ = writeln!(out, "| {effect} | {} more | | | | | |", rows.len() - SHOWN);
        }
        if rows.is_empty() {
            let _ = writeln!(out, "| {effect} | - | | | | | |");
        }
    }
}

/// Coefficients that are worse without an effect (swapped: with it), the worst first.
fn rows(trials: &[Trial], effect: Effect, swapped: bool) -> Vec<Row> {
    let mut rows = Vec::new();
    for trial in trials {
        let Some(without) = without(trial, effect) else { continue };
        for (place, name) in ["mu_s", "mu"].into_iter().enumerate() {
            let pairs = [
                (&OF_EVENTS, "events", &trial.with.events, &without.events),
                (&OF_MEANS, "means", &trial.with.means, &without.means),
            ];
            for (limits, of, with, without) in pairs {
                let (with, without) = (&with[place], &without[place]);
                let (good, bad) = if swapped { (without, with) } else { (with, without) };
                let Some(size) = limits.size(good, bad) else { continue };
                rows.push(Row {
                    scene: trial.name.clone(),
                    what: format!("{name}, {of}"),
                    rms: [with.rms(), without.rms()],
                    coverage: [with.coverage(), without.coverage()],
                    size,
                });
            }
        }
    }
    rows.sort_by(|a, b| b.size.total_cmp(&a.size));
    rows
}

impl Worse {
    /// How much worse `bad` is, or `None` if it is not worse.
    fn size(&self, good: &Errors, bad: &Errors) -> Option<f64> {
        if good.count() == 0 || bad.count() == 0 {
            return None;
        }
        let (factor, lost) = (bad.rms() / good.rms(), good.coverage() - bad.coverage());
        // A single interval among a few is not significant.
        let is_uncovered = lost > self.uncovered && lost * bad.count() as f64 > 1.5;
        let is_worse = factor > self.factor || (is_uncovered && bad.coverage() < HONEST);
        is_worse.then(|| factor + 10.0 * lost.max(0.0))
    }
}

/// Table of the records in which a change is reported, with and without an actual change.
fn changes(trials: &[Trial]) -> String {
    let said = |of: &dyn Fn(&Trial) -> bool| {
        let own = || trials.iter().filter(|trial| of(trial));
        let with: usize = own().map(|trial| trial.with.changes).sum();
        let records: usize = own().map(|trial| trial.with.records).sum();
        let without = own().filter_map(|trial| without(trial, Effect::Level));
        let without: usize = without.map(|outcome| outcome.changes).sum();
        format!("{records} | {with} | {without} |")
    };
    let breaks = |trial: &Trial| trial.name == "breaking";
    format!(
        "| what changes | records | change said | without `level` |\n|---|---:|---:|---:|\n\
         | friction, by 15 % | {}\n| the block breaks | {}\n| nothing | {}",
        said(&|trial| trial.changes),
        said(&breaks),
        said(&|trial| !trial.changes && !breaks(trial)),
    )
}
