//! JSON with the line breaks of `serde_json`'s pretty form, byte for byte, but with one write
//! for the beginning of a line: a long list of events consists of little else.

use std::io::{self, Write};

use serde_json::ser::Formatter;

/// What comes before a value, and room for the indentation.
const LINE: &[u8] = b",\n                        ";
const INDENT: &[u8] = b"  ";

/// For [`serde_json::Serializer::with_formatter`].
#[derive(Clone, Copy, Debug, Default)]
pub struct Indented {
    depth: usize,
    has_value: bool,
}

impl Indented {
    fn open(&mut self, out: &mut (impl Write + ?Sized), bracket: u8) -> io::Result<()> {
        *self = Self { depth: self.depth + 1, has_value: false };
        out.write_all(&[bracket])
    }

    fn close(&mut self, out: &mut (impl Write + ?Sized), bracket: u8) -> io::Result<()> {
        self.depth = self.depth.saturating_sub(1);
        if self.has_value {
            self.begin_line(out, true)?;
        }
        out.write_all(&[bracket])
    }

    fn begin_line(&self, out: &mut (impl Write + ?Sized), is_first: bool) -> io::Result<()> {
        let (comma, break_and_indent) = (usize::from(is_first), 2 + INDENT.len() * self.depth);
        if let Some(line) = LINE.get(comma..break_and_indent) {
            return out.write_all(line);
        }
        out.write_all(LINE.get(comma..2).unwrap_or_default())?;
        (0..self.depth).try_for_each(|_| out.write_all(INDENT))
    }
}

impl Formatter for Indented {
    fn begin_array<W: Write + ?Sized>(&mut self, out: &mut W) -> io::Result<()> {
        self.open(out, b'[')
    }

    fn end_array<W: Write + ?Sized>(&mut self, out: &mut W) -> io::Result<()> {
        self.close(out, b']')
    }

    fn begin_array_value<W: Write + ?Sized>(&mut self, out: &mut W, first: bool) -> io::Result<()> {
        self.begin_line(out, first)
    }

    fn end_array_value<W: Write + ?Sized>(&mut self, _: &mut W) -> io::Result<()> {
        self.has_value = true;
        Ok(())
    }

    fn begin_object<W: Write + ?Sized>(&mut self, out: &mut W) -> io::Result<()> {
        self.open(out, b'{')
    }

    fn end_object<W: Write + ?Sized>(&mut self, out: &mut W) -> io::Result<()> {
        self.close(out, b'}')
    }

    fn begin_object_key<W: Write + ?Sized>(&mut self, out: &mut W, first: bool) -> io::Result<()> {
        self.begin_line(out, first)
    }

    fn begin_object_value<W: Write + ?Sized>(&mut self, out: &mut W) -> io::Result<()> {
        out.write_all(b": ")
    }

    fn end_object_value<W: Write + ?Sized>(&mut self, _: &mut W) -> io::Result<()> {
        self.has_value = true;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use serde::Serialize;
    use serde_json::{Serializer, Value, json};

    use super::*;

    #[test]
    fn the_bytes_are_those_of_the_pretty_form() {
        let deep = (0..30).fold(json!({"end": []}), |inner, i| match i % 2 {
            0 => json!([inner, 1.5]),
            _ => json!({"a": inner, "b": {}}),
        });
        let flat = json!({"list": [1, null, "x\n", true], "none": [], "empty": {}});
        for value in [json!(3), Value::Null, flat, deep] {
            let mut bytes = Vec::new();
            let mut to = Serializer::with_formatter(&mut bytes, Indented::default());
            value.serialize(&mut to).unwrap();
            assert_eq!(bytes, serde_json::to_vec_pretty(&value).unwrap());
        }
    }
}
