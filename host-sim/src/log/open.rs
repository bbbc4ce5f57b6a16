//! Opens a log: finds format, header and columns.

use std::io::{Cursor, Read};

use floe_firmware::record::SECTOR_LEN;

use crate::error::{InputError, excerpt};

use super::cells::texts;
use super::comment::comment;
use super::header;
use super::layout::Layout;
use super::lines::Lines;
use super::metadata::Metadata;
use super::options::LogOptions;
use super::rows::Rows;
use super::{Format, Recognised, cr10, csv, toa5};

/// Number of bytes that show whether a stream is a card's log: 64 sectors.
pub const START_LEN: usize = 64 * SECTOR_LEN;

/// The beginning of a stream, [`START_LEN`] bytes or all of it, and the whole stream.
///
/// # Errors
/// The stream cannot be read.
pub fn peek(
    mut input: Box<dyn Read + Send>,
) -> Result<(Box<dyn Read + Send>, Vec<u8>), InputError> {
    let mut start = Vec::new();
    let read = input.by_ref().take(START_LEN as u64).read_to_end(&mut start);
    read.map_err(InputError::unreadable)?;
    Ok((Box::new(Cursor::new(start.clone()).chain(input)), start))
}

/// Error for another log with `--format floe`.
#[must_use]
pub fn no_floe() -> InputError {
    InputError::new(format!(
        "its first {} KiB hold no record of a floe logger: floe recover looks through all of it, and \
         another log needs no --format floe",
        START_LEN / 1024
    ))
}

/// The text converted to UTF-8 if it begins with the mark of UTF-16.
#[must_use]
pub fn utf8(input: Box<dyn Read + Send>, start: &[u8]) -> Box<dyn Read + Send> {
    if start.starts_with(b"\xFF\xFE") || start.starts_with(b"\xFE\xFF") {
        return Box::new(encoding_rs_io::DecodeReaderBytes::new(input));
    }
    input
}

/// Beginnings of files in other formats, with their remedies.
const BINARY: [(&[u8], &str); 6] = [
    (b"PK\x03\x04", "is a spreadsheet, or another zip archive; save its table as CSV"),
    (b"\xD0\xCF\x11\xE0", "is an old spreadsheet; save its table as CSV"),
    (b"PAR1", "is a Parquet file; write its table as CSV"),
    (b"\x89HDF", "is an HDF5 file; write its columns as CSV"),
    (b"MATLAB", "is a MATLAB file; write its columns as CSV"),
    (b"TDSm", "is a LabVIEW measurement (TDMS); export it as text"),
];

/// Beginnings of compressed files, with what unpacks them to standard output.
const PACKED: [(&[u8], &str); 4] = [
    (b"\x1F\x8B", "gunzip -c"),
    (b"BZh", "bunzip2 -c"),
    (b"\xFD7zXZ", "xz -dc"),
    (b"\x28\xB5\x2F\xFD", "zstd -dc"),
];

/// What unpacks a compressed file to standard output.
pub fn unpacker(head: &[u8]) -> Option<&'static str> {
    PACKED.iter().find(|(start, _)| head.starts_with(start)).map(|(_, tool)| *tool)
}

/// Rejects input that is certainly no text log, with a remedy.
///
/// # Errors
/// Names the kind of the input.
pub fn refuse_binary(head: &[u8]) -> Result<(), InputError> {
    let refuse = |message: &str| Err(InputError::new(message));
    let text = head.trim_ascii_start();
    if text.is_empty() {
        return refuse("is empty");
    }
    for kind in ["TOB1", "TOB2", "TOB3", "TOACI1"] {
        if text.strip_prefix(b"\"").unwrap_or(text).starts_with(kind.as_bytes()) {
            return Err(InputError::new(format!("is {kind}; convert it to TOA5 with CardConvert")));
        }
    }
    if is_card(head) {
        return refuse("is the image of a card; floe recover takes the tests out of it");
    }
    if zeros_between(head) {
        return refuse("looks like UTF-16 text without its mark, or UTF-32; save it as UTF-8");
    }
    if text.starts_with(b"%PDF") {
        return refuse("is a PDF; write its table as CSV");
    }
    if is_json(text) {
        return refuse("is JSON; write its times and forces as CSV");
    }
    let starts = |tag: &str| {
        text.get(..tag.len()).is_some_and(|start| start.eq_ignore_ascii_case(tag.as_bytes()))
    };
    if ["<?xml", "<!doctype", "<html", "<table"].into_iter().any(starts) {
        return refuse("is HTML or XML; save its table as CSV");
    }
    let mut lines = text.splitn(2, |&byte| byte == b'\n');
    let (first, rest) = (lines.next().unwrap_or_default(), lines.next().unwrap_or_default());
    if first.contains(&0) || control_share(head) > 0.02 {
        if let Some(tool) = unpacker(head) {
            let remedy = format!("is compressed; unpack it, or {tool} FILE | floe replay -");
            return Err(InputError::new(remedy));
        }
        let known = BINARY.iter().find(|(start, _)| head.starts_with(start));
        let other = match !rest.is_empty() && control_share(rest) <= 0.0 {
            true => "line 1 is no text: take it out, or give --skip-lines 1",
            false => {
                "is a binary file, not a csv, toa5 or cr10 log; a damaged card is for floe recover"
            }
        };
        return refuse(known.map_or(other, |known| known.1));
    }
    Ok(())
}

/// The beginning of a log behind the lines that are left out; all of it if nothing is left.
pub fn below(head: &[u8], end: u8, skip_lines: u64) -> &[u8] {
    let mut ends = head.iter().enumerate().filter(|(_, byte)| **byte == end);
    let last = skip_lines.checked_sub(1).and_then(|before| ends.nth(before as usize));
    last.and_then(|(at, _)| head.get(at + 1..)).unwrap_or(head)
}

/// Whether a sector is the first of a card with a file system.
fn is_card(head: &[u8]) -> bool {
    head.get(..SECTOR_LEN)
        .is_some_and(|sector| sector.ends_with(b"\x55\xAA") && sector.contains(&0))
}

/// Whether a text is a JSON object, or an array of objects or arrays; an instrument's `[Header]` is
/// not.
fn is_json(text: &[u8]) -> bool {
    let mut marks = text.iter().filter(|byte| !byte.is_ascii_whitespace());
    matches!(
        (marks.next(), marks.next()),
        (Some(b'{'), Some(b'"')) | (Some(b'['), Some(b'{' | b'['))
    )
}

/// Whether every second byte is zero, as in Latin text with two bytes per letter.
fn zeros_between(head: &[u8]) -> bool {
    let start = head.get(..64).unwrap_or(head);
    let zeros = |from: usize| start.iter().skip(from).step_by(2).all(|&byte| byte == 0);
    start.len() > 3 && (zeros(0) || zeros(1)) && start.iter().any(|&byte| byte != 0)
}

/// Fraction of bytes that no text contains, without the zeros that a logger leaves at the end after
/// a power cut.
fn control_share(bytes: &[u8]) -> f64 {
    let end = bytes.iter().rposition(|&byte| byte != 0).map_or(0, |last| last + 1);
    let bytes = bytes.get(..end).unwrap_or_default();
    let control = |byte: &&u8| byte.is_ascii_control() && !byte.is_ascii_whitespace();
    bytes.iter().filter(control).count() as f64 / bytes.len().max(1) as f64
}

/// The format, from the first line that is no comment; lines end with `end`.
#[must_use]
pub fn recognise(head: &[u8], end: u8) -> Format {
    let lines = head.split(|&byte| byte == end).map(<[u8]>::trim_ascii);
    let first = lines.into_iter().find(|line| !line.is_empty() && comment(line).is_none());
    match first.unwrap_or_default() {
        line if is_toa5(line) => Format::Toa5,
        line if cr10::is_row(line) => Format::Cr10,
        _ => Format::Csv,
    }
}

fn is_toa5(line: &[u8]) -> bool {
    line.strip_prefix(b"\"").unwrap_or(line).starts_with(b"TOA5")
}

/// Consumes the header and finds the layout.
///
/// # Errors
/// A header that cannot be used.
pub fn begin(
    format: Format,
    mut lines: Lines,
    options: &LogOptions,
) -> Result<(Rows, Recognised), InputError> {
    let mut metadata = Metadata::new(&options.settled);
    let (layout, head) = match format {
        Format::Csv | Format::Floe => table(&mut lines, &mut metadata, options)?,
        Format::Toa5 => toa5_layout(&mut lines, &mut metadata, options)?,
        Format::Cr10 => {
            let (head, end) = lines.head()?;
            let (layout, notes) = cr10::layout(head, end, options)?;
            (layout, Recognised { header: None, notes })
        }
    };
    Ok((Rows::new(lines, layout, metadata), head))
}

/// Header and columns of a text table; consumes the lines above its first row.
fn table(
    lines: &mut Lines,
    metadata: &mut Metadata,
    options: &LogOptions,
) -> Result<(Layout, Recognised), InputError> {
    let (head, end) = lines.head()?;
    let header = header::find(head, end, options.skip_lines, options.delimiter)?;
    for _ in 1..header.first_row {
        let Some(line) = lines.next_line()? else { break };
        let number = line.number;
        if number <= options.skip_lines {
            continue;
        }
        let taken = metadata.take(line.bytes, number);
        taken.map_err(|error| error.within(format_args!("line {number}")))?;
    }
    let line = header.names.as_ref().map_or(header.first_row, |(number, _)| *number);
    let found = csv::layout(&header, options, metadata);
    let (layout, notes) = found.map_err(|error| error.within(format_args!("line {line}")))?;
    Ok((layout, Recognised { header: Some(header), notes }))
}

fn toa5_layout(
    lines: &mut Lines,
    metadata: &mut Metadata,
    options: &LogOptions,
) -> Result<(Layout, Recognised), InputError> {
    let (first, number) = header_line(lines, metadata)?;
    if !is_toa5(&first) {
        let message = format!("a toa5 log begins with \"TOA5\", not {}", excerpt(&first));
        return Err(InputError::new(message).within(format_args!("line {number}")));
    }
    metadata.undated = texts(&first, b',').last().is_some_and(|table| table == toa5::UNDATED);
    let (names, number) = header_line(lines, metadata)?;
    let (units, _) = header_line(lines, metadata)?;
    let (_processing, _) = header_line(lines, metadata)?;
    let found = toa5::layout(&names, &units, options, metadata.first("unit"));
    let (layout, notes) = found.map_err(|error| error.within(format_args!("line {number}")))?;
    Ok((layout, Recognised { header: None, notes }))
}

/// The next line that is neither empty nor a comment, and its number.
fn header_line(lines: &mut Lines, metadata: &mut Metadata) -> Result<(Vec<u8>, u64), InputError> {
    while let Some(line) = lines.next_line()? {
        let number = line.number;
        match line.bytes.trim_ascii_start().first() {
            None => {}
            Some(b'#' | b'%' | b'"') if comment(line.bytes).is_some() => {
                let taken = metadata.take(line.bytes, number);
                taken.map_err(|error| error.within(format_args!("line {number}")))?;
            }
            Some(_) => return Ok((line.bytes.to_vec(), number)),
        }
    }
    Err(InputError::new("ends before its header does"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_holds_a_log_in_another_form_is_named_with_the_way_out() {
        for (start, why) in BINARY {
            let rest = (0..=255_u8).cycle().take(1000);
            let head: Vec<u8> = start.iter().copied().chain(rest).collect();
            assert_eq!(refuse_binary(&head), Err(InputError::new(why)));
        }
        assert_eq!(refuse_binary(b"PK\x03\x04"[..2].as_ref()), Ok(()));
        assert_eq!(refuse_binary(b"MATLAB 1.2\nt,F\n0,1\n"), Ok(()));
    }
}
