//! The loop of the display: handles port and keys, draws frames.

use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use ratatui::DefaultTerminal;
use ratatui::crossterm::event::{self, Event};

use floe_firmware::wall_clock::Moment;

use crate::error::InputError;

use super::ask::{Ask, Deed};
use super::lines::Lines;
use super::place::Place;
use super::port::{Input, Port};
use super::save::Save;
use super::screen;
use super::state::State;

/// Longest delay of a key or a sample.
const KEY_WAIT: Duration = Duration::from_millis(40);
/// Number of pieces processed before the next frame and key, which limits a flood.
const BATCH: usize = 16;
/// Longest time between frames, for content that changes without input (clock, silence).
const REDRAW: Duration = Duration::from_millis(500);
/// Longest time between requests of the board's state; and the shortest after an event.
pub(super) const ASK_EVERY: Duration = Duration::from_secs(5);
const ASK_AFTER_EVENT: Duration = Duration::from_secs(1);

/// Whether a signal has asked the program to end.
static ENDED: AtomicBool = AtomicBool::new(false);

/// Shows the board until the user leaves, or a signal ends the program: the terminal is as before.
///
/// # Errors
/// The terminal fails, or the file cannot be written.
pub fn run(place: &Place, port: &Port, save: Option<Save>) -> Result<(), InputError> {
    let failed = |error: io::Error| InputError::new(format!("this terminal: {error}"));
    // Without a handler a signal would leave the terminal on another screen.
    drop(ctrlc::set_handler(|| ENDED.store(true, Ordering::Relaxed)));
    let mut terminal = ratatui::try_init().map_err(failed)?;
    let mut display = Display::new(place, port, save);
    let done = display.watch(&mut terminal);
    // Before any message, because until then another screen is active.
    ratatui::restore();
    match (done, display.unsaved) {
        (Err(error), _) => Err(failed(error)),
        (Ok(()), Some(error)) => Err(error),
        (Ok(()), None) => Ok(()),
    }
}

struct Display<'a> {
    place: String,
    port: &'a Port,
    save: Option<Save>,
    /// Error that ended the file early.
    unsaved: Option<InputError>,
    lines: Lines,
    state: State,
    ask: Ask,
    start: Instant,
    asked: Duration,
    event_came: bool,
}

impl<'a> Display<'a> {
    fn new(place: &Place, port: &'a Port, save: Option<Save>) -> Self {
        Self {
            place: place.to_string(),
            port,
            save,
            unsaved: None,
            lines: Lines::default(),
            state: State::default(),
            ask: Ask::default(),
            start: Instant::now(),
            asked: Duration::ZERO,
            event_came: false,
        }
    }

    fn watch(&mut self, terminal: &mut DefaultTerminal) -> io::Result<()> {
        let mut drawn = None;
        while !ENDED.load(Ordering::Relaxed) {
            let taken = self.listen();
            let mut changed = taken > 0;
            self.question_board();
            let wait = if taken < BATCH { KEY_WAIT } else { Duration::ZERO };
            if event::poll(wait)? {
                changed = true;
                if let Event::Key(key) = event::read()? {
                    match self.ask.key(key) {
                        Deed::None => {}
                        Deed::Say(command) => self.say(command),
                        Deed::Quit => break,
                    }
                }
            }
            let now = self.start.elapsed();
            if changed || drawn.is_none_or(|drawn| now.saturating_sub(drawn) > REDRAW) {
                terminal.draw(|frame| {
                    screen::draw(frame, &self.state, &self.ask, &self.place, now);
                })?;
                drawn = Some(now);
            }
        }
        self.keep_unfinished(self.start.elapsed());
        Ok(())
    }

    fn say(&mut self, command: String) {
        self.port.say(&command);
        self.state.said = Some((command, self.start.elapsed()));
    }

    /// Processes waiting input, up to a batch; returns the number of pieces.
    fn listen(&mut self) -> usize {
        for taken in 0..BATCH {
            let Some(input) = self.port.next(Duration::ZERO) else { return taken };
            let now = self.start.elapsed();
            match input {
                Input::Up => {
                    self.state.up(now);
                    self.port.say(&clock_now());
                    self.port.say("live on");
                    self.question(now);
                }
                Input::Down(reason) => {
                    self.state.down(reason);
                    self.keep_unfinished(now);
                }
                Input::Bytes(bytes) => self.take(&bytes, now),
                Input::Dropped(bytes) => {
                    self.keep_unfinished(now);
                    self.state.drop(bytes, now);
                }
            }
        }
        BATCH
    }

    fn take(&mut self, bytes: &[u8], now: Duration) {
        for received in self.lines.take(bytes) {
            self.keep(&received.text, now);
            self.event_came |= self.state.take(&received, now).is_some();
        }
    }

    /// Saves the beginning of a line whose rest will not come.
    fn keep_unfinished(&mut self, now: Duration) {
        if let Some(text) = self.lines.restart() {
            self.keep(&text, now);
        }
    }

    /// Saves a line; a failing file must not end the display.
    fn keep(&mut self, text: &str, now: Duration) {
        if let Some(Err(error)) = self.save.as_mut().map(|save| save.line(text)) {
            self.state.complaint = Some((error.to_string(), now));
            self.unsaved = Some(error);
            self.save = None;
        }
    }

    /// Requests the result so far and the board's health, which the board sends on request only.
    fn question_board(&mut self) {
        let now = self.start.elapsed();
        let since = now.saturating_sub(self.asked);
        if since > ASK_EVERY || self.event_came && since > ASK_AFTER_EVENT {
            self.question(now);
        }
    }

    fn question(&mut self, now: Duration) {
        self.port.say("status");
        (self.asked, self.event_came) = (now, false);
    }
}

/// Command that sets the board's clock by this PC's.
fn clock_now() -> String {
    let since = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    let unix_ms = since.map_or(0, |since| since.as_millis() as u64);
    format!("clock {}", Moment(unix_ms))
}

#[cfg(test)]
mod tests {
    use std::io::Read;
    use std::net::TcpListener;

    use super::*;

    /// When the port opens, the display sets the clock, requests all samples and the state.
    #[test]
    fn a_board_is_told_the_time_when_the_port_comes_up() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let place = Place::parse(&listener.local_addr().unwrap().to_string());
        let port = Port::connect(&place).unwrap();
        let (mut board, _) = listener.accept().unwrap();
        board.set_read_timeout(Some(Duration::from_millis(100))).unwrap();
        let mut display = Display::new(&place, &port, None);
        let (mut said, mut bytes) = (String::new(), [0; 256]);
        while !said.contains("status\r\n") {
            let _ = display.listen();
            let count = board.read(&mut bytes).unwrap_or(0);
            said.push_str(std::str::from_utf8(&bytes[..count]).unwrap());
            assert!(display.start.elapsed() < Duration::from_secs(20), "{said}");
        }
        let (clock, rest) = said.split_once("\r\n").unwrap();
        assert_eq!(rest, "live on\r\nstatus\r\n");
        let told = Moment::parse(clock.strip_prefix("clock ").unwrap()).unwrap();
        let now = Moment::parse(clock_now().strip_prefix("clock ").unwrap()).unwrap();
        assert!(now.0.abs_diff(told.0) < 20_000, "{clock}");
    }
}
