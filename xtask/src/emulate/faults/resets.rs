//! Resets of the board: the test is resumed, and the clock is kept if possible.

use floe::card::Test;
use floe_board_model::run::{Incident, Setup};
use floe_firmware::wall_clock::Moment;

use super::{Bench, Row, at, expect, last_said, row, test, troubles, typed};
use crate::Result;
use crate::emulate::card::Image;
use crate::emulate::nucleo::{Played, card};

const SPI2: u32 = 0x4000_3800;
/// Stack left by the fault, bytes: less than an interrupt takes.
const STACK_LEFT: u32 = 256;
/// Longest time until a test is resumed, s after the first tick.
const GOES_ON_S: f64 = 1.0;
/// Clock command before the crystal runs: time of day, and moment of typing, s.
const SET: (&str, f64) = ("2027-03-02T10:15:00Z", 0.5);
/// Accuracy of a set clock, ms: one sampling period (`docs/field-guide.md`).
const SET_MS: f64 = 62.5;
/// Accuracy of the calendar, ms: it counts in 4 ms, and reading and setting round once each.
const CALENDAR_MS: f64 = 10.0;

/// Effect of the reset on the time of day.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Clock {
    Kept,
    Lost,
}

pub(super) fn hung(bench: &Bench<'_>) -> Result<Row> {
    let words = "restarted after: the watchdog";
    restarts(bench, Incident::StopClock, "the watchdog", words, Clock::Kept)
}

pub(super) fn fault(bench: &Bench<'_>) -> Result<Row> {
    let words = "restarted after: a fault at 0x";
    restarts(bench, Incident::FailAccess(SPI2), "the program", words, Clock::Kept)
}

pub(super) fn overflow(bench: &Bench<'_>) -> Result<Row> {
    let words = "restarted after: the stack ran over";
    restarts(bench, Incident::UseUpStack(STACK_LEFT), "the program", words, Clock::Kept)
}

pub(super) fn dip(bench: &Bench<'_>) -> Result<Row> {
    restarts(bench, Incident::Dip, "a dip", "floe, help lists the commands", Clock::Kept)
}

pub(super) fn brown_out(bench: &Bench<'_>) -> Result<Row> {
    restarts(bench, Incident::CutPower, "the power", "floe, help lists the commands", Clock::Lost)
}

/// Runs a test with an incident at second 6 that causes a reset; checks the reported cause and that
/// the test is resumed.
fn restarts(
    bench: &Bench<'_>,
    incident: Incident,
    cause: &str,
    words: &str,
    clock: Clock,
) -> Result<Row> {
    let image = Image::large("restart")?;
    let mut script = test();
    script.push(typed(SET.1, &format!("clock {}", SET.0)));
    script.push(at(6.0, incident));
    let setup = Setup { card: Some(card(image.path())?), ..bench.setup(20.0, script) };
    let played = bench.play(&setup)?;
    let resets = &played.outcome.resets;
    let [(reset_s, why)] = &resets[..] else { return Err(format!("resets: {resets:?}")) };
    expect(why == cause, format!("reset by {why}"))?;
    let after = |words: &str| {
        let said = last_said(&played, words).filter(|s| s > reset_s);
        said.ok_or_else(|| format!("never said '{words}': {:?}", troubles(&played.shown)))
    };
    let said = after(words)? - reset_s;
    let goes_on = after("the test goes on")? - reset_s;
    let tick = played.outcome.first_ticks_s.get(1).ok_or("never sampled again")? - reset_s;
    expect(goes_on <= tick + GOES_ON_S, format!("goes on after {goes_on:.1} s"))?;
    after(if clock == Clock::Kept { "I,clock 2027-03-02T10:15:" } else { "the clock is not set" })?;
    let tests = image.tests()?;
    let [.., before, again] = &tests[..] else { return Err("the card has no two parts".into()) };
    let same = again.part.id == before.part.id && again.part.number == before.part.number + 1;
    expect(same && again.samples.len() >= 32, format!("went on as {:?}", again.part))?;
    let time_lost = check_clock(&played, before, again, clock)?;
    let waited = reset_s - 6.0;
    let noticed = format!("reset after {waited:.1} s, said {said:.2} s later");
    let lost = format!("the half second that was not on the card yet, and {time_lost}");
    Ok(row(noticed, lost, format!("the test goes on, samples {tick:.1} s after the reset")))
}

/// Checks dates of both parts and the number of missing samples of the second, or that these are
/// unknown where the clock was lost. Returns the loss of time as text.
fn check_clock(played: &Played, before: &Test, again: &Test, clock: Clock) -> Result<String> {
    let ticks_s = &played.outcome.first_ticks_s;
    let time_s = |start: usize, index: u32| ticks_s[start] + f64::from(index) / 16.0;
    let began_s = time_s(0, before.part.first_index);
    let set_ms = Moment::parse(SET.0).ok_or("no moment")?.0 as f64;
    let start_ms = before.part.start_ms.ok_or("the test has no date")? as f64;
    let late_ms = start_ms - set_ms - 1000.0 * (began_s - SET.1);
    expect(late_ms.abs() < SET_MS, format!("the clock is {late_ms:.1} ms late"))?;
    let (gap, next_ms) = (again.part.gap, again.part.start_ms);
    if clock == Clock::Lost {
        expect(gap.is_none() && next_ms.is_none(), format!("invented: {:?}", again.part))?;
        return Ok("the time without samples, how long is unknown; the clock".into());
    }
    let next_s = time_s(1, again.part.first_index);
    let next_ms = next_ms.ok_or("the clock was lost")? as f64;
    let late_ms = next_ms - start_ms - 1000.0 * (next_s - began_s);
    expect(late_ms.abs() < CALENDAR_MS, format!("the calendar is {late_ms:.1} ms late"))?;
    let last = before.samples.last().ok_or("an empty part")?.index;
    let missing = (16.0 * (next_s - time_s(0, last))).round() as u32 - 1;
    expect(gap == Some(missing), format!("{gap:?} samples lost, not {missing}"))?;
    Ok(format!("the time without samples: {missing} in all, counted"))
}
