//! Tests of the display with the board's lines, formatted by the firmware.

use std::time::Duration;

use floe_core::{
    Coefficient, Counters, Effects, Estimate, Event, Phase, Provisional, Quality, Quantity, Reason,
    Report, SampleFlag, SampleTime,
};
use floe_firmware::line::{About, Health, Line, LiveSample};
use floe_firmware::settings::Settings;
use ratatui::Terminal;
use ratatui::backend::TestBackend;
use ratatui::buffer::Buffer;
use ratatui::crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
use ratatui::style::{Color, Modifier};

use super::ask::Ask;
use super::band::band;
use super::lines::Received;
use super::screen;
pub(super) use super::shown::rows;
use super::state::{State, TRACE_LEN};
use super::trace::pieces;
use super::verdict::{Level, Verdict, verdict};

#[path = "../../tests/support/dff8_13.rs"]
mod dff8_13;
#[path = "../../tests/support/picture.rs"]
mod picture;
mod said;
use dff8_13::event;

pub(super) fn seconds(seconds: f64) -> Duration {
    Duration::from_secs_f64(seconds)
}

/// Passes a line of the board to the display.
pub(super) fn say(state: &mut State, line: &Line<'_>, at_s: f64) {
    let text = line.to_text().unwrap().to_string();
    state.take(&Received { text, cut: false }, seconds(at_s));
}

pub(super) fn settings(run: u32, weight_n: f32) -> Line<'static> {
    let mut settings = Settings { name: "DFF8-13".try_into().unwrap(), ..Settings::default() };
    settings.config.weight_n = weight_n;
    Line::Start { run, settings }
}

pub(super) fn sample(index: u32, force_n: f32, phase: Phase) -> LiveSample {
    let (force_n, rate_n_per_s) = (Some(force_n), None);
    LiveSample { index, force_n, flag: SampleFlag::Good, phase, gap: 0, rate_n_per_s }
}

pub(super) fn flagged(index: u32, flag: SampleFlag) -> LiveSample {
    let (force_n, rate_n_per_s) = (None, None);
    LiveSample { index, force_n, flag, phase: Phase::Stick, gap: 0, rate_n_per_s }
}

pub(super) fn report() -> Report {
    let estimate = |mean| {
        Some(Estimate {
            mean,
            std_error: Some(0.0003),
            freedom: 6.0,
            systematic_std: 0.0056,
            common_std: 0.0,
            spread: None,
            events: 7,
        })
    };
    let exact = |value| Some(Quantity { value, std: 0.0 });
    Report {
        counters: Counters { samples: 240, missing: 3, ..Counters::default() },
        events: 7,
        mu_s: estimate(1.2406),
        mu: estimate(0.7802),
        noise_n: Some(1.9),
        loading_rate_n_per_s: exact(360.2),
        omega_rad_per_s: exact(18.9),
        stiffness_n_per_m: Some(23_010.0),
        recurrence_s: Some(1.78),
        zero_n: None,
        zero_std_n: 0.8,
        zero_drift_n: 0.0,
        damping_std: 0.005,
        weight_ratio: 1.0,
        weight_ratio_std: 0.0,
        change: None,
        found: Effects::NONE,
    }
}

pub(super) fn health() -> Health {
    Health { samples: 240, sectors: 30, period_s: Some(0.0625), ..Health::default() }
}

/// A test of 15 s: sawtooth, one slip per 28 samples, one event.
pub(super) fn measuring() -> State {
    let mut state = State::default();
    state.up(Duration::ZERO);
    say(&mut state, &settings(3, 630.0), 0.1);
    for index in 0..240 {
        let phase = if index % 28 < 25 { Phase::Stick } else { Phase::Slip };
        let force_n = 200.0 + 21.0 * (index % 28) as f32;
        say(&mut state, &Line::Sample(sample(index, force_n, phase)), index as f64 / 16.0);
    }
    say(&mut state, &Line::Event(event()), 14.0);
    say(&mut state, &settings(3, 630.0), 14.9);
    say(&mut state, &Line::Report(report()), 14.9);
    say(&mut state, &Line::Health(health()), 14.9);
    state
}

pub(super) fn frame(state: &State, ask: &Ask, size: (u16, u16), now_s: f64) -> Buffer {
    let mut terminal = Terminal::new(TestBackend::new(size.0, size.1)).unwrap();
    terminal.draw(|frame| screen::draw(frame, state, ask, "/dev/ttyACM0", seconds(now_s))).unwrap();
    terminal.backend().buffer().clone()
}

pub(super) fn screen_rows(state: &State, size: (u16, u16), now_s: f64) -> Vec<String> {
    rows(&frame(state, &Ask::default(), size, now_s))
}

fn bad(text: &str) -> Verdict {
    Verdict { level: Level::Bad, text: text.to_string() }
}

fn note(text: &str) -> Verdict {
    Verdict { level: Level::Note, text: text.to_string() }
}

/// Draws `live.svg` in cargo's folder, for the README.
#[test]
#[ignore = "writes a picture for the eye"]
fn picture() {
    let buffer = frame(&measuring(), &Ask::default(), (80, 24), 15.0);
    let target = std::env::var_os("CARGO_TARGET_DIR").unwrap_or("target".into());
    let place = std::path::Path::new("..").join(target).join("live.svg");
    std::fs::write(place, picture::svg(&buffer)).unwrap();
}

#[test]
fn a_picture_has_every_letter_of_the_screen() {
    let buffer = frame(&measuring(), &Ask::default(), (80, 24), 15.0);
    let svg = picture::svg(&buffer);
    let document = roxmltree::Document::parse(&svg).unwrap();
    let shown: String =
        document.descendants().filter(|n| n.is_text()).filter_map(|n| n.text()).collect();
    let letters = |text: &str| text.chars().filter(|c| !c.is_whitespace()).collect::<String>();
    assert_eq!(letters(&shown), letters(&rows(&buffer).concat()));
}

#[test]
fn the_whole_display() {
    let buffer = frame(&measuring(), &Ask::default(), (80, 24), 15.0);
    let rows = rows(&buffer);
    let head = [
        " floe /dev/ttyACM0   test 3 DFF8-13   630 N   0:14",
        " measuring; all is well",
        "  █▀▀ ▀█▀ █ █▀▀ █▄▀ █▀▀",
        "  ▀▀█  █  █ █   █▄  ▀▀█",
        "  ▀▀▀  ▀  ▀ ▀▀▀ ▀ ▀ ▀▀▀",
        "force, N                   mu_s, mean                mu, mean",
        "█▀▀ ▄█  █▀▀   █▀█          ▄█    ▀▀█ █ █ █▀█ █▀▀     █▀█   ▀▀█ █▀█ █▀█ ▀▀█",
        "▀▀█  █  ▀▀█   █ █           █    █▀▀ ▀▀█ █ █ █▀█     █ █     █ █▀█ █ █ █▀▀",
        "▀▀▀ ▀▀▀ ▀▀▀ ▀ ▀▀▀          ▀▀▀ ▀ ▀▀▀   ▀ ▀▀▀ ▀▀▀     ▀▀▀ ▀   ▀ ▀▀▀ ▀▀▀ ▀▀▀",
        "                           ± 0.0056 (7 events)       ± 0.0056 (7 events)",
        "event 6 at 12.9 s   mu_s 1.2404 ± 0.0007   mu 0.7798 ± 0.0007   good",
        "noise 1.9 N   loading 360 N/s   a slip every 1.78 s   k 23.0 kN/m",
        "card ok, 15 kB   lost 0   missing 3   bad 0   out of range 0   16.000 Hz",
    ];
    assert_eq!(rows[..head.len()], head);
    assert!(rows[13].starts_with("800 N│"), "{}", rows[13]);
    assert!(rows[23].starts_with("s start") && rows[23].ends_with("y accept"), "{}", rows[23]);
    // The whole trace is in the right half of the last 30 s.
    let dots = |row: &String| row.chars().position(|c| ('\u{2801}'..='\u{28FF}').contains(&c));
    let first = rows[13..21].iter().filter_map(dots).min().unwrap();
    assert!((40..=46).contains(&first), "{first}");
    // The verdict is green, missing samples are red, a slip is yellow.
    assert_eq!(buffer[(0, 1)].bg, Color::Green);
    assert_eq!(buffer[(rows[12].find("missing").unwrap() as u16, 12)].fg, Color::LightRed);
    // A sticking block is blue.
    assert_eq!(buffer[(0, 2)].bg, Color::LightBlue);
    let yellow = buffer.content.iter().filter(|cell| cell.fg == Color::LightYellow).count();
    assert!(yellow > 10, "{yellow}");
}

#[test]
fn small_terminals_keep_what_matters() {
    let state = measuring();
    let rows = screen_rows(&state, (40, 6), 15.0);
    assert_eq!(rows[0], " measuring; all is well");
    assert_eq!(rows[1], " STICKS");
    assert_eq!(rows[2], "force, N     515.0");
    assert_eq!(rows[3], "mu_s, mean  1.2406 ± 0.0056 (7 events)");
    assert_eq!(rows[4], "mu, mean    0.7802 ± 0.0056 (7 events)");
    assert_eq!(screen_rows(&state, (24, 1), 15.0), [" measuring; all is well"]);
}

#[test]
fn no_size_is_too_small_or_too_large() {
    let (full, empty) = (measuring(), State::default());
    let mut asking = Ask::default();
    asking.key(KeyEvent::new(KeyCode::Char('w'), KeyModifiers::NONE));
    for width in (0..12).chain((12..100).step_by(7)).chain([73, 74, 1000]) {
        for height in (0..26).chain([40, 120]) {
            frame(&empty, &Ask::default(), (width, height), 1.0);
            let rows = rows(&frame(&full, &asking, (width, height), 1.0));
            let asked = rows.iter().any(|row| row.starts_with("weight"));
            assert_eq!(asked, width >= 6 && height >= 1, "{width} x {height}");
        }
    }
}

/// Forces that a cell never gives do not break the trace.
#[test]
fn odd_forces_are_drawn_or_left_out() {
    for force in [0.0, -0.0, 1e-30, -5.0, -4000.0, 3.4e38, -3.4e38, f32::INFINITY, f32::NAN] {
        let mut state = measuring();
        for index in 240..250 {
            state.trace.push_back(sample(index, force, Phase::Stick));
        }
        frame(&state, &Ask::default(), (80, 24), 15.0);
        state.trace.retain(|sample| sample.index >= 240);
        frame(&state, &Ask::default(), (80, 24), 15.0);
    }
}

#[test]
fn a_gap_breaks_the_trace() {
    let mut state = State::default();
    for index in [0, 1, 2] {
        say(&mut state, &Line::Sample(sample(index, 10.0, Phase::Stick)), 0.0);
    }
    let after_gap = LiveSample { gap: 2, ..sample(5, 12.0, Phase::Stick) };
    say(&mut state, &Line::Sample(after_gap), 0.0);
    say(&mut state, &Line::Sample(flagged(6, SampleFlag::Rejected)), 0.0);
    say(&mut state, &Line::Sample(sample(7, 13.0, Phase::Stick)), 0.0);
    say(&mut state, &Line::Sample(sample(8, 14.0, Phase::Slip)), 0.0);
    let found = pieces(&state.trace, 16.0);
    let points: Vec<usize> = found.iter().map(|piece| piece.points.len()).collect();
    assert_eq!(points, [3, 1, 2, 1]);
    assert_eq!(found.iter().map(|p| p.slips).collect::<Vec<_>>(), [false, false, false, true]);
    assert_eq!(found[0].points[0], (-0.5, 10.0));
    // A sample identified as a spike later is removed.
    say(&mut state, &Line::Spike(1), 0.0);
    let points: Vec<usize> =
        pieces(&state.trace, 16.0).iter().map(|piece| piece.points.len()).collect();
    assert_eq!(points, [1, 1, 1, 2, 1]);
}

#[test]
fn the_trace_holds_half_a_minute() {
    let mut state = State::default();
    for index in 0..1000 {
        say(&mut state, &Line::Sample(sample(index, 1.0, Phase::Stick)), 0.0);
    }
    assert_eq!(state.trace.len(), TRACE_LEN);
    assert_eq!(state.trace.back().unwrap().index, 999);
}
