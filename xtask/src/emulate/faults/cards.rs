//! Faults of the card.

use floe_board_model::run::{CardSetup, Incident, Setup};

use super::{Bench, Row, at, events, expect, health, last_said, row, said, test, typed};
use crate::Result;
use crate::emulate::card::Image;
use crate::emulate::nucleo::card;

/// Longest time until a card that returns is written again, s.
const CARD_BACK_S: f64 = 5.0;
/// Sectors of the log's file.
const LOG_SECTORS: f64 = 196_608.0;

/// Makes a card with a name.
type Make = fn(&str) -> Result<Image>;

pub(super) fn none(bench: &Bench<'_>) -> Result<Row> {
    let mut script = test();
    script.push(typed(30.0, "stop"));
    let played = bench.play_well(&bench.setup(31.0, script))?;
    let health = health(&played)?;
    expect(health.overruns == 0 && health.adc_faults == 0, format!("{health:?}"))?;
    let noticed = said(&played, "no card")?;
    let events = events(&played);
    expect(events >= 10, format!("{events} events"))?;
    let first = played.outcome.line_times_s.first().copied().unwrap_or(0.0);
    let noticed = format!("first words after {first:.2} s, `no card` after {noticed:.2} s");
    Ok(row(noticed, "0 samples; nothing is kept", "works on, once a second asks for a card"))
}

pub(super) fn pulled(bench: &Bench<'_>) -> Result<Row> {
    let image = Image::large("pulled")?;
    let mut script = test();
    script.extend([at(10.0, Incident::PullCard), at(20.0, Incident::PutCard)]);
    script.push(typed(30.0, "stop"));
    let setup = Setup { card: Some(card(image.path())?), ..bench.setup(31.0, script) };
    let played = bench.play_well(&setup)?;
    let noticed = last_said(&played, "no card").filter(|&s| s > 10.0);
    let noticed = noticed.ok_or("never noticed")? - 10.0;
    let back = last_said(&played, "card found").filter(|&s| s > 20.0).ok_or("never back")? - 20.0;
    expect(back <= CARD_BACK_S, format!("back after {back:.1} s"))?;
    let health = health(&played)?;
    expect(health.overruns == 0, format!("{} samples lost", health.overruns))?;
    let kept = image.tests()?.last().map_or(0, |test| test.samples.len());
    // 27 s of a test, minus 10 s without a card, with a margin for detection and for both ends.
    expect(kept >= (27 - 10 - 6) * 16, format!("{kept} samples kept"))?;
    let noticed = format!("`no card` after {noticed:.1} s");
    let lost = "0 samples; what was measured meanwhile is not on the card";
    Ok(row(noticed, lost, format!("written to {back:.1} s after it is back")))
}

pub(super) fn late(bench: &Bench<'_>) -> Result<Row> {
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
    let a_second = f64::from(played.outcome.blocks_written) / (31.0 - 8.0 - found);
    let whole_min = LOG_SECTORS / a_second / 60.0;
    let noticed = format!("`card found` after {found:.1} s");
    let normal =
        format!("the test is kept from then on; the file is whole after {whole_min:.0} min");
    Ok(row(noticed, "0 samples; what was before is not on the card", normal))
}

pub(super) fn other_kinds(bench: &Bench<'_>) -> Result<Row> {
    let mut worst = 0.0_f64;
    let kinds: [(Make, &str); 4] = [
        (Image::exfat, "exFAT"),
        (Image::fat12, "FAT12"),
        (Image::empty, "no file system"),
        // FAT32 without a partition table is supported.
        (Image::without_table, "card found"),
    ];
    for (make, words) in kinds {
        let image = make("other")?;
        let setup = Setup { card: Some(card(image.path())?), ..bench.setup(4.0, Vec::new()) };
        worst = worst.max(said(&bench.play_well(&setup)?, words)?);
    }
    let noticed = format!("by name, {worst:.1} s after power-up");
    Ok(row(noticed, "0 samples; nothing is kept", "with a card of FAT16 or FAT32"))
}

pub(super) fn unreadable(bench: &Bench<'_>) -> Result<Row> {
    let image = Image::empty("unreadable")?;
    let unreadable = CardSetup { unreadable: true, ..card(image.path())? };
    let mut script = test();
    script.push(typed(9.0, "stop"));
    let setup = Setup { card: Some(unreadable), ..bench.setup(10.0, script) };
    let played = bench.play_well(&setup)?;
    let health = health(&played)?;
    expect(health.overruns == 0, format!("{health:?}"))?;
    let noticed = format!("`cannot be read` after {:.1} s", said(&played, "cannot be read")?);
    Ok(row(noticed, "0 samples; nothing is kept", "with another card"))
}
