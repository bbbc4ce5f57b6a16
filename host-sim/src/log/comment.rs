//! Lines that are no rows.

use super::number::is_missing;

/// The text of a comment: behind `#`, or `%` as MATLAB has it, also where a spreadsheet has put
/// the whole of it in quotes. A row may begin with `#N/A`.
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
}
