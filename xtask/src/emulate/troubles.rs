//! All faults of the converter, run through the whole firmware.

use std::ops::Range;

use floe::chip::{Schedule, Trouble};
use floe_core::SampleFlag;
use floe_firmware::line::Line;

use super::machine::{Machine, Setup};
use super::outcome;
use super::record::Record;
use crate::Result;
use crate::arm::Route;

/// Samples with the fault, of 960.
const TROUBLE: Range<u64> = 400..420;

/// Longest time until a fault is reported, samples.
const WITHIN: u64 = 2;

/// Runs a test with each fault. It must be reported within two samples and end within two samples
/// after its cause, without a reset of the board.
///
/// # Errors
/// The faults that were not handled.
pub fn check_troubles(route: Route) -> Result<()> {
    let machine = Machine::prepare(Some(route))?;
    let lasting = [
        ("silent", Trouble::Silent),
        ("late answers", Trouble::Late { ns: 10_000_000 }),
        ("slow conversions", Trouble::Slow { ns: 80_000_000 }),
        ("stuck", Trouble::Stuck),
        ("frozen", Trouble::Frozen),
        ("saturated", Trouble::Saturated),
        ("babbling", Trouble::Babbling),
    ];
    for (name, trouble) in lasting {
        check(&machine, name, trouble, TROUBLE.end)?;
    }
    let glitches = [
        ("brown-out", Trouble::BrownOut),
        ("register upset", Trouble::Upset { register: 3, mask: 0b100 }),
    ];
    for (name, trouble) in glitches {
        check(&machine, name, trouble, TROUBLE.start + 1)?;
    }
    Ok(())
}

fn check(machine: &Machine, name: &str, trouble: Trouble, end: u64) -> Result<()> {
    let schedule = Schedule::default().with(TROUBLE.start, end, trouble);
    let record = Record { trouble: schedule, ..Record::stick_slip() };
    let run = machine.run(&record, Setup { samples: true, ..Setup::default() })?;
    let outcome = outcome::decode(&run.shown)?;
    let bad: Vec<u64> = run.shown.lines().filter_map(bad_sample).collect();
    let stray = |i: &u64| *i + 2 < TROUBLE.start || *i > end.max(TROUBLE.start + WITHIN) + 2;
    let first = *bad.first().ok_or_else(|| format!("{name}: never noticed"))?;
    if first > TROUBLE.start + WITHIN {
        return Err(format!("{name}: noticed at sample {first}, {WITHIN} later are allowed"));
    }
    if let Some(stray) = bad.iter().find(|i| stray(i)) {
        return Err(format!("{name}: sample {stray} is bad long before or after"));
    }
    if outcome.events.iter().filter(|e| u64::from(e.onset.index) > end + 64).count() < 10 {
        return Err(format!("{name}: no events afterwards"));
    }
    let (count, shown) = (bad.len(), outcome.troubles.iter().find(|t| t.starts_with("converter")));
    let shown = shown.map_or("shown as saturated", String::as_str);
    println!("trouble: {name}: samples {first} on, {count} bad, then as before; {shown}");
    Ok(())
}

/// Index of a sample that the board reports as unusable.
fn bad_sample(line: &str) -> Option<u64> {
    match Line::parse(line) {
        Ok(Line::Sample(sample)) => match sample.flag {
            SampleFlag::Rejected | SampleFlag::Saturated => Some(sample.index.into()),
            SampleFlag::Good | SampleFlag::Spike | SampleFlag::Duplicate => None,
        },
        _ => None,
    }
}
