//! Effects of the board's lines, and the messages on them.

use floe_core::Effect;

use super::*;

#[test]
fn a_damaged_line_is_counted_and_changes_nothing() {
    let mut state = measuring();
    let text = Line::Event(Event { index: 7, ..event() }).to_text().unwrap().to_string();
    for place in 0..text.len() {
        let mut bytes = text.clone().into_bytes();
        bytes[place] ^= 1;
        let text = String::from_utf8_lossy(&bytes).to_string();
        assert_eq!(state.take(&Received { text, cut: false }, seconds(15.0)), None);
    }
    assert_eq!(state.damaged as usize, text.len());
    assert_eq!(state.event, Some(event()));
    let text_now = verdict(&state, seconds(16.0)).text;
    assert!(text_now.contains("damaged lines: bad cable"), "{text_now}");
    assert!(screen_rows(&state, (100, 24), 16.0)[12].contains("damaged lines"));
    // The end of a line that began before the port was opened is not counted as damage.
    let damaged = state.damaged;
    state.take(&Received { text: "0.5,good,stick,0*1234".to_string(), cut: true }, seconds(16.0));
    assert_eq!(state.damaged, damaged);
    // A complete line of an unknown kind is no damage either.
    let unknown = "B,12.6*E02B";
    state.take(&Received { text: unknown.to_string(), cut: false }, seconds(16.0));
    assert_eq!((state.damaged, state.unknown), (damaged, 1));
}

#[test]
fn what_is_wrong_is_said() {
    let now = seconds(15.0);
    let with = |lines: &[Line<'_>]| {
        let mut state = measuring();
        lines.iter().for_each(|line| say(&mut state, line, 14.95));
        verdict(&state, now)
    };
    let samples = |flag| (240..244).map(move |index| Line::Sample(flagged(index, flag)));
    let silent = Line::Trouble("converter at sample 240: silent");
    let mut rejected: Vec<Line<'_>> = samples(SampleFlag::Rejected).collect();
    assert_eq!(with(&rejected), bad("NO FORCE: the converter gives no readings"));
    rejected.push(silent);
    assert_eq!(with(&rejected), bad("NO FORCE: converter at sample 240: silent"));
    assert_eq!(with(&rejected[..2]), note("in the last 5 s: samples 2 without a reading"));
    let saturated: Vec<Line<'_>> = samples(SampleFlag::Saturated).collect();
    assert_eq!(with(&saturated), bad("FORCE OUT OF RANGE: a broken wire, or too much load"));
    let gap = Line::Sample(LiveSample { gap: 5, ..sample(245, 300.0, Phase::Stick) });
    assert_eq!(
        with(&[gap, Line::Spike(230)]),
        note("in the last 5 s: samples 5 missing, 1 spikes")
    );
    let lost = Line::Health(Health { overruns: 65, ..health() });
    assert_eq!(with(&[lost]), bad("SAMPLES LOST by the board: 65 since power-up"));
    let unkept = Line::Health(Health { store_failures: 8, ..health() });
    assert_eq!(with(&[unkept]), bad("NOT KEPT: card missing, full or broken (8 sectors)"));
    let full = Line::Trouble("the log is full");
    assert_eq!(with(&[full]), bad("the board says: the log is full"));
}

#[test]
fn what_is_over_is_no_longer_said() {
    let mut state = measuring();
    say(&mut state, &Line::Health(Health { overruns: 65, ..health() }), 15.0);
    for second in 16..40 {
        let index = second * 16;
        say(&mut state, &Line::Sample(sample(index, 1.0, Phase::Stick)), second as f64);
        say(&mut state, &Line::Health(Health { overruns: 65, ..health() }), second as f64);
    }
    assert_eq!(verdict(&state, seconds(39.5)).text, "measuring; all is well");
    assert!(screen_rows(&state, (80, 24), 39.5)[12].contains("lost 65"));
}

#[test]
fn silence_and_a_port_that_goes_away_and_comes_back() {
    let mut state = measuring();
    assert_eq!(verdict(&state, seconds(19.0)), bad("NO SAMPLES come any more (live off?)"));
    let silent = verdict(&state, seconds(30.0));
    assert_eq!(silent, bad("THE BOARD IS SILENT for 15 s: off, or another program has it"));
    state.down("closed".to_string());
    let away = "NO PORT (closed): check cable and power; trying again";
    assert_eq!(verdict(&state, seconds(31.0)), bad(away));
    // The last result stays visible, the force does not.
    let rows = screen_rows(&state, (40, 6), 31.0);
    assert_eq!(rows[2], "force, N       ---");
    assert_eq!(rows[3], "mu_s, mean  1.2406 ± 0.0056 (7 events)");
    state.up(seconds(40.0));
    assert_eq!(verdict(&state, seconds(40.1)).text, "asking the board");
    // The board was restarted meanwhile: no test, no settings.
    say(&mut state, &settings(0, 0.0), 40.2);
    say(&mut state, &Line::Health(Health::default()), 40.2);
    assert_eq!(
        verdict(&state, seconds(40.3)),
        note("no test is running: w sets the block's weight, then s starts")
    );
    assert_eq!((state.event, state.report), (None, None));
}

#[test]
fn tests_begin_and_end() {
    let mut state = measuring();
    assert_eq!(state.testing, Some(true));
    for line in [Line::Report(report()), Line::Health(health()), Line::End { run: 3 }] {
        say(&mut state, &line, 15.0);
    }
    assert_eq!(verdict(&state, seconds(15.1)), note("no test is running: s starts one"));
    assert_eq!(state.event, Some(event()));
    say(&mut state, &settings(4, 700.0), 16.0);
    assert_eq!((state.event, state.report, state.trace.len()), (None, None, 0));
    say(&mut state, &Line::Sample(sample(0, 1.0, Phase::Unknown)), 16.1);
    assert_eq!(verdict(&state, seconds(16.2)).text, "measuring; waiting for the first slip");
    assert_eq!(band(&state, seconds(16.2)).0, "LEARNING");
    // Without the settings' line the index shows the new test.
    let mut state = measuring();
    say(&mut state, &Line::Sample(sample(0, 1.0, Phase::Unknown)), 16.0);
    assert_eq!((state.event, state.trace.len()), (None, 1));
}

#[test]
fn an_event_without_coefficients_says_why() {
    let mut state = measuring();
    let (quality, reason) = (Quality::Clipped, Some(Reason::Hidden));
    say(&mut state, &Line::Event(Event { mu_s: None, mu: None, quality, reason, ..event() }), 15.0);
    let row = &screen_rows(&state, (100, 24), 15.0)[10];
    assert!(
        row.ends_with("mu_s -   mu -   clipped: a gap or saturated samples hide the slip"),
        "{row}"
    );
}

#[test]
fn a_first_answer_is_shown_until_its_event_comes() {
    let mut state = measuring();
    let coefficient = |value| Coefficient::random(value, 0.0114);
    let about = |index, mu| {
        let answer = Provisional { mu_s: coefficient(1.2391), mu };
        Line::About(About { index, answer })
    };
    let row = |state: &State| {
        let row = screen_rows(state, (80, 24), 15.0)[11].clone();
        if row.starts_with("provisional") { row } else { String::new() }
    };
    say(&mut state, &about(234, None), 14.9);
    assert_eq!(row(&state), "provisional at 14.6 s   mu_s ~ 1.239 ± 0.011");
    say(&mut state, &about(237, Some(coefficient(0.781))), 14.9);
    let both = "provisional at 14.8 s   mu_s ~ 1.239 ± 0.011   mu ~ 0.781 ± 0.011";
    assert_eq!(row(&state), both);
    let shown = frame(&state, &Ask::default(), (80, 24), 15.0);
    assert!(shown[(0, 11)].modifier.contains(Modifier::DIM));
    assert!(!shown[(0, 10)].modifier.contains(Modifier::DIM));
    // The event of the previous slip comes later than the answer; the slip's own event ends it.
    let with_stop = |index, sample| {
        let stop = SampleTime { index: sample, fraction: 0.1 };
        Line::Event(Event { index, stop, ..event() })
    };
    say(&mut state, &with_stop(6, 209), 15.0);
    assert_eq!(row(&state), both);
    say(&mut state, &with_stop(7, 236), 15.0);
    assert_eq!((row(&state).as_str(), state.about), ("", None));
    // A new test discards the answer.
    say(&mut state, &about(237, None), 15.0);
    say(&mut state, &settings(4, 630.0), 15.0);
    assert_eq!(state.about, None);
}

#[test]
fn a_command_is_followed_by_what_came_of_it() {
    let mut state = measuring();
    let said = |state: &mut State, command: &str| {
        state.said = Some((command.to_string(), seconds(15.0)));
    };
    said(&mut state, "start");
    let last = |state: &State, now_s| screen_rows(state, (80, 24), now_s)[23].clone();
    assert_eq!(last(&state, 15.1), "start: said");
    say(&mut state, &Line::Trouble("a test is running; stop ends it"), 15.2);
    assert_eq!(last(&state, 15.3), "start: a test is running; stop ends it");
    assert!(last(&state, 24.0).starts_with("s start"));
    let mut state = measuring();
    said(&mut state, "stop");
    say(&mut state, &Line::End { run: 3 }, 15.1);
    assert_eq!(last(&state, 15.3), "stop: done");
    said(&mut state, "start");
    state.down("closed".to_string());
    assert_eq!(last(&state, 15.3), "start: not said, there is no port");
}

#[test]
fn a_force_just_below_zero_is_no_negative_zero() {
    let mut state = measuring();
    say(&mut state, &Line::Sample(sample(240, -0.3, Phase::Stick)), 15.0);
    for size in [(80, 24), (160, 50)] {
        let rows = screen_rows(&state, size, 15.0);
        let label = |row: &String| row.split_whitespace().any(|word| word.starts_with("-0"));
        assert!(!rows.iter().skip(13).any(label), "{rows:#?}");
    }
}

#[test]
fn events_that_are_refused_tell_no_stiffness() {
    let mut state = measuring();
    let told = |state: &State| screen_rows(state, (160, 50), 15.0).join("\n");
    assert!(told(&state).contains("kN/m") && told(&state).contains("a slip every"));
    let refused = Report { mu_s: None, mu: None, ..report() };
    say(&mut state, &Line::Report(refused), 15.0);
    let told = told(&state);
    assert!(!told.contains("kN/m") && !told.contains("a slip every"), "{told}");
    assert!(told.contains("noise 1.9 N"), "{told}");
}

#[test]
fn the_effects_that_the_test_shows_are_named() {
    let mut state = measuring();
    let told = |state: &State| screen_rows(state, (160, 50), 15.0).join("\n");
    assert!(!told(&state).contains("shows"));
    let found = Effects::NONE.with(Effect::Ripple, true).with(Effect::Corner, true);
    say(&mut state, &Line::Report(Report { found, ..report() }), 15.0);
    assert!(told(&state).contains("23.0 kN/m   shows corner, ripple"), "{}", told(&state));
    // Without a mean there is nothing to correct.
    let refused = Report { mu_s: None, mu: None, found, ..report() };
    say(&mut state, &Line::Report(refused), 15.0);
    assert!(!told(&state).contains("shows"));
}

/// Without a card, a board whose power was off counts its tests from 1 again.
#[test]
fn a_test_with_the_number_of_the_one_before_has_a_date_of_its_own() {
    let mut state = State::default();
    let began = |state: &mut State, index, unix_ms| {
        say(state, &settings(1, 630.0), 1.0);
        say(state, &Line::Sync { index, unix_ms }, 1.0);
        state.began.unwrap().unix_s.round() as u64
    };
    assert_eq!(began(&mut state, 0, 1_000_000), 1_000);
    assert_eq!(began(&mut state, 160, 1_010_500), 1_000, "the first in a test counts");
    assert_eq!(began(&mut state, 0, 9_000_000), 9_000);
}
