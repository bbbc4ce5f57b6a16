//! `floe live` on a terminal that is ended by a signal.
#![cfg(unix)]

use std::fs::File;
use std::io::Read;
use std::net::TcpListener;
use std::os::fd::AsFd;
use std::process::{Child, Command};
use std::time::{Duration, Instant};

use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{LocalModes, Winsize, tcgetattr, tcsetwinsize};

/// What a terminal is told to show another screen, and the old one again.
const OTHER: &str = "\x1b[?1049h";
const OLD: &str = "\x1b[?1049l";

/// Both ends of a terminal of 80 times 24 letters.
fn terminal() -> (File, File) {
    let ours = openpt(OpenptFlags::RDWR | OpenptFlags::NOCTTY).unwrap();
    grantpt(&ours).unwrap();
    unlockpt(&ours).unwrap();
    let size = Winsize { ws_row: 24, ws_col: 80, ws_xpixel: 0, ws_ypixel: 0 };
    tcsetwinsize(&ours, size).unwrap();
    let name = ptsname(&ours, Vec::new()).unwrap().into_string().unwrap();
    let theirs = File::options().read(true).write(true).open(name).unwrap();
    (ours.into(), theirs)
}

fn is_cooked(terminal: impl AsFd) -> bool {
    tcgetattr(terminal).unwrap().local_modes.contains(LocalModes::ICANON | LocalModes::ECHO)
}

/// Reads until the text has been written.
fn read_until(terminal: &mut File, text: &str) {
    let (mut said, mut bytes) = (String::new(), [0; 4096]);
    while !said.contains(text) {
        let count = terminal.read(&mut bytes).unwrap();
        said.push_str(&String::from_utf8_lossy(&bytes[..count]));
    }
}

fn wait(mut child: Child) -> std::process::ExitStatus {
    let start = Instant::now();
    loop {
        if let Some(status) = child.try_wait().unwrap() {
            return status;
        }
        assert!(start.elapsed() < Duration::from_secs(20), "it goes on");
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn a_signal_leaves_the_terminal_as_it_was() {
    for signal in ["-TERM", "-INT", "-HUP"] {
        let board = TcpListener::bind("127.0.0.1:0").unwrap();
        let port = board.local_addr().unwrap().to_string();
        let (mut ours, theirs) = terminal();
        assert!(is_cooked(&theirs));
        let end = || theirs.try_clone().unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_floe"));
        command.args(["live", &port]).stdin(end()).stdout(end()).stderr(end());
        let child = command.env("TERM", "xterm").spawn().unwrap();
        read_until(&mut ours, OTHER);
        assert!(!is_cooked(&theirs));
        let id = child.id().to_string();
        assert!(Command::new("kill").args([signal, &id]).status().unwrap().success());
        read_until(&mut ours, OLD);
        assert_eq!(wait(child).code(), Some(0), "{signal}");
        assert!(is_cooked(&theirs), "{signal}");
    }
}
