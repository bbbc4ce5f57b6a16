//! Reads lines from a stream through a buffer of fixed size.

use std::io::Read;

use memchr::memchr;

use crate::error::InputError;

/// Longest accepted line, bytes. Lines of text logs are far shorter; a longer one belongs to
/// another kind of file and must not fill the memory.
pub const MAX_LINE: usize = 64 * 1024;

const BUFFER: usize = 4 * MAX_LINE;
const UTF8_MARK: &[u8] = b"\xEF\xBB\xBF";

/// One line without its end (LF, CR LF, or CR in a file without any LF).
#[derive(Clone, Copy, Debug)]
pub struct Line<'a> {
    /// Bytes of the line.
    pub bytes: &'a [u8],
    /// Line number from 1.
    pub number: u64,
    /// Whether the line has an end; the last line of a cut file has none.
    pub ended: bool,
}

/// Reads lines in constant memory, without seeking.
pub struct Lines {
    input: Box<dyn Read + Send>,
    buffer: Vec<u8>,
    start: usize,
    end: usize,
    exhausted: bool,
    number: u64,
    /// Last byte of a line.
    line_end: u8,
}

impl std::fmt::Debug for Lines {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Lines").field("number", &self.number).finish_non_exhaustive()
    }
}

impl Lines {
    /// Starts at the beginning of a stream.
    #[must_use]
    pub fn new(input: Box<dyn Read + Send>) -> Self {
        let buffer = vec![0; BUFFER];
        Self { input, buffer, start: 0, end: 0, exhausted: false, number: 0, line_end: b'\n' }
    }

    /// The first [`MAX_LINE`] bytes of the stream, or all, without a UTF-8 mark, and the end of a
    /// line: LF, or CR if they contain no LF. Does not consume them. Call it first.
    ///
    /// # Errors
    /// The stream cannot be read.
    pub fn head(&mut self) -> Result<(&[u8], u8), InputError> {
        while self.end < MAX_LINE + UTF8_MARK.len() && self.refill()? {}
        if self.number == 0 && self.unread().starts_with(UTF8_MARK) {
            self.start += UTF8_MARK.len();
        }
        let head = self.ahead();
        if self.number == 0 && !head.contains(&b'\n') && head.contains(&b'\r') {
            self.line_end = b'\r';
        }
        Ok((self.ahead(), self.line_end))
    }

    /// The next line; `None` at the end.
    ///
    /// # Errors
    /// The stream cannot be read, or a line is longer than [`MAX_LINE`].
    pub fn next_line(&mut self) -> Result<Option<Line<'_>>, InputError> {
        let mut searched = 0;
        let (length, ended) = loop {
            if let Some(at) =
                memchr(self.line_end, self.unread().get(searched..).unwrap_or_default())
            {
                break (searched + at, true);
            }
            searched = self.end - self.start;
            if searched > MAX_LINE {
                return Err(too_long(self.number + 1));
            }
            if !self.refill()? {
                break (searched, false);
            }
        };
        if length == 0 && !ended {
            return Ok(None);
        }
        if length > MAX_LINE {
            return Err(too_long(self.number + 1));
        }
        let begin = self.start;
        self.start += length + usize::from(ended);
        self.number += 1;
        let bytes = self.buffer.get(begin..begin + length).unwrap_or_default();
        let bytes = bytes.strip_suffix(b"\r").unwrap_or(bytes);
        Ok(Some(Line { bytes, number: self.number, ended }))
    }

    /// The bytes read and not consumed, up to [`MAX_LINE`].
    #[must_use]
    pub fn ahead(&self) -> &[u8] {
        let unread = self.unread();
        unread.get(..MAX_LINE).unwrap_or(unread)
    }

    /// Consumes a line of `length` bytes found by the caller; returns its number.
    pub fn take(&mut self, length: usize) -> u64 {
        self.start = self.end.min(self.start + length);
        self.number += 1;
        self.number
    }

    fn unread(&self) -> &[u8] {
        self.buffer.get(self.start..self.end).unwrap_or_default()
    }

    /// Reads more bytes after the unread ones; `false` at the end of the stream.
    fn refill(&mut self) -> Result<bool, InputError> {
        if self.exhausted {
            return Ok(false);
        }
        self.buffer.copy_within(self.start..self.end, 0);
        self.end -= self.start;
        self.start = 0;
        let count = loop {
            match self.input.read(self.buffer.get_mut(self.end..).unwrap_or_default()) {
                Ok(count) => break count,
                Err(error) if error.kind() == std::io::ErrorKind::Interrupted => {}
                Err(error) => return Err(InputError::unreadable(error)),
            }
        };
        self.exhausted = count == 0;
        self.end += count;
        Ok(count > 0)
    }
}

/// The error for a line that does not end within [`MAX_LINE`].
pub(super) fn too_long(number: u64) -> InputError {
    InputError::new(format!(
        "line {number}: longer than {} KiB, as no line of a text log is: shorten it, or take it out",
        MAX_LINE / 1024
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(bytes: &[u8]) -> Vec<(String, u64, bool)> {
        let mut lines = Lines::new(Box::new(std::io::Cursor::new(bytes.to_vec())));
        lines.head().unwrap();
        let mut all = Vec::new();
        while let Some(line) = lines.next_line().unwrap() {
            all.push((String::from_utf8_lossy(line.bytes).into_owned(), line.number, line.ended));
        }
        all
    }

    #[test]
    fn any_line_end_and_a_missing_one() {
        let expected =
            [("a", 1, true), ("", 2, true), ("b", 3, false)].map(|(t, n, e)| (t.to_string(), n, e));
        assert_eq!(lines(b"a\n\nb"), expected);
        assert_eq!(lines(b"\xEF\xBB\xBFa\r\n\r\nb"), expected);
        assert_eq!(lines(b"a\r\rb"), expected);
        assert!(lines(b"").is_empty());
    }

    #[test]
    fn lines_across_the_buffer_stay_whole() {
        let text: String = (0..100_000).map(|i| format!("{i}\n")).collect();
        let all = lines(text.as_bytes());
        assert_eq!(all.len(), 100_000);
        assert!(all.iter().enumerate().all(|(i, line)| line.0 == i.to_string()));
    }

    #[test]
    fn an_endless_line_is_refused_within_the_buffer() {
        let mut lines = Lines::new(Box::new(std::io::repeat(b'x')));
        let error = lines.next_line().unwrap_err();
        assert!(error.to_string().starts_with("line 1: longer than 64 KiB"));
    }
}
