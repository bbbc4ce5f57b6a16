//! Faults of the converter, the display and the crystal.

use floe::chip::{Schedule, Trouble};
use floe_board_model::run::{Incident, Setup};

use super::{Bench, Row, at, events, expect, health, row, said, test, typed};
use crate::Result;
/// First sample and length of a fault of the converter, in samples of the load cell.
const FROM: u64 = 160;
const LENGTH: u64 = 20;

pub(super) fn no_crystal(bench: &Bench<'_>) -> Result<Row> {
    let script = vec![
        typed(7.0, "set weight 630"),
        typed(7.1, "set span 5000"),
        typed(7.2, "start"),
        // The board's calendar stands still.
        typed(8.0, "clock 2027-03-02T10:15:00Z"),
        typed(27.0, "stop"),
    ];
    let setup = Setup { crystal_start_s: None, ..bench.setup(28.0, script) };
    let played = bench.play_well(&setup)?;
    let noticed = said(&played, "the crystal does not run")?;
    said(&played, "clock 2027-03-02T10:15:0")?;
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

pub(super) fn babbling(bench: &Bench<'_>) -> Result<Row> {
    converter(bench, Trouble::Babbling)
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
    // The samples before and after may be lost too.
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
    // The fault covers 32 samples; those before and after may be lost too.
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

pub(super) fn typed_often(bench: &Bench<'_>) -> Result<Row> {
    // A line of 2.3 ms every 303 ms: at varying times within a period, during pictures and
    // conversions.
    let script = (0..40).map(|n| {
        typed(3.0 + 0.3 * f64::from(n) + 0.0031 * f64::from(n), "set name A-name-of-16-chr")
    });
    let script: Vec<_> = script.collect();
    let played = bench.play_well(&bench.setup(16.0, script))?;
    let answers = played.shown.lines().filter(|line| line.starts_with("T,")).count();
    expect(answers == 40, format!("{answers} of 40 lines were understood"))?;
    Ok(row("-", "nothing", "-"))
}
