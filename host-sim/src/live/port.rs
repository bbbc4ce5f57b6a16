//! The line to the board, kept up by a thread of its own.

use std::io::ErrorKind;
use std::sync::mpsc::{self, Receiver, Sender, SyncSender, TryRecvError, TrySendError};
use std::thread;
use std::time::Duration;

use crate::error::InputError;

use super::place::{Place, Stream};

/// Between attempts to open a port that went away.
const RETRY_WAIT: Duration = Duration::from_millis(500);

/// Pieces of at most 4 KiB that wait for the display: more is dropped and counted, so
/// that neither memory nor the time to the newest line grows.
const WAITING: usize = 64;

/// What comes of a port.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Input {
    /// It is open, for the first time or again.
    Up,
    /// The board said this, whole lines or not.
    Bytes(Vec<u8>),
    /// So many bytes came faster than they were taken, and are gone.
    Dropped(u64),
    /// It went away, and why; it is tried again.
    Down(String),
}

/// A port that comes back when it goes away.
#[derive(Debug)]
pub struct Port {
    inputs: Receiver<Input>,
    commands: Sender<String>,
}

impl Port {
    /// Opens a port. Only this first time a failure is an error.
    ///
    /// # Errors
    /// One line for the user.
    pub fn connect(place: &Place) -> Result<Self, InputError> {
        let stream = place.open()?;
        let (to_display, inputs) = mpsc::sync_channel(WAITING);
        let (commands, to_board) = mpsc::channel();
        let place = place.clone();
        // It ends when nobody listens any more.
        thread::spawn(move || keep_up(&place, stream, &to_display, &to_board));
        Ok(Self { inputs, commands })
    }

    /// Says a line to the board. While the port is away it is not said at all:
    /// nothing must start by itself minutes later.
    pub fn say(&self, command: &str) {
        let _ = self.commands.send(format!("{command}\r\n"));
    }

    /// The next thing that happened, if it happens in time.
    #[must_use]
    pub fn next(&self, wait: Duration) -> Option<Input> {
        self.inputs.recv_timeout(wait).ok()
    }
}

/// Nobody listens any more.
struct Unheard;

/// Talks, and opens the port again whenever it went away.
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
        // Closed before it is opened again: a serial port may belong to one only.
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

/// Talks until the port goes away: why it did.
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

/// Gives bytes to the display, or counts them if it has no room.
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

/// Does something with every command that waits.
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
