//! Splits bytes into lines.

/// Largest length of a line, bytes, far above that of a board's lines.
const LONGEST: usize = 4096;

/// Collects bytes until a line is complete.
#[derive(Debug, Default)]
pub struct Lines {
    partial: Vec<u8>,
    /// Whether a line has begun since the port was opened, so that the next one is complete.
    begun: bool,
}

/// A received line without its end.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Received {
    /// Text of the line; invalid UTF-8 is replaced, and the checksum then fails.
    pub text: String,
    /// Whether the line began before the port was opened, so that damage is no fault.
    pub cut: bool,
}

impl Lines {
    /// Takes bytes and returns the lines that they complete, except empty ones.
    pub fn take(&mut self, bytes: &[u8]) -> Vec<Received> {
        let mut received = Vec::new();
        for &byte in bytes {
            let whole = byte == b'\n' || self.partial.len() >= LONGEST;
            if whole {
                if let Some(text) = text(&self.partial) {
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

    /// Ends an unfinished line whose rest will not come, and returns it.
    #[must_use]
    pub fn restart(&mut self) -> Option<String> {
        text(&std::mem::take(self).partial)
    }
}

/// Text of a line; `None` for an empty one.
fn text(bytes: &[u8]) -> Option<String> {
    let text = String::from_utf8_lossy(bytes).trim_end().to_string();
    Some(text).filter(|text| !text.is_empty())
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
        let _ = lines.take(b"unfin\r");
        assert_eq!(lines.restart().as_deref(), Some("unfin"));
        assert_eq!(lines.restart(), None);
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
