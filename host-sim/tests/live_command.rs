//! `floe live` as a command: invalid ports, and a simulated board on a local socket.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::PathBuf;
use std::process::{Child, Command, Output, Stdio};
use std::time::Duration;

use floe_core::{Event, Quality, Reason, SampleTime};
use floe_firmware::line::Line;
use floe_firmware::settings::Settings;

#[path = "support/dff8_13.rs"]
mod dff8_13;

fn floe(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_floe")).arg("live").args(arguments).output().unwrap()
}

/// The one line of a refusal.
fn refusal(arguments: &[&str]) -> String {
    let output = floe(arguments);
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
    assert!(output.stdout.is_empty());
    assert_eq!(said.lines().count(), 1, "{said}");
    said.trim_end().to_string()
}

fn event(index: u32) -> Event {
    let onset = index * 28;
    Event {
        index,
        onset: SampleTime { index: onset + 25, fraction: 0.5 },
        stop: SampleTime { index: onset + 28, fraction: 0.25 },
        omega_rad_per_s: None,
        ..dff8_13::event()
    }
}

fn hidden(index: u32) -> Event {
    let (quality, reason) = (Quality::Clipped, Some(Reason::Hidden));
    Event { mu_s: None, mu: None, quality, reason, ..event(index) }
}

fn text(line: &Line<'_>) -> String {
    line.to_text().unwrap().to_string() + "\r\n"
}

fn settings() -> String {
    let mut settings = Settings::default();
    settings.config.weight_n = 630.0;
    text(&Line::Start { run: 1, settings })
}

/// A display connected to a board that the test plays.
struct Live {
    listener: TcpListener,
    child: Child,
    lines: std::io::Lines<BufReader<std::process::ChildStdout>>,
}

impl Live {
    fn start(more: &[&str]) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let port = listener.local_addr().unwrap().to_string();
        let mut child = Command::new(env!("CARGO_BIN_EXE_floe"))
            .args(["live", &port])
            .args(more)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let lines = BufReader::new(child.stdout.take().unwrap()).lines();
        Self { listener, child, lines }
    }

    /// Accepts the connection and the first question of the display.
    fn accept(&self) -> TcpStream {
        let (mut board, _) = self.listener.accept().unwrap();
        board.set_read_timeout(Some(Duration::from_secs(20))).unwrap();
        let mut asked = [0; 8];
        board.read_exact(&mut asked).unwrap();
        assert_eq!(&asked, b"status\r\n");
        board
    }

    fn line(&mut self) -> String {
        self.lines.next().unwrap().unwrap()
    }

    /// Ends the display; returns its standard error.
    fn end(mut self) -> String {
        self.child.kill().unwrap();
        let mut said = String::new();
        self.child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
        self.child.wait().unwrap();
        said
    }
}

#[test]
fn ports_that_are_none() {
    let missing = refusal(&["/dev/floe-is-not-there"]);
    let start = "floe: /dev/floe-is-not-there: no such port; ";
    assert!(missing.starts_with(start), "{missing}");
    assert!(missing.contains("there are: ") || missing.contains("plug the board in"), "{missing}");
    let file = env!("CARGO_MANIFEST_DIR").to_string() + "/Cargo.toml";
    assert!(refusal(&[&file]).contains("Cargo.toml: cannot be used as a serial port: "));
    // A port that was free a moment ago, where nothing listens.
    let free = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().to_string();
    let refused = refusal(&[&free]);
    assert!(refused.starts_with(&format!("floe: {free}: nobody listens there")), "{refused}");
    let socket = refusal(&["unix:/floe/is/not/there"]);
    assert!(socket.starts_with("floe: /floe/is/not/there: no such socket"), "{socket}");
    for large in ["127.0.0.1:99999", "tcp:127.0.0.1:99999"] {
        let why = "floe: 127.0.0.1:99999: the number of a port is 65535 at most";
        assert_eq!(refusal(&[large]), why);
    }
    assert!(refusal(&[]).contains("<PORT>"));
    refusal(&["", "--json"]);
}

#[test]
fn no_file_is_overwritten() {
    let kept = std::env::temp_dir().join(format!("floe-live-{}.txt", std::process::id()));
    fs::write(&kept, "precious").unwrap();
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().to_string();
    let said = refusal(&[&port, "-o", kept.to_str().unwrap()]);
    assert!(said.ends_with("is there already; name a new file"), "{said}");
    assert_eq!(fs::read_to_string(&kept).unwrap(), "precious");
    fs::remove_file(kept).unwrap();
}

/// The connection starts in the middle of a line, a line is damaged, and the port disappears in the
/// middle of the next line and returns.
#[test]
fn events_as_lines() {
    let kept = std::env::temp_dir().join(format!("floe-live-{}-kept.txt", std::process::id()));
    let _ = fs::remove_file(&kept);
    let mut live = Live::start(&["-o", kept.to_str().unwrap()]);
    let mut board = live.accept();
    let first = text(&Line::Event(event(0)));
    let damaged = text(&Line::Event(event(1))).replace("1.2404", "1.2405");
    board.write_all(b"good,stick,0*1234\r\n").unwrap();
    board.write_all((settings() + &first + &damaged).as_bytes()).unwrap();
    let second = text(&Line::Event(hidden(2)));
    let (head, tail) = second.split_at(20);
    board.write_all(head.as_bytes()).unwrap();
    board.flush().unwrap();
    std::thread::sleep(Duration::from_millis(200));
    board.write_all(tail.as_bytes()).unwrap();
    assert_eq!(
        live.line(),
        "event 0  onset 1.594 s  mu_s 1.2404 ± 0.0007  mu 0.7798 ± 0.0007  Fs 781.2 N  \
         Fp 491.4 N  good"
    );
    assert_eq!(
        live.line(),
        "event 2  onset 5.094 s  mu_s -  mu -  Fs 781.2 N  Fp 491.4 N  \
         clipped: a gap or saturated samples hide the slip"
    );
    let third = text(&Line::Event(event(3)));
    board.write_all(&third.as_bytes()[..30]).unwrap();
    drop(board);
    let mut board = live.accept();
    board.write_all(&third.as_bytes()[30..]).unwrap();
    board.write_all(text(&Line::Event(event(4))).as_bytes()).unwrap();
    assert!(live.line().starts_with("event 4  onset 8.594 s"));
    let said = live.end();
    let said: Vec<&str> = said.lines().collect();
    assert_eq!(said.len(), 3, "{said:?}");
    assert_eq!(said[0], "floe: 1 damaged line so far");
    assert!(said[1].ends_with(": gone (closed); trying again"), "{said:?}");
    assert!(said[2].ends_with(": there again"), "{said:?}");
    let lines = fs::read_to_string(&kept).unwrap();
    assert_eq!(lines.lines().count(), 8, "{lines}");
    assert!(lines.contains(first.trim_end()) && lines.contains(damaged.trim_end()));
    let (head, tail) = third.split_at(30);
    assert!(lines.contains(&format!("\n{head}\n{}\n", tail.trim_end())), "{lines}");
    fs::remove_file(kept).unwrap();
}

/// A board that connects and sends nothing is reported, with and without `--json`.
#[test]
fn a_silent_board_is_said() {
    let lives = [&[][..], &["--json"]].map(Live::start);
    let mut boards = lives.each_ref().map(Live::accept);
    for board in &mut boards {
        board.read_exact(&mut [0; 8]).unwrap();
    }
    std::thread::sleep(Duration::from_secs(5));
    for live in lives {
        let said = live.end();
        assert_eq!(said.lines().count(), 1, "{said}");
        assert!(said.contains(": the board is silent for 8 s: off, or another program"), "{said}");
    }
}

#[test]
fn events_as_json_have_the_fields_of_a_replay() {
    let mut live = Live::start(&["--json"]);
    let mut board = live.accept();
    board.write_all(settings().as_bytes()).unwrap();
    board.write_all(text(&Line::Event(event(0))).as_bytes()).unwrap();
    board.write_all(text(&Line::Event(hidden(1))).as_bytes()).unwrap();
    assert_eq!(
        live.line(),
        r#"{"index":0,"onset_s":1.59375,"stop_s":1.765625,"static_force_n":781.2,"dynamic_force_n":491.4,"peak_force_n":781.8,"restick_force_n":201.6,"mu_s":1.2404,"mu_s_std":0.00074,"mu":0.7798,"mu_std":0.00074,"stick_s":1.6,"slip_s":0.173,"loading_rate_n_per_s":361.1,"omega_rad_per_s":null,"slack":false,"quality":"good","reason":null,"mu_s_systematic_std":0.0,"mu_systematic_std":0.0,"mu_s_combined_std":0.00074,"mu_combined_std":0.00074,"mu_s_ci95":[1.2389495,1.2418504],"mu_ci95":[0.77834964,0.78125036],"slip_length_m":null,"energy_j":null,"onset_time":null,"slip_length_m_std":null,"energy_j_std":null}"#
    );
    let event: serde_json::Value = serde_json::from_str(&live.line()).unwrap();
    assert!(event["mu_s"].is_null() && event["mu"].is_null());
    assert_eq!(event["reason"], "a gap or saturated samples hide the slip");
    assert_eq!(live.end(), "");
}

/// Slip length, energy and time of an event, from the settings and the clock of the board.
#[test]
fn events_as_json_say_how_far_and_when() {
    let mut live = Live::start(&["--json"]);
    let mut board = live.accept();
    let mut settings = Settings::default();
    settings.config.weight_n = 630.0;
    settings.config.winch_m_per_s = Some(0.0157);
    let begin = text(&Line::Start { run: 1, settings })
        + &text(&Line::Sync { index: 0, unix_ms: 1_803_982_500_123 })
        + &text(&Line::Event(event(0)))
        + &text(&Line::Sync { index: 25, unix_ms: 1_803_982_501_700 })
        + &text(&Line::Event(hidden(1)));
    board.write_all(begin.as_bytes()).unwrap();
    let event: serde_json::Value = serde_json::from_str(&live.line()).unwrap();
    let number = |key: &str| event[key].as_f64().unwrap();
    let length_m = (781.2 - 201.6) * 0.0157 / 361.1 + 0.0157 * 0.173;
    assert!((number("slip_length_m") - length_m).abs() < 1e-6, "{event}");
    assert!((number("energy_j") - 491.4 * length_m).abs() < 1e-4, "{event}");
    assert_eq!(event["onset_time"], "2027-03-02T10:15:01.717Z");
    let refused: serde_json::Value = serde_json::from_str(&live.line()).unwrap();
    assert!(refused["slip_length_m"].is_null() && refused["onset_time"].is_string(), "{refused}");
    live.end();
}

#[test]
fn it_ends_when_nobody_reads() {
    let live = Live::start(&[]);
    let mut board = live.accept();
    // The reader closes its end, as `head` does.
    let Live { mut child, lines, .. } = live;
    drop(lines);
    board.write_all(text(&Line::Event(event(0))).as_bytes()).unwrap();
    let status = child.wait().unwrap();
    assert_eq!(status.code(), Some(0));
}

/// Before the first event, or with a board that is silent for a long time.
#[cfg(unix)]
#[test]
fn it_ends_when_nobody_reads_and_no_event_comes() {
    let live = Live::start(&["--json"]);
    let _board = live.accept();
    let Live { mut child, lines, .. } = live;
    drop(lines);
    let ended = (0..200).find_map(|_| {
        std::thread::sleep(Duration::from_millis(100));
        child.try_wait().unwrap()
    });
    let _ = child.kill();
    assert_eq!(ended.expect("ends by itself").code(), Some(0));
}

/// A Unix socket as the port.
#[cfg(unix)]
#[test]
fn a_unix_socket() {
    let path: PathBuf =
        std::env::temp_dir().join(format!("floe-live-{}.socket", std::process::id()));
    let _ = fs::remove_file(&path);
    let listener = std::os::unix::net::UnixListener::bind(&path).unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_floe"))
        .args(["live", &format!("unix:{}", path.display())])
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let (mut board, _) = listener.accept().unwrap();
    board.write_all((settings() + &text(&Line::Event(event(0)))).as_bytes()).unwrap();
    let mut line = String::new();
    BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
    assert!(line.starts_with("event 0  onset 1.594 s"), "{line}");
    child.kill().unwrap();
    child.wait().unwrap();
    fs::remove_file(path).unwrap();
}

/// Output on a terminal, up to the first question to the board.
#[cfg(target_os = "linux")]
fn on_a_terminal(no_color: &[(&str, &str)]) -> String {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let (floe, port) = (env!("CARGO_BIN_EXE_floe"), listener.local_addr().unwrap());
    let live = format!("stty rows 30 cols 100; exec '{floe}' live {port}");
    let mut terminal = Command::new("script")
        .args(["--quiet", "--command", &live, "/dev/null"])
        .envs([("SHELL", "/bin/sh"), ("TERM", "xterm-256color")])
        .env_remove("NO_COLOR")
        .envs(no_color.iter().copied())
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let _board = listener.accept().unwrap();
    let (mut keys, mut screen) = (terminal.stdin.take().unwrap(), terminal.stdout.take().unwrap());
    let (mut shown, mut bytes) = (String::new(), [0; 4096]);
    while !shown.contains("asking the board") {
        let count = screen.read(&mut bytes).unwrap();
        assert!(count > 0, "{shown}");
        shown += &String::from_utf8_lossy(&bytes[..count]);
    }
    keys.write_all(b"q").unwrap();
    screen.read_to_end(&mut Vec::new()).unwrap();
    terminal.wait().unwrap();
    shown
}

#[cfg(target_os = "linux")]
#[test]
fn a_terminal_has_colours_unless_they_are_switched_off() {
    let is_coloured = |shown: String| ["38;5;", "48;5;"].iter().any(|code| shown.contains(code));
    assert!(is_coloured(on_a_terminal(&[])));
    assert!(!is_coloured(on_a_terminal(&[("NO_COLOR", "1")])));
}
