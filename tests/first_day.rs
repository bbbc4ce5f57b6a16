//! A first day on the ice, typed on the console of the whole logger: clock, self-test, zero,
//! weight, notes, a pull of 60 s, the zero again; then evaluation of the card. All places that show
//! the result show the same digits.
//!
//! The transcript is `docs/first-day.txt`; `FLOE_GOLDEN=write` writes it again, to be reviewed.

use std::io::Cursor;
use std::path::Path;
use std::{env, fs};

use floe::campaign::manifest::Entry;
use floe::campaign::summary::Summary;
use floe::campaign::{TestRecord, recorded};
use floe::card;
use floe::chip::{LoadCell, Schedule};
use floe::live;
use floe::log::{Log, LogOptions};
use floe::replay::budget::lines;
use floe::replay::result::ReplayResult;
use floe::replay::test::{TestOptions, configure};
use floe::replay::{replay, table};
use floe_core::Report;
use floe_firmware::display::rows;
use floe_firmware::line::Line;
use floe_firmware::notebook::{Kind, WeightFrom};
use floe_firmware::wall_clock::Moment;
use floe_tests::day::{DAY, LOOKED, MOVED_N, NOISE, SPAN, codes, day};
use floe_tests::scripted::{Card, Session, run};
use floe_tests::shown;

/// Input and output of the console, without samples and first answers.
fn transcript(board: &Session) -> String {
    let (mut text, mut said, mut left_out) = (String::new(), 0, 0);
    let mut show = |piece: &str, text: &mut String| {
        for line in piece.lines() {
            if line.starts_with("S,") || line.starts_with("A,") {
                left_out += 1;
            } else {
                text.push_str(line.trim_end());
                text.push('\n');
            }
        }
    };
    for (at, typed) in &board.typed {
        show(&board.screen[said..*at], &mut text);
        text.push_str(&format!("> {typed}"));
        said = *at;
    }
    show(&board.screen[said..], &mut text);
    text + &format!("({left_out} lines S and A are left out)\n")
}

/// Other output of the day: display, `floe live`, evaluation of the card.
fn seen(board: &Session, card: &Card, folder: &str) -> String {
    let mut text = "\nThe display before `stop`:\n".to_string();
    for row in rows(&board.views[LOOKED as usize]) {
        text += format!("  {row}").trim_end();
        text.push('\n');
    }
    text += "\n`floe live` then:\n";
    for row in live::shown(before_stop(board), (80, 24)) {
        text += format!("  {row}").trim_end();
        text.push('\n');
    }
    let bytes = card.bytes.borrow().clone();
    let (tests, found) = card::tests(Cursor::new(bytes)).expect("readable");
    text += "\n$ floe recover FLOE.LOG -o tests\n";
    text += &card::summary(&tests, &found);
    text += "\n$ floe replay FLOE.LOG --summary\n";
    text += &replayed_text(&replayed(card), false);
    text += "\n$ floe campaign tests\n";
    let logs = recovered(&tests, folder);
    let records: Vec<TestRecord> =
        logs.iter().zip(0..).map(|(log, i)| recorded::evaluate(log, i).expect("read")).collect();
    let events = records.iter().map(|record| record.event_count as u64).sum();
    text + &Summary::new(&records, events, None).text()
}

/// Files written by `floe recover`, as entries of `floe campaign`.
fn recovered(tests: &[card::Test], folder: &str) -> Vec<Entry> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(folder);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder");
    for test in tests {
        let file = |extension: &str| folder.join(format!("{}.{extension}", test.stem));
        fs::write(file("csv"), card::csv(test)).expect("written");
        fs::write(file("txt"), &test.lines).expect("written");
    }
    recorded::logs(&folder).expect("logs").entries
}

/// Console output up to the time of the display's picture.
fn before_stop(board: &Session) -> &str {
    let typed = board.typed.iter().find(|(_, text)| text == "stop\n");
    &board.screen[..typed.expect("typed").0]
}

fn replayed(card: &Card) -> ReplayResult {
    let bytes = Cursor::new(card.bytes.borrow().clone());
    let mut log = Log::from_reader(Box::new(bytes), &LogOptions::default()).expect("a log");
    let config = configure(&log, &TestOptions::default()).expect("complete");
    replay("FLOE.LOG", &mut log, &config, |_, _| {}).expect("replayed")
}

fn replayed_text(result: &ReplayResult, each_event: bool) -> String {
    let mut text = Vec::new();
    table::write(&mut text, result, each_event).expect("written");
    String::from_utf8(text).expect("text")
}

fn one_day(card: &Card) -> Session {
    let cell = LoadCell::from_codes(&codes(day(), SPAN), 16.0).with_noise(NOISE.0, NOISE.1);
    run(cell, Schedule::default(), card, &DAY)
}

fn report(board: &Session) -> Report {
    let report = |line| if let Line::Report(report) = line { Some(report) } else { None };
    board.lines().filter_map(report).last().expect("a report")
}

#[test]
fn the_day_is_the_one_in_the_documentation() {
    let card = Card::default();
    let board = one_day(&card);
    let text = transcript(&board) + &seen(&board, &card, "first-day-seen");
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/first-day.txt");
    if env::var("FLOE_GOLDEN").is_ok_and(|value| value == "write") {
        fs::write(&path, &text).expect("written");
    }
    let kept = fs::read_to_string(&path).unwrap_or_default();
    assert!(text == kept, "{}: FLOE_GOLDEN=write writes it", path.display());
}

#[test]
fn what_was_measured_before_the_pull_is_right() {
    let board = one_day(&Card::default());
    let settings = board.last_settings();
    let (config, std_n) = (settings.config, settings.stds.weight_n.expect("a std"));
    // With an exact span the weight is exact.
    let span = 429.5;
    assert!((config.calibration.counts_per_n - span).abs() < 1e-3, "{config:?}");
    let error_n = f64::from(config.weight_n) - 630.0;
    assert!(error_n.abs() < 4.0 * f64::from(std_n) && std_n < 0.2, "{error_n} ± {std_n}");
    assert_eq!(settings.weight_from, Some(WeightFrom::SameCell));
    assert_eq!(settings.notes.kind, Some(Kind::Sliding));
    assert!(board.says("self test passed"), "{}", board.screen);
    assert!(board.says("load ") && board.says("% of the range"), "{}", board.screen);
}

/// Console, display, card and the replay of the card agree to the last bit.
#[test]
fn board_display_and_card_agree() {
    let card = Card::default();
    let board = one_day(&card);
    let report = report(&board);
    assert!(report.events > 25, "{report:?}");
    let shown = board.views.iter().rev().find_map(|view| view.report).expect("shown");
    // The display was drawn before the last event was complete.
    assert!(shown.events + 1 >= report.events && shown.noise_n.is_some(), "{shown:?}");

    let result = replayed(&card);
    let mean = |estimate: Option<floe_core::Estimate>| estimate.map(|e| f64::from(e.mean));
    assert_eq!(result.estimate.mu_s.mean, mean(report.mu_s));
    assert_eq!(result.estimate.mu.mean, mean(report.mu));
    assert_eq!(result.events.len(), board.events().len());
    // The error budgets from the board's report and from the replay agree too.
    let said = lines(&board.last_settings().core_config(), &report);
    assert!(said.len() > 5 && said == result.budget, "{said:?}\n{:?}", result.budget);
    let winch = said.iter().find(|line| line.input == "winch_m_per_s").expect("the winch");
    assert!((winch.std.expect("a std") - 0.0002).abs() < 1e-9, "{winch:?}");
    // Accuracy of a millisecond, from the crystal; `Y` gives the time of the previous sample.
    let onset = board.events()[0].onset;
    let first =
        |line| if let Line::Sync { index: 0, unix_ms } = line { Some(unix_ms) } else { None };
    let start = board.lines().find_map(first).expect("a date");
    let onset_ms = start + ((onset.index as f64 + f64::from(onset.fraction)) * 62.5).round() as u64;
    assert_eq!(result.events[0].onset_time, Some(Moment(onset_ms).to_string()));

    let bytes = card.bytes.borrow().clone();
    let (tests, _) = card::tests(Cursor::new(bytes)).expect("readable");
    let [test] = tests.as_slice() else { panic!("{} tests", tests.len()) };
    assert_eq!(test.stem, "test-0001-first_pull");
    let after_n = test.settings.zero.after_n.expect("a zero after the test");
    assert!((f64::from(after_n) - MOVED_N).abs() < 0.05, "{after_n}");
    assert!(test.lines.contains("N,wind from the side*"), "{}", test.lines);
    // Temperature is reported once a minute, without loss of a sample.
    assert!(test.lines.lines().any(|line| line.starts_with("K,0,-12,3.3*")), "{}", test.lines);
    assert_eq!((test.missing(), test.samples.len()), (0, 960));
    let at = |line| if let Line::Sync { unix_ms, .. } = line { Some(unix_ms) } else { None };
    let times: Vec<u64> = board.lines().filter_map(at).collect();
    assert_eq!(times.len(), 1 + board.events().len());
    assert!(times.windows(2).all(|pair| pair[0] < pair[1]), "{times:?}");
    let start_ms = test.part.start_ms.expect("a date");
    assert_eq!(times.first(), Some(&start_ms));
}

/// All displays of the result agree to the last digit shown.
#[test]
fn what_people_see_is_the_same_everywhere() {
    let card = Card::default();
    let board = one_day(&card);
    let photograph = shown::picture(&board.views[LOOKED as usize]);
    let said = shown::agree(before_stop(&board), &photograph).expect("agreed");
    assert!(said[0].starts_with("mu_s 1.2") && said[1].starts_with("mu   0.7"), "{said:?}");
    // After the test: `floe live` and the replay of the card.
    let (live, text) = (shown::live_words(&board.screen), replayed_text(&replayed(&card), true));
    for row in shown::coefficients(&report(&board)) {
        let (name, value) = row.split_once(' ').expect("a name");
        let value = value.trim().replace("+-", "±");
        assert!(live.contains(&format!("{name}, mean {value} (32 events)")), "{value}: {live}");
        assert!(text.contains(&format!("\n{name:<6} {value}   random")), "{value}: {text}");
    }
    let last = text.lines().find(|line| line.trim_start().starts_with("31 ")).expect("event 31");
    let [_, onset, _, mu_s, mu_s_std, _, mu, mu_std, ..] =
        last.split_whitespace().collect::<Vec<_>>()[..]
    else {
        panic!("{last}")
    };
    let at = format!("event 31 at {:.1} s", onset.parse::<f64>().expect("s"));
    let event = format!("{at} mu_s {mu_s} ± {mu_s_std} mu {mu} ± {mu_std} good");
    assert!(live.contains(&event), "{event}: {live}");
}

/// `campaign` reads the files of `recover`, next to a file that is not a log.
#[test]
fn a_campaign_of_the_recovered_card() {
    let card = Card::default();
    let board = one_day(&card);
    let (tests, _) = card::tests(Cursor::new(card.bytes.borrow().clone())).expect("readable");
    recovered(&tests, "first-day");
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("first-day");
    fs::write(folder.join("broken.csv"), "time_s,force_n\nx,y\n").expect("written");
    let logs = recorded::logs(&folder).expect("logs").entries;
    assert_eq!(logs.len(), 2, "{logs:?}");
    assert!(recorded::evaluate(&logs[0], 0).is_err());
    let record = recorded::evaluate(&logs[1], 1).expect("evaluated");
    assert_eq!(record.test_id, "first pull");
    assert_eq!((record.kind.as_deref(), record.track.as_deref()), (Some("sliding"), Some("fresh")));
    assert_eq!((record.snow_mm, record.cable_length_m), (Some(10.0), Some(15.0)));
    assert_eq!(record.temperature_c, Some(-12.0));
    let supply_v = record.supply_v.expect("measured");
    assert!((supply_v - 3.3).abs() < 0.01, "{supply_v}");
    assert!(record.start_time.expect("a date").starts_with("2027-03-02T10:16:"));
    // The campaign subtracts the shift of the zero, half of it on average; the board did not know
    // it.
    let shown = f64::from(report(&board).mu_s.expect("a mean").mean);
    let moved = shown - record.mu_s.mean.expect("a mean");
    let half = 0.5 * MOVED_N / 630.0;
    assert!((moved / half - 1.0).abs() < 0.2, "{moved} {half}");
}
