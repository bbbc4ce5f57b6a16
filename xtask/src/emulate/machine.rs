//! The emulator running the firmware on the MPS2 board.

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

/// Speed of the processor: 62.5 million instructions per second.
const SHIFT: u32 = 4;

/// An emulator and a firmware, ready to run.
#[derive(Debug)]
pub struct Machine {
    qemu: &'static str,
    firmware: PathBuf,
}

/// Options of a run.
#[derive(Clone, Copy, Debug, Default)]
pub struct Setup<'a> {
    /// Whether every sample is printed, not only the results.
    pub samples: bool,
    /// TCP port of the board's UART 0, for a run in real time.
    pub port: Option<u16>,
    /// The SD card.
    pub card: Option<&'a Path>,
    /// Sample in the middle of the test at which the power fails.
    pub cut_at: Option<u64>,
}

/// Results of a run.
#[derive(Debug)]
pub struct Run {
    /// Output of the console.
    pub shown: String,
    /// Every conversion that the board read: number of the sample, and code.
    pub delivered: Vec<(u64, i32)>,
    /// Largest use of the stack, bytes.
    pub stack: u64,
    /// The firmware's log, not decoded.
    pub logged: Vec<u8>,
    /// Duration of the run.
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
    /// The build fails, or the emulator cannot be installed.
    pub fn prepare(forced: Option<Route>) -> Result<Self> {
        Self::with_features(forced, "mps2-an386")
    }

    /// Builds the firmware with other features and finds the emulator.
    ///
    /// # Errors
    /// The build fails, or the emulator cannot be installed.
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
        // Ends a test that a power cut has interrupted, which would be resumed.
        let first = if setup.card.is_some() { "stop\r\n" } else { "" };
        let typed = first.to_string() + &record.commands() + live + "start\r\n";
        directory.write("console.in", &typed)?;
        // The leading line end separates the command from input of a client.
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

    /// Largest use of the stack in a test with events.
    ///
    /// # Errors
    /// The firmware or the emulator failed.
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

/// Option of QEMU for UART 0 on a TCP port, for one client at a time.
fn socket(port: u16) -> String {
    format!("tcp:127.0.0.1:{port},server=on,wait=off,nodelay=on")
}

/// Prints the address of the console if the port is free.
pub(super) fn invite(port: u16) -> Result<()> {
    let free = TcpListener::bind(("127.0.0.1", port));
    free.map_err(|e| format!("port {port}: {e}; name another: --live PORT"))?;
    say(&format!("console: floe live 127.0.0.1:{port}, or nc 127.0.0.1 {port}"));
    Ok(())
}

/// Largest use of the stack from the board's last line on standard error; other lines are passed
/// on.
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
        // After a failure of the emulator nothing receives the result.
        let _ = sender.send(link.serve(&place));
    });
    let done = loop {
        if let Ok(done) = receiver.recv_timeout(Duration::from_millis(20)) {
            break done.map_err(|e| e.to_string())?;
        }
        if let Ok(Some(status)) = child.try_wait() {
            // A line that closes at the end stops the board, perhaps before the result arrives
            // here.
            match receiver.recv_timeout(Duration::from_secs(1)) {
                Ok(Ok(done)) if status.success() => return Ok(done),
                _ => return Err(format!("the firmware stopped ({status})")),
            }
        }
    };
    // The closed line makes the board end.
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
