//! Splits a line into cells.

use std::borrow::Cow;

use memchr::memchr2_iter;

/// Bounds of the cells of one line, reused from line to line.
///
/// Quoting follows RFC 4180: a cell in double quotes may contain the separator. Quoted line breaks
/// are not supported, because no logger writes them.
#[derive(Clone, Debug, Default)]
pub struct Cells {
    bounds: Vec<(usize, usize)>,
}

/// A cell as text; empty if it is not valid text.
pub fn text(cell: &[u8]) -> &str {
    std::str::from_utf8(cell).unwrap_or_default()
}

/// Text in UTF-8, or else in Latin-1, as older programs write their umlauts and degree signs.
pub fn words(bytes: &[u8]) -> Cow<'_, str> {
    let latin = || bytes.iter().map(|&byte| char::from(byte)).collect::<String>();
    std::str::from_utf8(bytes).map_or_else(|_| Cow::from(latin()), Cow::from)
}

impl Cells {
    /// Splits a line; `false` if a quote stays open. Several blanks count as one separator.
    pub fn cut(&mut self, line: &[u8], separator: u8) -> bool {
        self.bounds.clear();
        if separator == b' ' {
            return self.cut_blanks(line);
        }
        let mut start = 0;
        for end in memchr2_iter(separator, b'"', line) {
            if line.get(end) == Some(&b'"') {
                return self.cut_quoted(line, separator);
            }
            self.bounds.push((start, end));
            start = end + 1;
        }
        self.bounds.push((start, line.len()));
        true
    }

    fn cut_blanks(&mut self, line: &[u8]) -> bool {
        let mut start = None;
        for (at, byte) in line.iter().enumerate() {
            if !byte.is_ascii_whitespace() {
                start.get_or_insert(at);
            } else if let Some(start) = start.take() {
                self.bounds.push((start, at));
            }
        }
        self.bounds.extend(start.map(|start| (start, line.len())));
        true
    }

    fn cut_quoted(&mut self, line: &[u8], separator: u8) -> bool {
        self.bounds.clear();
        let mut start = 0;
        let mut quoted = false;
        for (at, &byte) in line.iter().enumerate() {
            if byte == b'"' {
                // A doubled quote inside a cell switches twice, which needs no special case.
                quoted = !quoted;
            } else if byte == separator && !quoted {
                self.bounds.push((start, at));
                start = at + 1;
            }
        }
        self.bounds.push((start, line.len()));
        !quoted
    }

    /// Number of cells in the line.
    #[must_use]
    pub fn len(&self) -> usize {
        self.bounds.len()
    }

    /// Whether no line was split yet.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.bounds.is_empty()
    }

    /// A cell of the last line, from 0, without surrounding blanks and quotes.
    #[must_use]
    pub fn get<'a>(&self, line: &'a [u8], index: usize) -> Option<&'a [u8]> {
        let &(start, end) = self.bounds.get(index)?;
        Some(unquoted(line.get(start..end)?))
    }

    /// A cell as text, empty if missing; doubled quotes become one.
    #[must_use]
    pub fn text(&self, line: &[u8], index: usize) -> String {
        let cell = self.get(line, index).unwrap_or_default();
        words(cell).replace("\"\"", "\"")
    }
}

fn unquoted(cell: &[u8]) -> &[u8] {
    let cell = cell.trim_ascii();
    match cell {
        [b'"', inner @ .., b'"'] => inner.trim_ascii(),
        _ => cell,
    }
}

/// All cells of a header line as text.
#[must_use]
pub fn texts(line: &[u8], separator: u8) -> Vec<String> {
    let mut cells = Cells::default();
    cells.cut(line, separator);
    (0..cells.len()).map(|i| cells.text(line, i)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_as_the_csv_crate_cuts_them() {
        let lines = ["a,b,c", "a,,", "\"a,b\",c", "\"a\"\"b\",\"\"", "", "\"x\"", "1;2,3"];
        for line in lines {
            let mut reader =
                csv::ReaderBuilder::new().has_headers(false).from_reader(line.as_bytes());
            let expected: Vec<String> = match reader.records().next() {
                Some(record) => record.unwrap().iter().map(str::to_string).collect(),
                None => vec![String::new()],
            };
            assert_eq!(texts(line.as_bytes(), b','), expected, "{line}");
        }
    }

    #[test]
    fn any_number_of_blanks_separates() {
        assert_eq!(texts(b"  0.0625 \t 12.5", b' '), ["0.0625", "12.5"]);
    }

    #[test]
    fn an_open_quote_is_told() {
        let mut cells = Cells::default();
        assert!(!cells.cut(b"\"a,b", b','));
        assert!(cells.cut(b"a,\"b\"", b','));
    }

    #[test]
    fn blanks_around_cells_do_not_count() {
        assert_eq!(texts(b" a ;\" b \"; c", b';'), ["a", "b", "c"]);
    }
}
