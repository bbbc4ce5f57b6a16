//! Items between two brackets: one value per line, indented by its depth.

use std::io::{self, Write};

use serde::ser::{self, Serialize};

use super::{Done, Failure, Pretty};

/// Separator before a value with indentation, and the indentation of one level.
const LINE: &[u8] = b",\n                        ";
const INDENT: &[u8] = b"  ";

/// Writes the items between two brackets.
#[derive(Debug)]
pub struct Items<'a, W> {
    out: &'a mut W,
    depth: usize,
    is_empty: bool,
    bracket: u8,
}

impl<'a, W: Write> Items<'a, W> {
    /// Starts without items, at a depth, with the closing bracket.
    pub(super) fn new(out: &'a mut W, depth: usize, bracket: u8) -> Self {
        Self { out, depth, is_empty: true, bracket }
    }

    fn begin_line(&mut self) -> io::Result<()> {
        let comma = usize::from(std::mem::take(&mut self.is_empty));
        if let Some(line) = LINE.get(comma..2 + INDENT.len() * self.depth) {
            return self.out.write_all(line);
        }
        self.out.write_all(LINE.get(comma..2).unwrap_or_default())?;
        (0..self.depth).try_for_each(|_| self.out.write_all(INDENT))
    }

    fn value<T: Serialize + ?Sized>(&mut self, value: &T) -> Done {
        value.serialize(Pretty { out: &mut *self.out, depth: self.depth })
    }

    fn item<T: Serialize + ?Sized>(&mut self, value: &T) -> Done {
        self.begin_line()?;
        self.value(value)
    }

    fn close(mut self) -> Done {
        self.depth -= 1;
        if !self.is_empty {
            self.is_empty = true;
            self.begin_line()?;
        }
        Ok(self.out.write_all(&[self.bracket])?)
    }
}

macro_rules! items {
    ($($kind:ident::$method:ident;)*) => {
        $(impl<W: Write> ser::$kind for Items<'_, W> {
            type Ok = ();
            type Error = Failure;

            fn $method<T: Serialize + ?Sized>(&mut self, value: &T) -> Done {
                self.item(value)
            }

            fn end(self) -> Done {
                self.close()
            }
        })*
    };
}

items! {
    SerializeSeq::serialize_element;
    SerializeTuple::serialize_element;
    SerializeTupleStruct::serialize_field;
}

impl<W: Write> ser::SerializeMap for Items<'_, W> {
    type Ok = ();
    type Error = Failure;

    /// Writes a key, which is a text.
    fn serialize_key<T: Serialize + ?Sized>(&mut self, key: &T) -> Done {
        self.item(key)
    }

    fn serialize_value<T: Serialize + ?Sized>(&mut self, value: &T) -> Done {
        self.out.write_all(b": ")?;
        self.value(value)
    }

    fn end(self) -> Done {
        self.close()
    }
}

impl<W: Write> ser::SerializeStruct for Items<'_, W> {
    type Ok = ();
    type Error = Failure;

    fn serialize_field<T: Serialize + ?Sized>(&mut self, key: &'static str, value: &T) -> Done {
        self.begin_line()?;
        self.out.write_all(b"\"")?;
        self.out.write_all(key.as_bytes())?;
        self.out.write_all(b"\": ")?;
        self.value(value)
    }

    fn end(self) -> Done {
        self.close()
    }
}
