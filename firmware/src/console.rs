//! The serial console: reads lines and sends lines.

use embedded_io::{Read, ReadReady, Write};
use heapless::String;

use crate::line::Line;

/// Longest command.
pub const INPUT_LEN: usize = 80;

/// Character (ASCII *cancel*) that a port delivers in place of lost characters; a line that
/// contains it is discarded.
pub const LOST: u8 = 0x18;

/// A port, and the line being typed.
#[derive(Debug)]
pub struct Console<P> {
    port: P,
    input: String<INPUT_LEN>,
    too_long: bool,
}

/// Input of the user.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Typed {
    /// A complete line without its end, never empty.
    Line(String<INPUT_LEN>),
    /// A line that was too long for a command or for the port, and was discarded.
    TooLong,
}

impl<P: Read + ReadReady + Write> Console<P> {
    /// A console without input yet.
    pub fn new(port: P) -> Self {
        Self { port, input: String::new(), too_long: false }
    }

    /// The next complete line; CR, LF or both end a line. A port that fails delivers no input.
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
            // Other bytes, such as noise when the cable is plugged in.
            _ => {}
        }
        None
    }

    /// Sends a line. If the port fails the line is lost here, but the card has it too.
    pub fn say(&mut self, text: &str) {
        let _ = self.port.write_all(text.as_bytes());
        let _ = self.port.write_all(b"\r\n");
    }

    /// Sends a problem that does not go to the card.
    pub fn trouble(&mut self, text: &str) {
        self.tell(&Line::Trouble(text));
    }

    /// Sends a message that does not go to the card.
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

    /// A port with fixed input; its output is discarded.
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

    /// A line with lost characters is not joined with the next one.
    #[test]
    fn a_line_that_the_port_has_lost_some_of_is_none() {
        let mut console = Console::new(Port(b"set snow 1\nset snow\x18eight 56\nset snow 2\n"));
        let typed: Vec<_> = core::iter::from_fn(|| console.poll()).collect();
        let line = |text| Typed::Line(String::try_from(text).unwrap());
        assert_eq!(typed, [line("set snow 1"), Typed::TooLong, line("set snow 2")]);
    }
}
