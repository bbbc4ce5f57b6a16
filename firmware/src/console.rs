//! The serial line to the user: lines in, lines out.

use embedded_io::{Read, ReadReady, Write};
use heapless::String;

use crate::line::Line;

/// Longest command.
pub const INPUT_LEN: usize = 80;

/// A port, and the line that is being typed.
#[derive(Debug)]
pub struct Console<P> {
    port: P,
    input: String<INPUT_LEN>,
    too_long: bool,
}

/// What was typed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Typed {
    /// A line, without its end, never empty.
    Line(String<INPUT_LEN>),
    /// A line too long to be a command; it was thrown away.
    TooLong,
}

impl<P: Read + ReadReady + Write> Console<P> {
    /// Nothing typed yet.
    pub fn new(port: P) -> Self {
        Self { port, input: String::new(), too_long: false }
    }

    /// The next line, if it is complete. CR, LF and both together end a line.
    /// A port that fails has nothing to say.
    pub fn poll(&mut self) -> Option<Typed> {
        while self.port.read_ready().unwrap_or(false) {
            let mut byte = [0];
            if self.port.read(&mut byte).unwrap_or(0) == 0 {
                return None;
            }
            if let Some(typed) = self.take(byte[0]) {
                return Some(typed);
            }
        }
        None
    }

    fn take(&mut self, byte: u8) -> Option<Typed> {
        const BACKSPACE: u8 = 0x08;
        const DELETE: u8 = 0x7F;
        match byte {
            b'\r' | b'\n' if self.too_long => {
                self.too_long = false;
                self.input.clear();
                return Some(Typed::TooLong);
            }
            b'\r' | b'\n' if self.input.bytes().all(|byte| byte == b' ') => self.input.clear(),
            b'\r' | b'\n' => return Some(Typed::Line(core::mem::take(&mut self.input))),
            BACKSPACE | DELETE => drop(self.input.pop()),
            b' '..=b'~' => self.too_long |= self.input.push(char::from(byte)).is_err(),
            // Whatever a line picks up when it is plugged in.
            _ => {}
        }
        None
    }

    /// Sends a line. A port that fails loses it: the card has it too.
    pub fn say(&mut self, text: &str) {
        let _ = self.port.write_all(text.as_bytes());
        let _ = self.port.write_all(b"\r\n");
    }

    /// Sends a message that is not for the card.
    pub fn tell(&mut self, line: &Line<'_>) {
        if let Ok(text) = line.to_text() {
            self.say(&text);
        }
    }
}
