//! The serial line to the user: lines in, lines out.

use embedded_io::{Read, ReadReady, Write};
use heapless::String;

use crate::line::Line;

/// Longest command.
pub const INPUT_LEN: usize = 80;

/// What a port gives instead of characters that it had no room for (ASCII's *cancel*): the line that
/// has it is none.
pub const LOST: u8 = 0x18;

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
    /// A line too long to be a command, or for the port; it was thrown away.
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
            LOST => self.too_long = true,
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

#[cfg(test)]
mod tests {
    use super::*;
    use core::convert::Infallible;

    /// What was typed, and nobody who listens.
    struct Port<'a>(&'a [u8]);

    impl embedded_io::ErrorType for Port<'_> {
        type Error = Infallible;
    }

    impl ReadReady for Port<'_> {
        fn read_ready(&mut self) -> Result<bool, Infallible> {
            Ok(!self.0.is_empty())
        }
    }

    impl Read for Port<'_> {
        fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Infallible> {
            self.0.read(buffer)
        }
    }

    impl Write for Port<'_> {
        fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
            Ok(bytes.len())
        }

        fn flush(&mut self) -> Result<(), Infallible> {
            Ok(())
        }
    }

    /// Two halves of lines never make a third one.
    #[test]
    fn a_line_that_the_port_has_lost_some_of_is_none() {
        let mut console = Console::new(Port(b"set snow 1\nset snow\x18eight 56\nset snow 2\n"));
        let typed: Vec<_> = core::iter::from_fn(|| console.poll()).collect();
        let line = |text| Typed::Line(String::try_from(text).unwrap());
        assert_eq!(typed, [line("set snow 1"), Typed::TooLong, line("set snow 2")]);
    }
}
