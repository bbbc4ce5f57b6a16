//! The connection to the board, maintained by a separate thread.

use std::io::ErrorKind;
use std::sync::mpsc::{self, Receiver, Sender, SyncSender, TryRecvError, TrySendError};
use std::thread;
use std::time::Duration;

use crate::error::InputError;

use super::place::{Place, Stream};

/// Time between attempts to reopen a lost port.
const RETRY_WAIT: Duration = Duration::from_millis(500);

/// Number of pieces of at most 4 KiB that wait for the display. More are dropped and counted, so
/// that neither memory nor the delay of the newest line grows.
const WAITING: usize = 64;

/// Event of a port.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Input {
    /// The port was opened or reopened.
    Up,
    /// Bytes from the board, not necessarily complete lines.
    Bytes(Vec<u8>),
    /// Number of bytes that arrived too fast and were dropped.
    Dropped(u64),
    /// The port was lost, with the reason; reopening is attempted.
    Down(String),
}

/// A port that is reopened when it is lost.
#[derive(Debug)]
pub struct Port {
    inputs: Receiver<Input>,
    commands: Sender<String>,
}

impl Port {
    /// Opens a port. Only this first attempt can fail with an error.
    ///
    /// # Errors
    /// A message of one line.
    pub fn connect(place: &Place) -> Result<Self, InputError> {
        let stream = place.open()?;
        let (to_display, inputs) = mpsc::sync_channel(WAITING);
        let (commands, to_board) = mpsc::channel();
        let place = place.clone();
        // The thread ends when the receiver is dropped.
        thread::spawn(move || keep_up(&place, stream, &to_display, &to_board));
        Ok(Self { inputs, commands })
    }

    /// Sends a line to the board. While the port is lost the line is discarded, because a command
    /// must not take effect minutes later.
    pub fn say(&self, command: &str) {
        let _ = self.commands.send(format!("{command}\r\n"));
    }

    /// The next event, if one arrives in time.
    #[must_use]
    pub fn next(&self, wait: Duration) -> Option<Input> {
        self.inputs.recv_timeout(wait).ok()
    }
}

/// The receiver was dropped.
struct Unheard;

/// Communicates with the board and reopens the port when it is lost.
fn keep_up(
    place: &Place,
    mut stream: Box<dyn Stream>,
    to_display: &SyncSender<Input>,
    to_board: &Receiver<String>,
) -> Unheard {
    let tell = |input| to_display.send(input).is_ok();
    while tell(Input::Up) {
        match talk(&mut *stream, to_display, to_board) {
            Ok(reason) => tell(Input::Down(reason)),
            Err(Unheard) => return Unheard,
        };
        // Closed before it is reopened, because a serial port may be open only once.
        drop(stream);
        stream = loop {
            thread::sleep(RETRY_WAIT);
            if commands(to_board, |_| ()).is_err() {
                return Unheard;
            }
            if let Ok(stream) = place.open() {
                break stream;
            }
        };
    }
    Unheard
}

/// Communicates until the port is lost; returns the reason.
fn talk(
    stream: &mut dyn Stream,
    to_display: &SyncSender<Input>,
    to_board: &Receiver<String>,
) -> Result<String, Unheard> {
    let mut bytes = [0; 4096];
    let mut dropped = 0;
    loop {
        let mut said = Ok(());
        commands(to_board, |line| {
            if said.is_ok() {
                said = stream.write_all(line.as_bytes());
            }
        })?;
        if let Err(error) = said {
            return Ok(error.to_string());
        }
        match stream.read(&mut bytes) {
            Ok(0) => return Ok("closed".to_string()),
            Ok(count) => {
                let bytes = bytes.get(..count).unwrap_or_default();
                hand_over(bytes, &mut dropped, to_display)?;
            }
            Err(error) if is_pause(error.kind()) => {}
            Err(error) => return Ok(error.to_string()),
        }
    }
}

/// Passes bytes to the display, or counts them if there is no room.
fn hand_over(
    bytes: &[u8],
    dropped: &mut u64,
    to_display: &SyncSender<Input>,
) -> Result<(), Unheard> {
    let offer = |input| match to_display.try_send(input) {
        Ok(()) => Ok(true),
        Err(TrySendError::Full(_)) => Ok(false),
        Err(TrySendError::Disconnected(_)) => Err(Unheard),
    };
    if *dropped > 0 && offer(Input::Dropped(*dropped))? {
        *dropped = 0;
    }
    if *dropped > 0 || !offer(Input::Bytes(bytes.to_vec()))? {
        *dropped += bytes.len() as u64;
    }
    Ok(())
}

/// Calls `each` for every waiting command.
fn commands(to_board: &Receiver<String>, mut each: impl FnMut(String)) -> Result<(), Unheard> {
    loop {
        match to_board.try_recv() {
            Ok(line) => each(line),
            Err(TryRecvError::Empty) => return Ok(()),
            Err(TryRecvError::Disconnected) => return Err(Unheard),
        }
    }
}

fn is_pause(kind: ErrorKind) -> bool {
    [ErrorKind::TimedOut, ErrorKind::WouldBlock, ErrorKind::Interrupted].contains(&kind)
}
