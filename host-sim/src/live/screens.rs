//! The display in every state and three sizes, compared with reviewed copies in `live_screens/`.
//! `FLOE_GOLDEN=write` writes them again, to be reviewed.

use std::path::Path;

use floe_core::{Phase, SampleFlag};
use floe_firmware::line::{Health, Line, Weighed};
use floe_firmware::weighing::{Load, Swing};

use super::ask::Ask;
use super::flow::wrapped;
use super::state::State;
use super::tests::{
    flagged, frame, health, measuring, rows, sample, say, screen_rows, seconds, settings,
};
use super::verdict::verdict;

const SIZES: [(u16, u16); 3] = [(40, 15), (80, 24), (160, 50)];
/// Time at which the screens are drawn, s.
const NOW_S: f64 = 15.0;

fn states() -> [(&'static str, State, f64); 8] {
    let mut unconnected = State::default();
    unconnected.down("no such device".to_string());
    let silent = measuring();
    let mut idle = State::default();
    idle.up(seconds(14.0));
    say(&mut idle, &settings(3, 630.0), 14.5);
    say(&mut idle, &Line::Health(health()), 14.5);
    let mut weighing = idle.clone();
    let swing = Some(Swing { period_s: 2.01, amplitude_rad: 0.0873, excess: 1.2 });
    let load = Ok(Load { value: 630.02, std: 0.05, swing });
    say(&mut weighing, &Line::Weighed(Weighed { duration_s: 40.0, load }), 14.9);
    let sticking = with_rates(Phase::Stick, 361.0);
    let slipping = with_rates(Phase::Slip, -2840.0);
    let mut fault = measuring();
    for index in 240..246 {
        say(&mut fault, &Line::Sample(flagged(index, SampleFlag::Rejected)), 14.9);
    }
    say(&mut fault, &Line::Trouble("converter at sample 240: silent"), 14.9);
    let mut flood = measuring();
    for index in 240..100_240 {
        say(&mut flood, &Line::Sample(sample(index, 300.0, Phase::Stick)), 14.9);
    }
    let lost = Health { overruns: 65, ..health() };
    say(&mut flood, &Line::Health(lost), 14.9);
    [
        ("unconnected", unconnected, NOW_S),
        ("silent", silent, 40.0),
        ("idle", idle, NOW_S),
        ("weighing", weighing, NOW_S),
        ("sticking", sticking, NOW_S),
        ("slipping", slipping, NOW_S),
        ("fault", fault, NOW_S),
        ("flood", flood, NOW_S),
    ]
}

/// A test with rates of the force; its last samples are of one phase.
fn with_rates(phase: Phase, rate_n_per_s: f32) -> State {
    let mut state = measuring();
    for (index, at) in state.trace.iter_mut().zip(0_u16..) {
        let angle = f32::from(at % 28) / 28.0 * std::f32::consts::TAU;
        index.rate_n_per_s = Some(361.0 - 3000.0 * angle.sin().max(0.0));
    }
    for index in 240..244 {
        let mut last = sample(index, 612.5, phase);
        last.rate_n_per_s = Some(rate_n_per_s);
        say(&mut state, &Line::Sample(last), 14.95);
    }
    state
}

#[test]
fn screens_are_as_they_were_looked_at() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/live_screens");
    let write = std::env::var("FLOE_GOLDEN").is_ok_and(|value| value == "write");
    for (name, state, now_s) in states() {
        for (width, height) in SIZES {
            let path = folder.join(format!("{name}-{width}x{height}.txt"));
            let screen = screen_rows(&state, (width, height), now_s).join("\n") + "\n";
            if write {
                std::fs::create_dir_all(&folder).unwrap();
                std::fs::write(&path, &screen).unwrap();
            }
            let kept = std::fs::read_to_string(&path).unwrap_or_default();
            assert_eq!(screen, kept, "{}: FLOE_GOLDEN=write writes it", path.display());
        }
    }
}

/// The whole text of a verdict is shown at every width.
#[test]
fn no_verdict_is_cut() {
    for (name, state, now_s) in states() {
        let text = verdict(&state, seconds(now_s)).text;
        for width in 40..161 {
            let screen = screen_rows(&state, (width, 24), now_s);
            let expected = wrapped(&text, width - 1);
            let first = screen.iter().position(|row| row.trim() == expected[0].trim());
            let first = first.unwrap_or_else(|| panic!("{name} at {width}: {screen:#?}"));
            for (row, expected) in screen[first..].iter().zip(&expected) {
                assert_eq!(row.trim(), expected, "{name} at {width}");
            }
        }
    }
}

/// Questions, with the error of an answer, and all keys are shown completely.
#[test]
fn no_question_is_cut() {
    use ratatui::crossterm::event::{KeyCode, KeyEvent, KeyModifiers};
    let state = measuring();
    for keys in ["w", "wx\n", "n", "a", "c", "m", "x", ":", ":fly\n", "?"] {
        let mut ask = Ask::default();
        for letter in keys.chars() {
            let code = if letter == '\n' { KeyCode::Enter } else { KeyCode::Char(letter) };
            ask.key(KeyEvent::new(code, KeyModifiers::NONE));
        }
        for width in [40, 80] {
            let screen = rows(&frame(&state, &ask, (width, 15), NOW_S)).join(" ");
            let plain = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
            let shown = plain(&screen);
            match ask.keys() {
                Some(all) => all.iter().for_each(|key| assert!(shown.contains(key), "{key}")),
                None => assert!(shown.contains(&plain(&ask.text())), "{}: {shown}", ask.text()),
            }
        }
    }
}
