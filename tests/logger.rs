//! The whole logger on a PC: converter model, sampler, application and card, and reading the card's
//! tests.

use std::io::Cursor;

use floe::card;
use floe::chip::{LoadCell, Schedule, Trouble};
use floe::log::{Log, LogOptions};
use floe_core::{Config, Counts, Event, Pipeline, RawSample, Reading};
use floe_firmware::line::{Line, LineError};
use floe_firmware::notebook::WeightFrom;
use floe_firmware::record::{Record, SECTOR_LEN, SECTOR_SAMPLES};
use floe_firmware::wall_clock::Moment;
use floe_tests::records::stick_slip;
use floe_tests::scripted::{Card, Session, run};

fn cell(codes: &[i32]) -> LoadCell {
    LoadCell::from_codes(codes, 16.0).with_noise(12.0, 5)
}

const BEGIN: &str = "set weight 630\r\nset span 5000\r\nset name T-1\r\nlive off\r\nstart\r\n";

fn one_test(card: &Card) -> Session {
    run(cell(&stick_slip(960)), Schedule::default(), card, &[(0, BEGIN), (961, "stop\n")])
}

fn config() -> Config {
    let mut config = Config { weight_n: 630.0, ..Config::default() };
    config.calibration.counts_per_n = 5000.0;
    config
}

fn events_of(samples: impl Iterator<Item = RawSample>) -> Vec<Event> {
    let mut pipeline = Pipeline::new(&config()).expect("valid");
    let mut events: Vec<Event> = samples.filter_map(|s| pipeline.step(s).event).collect();
    while let Some(event) = pipeline.finish() {
        events.push(event);
    }
    events
}

#[test]
fn events_on_the_console_are_the_cores() {
    let board = one_test(&Card::default());
    let samples = board.delivered.iter().take(960);
    let raw = |&(index, code): &(u64, i32)| RawSample {
        index: index.try_into().unwrap(),
        reading: Reading::Counts(Counts(code)),
    };
    let expected = events_of(samples.map(raw));
    assert!(expected.len() > 20, "{}", expected.len());
    assert_eq!(board.events(), expected);
}

#[test]
fn the_card_gives_the_test_back() {
    let card = Card::default();
    let board = one_test(&card);
    let bytes = card.bytes.borrow().clone();
    let (tests, found) = card::tests(Cursor::new(bytes.clone())).expect("readable");
    assert_eq!((found.damaged, found.lost), (0, 0));
    let [test] = tests.as_slice() else { panic!("{} tests", tests.len()) };
    assert_eq!((test.samples.len(), test.missing(), test.overruns), (960, 0, 0));
    assert_eq!(test.stem, "test-0001-T-1");
    assert_eq!(test.settings.config, config());
    // The card also has the lines, including every event.
    let events = test.lines.lines().filter(|line| line.starts_with("E,")).count();
    assert_eq!(events, board.events().len());

    // `floe replay` reads the file and its CSV with the same events as the board's.
    for text in [bytes, card::csv(test).into_bytes()] {
        let options = if text.starts_with(b"FLOE") {
            LogOptions::default()
        } else {
            let unit = Some(floe::log::Unit::Counts);
            LogOptions { column: Some("counts".into()), unit, ..LogOptions::default() }
        };
        let mut log = Log::from_reader(Box::new(Cursor::new(text)), &options).expect("a log");
        assert_eq!(log.metadata().weight_n, Some(630.0));
        let mut samples = Vec::new();
        while let Some(sample) = log.next_sample().expect("a sample") {
            samples.push(sample.raw);
        }
        assert_eq!(events_of(samples.into_iter()), board.events());
    }
}

#[test]
fn a_pulled_battery_costs_at_most_half_a_second() {
    let card = Card::default();
    one_test(&card);
    let bytes = card.bytes.borrow().clone();
    // Sectors with settings or text only contain no samples.
    let in_sector = |sector: &[u8]| {
        let record = Record::decode(sector.try_into().expect("whole")).expect("a record");
        record.samples.len()
    };
    let held: Vec<usize> = bytes.chunks_exact(SECTOR_LEN).map(in_sector).collect();
    for cut in (0..bytes.len()).step_by(123) {
        // No test is read before the first sector is complete.
        let read = card::tests(Cursor::new(&bytes[..cut])).map_or(0, |(tests, found)| {
            assert_eq!(found.damaged, 0);
            tests.iter().map(|test| test.samples.len()).sum()
        });
        // Samples for the sector in progress have been taken too.
        let taken: usize = held[..cut.div_ceil(SECTOR_LEN)].iter().sum();
        assert!(read + SECTOR_SAMPLES >= taken, "{read} of {taken} samples, cut at byte {cut}");
    }
}

#[test]
fn a_damaged_sector_costs_itself() {
    let card = Card::default();
    one_test(&card);
    let clean = card.bytes.borrow().clone();
    for sector in [20, 57, 100] {
        for bit in [32 + 3, 8 * 90, 8 * 200 + 7, 8 * 511] {
            let mut bytes = clean.clone();
            bytes[sector * SECTOR_LEN + bit / 8] ^= 1 << (bit % 8);
            let (tests, found) = card::tests(Cursor::new(bytes)).expect("readable");
            assert_eq!((found.damaged, found.lost), (1, 1), "sector {sector} bit {bit}");
            assert_eq!((tests[0].samples.len(), tests[0].missing()), (952, 8));
        }
    }
}

#[test]
fn any_line_end_will_do() {
    for end in ["\r", "\n", "\r\n", "\n\r\n"] {
        let typed = BEGIN.replace("\r\n", end);
        let board = run(
            cell(&stick_slip(960)),
            Schedule::default(),
            &Card::default(),
            &[(0, &typed), (9, "")],
        );
        let starts = board.lines().filter(|line| matches!(line, Line::Start { .. })).count();
        // Three settings and the start.
        assert_eq!(starts, 4, "{end:?}: {}", board.screen);
        assert!(!board.screen.lines().any(|line| line.starts_with('!')), "{}", board.screen);
    }
}

#[test]
fn mistakes_are_told() {
    let long = "x".repeat(200);
    let script: Vec<(u64, String)> = ["start", "stop", "accept", "fly", "set weight -1", &long]
        .iter()
        .zip(0..)
        .map(|(text, tick)| (tick, format!("{text}\r\n")))
        .collect();
    let script: Vec<(u64, &str)> = script.iter().map(|(tick, text)| (*tick, &**text)).collect();
    let board = run(cell(&[0]), Schedule::default(), &Card::default(), &script);
    for words in [
        "set weight N, above 0",
        "no test is running",
        "nothing to accept",
        "unknown command",
        "too long",
    ] {
        assert!(board.says(words), "{words} not in {}", board.screen);
    }
}

/// Each of these commands was once accepted, and the sectors of the next test were unreadable.
#[test]
fn no_standard_deviation_is_below_zero_whether_the_core_is_told_it_or_not() {
    let script = [
        (0, "set weight-std -1\n"),
        (1, "set winch-std -0.001\n"),
        (2, "set weight-from same_cell\nset span-std -5\n"),
        (3, BEGIN),
        (200, "stop\n"),
    ];
    let card = Card::default();
    let board = run(cell(&stick_slip(220)), Schedule::default(), &card, &script);
    assert_eq!(board.screen.matches("not below zero").count(), 3, "{}", board.screen);
    let (tests, found) = card::tests(Cursor::new(card.bytes.borrow().clone())).expect("readable");
    assert_eq!((tests.len(), found.damaged), (1, 0));
}

/// The weight was measured with the previous span.
#[test]
fn another_span_does_not_cancel_in_a_weight() {
    let script =
        [(0, "set weight 300\nset weight-from same_cell\n"), (1, "set span 4500\nstatus\n")];
    let board = run(cell(&[0]), Schedule::default(), &Card::default(), &script);
    assert_eq!(board.last_settings().weight_from, Some(WeightFrom::Other));
}

/// A weight in newtons is that of the span with which it was measured.
#[test]
fn the_span_does_not_change_while_the_block_is_weighed() {
    let script = [
        (0, "set span 400\nweigh\n"),
        (150, "set span 500\n"),
        (151, "accept\n"),
        (152, "status\n"),
    ];
    let board = run(cell(&[400 * 300]), Schedule::default(), &Card::default(), &script);
    let config = board.last_settings().config;
    let codes = config.weight_n * config.calibration.counts_per_n;
    assert!((codes / 120_000.0 - 1.0).abs() < 1e-3, "{config:?}");
}

/// A reset keeps the calendar, so the samples that it costs are counted.
#[test]
fn a_clock_that_is_set_in_a_test_dates_it() {
    let card = Card::default();
    let script = [(0, BEGIN), (100, "clock 2027-03-02T10:15:00Z\n"), (400, "")];
    run(cell(&stick_slip(960)), Schedule::default(), &card, &script);
    let script = [(0, "clock 2027-03-02T10:15:30Z\n"), (200, "stop\n")];
    run(cell(&stick_slip(960)), Schedule::default(), &card, &script);
    let (tests, _) = card::tests(Cursor::new(card.bytes.borrow().clone())).expect("readable");
    let [first, second] = tests.as_slice() else { panic!("{} tests", tests.len()) };
    let start_ms = Moment::parse("2027-03-02T10:15:00Z").expect("a time").0 - 6250;
    let off = first.part.start_ms.expect("a date").abs_diff(start_ms);
    assert!(off < 125, "{off} ms");
    // The clock was set at sample 100; the last sample on the card is 399.
    let lost = 480 - (399 - 100);
    let gap = second.part.gap.expect("counted");
    assert!(gap.abs_diff(lost) <= 3, "{gap} {lost}");
}

#[test]
fn a_test_begins_after_a_measurement_and_ends_by_stop() {
    let script = [
        (0, "set weight 630\nset span 5000\nweigh\n"),
        (40, "start\n"),
        (41, "abort\nstart\n"),
        (80, "abort\n"),
    ];
    let board = run(cell(&stick_slip(100)), Schedule::default(), &Card::default(), &script);
    for words in ["accept or abort?", "aborted", "a test is running; stop ends it"] {
        assert_eq!(board.screen.matches(words).count(), 1, "{words} in {}", board.screen);
    }
}

#[test]
fn tare_and_calibration_survive_the_power() {
    let card = Card::default();
    let mut codes = vec![12_345; 180];
    codes.extend(vec![12_345 + 4_000 * 98; 180]);
    let script = [
        (1, "tare\n"),
        (150, "accept\n"),
        (184, "set span 4100\ncalibrate 98\n"),
        (340, "accept\n"),
        (341, "set weight 300\n"),
    ];
    let first = run(cell(&codes), Schedule::default(), &card, &script);
    assert!(first.says("accept, or abort"), "{}", first.screen);
    let again = run(cell(&codes), Schedule::default(), &card, &[(0, "status\n")]);
    let config = again.last_settings().config;
    assert!((config.calibration.tare_counts - 12_345).abs() < 10, "{config:?}");
    assert!((config.calibration.counts_per_n - 4_000.0).abs() < 0.2, "{config:?}");
    assert_eq!(config.weight_n.to_bits(), 300.0_f32.to_bits());
}

/// Without effects the board's events equal those of a core without, and the card records the
/// setting.
#[test]
fn what_the_core_looks_for_can_be_set() {
    let card = Card::default();
    let script = [(0, "set weight 630\nset effects none\n"), (1, "start\n"), (970, "stop\n")];
    let board = run(cell(&stick_slip(960)), Schedule::default(), &card, &script);
    let again = run(cell(&[0]), Schedule::default(), &card, &[(0, "status\n")]);
    let said = |board: &Session| {
        let effects = |line| {
            if let Line::Start { settings, .. } = line { settings.effects.enabled } else { None }
        };
        board.lines().filter_map(effects).last()
    };
    assert_eq!((said(&board), said(&again)), (Some(0), Some(0)));
    let with = one_test(&Card::default());
    assert!(board.events().len() > 20 && board.events() != with.events());
}

#[test]
fn runs_are_numbered_across_the_power() {
    let card = Card::default();
    one_test(&card);
    one_test(&card);
    let (tests, _) = card::tests(Cursor::new(card.bytes.borrow().clone())).expect("readable");
    let runs: Vec<(u32, usize)> = tests.iter().map(|t| (t.part.run, t.samples.len())).collect();
    assert_eq!(runs, [(1, 960), (2, 960)]);
}

#[test]
fn self_test() {
    let script = [(1, "self-test\n"), (120, "")];
    let good = run(cell(&stick_slip(960)), Schedule::default(), &Card::default(), &script);
    assert!(good.says("self test passed"), "{}", good.screen);
    let broken = cell(&stick_slip(960)).disconnected();
    let broken = run(broken, Schedule::default(), &Card::default(), &script);
    assert!(broken.says("a wire to the load cell is broken"), "{}", broken.screen);
    assert!(broken.says("self test FAILED"), "{}", broken.screen);
    let silent = Schedule::default().with(0, u64::MAX, Trouble::Silent);
    let silent = run(cell(&stick_slip(960)), silent, &Card::default(), &script);
    assert!(silent.says("does not answer"), "{}", silent.screen);
    assert!(!silent.says("% of the range"), "nothing was read: {}", silent.screen);
}

/// Samples of a test are counted from its first one, in every line.
#[test]
fn a_trouble_of_the_converter_is_at_a_sample_of_the_test() {
    let trouble = Schedule::default().with(150, 153, Trouble::Silent);
    let script = [(0, "set weight 630\nset span 5000\n"), (40, "start\n"), (200, "")];
    let card = Card::default();
    let board = run(cell(&stick_slip(960)), trouble, &card, &script);
    let missing = |line: Line<'_>| if let Line::Sample(it) = line { Some(it) } else { None };
    let first = board.lines().filter_map(missing).find(|it| it.force_n.is_none());
    let said = format!("converter at sample {}: ", first.expect("a missing sample").index);
    assert!(board.says(&said), "{said} not in {}", board.screen);
}

#[test]
fn a_card_that_refuses_is_told_and_costs_no_sample() {
    let card = Card::default();
    *card.broken.borrow_mut() = true;
    let board = one_test(&card);
    assert!(board.says("nothing is kept"), "{}", board.screen);
    assert!(board.events().len() > 20);
}

#[test]
fn a_damaged_line_is_refused() {
    let board = one_test(&Card::default());
    let line = board.screen.lines().find(|line| line.starts_with("E,")).expect("an event");
    for at in 0..line.len() {
        let mut bytes = line.as_bytes().to_vec();
        bytes[at] ^= 1;
        let damaged = String::from_utf8(bytes).expect("ASCII");
        assert!(Line::parse(&damaged).is_err(), "{damaged}");
        assert!(Line::parse(&line[..at]).is_err(), "{}", &line[..at]);
    }
    assert_eq!(Line::parse("I,hello"), Err(LineError::NoChecksum));
}
