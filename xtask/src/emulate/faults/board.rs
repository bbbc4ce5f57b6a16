//! What can happen to the board, the converter and the display.

use floe::chip::{Schedule, Trouble};
use floe_board_model::run::{Incident, Setup};

use super::{Bench, Row, at, events, expect, health, last_said, row, said, test, troubles, typed};
use crate::Result;
use crate::emulate::card::Image;
use crate::emulate::nucleo::card;

const SPI2: u32 = 0x4000_3800;
/// A converter's trouble, in samples of the load cell.
const FROM: u64 = 160;
const LENGTH: u64 = 20;
/// A test goes on within, s after the first tick.
const GOES_ON_S: f64 = 1.0;

pub(super) fn no_crystal(bench: &Bench<'_>) -> Result<Row> {
    let script = vec![
        typed(7.0, "set weight 630"),
        typed(7.1, "set span 5000"),
        typed(7.2, "start"),
        typed(27.0, "stop"),
    ];
    let setup = Setup { crystal_start_s: None, ..bench.setup(28.0, script) };
    let played = bench.play_well(&setup)?;
    let noticed = said(&played, "the crystal does not run")?;
    let events = events(&played);
    expect(events >= 5, format!("{events} events"))?;
    let noticed = format!("after {noticed:.1} s, and in every test");
    let lost = "nothing from then on; the rate is off by up to 2 %";
    Ok(row(noticed, lost, "at the next start with a crystal"))
}

pub(super) fn silent(bench: &Bench<'_>) -> Result<Row> {
    converter(bench, Trouble::Silent)
}

pub(super) fn late(bench: &Bench<'_>) -> Result<Row> {
    converter(bench, Trouble::Slow { ns: 80_000_000 })
}

pub(super) fn frozen(bench: &Bench<'_>) -> Result<Row> {
    converter(bench, Trouble::Frozen)
}

fn converter(bench: &Bench<'_>, trouble: Trouble) -> Result<Row> {
    let mut script = test();
    script.push(typed(20.0, "stop"));
    let troubles = Schedule::default().with(FROM, FROM + LENGTH, trouble);
    let setup = Setup { troubles, ..bench.setup(21.0, script) };
    let played = bench.play_well(&setup)?;
    let first_tick = played.outcome.first_ticks_s.first().copied().unwrap_or(0.0);
    let noticed = said(&played, "converter at sample")? - first_tick - FROM as f64 / 16.0;
    let health = health(&played)?;
    let bad = u64::from(health.adc_faults);
    // The ones before and after may be lost too.
    let good = bad + 1 >= LENGTH && bad <= LENGTH + 2 && health.overruns == 0;
    expect(good, format!("{health:?}"))?;
    let noticed = format!("after {noticed:.2} s, what it did");
    Ok(row(noticed, format!("{bad} samples"), "with the next sample"))
}

pub(super) fn bus_held(bench: &Bench<'_>) -> Result<Row> {
    let mut script = test();
    script.extend([at(10.0, Incident::HoldBus(2.0)), typed(20.0, "stop")]);
    let played = bench.play_well(&bench.setup(21.0, script))?;
    let noticed = said(&played, "converter at sample")? - 10.0;
    let health = health(&played)?;
    let bad = health.adc_faults;
    // 32 samples are held down; the ones before and after may be lost too.
    expect((30..=36).contains(&bad) && health.overruns == 0, format!("{health:?}"))?;
    Ok(row(format!("after {noticed:.2} s"), format!("{bad} samples"), "with the next sample"))
}

pub(super) fn bus_stuck(bench: &Bench<'_>) -> Result<Row> {
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
    let lost = format!("at most {worst} sample");
    Ok(row("with the sample", lost, "with the next sample: freed by clocks"))
}

pub(super) fn no_display(bench: &Bench<'_>) -> Result<Row> {
    let mut script = test();
    script.push(typed(9.0, "stop"));
    let setup = Setup { display: false, ..bench.setup(10.0, script) };
    let health = health(&bench.play_well(&setup)?)?;
    expect(health.adc_faults == 0 && health.overruns == 0, format!("{health:?}"))?;
    Ok(row("it is dark", "nothing", "at the next start with a display"))
}

/// The reset that an incident at second 6 leads to: what the board says about it, and
/// the test goes on.
fn restarts(bench: &Bench<'_>, incident: Incident, cause: &str, words: &str) -> Result<Row> {
    let image = Image::large("restart")?;
    let mut script = test();
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
    let tests = image.tests()?;
    let [.., before, again] = &tests[..] else { return Err("the card has no two parts".into()) };
    let same = again.part.id == before.part.id && again.part.number == before.part.number + 1;
    expect(same && again.samples.len() >= 32, format!("went on as {:?}", again.part))?;
    let waited = reset_s - 6.0;
    let noticed = format!("reset after {waited:.1} s, said {said:.2} s later");
    let lost = "the half second that was not on the card yet, and the time without samples";
    Ok(row(noticed, lost, format!("the test goes on, samples {tick:.1} s after the reset")))
}

pub(super) fn hung(bench: &Bench<'_>) -> Result<Row> {
    restarts(bench, Incident::StopClock, "the watchdog", "restarted after: the watchdog")
}

pub(super) fn fault(bench: &Bench<'_>) -> Result<Row> {
    restarts(bench, Incident::FailAccess(SPI2), "the program", "restarted after: a fault at 0x")
}

pub(super) fn brown_out(bench: &Bench<'_>) -> Result<Row> {
    restarts(bench, Incident::CutPower, "the power", "floe, help lists the commands")
}

pub(super) fn typed_fast(bench: &Bench<'_>) -> Result<Row> {
    // Longer than a tick, through pictures and conversions.
    let script = (0..40).map(|n| {
        typed(3.0 + 0.3 * f64::from(n) + 0.0031 * f64::from(n), "set name A-name-of-16-chr")
    });
    let script: Vec<_> = script.collect();
    let played = bench.play_well(&bench.setup(16.0, script))?;
    let answers = played.shown.lines().filter(|line| line.starts_with("T,")).count();
    expect(answers == 40, format!("{answers} of 40 lines were understood"))?;
    Ok(row("-", "nothing", "-"))
}
