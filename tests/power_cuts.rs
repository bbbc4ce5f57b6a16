//! Power cuts at random bytes written to a card, with the real file system code: no older data are
//! lost, no wrong data are read, and the logger resumes.
//!
//! `FLOE_POWER_CUTS=10000` sets the number of cuts.

use std::io::{Cursor, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use floe::card::{self, Test};
use floe_core::{Counts, Event, Pipeline};
use floe_firmware::card::CardLog;
use floe_firmware::line::Line;
use floe_tests::board::{last_settings, with_board};
use floe_tests::fat::{Rest, SimCard, formatted, partition};
use floe_tests::fuzz::Dice;
use floe_tests::records::stick_slip;
use floe_tests::{in_ci, number};

/// Length of the log, sectors: 512 KiB, eight minutes.
const LOG_SECTORS: u32 = 1024;
/// Samples in a test without a cut.
const WHOLE: u32 = 400;
const BEGIN: &str = "set weight 630\nset span 5000\nlive off\nstart\n";

/// Switches the board on, types, and runs it for `ticks` ticks or until its power fails; returns
/// the number of samples taken.
fn run(card: &SimCard, typed: &str, codes: &[i32], ticks: u32) -> u32 {
    run_with(CardLog::new(card.clone(), LOG_SECTORS), card, typed, codes, ticks)
}

/// Runs a board as `run` does, with a log file extended in 64 steps.
fn run_new(card: &SimCard, typed: &str, codes: &[i32], ticks: u32) -> u32 {
    let log = CardLog::new(card.clone(), LOG_SECTORS).in_steps_of(LOG_SECTORS / 64);
    run_with(log, card, typed, codes, ticks)
}

fn run_with(log: CardLog<SimCard>, card: &SimCard, typed: &str, codes: &[i32], ticks: u32) -> u32 {
    with_board(log, codes, |board| {
        board.type_in(typed.as_bytes());
        for tick in 0..ticks {
            if card.is_dead() {
                return tick.saturating_sub(1);
            }
            board.tick();
        }
        ticks.saturating_sub(1)
    })
}

fn tests(card: &SimCard) -> Vec<Test> {
    card::tests(Cursor::new(card.content())).map(|(tests, _)| tests).unwrap_or_default()
}

/// Checks every code against the measured one.
fn assert_true(test: &Test, codes: &[i32]) {
    for sample in &test.samples {
        let expected = codes[sample.index as usize % codes.len()];
        assert_eq!(sample.reading, Ok(Counts(expected)), "{sample:?}");
    }
}

/// A card with one complete test.
fn used_card(codes: &[i32]) -> Vec<u8> {
    let card = SimCard::new(formatted());
    run(&card, BEGIN, codes, WHOLE + 1);
    run(&card, "stop\n", codes, 0);
    card.content()
}

/// The file system checker; without it its checks are skipped, except in CI.
fn fsck() -> Option<PathBuf> {
    let places = ["/usr/sbin/fsck.fat", "/sbin/fsck.fat"].map(PathBuf::from);
    let found = places.into_iter().find(|place| place.exists());
    assert!(found.is_some() || !in_ci(), "no fsck.fat: install dosfstools");
    found
}

/// Whether the file system is clean.
fn is_clean(fsck: &Path, place: &Path, card: &SimCard) -> bool {
    let mut file = std::fs::File::create(place).expect("a file");
    file.write_all(partition(&card.content())).expect("room");
    checks(fsck, "-n", place)
}

fn checks(fsck: &Path, option: &str, place: &Path) -> bool {
    let mut command = Command::new(fsck);
    let checked = command.arg(option).arg(place).stdin(Stdio::null()).output().expect("runs");
    checked.status.success()
}

/// The tests on a card after a repair of the file system.
fn mended(fsck: &Path, place: &Path) -> Vec<Test> {
    checks(fsck, "-a", place);
    assert!(checks(fsck, "-n", place), "not mended");
    let file = std::fs::File::open(place).expect("there");
    card::tests(file).map(|(tests, _)| tests).unwrap_or_default()
}

#[test]
fn nothing_is_lost_but_the_last_half_second() {
    let cuts = number("FLOE_POWER_CUTS", 300.0) as u64;
    let codes = stick_slip(WHOLE);
    let used = used_card(&codes);
    let place = std::env::temp_dir().join(format!("floe-cuts-{}.img", std::process::id()));
    let fsck = fsck();
    let (mut worst, mut dirty, mut checked, mut resumed) = (0, 0, 0, 0);
    for number in 0..cuts {
        let dice = &mut Dice::new(number);
        let card = SimCard::new(used.clone());
        let rest = *dice.pick(&[Rest::Old, Rest::Erased, Rest::Noise]);
        card.cut_after(dice.below(40 * 512) as u64, rest);
        let taken = run(&card, BEGIN, &codes, 2 * WHOLE);
        assert!(card.is_dead(), "cut {number} came too late");
        card.revive();

        let found = tests(&card);
        assert_eq!(found[0].samples.len(), WHOLE as usize, "cut {number}: the older test");
        let kept = found.get(1).map_or(0, |test| test.samples.len() as u32);
        worst = worst.max(taken - kept);
        if let Some(fsck) = &fsck {
            dirty += u32::from(!is_clean(fsck, &place, &card));
            checked += 1;
        }

        // After the power returns, a test that had begun is resumed.
        let before = found.get(1).map(|test| test.part);
        run(&card, "", &codes, 100);
        let found = tests(&card);
        for test in &found {
            assert_true(test, &codes);
        }
        if let (Some(before), Some(after)) = (before, found.get(2)) {
            assert_eq!((after.part.id, after.part.number), (before.id, 1), "cut {number}");
            assert_eq!(after.samples.len(), 96, "cut {number}");
            resumed += 1;
        }
    }
    let _ = std::fs::remove_file(&place);
    println!(
        "{cuts} power cuts: at most {worst} samples lost ({} ms), {resumed} tests went on, \
         {checked} file systems checked, {dirty} of them not clean",
        f64::from(worst) * 62.5
    );
    assert!(worst <= 8 && dirty == 0 && resumed * 10 >= cuts * 9);
    assert!(checked == cuts || !in_ci(), "{checked} of {cuts} file systems checked");
}

/// The estimate starts again after a restart: a replay of the resumed part gives the board's events
/// bit for bit.
#[test]
fn a_part_that_went_on_is_replayed_to_the_boards_events() {
    let codes = stick_slip(WHOLE);
    let card = SimCard::new(formatted());
    run(&card, BEGIN, &codes, WHOLE);
    let said = with_board(CardLog::new(card.clone(), LOG_SECTORS), &codes, |board| {
        (0..2 * WHOLE).for_each(|_| board.tick());
        board.type_in(b"stop\n");
        board.said()
    });
    let is_event = |line: &&str| line.starts_with("E,");
    let board: Vec<String> = said.lines().filter(is_event).map(String::from).collect();

    let found = tests(&card);
    let [_, part] = &found[..] else { panic!("{} parts on the card", found.len()) };
    assert_eq!((part.part.number, part.missing()), (1, 0));
    let mut pipeline = Pipeline::new(&part.settings.core_config()).expect("the board's own");
    let raw = part.samples.iter().map(|sample| sample.raw(part.part.first_index));
    let mut events: Vec<Event> = raw.filter_map(|raw| pipeline.step(raw).event).collect();
    events.extend(std::iter::from_fn(|| pipeline.finish()));
    let text = |event| Line::Event(event).to_text().expect("room").to_string();
    assert!(board.len() > 20, "{} events", board.len());
    assert_eq!(events.into_iter().map(text).collect::<Vec<_>>(), board);
}

/// The weight in the settings of a board after it was switched on.
fn settings(card: &SimCard, codes: &[i32]) -> f32 {
    with_board(CardLog::new(card.clone(), LOG_SECTORS), codes, |board| {
        board.type_in(b"status\n");
        last_settings(&board.said()).config.weight_n
    })
}

/// Saving settings, cut at any byte, leaves the old settings or the new ones.
#[test]
fn settings_are_the_old_or_the_new() {
    let codes = stick_slip(WHOLE);
    let used = used_card(&codes);
    let (mut old, mut new) = (0, 0);
    for cut in 0..=512 {
        for rest in [Rest::Old, Rest::Erased, Rest::Noise] {
            let card = SimCard::new(used.clone());
            card.cut_after(cut, rest);
            run(&card, "set weight 700\n", &codes, 0);
            card.revive();
            match settings(&card, &codes) {
                630.0 => old += 1,
                700.0 => new += 1,
                other => panic!("cut at byte {cut}: {other} N"),
            }
            // The settings can be changed again.
            run(&card, "set weight 800\n", &codes, 0);
            assert_eq!(settings(&card, &codes).to_bits(), 800.0_f32.to_bits(), "byte {cut}");
        }
    }
    println!("settings: {old} saves cut left the old ones, {new} the new ones");
    assert!(old > 1500 && new > 0);
}

/// The log file of a new card is extended during a test, and the power is cut. If the card writes
/// sectors completely or not at all, the extension continues; unused clusters may remain until a
/// check frees them and leaves the log unchanged. If a sector of the file system is torn, the file
/// may be lost, but no wrong data are read.
#[test]
fn a_new_card_that_is_cut_is_made_on() {
    const CUTS: u64 = 100;
    // Bytes written in the first 37 of 64 steps.
    const BYTES: usize = 600 * 512;
    let codes = stick_slip(WHOLE);
    let place = std::env::temp_dir().join(format!("floe-new-{}.img", std::process::id()));
    let fsck = fsck();
    for rest in [Rest::Old, Rest::Erased, Rest::Noise] {
        let (mut worst, mut lost, mut dirty) = (0, 0, 0);
        for number in 0..CUTS {
            let card = SimCard::new(formatted());
            card.cut_after(Dice::new(number).below(BYTES) as u64, rest);
            let taken = run_new(&card, BEGIN, &codes, WHOLE);
            assert!(card.is_dead(), "cut {number} came too late");
            card.revive();
            let kept = tests(&card).first().map_or(0, |test| test.samples.len() as u32);
            worst = worst.max(taken.saturating_sub(kept));

            // The file is extended during the test, and then complete.
            run_new(&card, "", &codes, WHOLE);
            run_new(&card, "stop\n", &codes, 0);
            run_new(&card, BEGIN, &codes, WHOLE + 1);
            run_new(&card, "stop\n", &codes, 0);
            let found = tests(&card);
            found.iter().for_each(|test| assert_true(test, &codes));
            let last = found.last().map_or(0, |test| test.samples.len() as u32);
            lost += u32::from(last != WHOLE);
            if let Some(fsck) = fsck.as_ref().filter(|fsck| !is_clean(fsck, &place, &card)) {
                dirty += 1;
                if rest == Rest::Old {
                    let samples = |test: &Test| test.samples.clone();
                    let mended: Vec<_> = mended(fsck, &place).iter().map(samples).collect();
                    assert_eq!(mended, found.iter().map(samples).collect::<Vec<_>>());
                }
            }
        }
        println!(
            "{CUTS} cuts of a new card, {rest:?}: at most {worst} samples lost, then {lost} \
             cards not used, {dirty} not clean"
        );
        assert!(worst <= 8);
        assert!(rest != Rest::Old || lost == 0, "{lost} not used");
        assert!(lost * 4 < CUTS as u32, "{lost} not used");
        // The mended ones are compared only where some were not clean.
        assert!(dirty > 0 || fsck.is_none(), "every card was clean");
    }
    let _ = std::fs::remove_file(&place);
}
