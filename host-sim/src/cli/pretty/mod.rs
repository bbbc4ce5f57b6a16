//! JSON equal to `serde_json`'s pretty form, byte for byte. Most bytes of a long list of events are
//! line breaks and names of fields; they are written in one piece, and names in the program are not
//! searched for characters that JSON must escape.

mod items;

use std::fmt;
use std::io::{self, Write};

use serde::ser::{self, Impossible, Serialize, Serializer};
use serde_json::Serializer as Plain;

use self::items::Items;

/// Writes one value.
#[derive(Debug)]
pub struct Pretty<'a, W> {
    out: &'a mut W,
    depth: usize,
}

/// Error of writing, with its original cause.
#[derive(Debug)]
pub struct Failure(pub io::Error);

type Done = Result<(), Failure>;

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl std::error::Error for Failure {}

impl ser::Error for Failure {
    fn custom<T: fmt::Display>(message: T) -> Self {
        Self(io::Error::other(message.to_string()))
    }
}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        Self(error)
    }
}

impl From<serde_json::Error> for Failure {
    fn from(error: serde_json::Error) -> Self {
        Self(error.into())
    }
}

impl<'a, W: Write> Pretty<'a, W> {
    /// Starts at the outermost value.
    pub fn new(out: &'a mut W) -> Self {
        Self { out, depth: 0 }
    }

    fn open(self, brackets: [u8; 2]) -> Result<Items<'a, W>, Failure> {
        let [bracket, close] = brackets;
        self.out.write_all(&[bracket])?;
        Ok(Items::new(self.out, self.depth + 1, close))
    }
}

macro_rules! plainly {
    ($($name:ident($type:ty);)*) => {
        $(fn $name(self, value: $type) -> Done {
            Ok(Plain::new(self.out).$name(value)?)
        })*
    };
}

impl<'a, W: Write> Serializer for Pretty<'a, W> {
    type Ok = ();
    type Error = Failure;
    type SerializeSeq = Items<'a, W>;
    type SerializeTuple = Items<'a, W>;
    type SerializeTupleStruct = Items<'a, W>;
    type SerializeTupleVariant = Impossible<(), Failure>;
    type SerializeMap = Items<'a, W>;
    type SerializeStruct = Items<'a, W>;
    type SerializeStructVariant = Impossible<(), Failure>;

    plainly! {
        serialize_bool(bool);
        serialize_i8(i8);
        serialize_i16(i16);
        serialize_i32(i32);
        serialize_i64(i64);
        serialize_u8(u8);
        serialize_u16(u16);
        serialize_u32(u32);
        serialize_u64(u64);
        serialize_f32(f32);
        serialize_f64(f64);
        serialize_char(char);
        serialize_str(&str);
        serialize_unit_struct(&'static str);
    }

    fn serialize_bytes(self, bytes: &[u8]) -> Done {
        self.collect_seq(bytes)
    }

    fn serialize_none(self) -> Done {
        self.serialize_unit()
    }

    fn serialize_unit(self) -> Done {
        Ok(self.out.write_all(b"null")?)
    }

    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> Done {
        value.serialize(self)
    }

    fn serialize_unit_variant(self, _: &'static str, _: u32, name: &'static str) -> Done {
        self.serialize_str(name)
    }

    fn serialize_newtype_struct<T: Serialize + ?Sized>(self, _: &'static str, value: &T) -> Done {
        value.serialize(self)
    }

    fn serialize_newtype_variant<T: Serialize + ?Sized>(
        self,
        _: &'static str,
        _: u32,
        name: &'static str,
        value: &T,
    ) -> Done {
        self.collect_map([(name, value)])
    }

    fn serialize_seq(self, _: Option<usize>) -> Result<Items<'a, W>, Failure> {
        self.open(*b"[]")
    }

    fn serialize_tuple(self, _: usize) -> Result<Items<'a, W>, Failure> {
        self.open(*b"[]")
    }

    fn serialize_tuple_struct(self, _: &'static str, _: usize) -> Result<Items<'a, W>, Failure> {
        self.open(*b"[]")
    }

    fn serialize_map(self, _: Option<usize>) -> Result<Items<'a, W>, Failure> {
        self.open(*b"{}")
    }

    fn serialize_struct(self, _: &'static str, _: usize) -> Result<Items<'a, W>, Failure> {
        self.open(*b"{}")
    }

    /// Results contain no such value.
    fn serialize_tuple_variant(
        self,
        _: &'static str,
        _: u32,
        name: &'static str,
        _: usize,
    ) -> Result<Self::SerializeTupleVariant, Failure> {
        Err(ser::Error::custom(name))
    }

    /// Results contain no such value.
    fn serialize_struct_variant(
        self,
        _: &'static str,
        _: u32,
        name: &'static str,
        _: usize,
    ) -> Result<Self::SerializeStructVariant, Failure> {
        Err(ser::Error::custom(name))
    }
}

#[cfg(test)]
mod tests {
    use serde::Serialize;
    use serde_json::{Value, json};

    use super::*;

    fn assert_same(value: &impl Serialize) {
        let mut bytes = Vec::new();
        value.serialize(Pretty::new(&mut bytes)).unwrap();
        let expected = serde_json::to_vec_pretty(value).unwrap();
        assert_eq!(String::from_utf8(bytes).unwrap(), String::from_utf8(expected).unwrap());
    }

    #[test]
    fn the_bytes_are_those_of_the_pretty_form() {
        let deep = (0..30).fold(json!({"end": []}), |inner, i| match i % 2 {
            0 => json!([inner, 1.5]),
            _ => json!({"a": inner, "b": {}}),
        });
        let flat = json!({"list": [1, null, "x\n", true], "none": [], "em\"pty": {}});
        for value in [json!(3), Value::Null, flat, deep] {
            assert_same(&value);
        }
    }

    #[derive(Serialize)]
    struct Every {
        number: f32,
        none: Option<f64>,
        not: f64,
        text: &'static str,
        pair: Option<[Option<f32>; 2]>,
        tuple: (u8, char),
        word: Word,
        new: Word,
        #[serde(flatten)]
        more: More,
    }

    #[derive(Serialize)]
    struct More {
        unit: (),
        bytes: Vec<u8>,
    }

    #[derive(Serialize)]
    enum Word {
        Plain,
        With(i64),
    }

    #[test]
    fn so_they_are_of_what_a_result_consists_of() {
        assert_same(&Every {
            number: 0.78,
            none: None,
            not: f64::NAN,
            text: "a\u{1b}\"\\\u{202e}",
            pair: Some([Some(1e-9), None]),
            tuple: (7, '\t'),
            word: Word::Plain,
            new: Word::With(-3),
            more: More { unit: (), bytes: vec![1, 2] },
        });
    }

    #[test]
    fn what_went_wrong_is_told_as_it_was() {
        struct Gone;
        impl Write for Gone {
            fn write(&mut self, _: &[u8]) -> io::Result<usize> {
                Err(io::ErrorKind::BrokenPipe.into())
            }
            fn flush(&mut self) -> io::Result<()> {
                Ok(())
            }
        }
        for value in [json!(1), json!({"a": []})] {
            let Failure(error) = value.serialize(Pretty::new(&mut Gone)).unwrap_err();
            assert_eq!(error.kind(), io::ErrorKind::BrokenPipe);
        }
    }
}
