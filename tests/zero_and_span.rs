//! Zero, span and self-test on the console: messages on a swinging load, on a cell that is
//! reversed, overloaded or hardly used, and on a board whose clock is not set.

use floe::chip::{LoadCell, Schedule, Trouble};
use floe_firmware::line::Line;
use floe_tests::day::{NOISE, SPAN, codes, swinging};
use floe_tests::scripted::{Card, Session, run};

fn cell(forces_n: impl IntoIterator<Item = f64>, span: f64) -> LoadCell {
    LoadCell::from_codes(&codes(forces_n, span), 16.0).with_noise(NOISE.0, NOISE.1)
}

fn says(forces_n: Vec<f64>, span: f64, script: &[(u64, &str)]) -> Session {
    run(cell(forces_n, span), Schedule::default(), &Card::default(), script)
}

#[test]
fn a_swinging_tare_is_not_taken() {
    let board = says(swinging(30.0), SPAN, &[(1, "tare\n"), (300, "accept\n"), (301, "status\n")]);
    assert!(board.says("it swings: nothing may hang there"), "{}", board.screen);
    assert_eq!(board.last_settings().config.calibration.tare_counts, 0);
}

#[test]
fn a_tare_with_the_block_on_asks() {
    let board = says(vec![630.0; 400], SPAN, &[(1, "tare\n"), (200, "abort\n"), (201, "status\n")]);
    assert!(board.says("DOES ANYTHING HANG THERE?: accept, or abort"), "{}", board.screen);
    assert_eq!(board.last_settings().config.calibration.tare_counts, 0);
}

const CALIBRATE: [(u64, &str); 6] = [
    (0, "set tare 12345\n"),
    (1, "set range 5000\n"),
    (2, "calibrate 630\n"),
    (500, "accept\n"),
    (501, "status\n"),
    (502, ""),
];

#[test]
fn a_swinging_calibration_takes_the_excess_off() {
    let board = says(swinging(40.0), SPAN, &CALIBRATE);
    assert!(board.says("swing 4.") || board.says("swing 5."), "{}", board.screen);
    let span = f64::from(board.last_settings().config.calibration.counts_per_n);
    // A weighing is accurate to a fiftieth of a percent; the excess is a fifth of one.
    assert!((span / SPAN - 1.0).abs() < 6e-4, "{span}");
}

/// The converter still has range where the cell has none.
#[test]
fn a_block_beyond_the_cells_range_is_said() {
    let script = [(0, "set tare 12345\nset range 600\nweigh\n"), (200, "accept\n"), (201, "")];
    let board = says(vec![630.0; 400], SPAN, &script);
    assert!(board.says(",out-of-range*"), "{}", board.screen);
    assert!(board.says("OUT OF RANGE: overloaded, or a wire is off"), "{}", board.screen);
}

#[test]
fn a_reversed_cell_is_said() {
    let board = says(vec![630.0; 600], -SPAN, &CALIBRATE);
    assert!(board.says("REVERSED: the reading falls under load"), "{}", board.screen);
    let reads_below =
        says(vec![630.0; 200], -SPAN, &[(0, "set tare 12345\nself-test\n"), (90, "")]);
    assert!(reads_below.says("below zero"), "{}", reads_below.screen);
    assert!(reads_below.says("self test FAILED"), "{}", reads_below.screen);
}

#[test]
fn a_little_of_the_range_is_said() {
    let script =
        [(0, "set tare 12345\n"), (1, "set range 5000\n"), (2, "calibrate 100\n"), (200, "")];
    let board = says(vec![100.0; 300], SPAN, &script);
    assert!(board.says("LITTLE OF THE RANGE: hang more"), "{}", board.screen);
}

#[test]
fn an_overloaded_cell_is_said() {
    let board = says(vec![25_000.0; 300], SPAN, &[(0, "weigh\n"), (200, "accept\n"), (201, "")]);
    assert!(board.says("out-of-range"), "{}", board.screen);
    assert!(board.says("OUT OF RANGE: overloaded, or a wire is off"), "{}", board.screen);
}

/// Two known weights: the span is fitted to both, and a disagreement is reported.
#[test]
fn two_weights_make_one_span() {
    let steps = |second_n: f64| {
        let mut forces_n = vec![500.0; 186];
        forces_n.resize(500, second_n);
        forces_n
    };
    let script = [
        (0, "set tare 12345\nset span 400\n"),
        (1, "calibrate 500\n"),
        (200, "calibrate 1000\n"),
        (360, "accept\n"),
        (361, "status\n"),
    ];
    let good = says(steps(1000.0), SPAN, &script);
    let span = f64::from(good.last_settings().config.calibration.counts_per_n);
    assert!((span / SPAN - 1.0).abs() < 1e-4, "{span}: {}", good.screen);
    let bad = says(steps(1050.0), SPAN, &script);
    assert!(bad.says("THE WEIGHTS DISAGREE"), "{}", bad.screen);
}

/// Half the codes per newton, or kilograms typed for newtons, cause a question before they are
/// accepted.
#[test]
fn another_cell_asks() {
    let script = [
        (0, "set tare 12345\nset span 429.5\nset range 5000\n"),
        (2, "calibrate 64.2\n"),
        (200, "abort\n"),
        (201, "status\n"),
        (202, ""),
    ];
    let board = says(vec![630.0; 400], SPAN, &script);
    assert!(board.says("NOT THE SAME CELL as before?"), "{}", board.screen);
    let span = f64::from(board.last_settings().config.calibration.counts_per_n);
    assert!((span / SPAN - 1.0).abs() < 1e-4, "abort left {span}");
}

#[test]
fn a_self_test_tells_the_load_and_fails_when_a_fault_was_counted() {
    let script = [(0, "set tare 12345\nset range 5000\n"), (1, "self-test\n"), (110, "")];
    let little = says(vec![100.0; 200], SPAN, &script);
    assert!(little.says("load 2.0 % of the range"), "{}", little.screen);
    assert!(little.says("self test passed"), "{}", little.screen);
    let once = Schedule::default().with(60, 61, Trouble::Silent);
    let faulty = run(cell(vec![100.0; 200], SPAN), once, &Card::default(), &script);
    assert!(faulty.says("the converter owed readings"), "{}", faulty.screen);
    assert!(faulty.says("self test FAILED"), "{}", faulty.screen);
    let overloaded = says(vec![25_000.0; 200], SPAN, &script);
    assert!(overloaded.says("the load cell reads full scale"), "{}", overloaded.screen);
    assert!(overloaded.says("self test FAILED"), "{}", overloaded.screen);
}

#[test]
fn a_clock_that_is_not_set_is_said_and_no_time_invented() {
    let script = [(1, "clock\n"), (2, "set weight 630\n"), (3, "start test\n"), (40, "stop\n")];
    let board = says(vec![100.0; 60], SPAN, &script);
    assert!(board.says("the clock is not set: clock 20"), "{}", board.screen);
    assert!(board.says("the clock is not set: this test has no date"), "{}", board.screen);
    assert!(!board.lines().any(|line| matches!(line, Line::Sync { .. })), "{}", board.screen);
}
