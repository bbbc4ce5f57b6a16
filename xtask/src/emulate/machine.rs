//! The emulator with the firmware in it.

use std::fs;
use std::io::Read;
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::{Child, Stdio};
use std::sync::mpsc;
use std::time::{Duration, Instant};

use floe::chip::SerialChip;

use super::directory::Directory;
use super::link::{Link, Typist};
use super::record::Record;
use crate::Result;
use crate::arm::Route;
use crate::qemu;
use crate::shell::say;

/// 62.5 million instructions per second.
const SHIFT: u32 = 4;

/// A firmware that is ready to run.
#[derive(Debug)]
pub struct Machine {
    qemu: &'static str,
    firmware: PathBuf,
}

/// How to run.
#[derive(Clone, Copy, Debug, Default)]
pub struct Setup<'a> {
    /// Every sample is shown, not only what comes of them.
    pub samples: bool,
    /// In real time, the board's UART 0 on this TCP port of this PC.
    pub port: Option<u16>,
    /// The SD card.
    pub card: Option<&'a Path>,
    /// The power fails at this sample, in the middle of the test.
    pub cut_at: Option<u64>,
}

/// What a run gave.
#[derive(Debug)]
pub struct Run {
    /// What the board said.
    pub shown: String,
    /// Every conversion that the board read: number of the sample and code.
    pub delivered: Vec<(u64, i32)>,
    /// Bytes of stack used at most.
    pub stack: u64,
    /// What the firmware logged, undecoded.
    pub logged: Vec<u8>,
    /// Time it took.
    pub wall: Duration,
}

impl Machine {
    /// The firmware's file.
    pub fn firmware(&self) -> &Path {
        &self.firmware
    }

    /// Builds the firmware and finds the emulator.
    ///
    /// # Errors
    /// One of them is not to be had.
    pub fn prepare(forced: Option<Route>) -> Result<Self> {
        Self::with_features(forced, "mps2-an386")
    }

    /// The same with other features of the firmware.
    ///
    /// # Errors
    /// As [`Machine::prepare`].
    pub fn with_features(forced: Option<Route>, features: &str) -> Result<Self> {
        let qemu = qemu::find()?;
        let firmware = Route::find(forced)?.build_firmware("mps2-an386", features)?;
        Ok(Self { qemu, firmware })
    }

    /// Runs a record from power-up to the end of the test.
    ///
    /// # Errors
    /// The firmware or the emulator failed.
    pub fn run(&self, record: &Record, setup: Setup<'_>) -> Result<Run> {
        let directory = Directory::new()?;
        directory.make_fifos()?;
        if let Some(card) = setup.card {
            directory.link(card, "card.img")?;
        }
        let live = if setup.samples { "live on\r\n" } else { "live off\r\n" };
        // A test that the power failed in would go on.
        let first = if setup.card.is_some() { "stop\r\n" } else { "" };
        let typed = first.to_string() + &record.commands() + live + "start\r\n";
        directory.write("console.in", &typed)?;
        // In a line of its own, whatever a person may just be typing.
        let typist = vec![(record.codes.len() as u64, "\r\nstop\r\n".to_string())];
        let typist = Typist::new(&directory.path("console.in"), typist);
        let typist = typist.map_err(|e| e.to_string())?;
        let (load_cell, trouble) = record.load_cell();
        let chip = SerialChip::new(load_cell, trouble, 0);
        let start = Instant::now();
        if let Some(port) = setup.port {
            directory.write("uart", "")?;
            invite(port)?;
        }
        let mut child = self.spawn(&directory, setup.port)?;
        let link = Link { chip, typist, real_time: setup.port.is_some(), cut_at: setup.cut_at };
        let done = serve(&directory, link, &mut child);
        let stack = stack_of(&mut child);
        let wall = start.elapsed();
        let shown = fs::read_to_string(directory.path("console.out")).unwrap_or_default();
        let chip = done.map_err(|e| format!("{e}; the board's last words: {}", tail(&shown)))?;
        let logged = fs::read(directory.path("logged")).unwrap_or_default();
        Ok(Run { shown, logged, delivered: chip.device().delivered().to_vec(), stack, wall })
    }

    /// Deepest stack in a test with events.
    ///
    /// # Errors
    /// As [`Machine::run`].
    pub fn stack_used(&self) -> Result<u64> {
        Ok(self.run(&Record::stick_slip(), Setup::default())?.stack)
    }

    fn spawn(&self, directory: &Directory, port: Option<u16>) -> Result<Child> {
        let socket = port.map(socket);
        let socket = socket.as_deref();
        let mut command = qemu::board(self.qemu, SHIFT, socket, &self.firmware, directory.place());
        let logged = fs::File::create(directory.path("logged")).map_err(|e| e.to_string())?;
        command.stdin(Stdio::null()).stdout(logged).stderr(Stdio::piped());
        command.spawn().map_err(|e| format!("cannot start {}: {e}", self.qemu))
    }
}

/// UART 0 for whoever comes, one at a time, again and again.
fn socket(port: u16) -> String {
    format!("tcp:127.0.0.1:{port},server=on,wait=off,nodelay=on")
}

/// Says where the console will be, if that port is free.
pub(super) fn invite(port: u16) -> Result<()> {
    let free = TcpListener::bind(("127.0.0.1", port));
    free.map_err(|e| format!("port {port}: {e}; name another: --live PORT"))?;
    say(&format!("console: floe live 127.0.0.1:{port}, or nc 127.0.0.1 {port}"));
    Ok(())
}

/// What the board says about its stack at its end; whatever else it or the
/// emulator says there is passed on.
fn stack_of(child: &mut Child) -> u64 {
    let mut text = String::new();
    if let Some(mut stderr) = child.stderr.take() {
        let _ = stderr.read_to_string(&mut text);
    }
    let mut stack = 0;
    for line in text.lines() {
        match line.strip_prefix("stack ").and_then(|rest| rest.split(' ').next()?.parse().ok()) {
            Some(used) => stack = used,
            None => eprintln!("{line}"),
        }
    }
    stack
}

/// Serves the converter while the emulator lives.
fn serve(directory: &Directory, link: Link, child: &mut Child) -> Result<SerialChip> {
    let (sender, receiver) = mpsc::channel();
    let place = directory.place().to_path_buf();
    std::thread::spawn(move || {
        // Nobody waits for the answer when the emulator has failed.
        let _ = sender.send(link.serve(&place));
    });
    let done = loop {
        if let Ok(done) = receiver.recv_timeout(Duration::from_millis(20)) {
            break done.map_err(|e| e.to_string())?;
        }
        if let Ok(Some(status)) = child.try_wait() {
            // A line that was just closed ends the board before it is told of here.
            match receiver.recv_timeout(Duration::from_secs(1)) {
                Ok(Ok(done)) if status.success() => return Ok(done),
                _ => return Err(format!("the firmware stopped ({status})")),
            }
        }
    };
    // The line is closed: the board ends by itself.
    let end = Instant::now() + Duration::from_secs(5);
    while Instant::now() < end {
        match child.try_wait() {
            Ok(Some(status)) if status.success() => return Ok(done),
            Ok(Some(status)) => return Err(format!("the firmware stopped ({status})")),
            _ => std::thread::sleep(Duration::from_millis(2)),
        }
    }
    let _ = child.kill();
    Err("the firmware did not notice the end".into())
}

pub(super) fn tail(text: &str) -> String {
    let lines: Vec<&str> = text.lines().collect();
    lines[lines.len().saturating_sub(3)..].join(" | ")
}
