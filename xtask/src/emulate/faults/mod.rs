//! Faults of the user's board, on the image that is flashed: time until each is noticed, loss, and
//! time until normal operation.

mod board;
mod cards;
mod resets;

use floe_board_model::run::{Incident, Setup, When};
use floe_firmware::line::{Health, Line};

use super::nucleo::{Nucleo, Played};
use super::record::{NOISE, RATE_HZ, Record};
use crate::Result;
use floe_tests::parallel;

/// Latest first answer on the console after power-up, s.
const FIRST_WORDS_S: f64 = 1.0;
/// Latest first sample after the start of the crystal, s.
const FIRST_TICK_S: f64 = 1.0;
/// Time after which the board gives up on a crystal, s.
const NO_CRYSTAL_S: f64 = 6.0;

/// A fault with the checks of its consequences.
type Case = fn(&Bench<'_>) -> Result<Row>;

/// Consequences of a fault: a row of the table.
struct Row {
    noticed: String,
    lost: String,
    normal: String,
}

/// Shared input of the cases.
struct Bench<'a> {
    nucleo: &'a Nucleo,
    codes: Vec<i32>,
}

/// Runs every case and prints the table of `docs/reliability.md`.
///
/// # Errors
/// The cases that fail.
pub fn check_faults(nucleo: &Nucleo) -> Result<()> {
    let (codes, _) = Record::stick_slip().played();
    let bench = Bench { nucleo, codes };
    let cases: [(&str, Case); 19] = [
        ("no card", cards::none),
        ("card pulled for 10 s in a test", cards::pulled),
        ("new card put in during a test", cards::late),
        ("exFAT, FAT12, empty card", cards::other_kinds),
        ("card that cannot be read", cards::unreadable),
        ("crystal that never starts", board::no_crystal),
        ("converter silent for 20 samples", board::silent),
        ("converter late for 20 samples", board::late),
        ("converter babbling for 20 samples", board::babbling),
        ("converter frozen for 20 samples", board::frozen),
        ("data line held for 2 s", board::bus_held),
        ("data line held by a chip that waits for 1 to 9 clocks", board::bus_stuck),
        ("no display", board::no_display),
        ("main loop hangs in a test", resets::hung),
        ("fault of the processor in a test", resets::fault),
        ("stack that runs over in a test", resets::overflow),
        ("supply dips below the brown-out level in a test", resets::dip),
        ("supply fails for a moment in a test", resets::brown_out),
        ("40 lines typed, one every 0.3 s", board::typed_often),
    ];
    let results = parallel::each(&cases, |(_, case)| case(&bench));
    println!("| fault | noticed, said | lost | normal again |");
    println!("|---|---|---|---|");
    let mut failed = Vec::new();
    for ((name, _), result) in cases.iter().zip(results) {
        match result {
            Ok(Row { noticed, lost, normal }) => {
                println!("| {name} | {noticed} | {lost} | {normal} |");
            }
            Err(reason) => {
                println!("| {name} | FAILED: {reason} | | |");
                failed.push(format!("{name}: {reason}"));
            }
        }
    }
    if failed.is_empty() { Ok(()) } else { Err(failed.join("\n       ")) }
}

/// A row of the table.
fn row(noticed: impl Into<String>, lost: impl Into<String>, normal: impl Into<String>) -> Row {
    Row { noticed: noticed.into(), lost: lost.into(), normal: normal.into() }
}

fn at(s: f64, what: Incident) -> (When, Incident) {
    (When::Seconds(s), what)
}

fn typed(s: f64, line: &str) -> (When, Incident) {
    at(s, Incident::Type(format!("{line}\r\n")))
}

/// Script of a test that starts at second 3.
fn test() -> Vec<(When, Incident)> {
    vec![typed(2.9, "set weight 630"), typed(3.0, "set span 5000"), typed(3.1, "start")]
}

fn expect(good: bool, what: impl Into<String>) -> Result<()> {
    if good { Ok(()) } else { Err(what.into()) }
}

impl Bench<'_> {
    fn setup(&self, end_s: f64, script: Vec<(When, Incident)>) -> Setup {
        let script = script.into_iter().chain([at(end_s, Incident::End)]).collect();
        let codes = self.codes.clone();
        Setup { codes, noise: NOISE, rate_hz: RATE_HZ, script, ..Setup::quiet() }
    }

    /// Runs a setup; a breach is an error.
    fn play(&self, setup: &Setup) -> Result<Played> {
        let played = self.nucleo.play(setup)?;
        let last: Vec<&str> = played.shown.lines().rev().take(4).collect();
        played.check().map_err(|e| format!("{e}; last words: {last:?}"))?;
        Ok(played)
    }

    /// Runs a setup, and checks that the board starts and samples in time without a reset.
    fn play_well(&self, setup: &Setup) -> Result<Played> {
        let played = self.play(setup)?;
        let first = played.outcome.line_times_s.first().copied().unwrap_or(f64::INFINITY);
        let tick = played.outcome.first_ticks_s.first().copied().unwrap_or(f64::INFINITY);
        let start = setup.crystal_start_s.unwrap_or(NO_CRYSTAL_S - FIRST_TICK_S);
        expect(first <= FIRST_WORDS_S, format!("first words after {first:.2} s"))?;
        expect(tick <= start + FIRST_TICK_S, format!("first tick after {tick:.2} s"))?;
        let resets = &played.outcome.resets;
        expect(resets.is_empty(), format!("reset: {resets:?}"))?;
        Ok(played)
    }
}

fn said(played: &Played, words: &str) -> Result<f64> {
    let said = played.said_at(words);
    said.ok_or_else(|| format!("never said '{words}', but {:?}", troubles(&played.shown)))
}

fn troubles(shown: &str) -> Vec<&str> {
    shown.lines().filter(|line| line.starts_with(['!', 'I'])).collect()
}

/// Time of the last line that contains these words, s.
fn last_said(played: &Played, words: &str) -> Option<f64> {
    let lines = played.shown.lines().zip(&played.outcome.line_times_s);
    lines.filter(|(line, _)| line.contains(words)).map(|(_, &s)| s).last()
}

fn events(played: &Played) -> usize {
    played.shown.lines().filter(|line| line.starts_with("E,")).count()
}

/// Last health line on the console.
fn health(played: &Played) -> Result<Health> {
    let mut healths = played.shown.lines().rev().filter_map(|line| match Line::parse(line) {
        Ok(Line::Health(health)) => Some(health),
        _ => None,
    });
    healths.next().ok_or_else(|| "no health was said".into())
}
