//! Marks of the winch on the console: with them the board and every replay of its card know whether
//! the block moved during a constant force.

use std::io::Cursor;

use floe::card;
use floe::chip::{LoadCell, Schedule};
use floe::log::{Log, LogOptions, Unit};
use floe::replay::test::{TestOptions, configure};
use floe_core::{Stretch, StretchKind};
use floe_firmware::line::Line;
use floe_firmware::notebook::Winch;
use floe_tests::records::stick_slip;
use floe_tests::scripted::{Card, Session, run};

const BEGIN: &str = "set weight 630\r\nset span 5000\r\nlive off\r\nstart\r\n";
const HELD_AT: u64 = 600;
const TURNS_AT: u64 = 900;
const STOP: u64 = 1201;
/// Samples by which the end of a constant force may precede the mark: the force is followed second
/// by second.
const WITHIN: u32 = 32;

/// Slips for twenty seconds, then a force of 500 N, during which the winch is marked as held, then
/// as moving.
fn session(card: &Card) -> Session {
    let slips = stick_slip(320);
    let constant = (0..900).map(|i| 5000 * 500 + (i * 7919) % 8192);
    let codes: Vec<i32> = slips.into_iter().chain(constant).collect();
    let script =
        [(0, BEGIN), (HELD_AT, "winch held\n"), (TURNS_AT, "winch moving\n"), (STOP, "stop\n")];
    run(LoadCell::from_codes(&codes, 16.0).with_noise(12.0, 5), Schedule::default(), card, &script)
}

/// Ends of constant forces, in samples, and whether the block moved in them, as reported by the
/// board.
fn ends(board: &Session) -> Vec<(u32, Option<bool>)> {
    let end = |line| {
        let Line::Stretch(Stretch { stop, kind, .. }) = line else { return None };
        let StretchKind::Steady { moving, .. } = kind else { return None };
        Some((stop.index, moving))
    };
    board.lines().filter_map(end).collect()
}

#[test]
fn the_board_knows_whether_the_block_moved() {
    let board = session(&Card::default());
    let mark =
        |line| if let Line::Mark { index, winch } = line { Some((index, winch)) } else { None };
    let marks: Vec<(u32, Winch)> = board.lines().filter_map(mark).collect();
    let [(held, Winch::Held), (turns, Winch::Moving)] = marks.as_slice() else {
        panic!("{marks:?}")
    };
    assert!(held.abs_diff(HELD_AT as u32) < 4 && turns.abs_diff(TURNS_AT as u32) < 4, "{marks:?}");
    // The state of the winch is unknown before the first mark.
    let [(first, None), (second, Some(false)), (last, Some(true))] = ends(&board)[..] else {
        panic!("{:?}", ends(&board))
    };
    for (end, expected) in [(first, *held), (second, *turns), (last, STOP as u32)] {
        assert!((expected - WITHIN..=expected).contains(&end), "{end} {expected}");
    }
}

#[test]
fn a_replay_of_the_card_knows_as_much() {
    let card = Card::default();
    let board = session(&card);
    let of_board = ends(&board);
    let bytes = card.bytes.borrow().clone();
    let (tests, _) = card::tests(Cursor::new(bytes.clone())).expect("readable");
    let csv = card::csv(tests.first().expect("a test"));
    assert!(csv.contains("\n# winch_marks_s: held 37."), "{csv:.900}");
    let counts = LogOptions {
        column: Some("counts".into()),
        unit: Some(Unit::Counts),
        ..LogOptions::default()
    };
    for (text, options) in [(bytes, LogOptions::default()), (csv.into_bytes(), counts)] {
        let mut log = Log::from_reader(Box::new(Cursor::new(text)), &options).expect("a log");
        let config = configure(&log, &TestOptions::default()).expect("a configuration");
        let result = floe::replay::replay("card", &mut log, &config, |_, _| {});
        let steady = result.expect("a result").stretches.steady;
        let ends = steady.iter().map(|it| ((16.0 * it.stop_s).round() as u32, it.moving));
        assert_eq!(ends.collect::<Vec<_>>(), of_board);
    }
}

#[test]
fn only_a_test_has_marks_and_only_words_that_are_known() {
    let script = [(0, "winch held\n"), (3, "winch off\n")];
    let board =
        run(LoadCell::from_codes(&[0], 16.0), Schedule::default(), &Card::default(), &script);
    assert!(board.says("start a test first") && board.says("unknown command"));
}
