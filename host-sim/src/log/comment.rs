//! Lines that are not rows.

use super::number::is_missing;

/// The text of a comment: after `#`, or `%` as in MATLAB, also if a spreadsheet has quoted the
/// whole line. A row may begin with `#N/A`.
#[must_use]
pub fn comment(line: &[u8]) -> Option<&[u8]> {
    let first_cell = |line: &[u8]| {
        let end = line.iter().position(|byte| b",;|\t \r".contains(byte));
        is_missing(end.and_then(|end| line.get(..end)).unwrap_or(line))
    };
    match line.trim_ascii_start() {
        row @ [b'#', ..] if first_cell(row) => None,
        [b'#' | b'%', text @ ..] => Some(text.trim_ascii_start()),
        [b'"', cell @ ..] => {
            let end = cell.iter().position(|&byte| byte == b'"')?;
            let (cell, behind) = cell.split_at_checked(end)?;
            let alone = behind.iter().all(|byte| b"\",;\t ".contains(byte));
            comment(cell).filter(|text| alone && text.contains(&b':'))
        }
        _ => None,
    }
}

/// Whether a line is only a ruler of a table: `|---|---|`, `--------+--------`.
#[must_use]
pub fn is_ruler(line: &[u8]) -> bool {
    let rules = |w: &[u8]| w == b"--" || w == b"==";
    line.iter().all(|byte| b"-=+|: \t".contains(byte)) && line.windows(2).any(rules)
}

/// Whether a line is an empty row of a spreadsheet: separators and quotes alone.
#[must_use]
pub fn is_empty(line: &[u8]) -> bool {
    line.iter().all(|byte| b";\t|,\" ".contains(byte))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_are_told_from_rows() {
        assert_eq!(comment(b" % note"), Some(&b"note"[..]));
        assert_eq!(comment(b"\"#\",\"time\""), None);
        assert_eq!((comment(b"#N/A"), comment(b" #DIV/0!;7")), (None, None));
        assert_eq!(comment(b"#N/A: none"), Some(&b"N/A: none"[..]));
    }

    #[test]
    fn rulers() {
        for line in ["|---|:--:|", " --------+---------", "==== ====", "---"] {
            assert!(is_ruler(line.as_bytes()), "{line}");
        }
        for line in ["---;---", "-", "--- 1", "0 --- 1", ""] {
            assert!(!is_ruler(line.as_bytes()), "{line}");
        }
    }
}
