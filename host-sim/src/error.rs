//! What a tool says when it cannot go on: one line, then exit code 2.

use std::fmt;

/// A problem with something the user gave.
///
/// Reads as one line that says where, what, and what to do about it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InputError(String);

impl InputError {
    /// A problem as one sentence without a full stop.
    pub fn new(message: impl Into<String>) -> Self {
        Self(message.into())
    }

    /// The same problem with the place where it is put in front.
    #[must_use]
    pub fn within(self, place: impl fmt::Display) -> Self {
        Self(format!("{place}: {}", self.0))
    }
}

impl fmt::Display for InputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for InputError {}

/// Text from a file made fit for a message: in quotes, printable and short.
#[must_use]
pub fn excerpt(bytes: &[u8]) -> String {
    const LONGEST: usize = 40;
    let text = String::from_utf8_lossy(bytes);
    let tail = if text.chars().nth(LONGEST).is_some() { "..." } else { "" };
    let start: String = text.chars().take(LONGEST).flat_map(char::escape_debug).collect();
    format!("'{start}{tail}'")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_excerpt_is_one_short_printable_line() {
        assert_eq!(excerpt(b"abc"), "'abc'");
        assert_eq!(excerpt(b"a\nb\0"), "'a\\nb\\0'");
        assert_eq!(excerpt(&[b'x'; 100]).len(), 2 + 40 + 3);
    }
}
