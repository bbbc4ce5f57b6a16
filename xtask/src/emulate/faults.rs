//! Everything that can happen to the user's board, on the image that is flashed: when it
//! is noticed, what is lost, when all is as before.

use floe_board_model::run::{CardSetup, Incident, Setup, When};
use floe_firmware::line::Line;

use super::card::Image;
use super::nucleo::{Nucleo, Played, card};
use super::record::{NOISE, RATE_HZ, Record};
use crate::Result;
use crate::arm::Route;

/// First answer on the console after the power comes, s.
const FIRST_WORDS_S: f64 = 1.0;
/// First sample after the crystal has started, s.
const FIRST_TICK_S: f64 = 1.0;
/// A card that comes back is written to again within, s.
const CARD_BACK_S: f64 = 5.0;
/// The board gives up on a crystal after, s.
const NO_CRYSTAL_S: f64 = 6.0;

const SPI2: u32 = 0x4000_3800;

/// What happens, and what has to come of it: a sentence.
type Case = fn(&Bench<'_>) -> Result<String>;
/// Makes a card with a name.
type Make = fn(&str) -> Result<Image>;

/// What the cases run on.
struct Bench<'a> {
    nucleo: &'a Nucleo,
    codes: Vec<i32>,
}

/// Runs every case.
///
/// # Errors
/// Those that did not go as they have to.
pub fn check_faults(route: Route) -> Result<()> {
    let nucleo = Nucleo::prepare(Some(route))?;
    let (codes, _) = Record::stick_slip().played();
    let bench = Bench { nucleo: &nucleo, codes };
    let cases: [(&str, Case); 13] = [
        ("no card", no_card),
        ("card pulled and put back", card_pulled),
        ("card put in late, a new one", late_card),
        ("cards of other kinds", other_cards),
        ("card that cannot be read", unreadable_card),
        ("crystal that never starts", no_crystal),
        ("bus held down for 2 s", bus_held),
        ("bus held by a chip at any clock", bus_stuck),
        ("no display", no_display),
        ("main loop that hangs", hung),
        ("fault of the processor", fault),
        ("supply that fails", brown_out),
        ("typed without pauses", typed_fast),
    ];
    let mut failed = Vec::new();
    for (name, case) in cases {
        match case(&bench) {
            Ok(said) => println!("board: {name}: {said}"),
            Err(reason) => {
                println!("board: {name}: FAILED: {reason}");
                failed.push(format!("{name}: {reason}"));
            }
        }
    }
    if failed.is_empty() { Ok(()) } else { Err(failed.join("\n       ")) }
}

fn at(s: f64, what: Incident) -> (When, Incident) {
    (When::Seconds(s), what)
}

fn typed(s: f64, line: &str) -> (When, Incident) {
    at(s, Incident::Type(format!("{line}\r\n")))
}

/// A test from second 3 on.
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

    /// Runs; nothing forbidden may have been done.
    fn play(&self, setup: &Setup) -> Result<Played> {
        let played = self.nucleo.play(setup)?;
        let last: Vec<&str> = played.shown.lines().rev().take(4).collect();
        played.check().map_err(|e| format!("{e}; last words: {last:?}"))?;
        Ok(played)
    }

    /// Starts and samples in time, without a reset.
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

/// Last health on the console.
fn health(played: &Played) -> Result<floe_firmware::line::Health> {
    let mut healths = played.shown.lines().rev().filter_map(|line| match Line::parse(line) {
        Ok(Line::Health(health)) => Some(health),
        _ => None,
    });
    healths.next().ok_or_else(|| "no health was said".into())
}

fn no_card(bench: &Bench<'_>) -> Result<String> {
    let mut script = test();
    script.push(typed(30.0, "stop"));
    let played = bench.play_well(&bench.setup(31.0, script))?;
    let health = health(&played)?;
    expect(health.overruns == 0 && health.adc_faults == 0, format!("{health:?}"))?;
    let noticed = said(&played, "no card")?;
    let events = played.shown.lines().filter(|line| line.starts_with("E,")).count();
    expect(events >= 10, format!("{events} events"))?;
    let first = played.outcome.line_times_s.first().copied().unwrap_or(0.0);
    Ok(format!("first words after {first:.2} s, said after {noticed:.2} s, {events} events"))
}

fn card_pulled(bench: &Bench<'_>) -> Result<String> {
    let image = Image::large("pulled")?;
    let mut script = test();
    script.extend([at(10.0, Incident::PullCard), at(20.0, Incident::PutCard)]);
    script.push(typed(30.0, "stop"));
    let setup = Setup { card: Some(card(image.path())?), ..bench.setup(31.0, script) };
    let played = bench.play_well(&setup)?;
    let noticed = last_said(&played, "no card").filter(|&s| s > 10.0);
    let noticed = noticed.ok_or("never noticed")?;
    let back = last_said(&played, "card found").filter(|&s| s > 20.0).ok_or("never back")?;
    expect(back - 20.0 <= CARD_BACK_S, format!("back after {:.1} s", back - 20.0))?;
    let health = health(&played)?;
    expect(health.overruns == 0, format!("{} samples lost", health.overruns))?;
    let kept = image.tests()?.last().map_or(0, |test| test.samples.len());
    // 27 s of a test, 10 s of them without a card, and half a second at both ends.
    expect(kept >= (27 - 10 - 6) * 16, format!("{kept} samples kept"))?;
    let (noticed, back) = (noticed - 10.0, back - 20.0);
    Ok(format!("noticed after {noticed:.1} s, written again after {back:.1} s; 0 samples lost"))
}

fn last_said(played: &Played, words: &str) -> Option<f64> {
    let lines = played.shown.lines().zip(&played.outcome.line_times_s);
    lines.filter(|(line, _)| line.contains(words)).map(|(_, &s)| s).last()
}

fn late_card(bench: &Bench<'_>) -> Result<String> {
    let image = Image::large("late")?;
    let mut script = test();
    script.push(at(8.0, Incident::PutCard));
    script.push(typed(30.0, "stop"));
    let late = CardSetup { present: false, ..card(image.path())? };
    let setup = Setup { card: Some(late), ..bench.setup(31.0, script) };
    let played = bench.play_well(&setup)?;
    let found = said(&played, "card found")? - 8.0;
    expect(found <= CARD_BACK_S, format!("found after {found:.1} s"))?;
    let health = health(&played)?;
    expect(health.overruns == 0, format!("{} samples lost", health.overruns))?;
    let kept = image.tests()?.last().map_or(0, |test| test.samples.len());
    expect(kept >= (30 - 8 - 5) * 16, format!("{kept} samples kept"))?;
    let made = f64::from(played.outcome.blocks_written) / (31.0 - 8.0 - found);
    let whole_s = 131_072.0 / made;
    Ok(format!("written to after {found:.1} s; the log's file is whole after {whole_s:.0} s"))
}

fn other_cards(bench: &Bench<'_>) -> Result<String> {
    let mut named = Vec::new();
    let kinds: [(&str, Make, &str); 4] = [
        ("exFAT", Image::exfat, "exFAT"),
        ("FAT12", Image::fat12, "FAT12"),
        ("empty", Image::empty, "no file system"),
        ("FAT32 without a partition table", Image::without_table, "card found"),
    ];
    for (name, make, words) in kinds {
        let image = make("other")?;
        let setup = Setup { card: Some(card(image.path())?), ..bench.setup(4.0, Vec::new()) };
        let seconds = said(&bench.play_well(&setup)?, words)?;
        named.push(format!("{name} after {seconds:.1} s"));
    }
    Ok(named.join(", "))
}

fn unreadable_card(bench: &Bench<'_>) -> Result<String> {
    let image = Image::empty("unreadable")?;
    let unreadable = CardSetup { unreadable: true, ..card(image.path())? };
    let mut script = test();
    script.push(typed(9.0, "stop"));
    let setup = Setup { card: Some(unreadable), ..bench.setup(10.0, script) };
    let played = bench.play_well(&setup)?;
    let health = health(&played)?;
    expect(health.overruns == 0, format!("{health:?}"))?;
    Ok(format!("said after {:.1} s; 0 samples lost", said(&played, "cannot be read")?))
}

fn no_crystal(bench: &Bench<'_>) -> Result<String> {
    let script = vec![
        typed(7.0, "set weight 630"),
        typed(7.1, "set span 5000"),
        typed(7.2, "start"),
        typed(27.0, "stop"),
    ];
    let setup = Setup { crystal_start_s: None, ..bench.setup(28.0, script) };
    let played = bench.play_well(&setup)?;
    let noticed = said(&played, "the crystal does not run")?;
    let events = played.shown.lines().filter(|line| line.starts_with("E,")).count();
    expect(events >= 5, format!("{events} events"))?;
    Ok(format!("said after {noticed:.1} s, then {events} events by the internal oscillator"))
}

fn bus_held(bench: &Bench<'_>) -> Result<String> {
    let mut script = test();
    script.extend([at(10.0, Incident::HoldBus(2.0)), typed(20.0, "stop")]);
    let played = bench.play_well(&bench.setup(21.0, script))?;
    let noticed = said(&played, "converter at sample")? - 10.0;
    let health = health(&played)?;
    let bad = health.adc_faults;
    // 32 samples are held down; the ones before and after may be lost too.
    expect((30..=36).contains(&bad) && health.overruns == 0, format!("{health:?}"))?;
    Ok(format!("noticed after {noticed:.2} s; {bad} samples lost, then as before"))
}

fn bus_stuck(bench: &Bench<'_>) -> Result<String> {
    let mut worst = 0;
    for clocks in 1..=9_u32 {
        let mut script = test();
        let moment = 5.0 + 0.0731 * f64::from(clocks);
        script.push(at(moment, Incident::HoldBusForClocks(clocks)));
        script.push(typed(6.5, "stop"));
        let played = bench.play_well(&bench.setup(7.0, script))?;
        let bad = health(&played)?.adc_faults;
        expect(bad <= 2, format!("{clocks} clocks: {bad} samples lost"))?;
        worst = worst.max(bad);
    }
    Ok(format!("freed by clocks; at most {worst} samples lost"))
}

fn no_display(bench: &Bench<'_>) -> Result<String> {
    let mut script = test();
    script.push(typed(9.0, "stop"));
    let setup = Setup { display: false, ..bench.setup(10.0, script) };
    let health = health(&bench.play_well(&setup)?)?;
    expect(health.adc_faults == 0 && health.overruns == 0, format!("{health:?}"))?;
    Ok("0 samples lost".into())
}

/// What the board says after the reset that an incident at second 6 leads to.
fn restarts(bench: &Bench<'_>, incident: Incident, cause: &str, words: &str) -> Result<String> {
    let image = Image::large("restart")?;
    let mut script = test();
    script.push(at(6.0, incident));
    let setup = Setup { card: Some(card(image.path())?), ..bench.setup(20.0, script) };
    let played = bench.play(&setup)?;
    let resets = &played.outcome.resets;
    let [(reset_s, why)] = &resets[..] else { return Err(format!("resets: {resets:?}")) };
    expect(why == cause, format!("reset by {why}"))?;
    let said = last_said(&played, words).filter(|s| s > reset_s);
    let said =
        said.ok_or_else(|| format!("never said '{words}': {:?}", troubles(&played.shown)))?;
    let again = played.outcome.first_ticks_s.get(1).ok_or("never sampled again")?;
    let (after, said, again) = (reset_s - 6.0, said - reset_s, again - reset_s);
    Ok(format!("reset after {after:.1} s, said {said:.2} s later, sampling {again:.2} s later"))
}

fn hung(bench: &Bench<'_>) -> Result<String> {
    restarts(bench, Incident::StopClock, "the watchdog", "restarted after: the watchdog")
}

fn fault(bench: &Bench<'_>) -> Result<String> {
    restarts(bench, Incident::FailAccess(SPI2), "the program", "restarted after: a fault at 0x")
}

fn brown_out(bench: &Bench<'_>) -> Result<String> {
    restarts(bench, Incident::CutPower, "the power", "floe, help lists the commands")
}

fn typed_fast(bench: &Bench<'_>) -> Result<String> {
    // Longer than a tick, through pictures and conversions.
    let script = (0..40).map(|n| {
        typed(3.0 + 0.3 * f64::from(n) + 0.0031 * f64::from(n), "set name A-name-of-16-chr")
    });
    let script: Vec<_> = script.collect();
    let played = bench.play_well(&bench.setup(16.0, script))?;
    let answers = played.shown.lines().filter(|line| line.starts_with("T,")).count();
    expect(answers == 40, format!("{answers} of 40 lines were understood"))?;
    Ok("40 of 40 lines understood".into())
}
