//! Bytes to lines.

/// Far more than the longest line of a board; beyond it, it is no board's.
const LONGEST: usize = 4096;

/// Collects bytes until a line is whole.
#[derive(Debug, Default)]
pub struct Lines {
    partial: Vec<u8>,
    /// A line has begun since the port was opened: what comes now is a whole one.
    begun: bool,
}

/// A line as it came, without its end.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Received {
    /// Its text; what is no UTF-8 is replaced, which its checksum will tell.
    pub text: String,
    /// It began before the port was opened: a damaged one says nothing.
    pub cut: bool,
}

impl Lines {
    /// Takes bytes, and gives the lines that they complete; empty ones are no lines.
    pub fn take(&mut self, bytes: &[u8]) -> Vec<Received> {
        let mut received = Vec::new();
        for &byte in bytes {
            let whole = byte == b'\n' || self.partial.len() >= LONGEST;
            if whole {
                let text = String::from_utf8_lossy(&self.partial).trim_end().to_string();
                if !text.is_empty() {
                    received.push(Received { text, cut: !self.begun });
                }
                self.begun = true;
                self.partial.clear();
            }
            if byte != b'\n' {
                self.partial.push(byte);
            }
        }
        received
    }

    /// The port is another one now: what was begun is not continued.
    pub fn restart(&mut self) {
        *self = Self::default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(lines: &[Received]) -> Vec<&str> {
        lines.iter().map(|line| line.text.as_str()).collect()
    }

    #[test]
    fn pieces_become_lines() {
        let mut lines = Lines::default();
        assert_eq!(lines.take(b"tail of one"), []);
        let received = lines.take(b"\r\nwhole\r\n\r\nbeg");
        assert_eq!(texts(&received), ["tail of one", "whole"]);
        assert_eq!(received.iter().map(|l| l.cut).collect::<Vec<_>>(), [true, false]);
        assert_eq!(texts(&lines.take(b"un\n\xFF\n")), ["begun", "\u{FFFD}"]);
        let _ = lines.take(b"lost");
        lines.restart();
        assert_eq!(lines.take(b"cut\n"), [Received { text: "cut".to_string(), cut: true }]);
    }

    #[test]
    fn noise_without_end_is_cut() {
        let mut lines = Lines::default();
        let received = lines.take(&vec![b'x'; 3 * LONGEST]);
        assert_eq!(received.len(), 2);
        assert!(received.iter().all(|line| line.text.len() == LONGEST));
    }
}
