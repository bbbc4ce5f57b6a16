//! Errors of the tools: a message of one line, with exit code 2.

use std::borrow::Cow;
use std::{fmt, io};

/// A problem with an input of the user.
///
/// Its text is one line with place, problem and remedy, whatever names and texts it contains.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InputError(String);

impl InputError {
    /// A problem as one sentence without a full stop.
    pub fn new(message: impl fmt::Display) -> Self {
        Self(printable_line(&message.to_string()).into_owned())
    }

    /// A file that could not be opened.
    #[must_use]
    pub fn unopened(error: io::Error) -> Self {
        Self::failed("cannot be opened", &error)
    }

    /// A failed read.
    #[must_use]
    pub fn unreadable(error: io::Error) -> Self {
        Self::failed("cannot be read", &error)
    }

    /// A failed operation, in the tool's words where it has some, else with the system's message.
    fn failed(what: &str, error: &io::Error) -> Self {
        let kind = error.kind();
        if kind == io::ErrorKind::NotFound {
            Self::new("no such file")
        } else if kind == io::ErrorKind::IsADirectory {
            Self::new("is a directory; name a file")
        } else {
            Self::new(format!("{what}: {error}"))
        }
    }

    /// Adds the place of the problem in front of the message.
    #[must_use]
    pub fn within(self, place: impl fmt::Display) -> Self {
        Self(format!("{}: {}", printable_line(&place.to_string()), self.0))
    }
}

impl fmt::Display for InputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for InputError {}

/// Lets code that writes a file from a log return an error of the log.
impl From<InputError> for io::Error {
    fn from(error: InputError) -> Self {
        Self::other(error)
    }
}

/// Text from a file for a message: in quotes, printable and short.
#[must_use]
pub fn excerpt(bytes: &[u8]) -> String {
    let text = String::from_utf8_lossy(bytes);
    let tail = if text.chars().nth(LONGEST).is_some() { "..." } else { "" };
    format!("'{}{tail}'", beginning(&text))
}

/// Letters of a text that a message shows.
const LONGEST: usize = 40;

/// The beginning of a text for a message, printable.
#[must_use]
pub fn beginning(text: &str) -> String {
    text.chars().take(LONGEST).flat_map(char::escape_debug).collect()
}

/// Text of several lines without control of the terminal: characters other than text and line ends
/// are written as `\u001b`, which in JSON is equivalent.
#[must_use]
pub fn printable_text(text: &str) -> Cow<'_, str> {
    escaped(text, |letter| commands(letter) && !matches!(letter, '\n' | '\t'))
}

/// Text of one line without control of the terminal; line ends are escaped too.
#[must_use]
pub fn printable_line(text: &str) -> Cow<'_, str> {
    escaped(text, commands)
}

/// Whether a letter moves the cursor, changes its colours or the direction of text.
fn commands(letter: char) -> bool {
    let turns = matches!(letter, '\u{200E}' | '\u{200F}' | '\u{2028}'..='\u{202E}')
        || matches!(letter, '\u{061C}' | '\u{2066}'..='\u{2069}');
    letter.is_control() || turns
}

fn escaped(text: &str, bad: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.contains(&bad) {
        return Cow::Borrowed(text);
    }
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match bad(letter) {
            true => escaped += &format!("\\u{:04x}", u32::from(letter)),
            false => escaped.push(letter),
        }
    }
    Cow::Owned(escaped)
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

    #[test]
    fn no_message_commands_a_terminal() {
        let hostile = "a\u{1b}[2J\u{9b}1m\u{202e}b\r\nc\u{7f}";
        let error = InputError::new(hostile).within(hostile).to_string();
        assert_eq!(error.lines().count(), 1);
        assert!(!error.contains(commands), "{error:?}");
        let text = printable_text("a\u{1b}b\n\tc – µ");
        assert_eq!(text, "a\\u001bb\n\tc – µ");
        assert!(matches!(printable_text("plain\n"), Cow::Borrowed(_)));
    }

    #[test]
    fn json_stays_the_same_json() {
        let said = serde_json::json!({ "test_id": "a\u{9b}\u{7f}\u{1b}\u{202e}b" });
        let text = serde_json::to_string_pretty(&said).unwrap();
        let back: serde_json::Value = serde_json::from_str(&printable_text(&text)).unwrap();
        assert_eq!(back, said);
    }
}
