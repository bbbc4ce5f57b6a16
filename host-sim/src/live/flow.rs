//! Text in rows of a given width, without breaks in words or numbers.

use ratatui::text::{Line, Span};

/// Space between parts of a row.
const GAP: &str = "   ";

/// The words of a text in rows of at most `width` characters; only a longer word is broken.
#[must_use]
pub fn wrapped(text: &str, width: u16) -> Vec<String> {
    let width = usize::from(width).max(1);
    let mut rows = vec![String::new()];
    for word in text.split_whitespace() {
        let mut word: String = word.to_string();
        while !word.is_empty() {
            let Some(row) = rows.last_mut() else { break };
            let used = row.chars().count();
            let gap = usize::from(used > 0);
            if used + gap + word.chars().count() <= width {
                if gap > 0 {
                    row.push(' ');
                }
                row.push_str(&word);
                break;
            }
            if used == 0 {
                let cut: String = word.chars().take(width).collect();
                word = word.chars().skip(width).collect();
                row.push_str(&cut);
            }
            rows.push(String::new());
        }
    }
    if rows.len() > 1 && rows.last().is_some_and(String::is_empty) {
        rows.pop();
    }
    rows
}

/// Parts side by side, as many per row as fit; a part wider than a row is wrapped.
#[must_use]
pub fn flow(parts: Vec<Span<'static>>, width: u16) -> Vec<Line<'static>> {
    let mut rows: Vec<Line<'static>> = Vec::new();
    for part in parts.into_iter().filter(|part| !part.content.is_empty()) {
        let fits =
            |row: &&mut Line<'_>| row.width() + GAP.len() + part.width() <= usize::from(width);
        match rows.last_mut().filter(fits) {
            Some(row) => row.spans.extend([Span::raw(GAP), part]),
            None if part.width() <= usize::from(width) => rows.push(Line::from(part)),
            None => {
                let style = part.style;
                let pieces = wrapped(&part.content, width);
                rows.extend(pieces.into_iter().map(|piece| Line::from(Span::styled(piece, style))));
            }
        }
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_stay_whole() {
        assert_eq!(wrapped("one two three", 7), ["one two", "three"]);
        assert_eq!(wrapped("one two three", 8), ["one two", "three"]);
        assert_eq!(wrapped("", 8), [""]);
        assert_eq!(wrapped("abcdefgh ij", 3), ["abc", "def", "gh", "ij"]);
        assert_eq!(wrapped("±± ±±", 5), ["±± ±±"]);
        assert_eq!(wrapped("a b", 0), ["a", "b"]);
    }

    #[test]
    fn parts_stay_whole() {
        let parts =
            || ["noise 1.9 N", "loading 360 N/s", "", "k 23.0 kN/m"].map(Span::raw).to_vec();
        let rows = |width| flow(parts(), width).iter().map(ToString::to_string).collect::<Vec<_>>();
        assert_eq!(rows(80), ["noise 1.9 N   loading 360 N/s   k 23.0 kN/m"]);
        assert_eq!(rows(30), ["noise 1.9 N   loading 360 N/s", "k 23.0 kN/m"]);
        assert_eq!(rows(12), ["noise 1.9 N", "loading 360", "N/s", "k 23.0 kN/m"]);
    }
}
