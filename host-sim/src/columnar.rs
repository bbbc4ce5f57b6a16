//! Columns and settings common to all Parquet files of Floe.

use std::io::{self, Write};
use std::sync::Arc;

use parquet::basic::{Compression, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{
    BoolType, ByteArray, ByteArrayType, DataType, DoubleType, FloatType, Int32Type, Int64Type,
};
use parquet::errors::{ParquetError, Result};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{
    EnabledStatistics, WriterProperties, WriterPropertiesBuilder, WriterPropertiesPtr,
};
use parquet::file::writer::SerializedRowGroupWriter;
use parquet::schema::types::{ColumnPath, Type, TypePtr};

/// Largest size of a dictionary, bytes: a column with more distinct values has hardly any repeated,
/// and the search for them would take most of the time of writing.
const DICTIONARY: usize = 1 << 16;

/// The error behind a Parquet error, without the library's prefix.
pub(crate) fn io_error(error: ParquetError) -> io::Error {
    let ParquetError::External(cause) = error else { return io::Error::other(error) };
    cause.downcast().map_or_else(io::Error::other, |cause| *cause)
}

/// Kind of a column in a table of `R`, and where its values come from.
pub(crate) enum Column<'a, R> {
    Integer(fn(R) -> i32),
    Long(fn(R) -> i64),
    Number(fn(R) -> f64),
    Maybe(fn(R) -> Option<f64>),
    MaybeSingle(fn(R) -> Option<f32>),
    Truth(fn(R) -> bool),
    Text(fn(R) -> &'a str),
    MaybeText(fn(R) -> Option<&'a str>),
}

impl<'a, R> Column<'a, R> {
    fn field(&self, name: &str) -> Result<TypePtr> {
        let (required, optional) = (Repetition::REQUIRED, Repetition::OPTIONAL);
        let (physical, repetition) = match self {
            Self::Integer(_) => (Physical::INT32, required),
            Self::Long(_) => (Physical::INT64, required),
            Self::Number(_) => (Physical::DOUBLE, required),
            Self::Maybe(_) => (Physical::DOUBLE, optional),
            Self::MaybeSingle(_) => (Physical::FLOAT, optional),
            Self::Truth(_) => (Physical::BOOLEAN, required),
            Self::Text(_) => (Physical::BYTE_ARRAY, required),
            Self::MaybeText(_) => (Physical::BYTE_ARRAY, optional),
        };
        let text = (physical == Physical::BYTE_ARRAY).then_some(LogicalType::String);
        let builder = Type::primitive_type_builder(name, physical).with_repetition(repetition);
        builder.with_logical_type(text).build().map(Arc::new)
    }

    /// Writes the values of a group's rows.
    pub(crate) fn write(
        &self,
        group: &mut SerializedRowGroupWriter<'_, impl Write + Send>,
        rows: impl ExactSizeIterator<Item = R>,
    ) -> Result<()> {
        match self {
            Self::Integer(of) => write_all::<Int32Type>(group, rows.map(of)),
            Self::Long(of) => write_all::<Int64Type>(group, rows.map(of)),
            Self::Number(of) => write_all::<DoubleType>(group, rows.map(of)),
            Self::Maybe(of) => write_known::<DoubleType>(group, rows.map(of)),
            Self::MaybeSingle(of) => write_known::<FloatType>(group, rows.map(of)),
            Self::Truth(of) => write_all::<BoolType>(group, rows.map(of)),
            Self::Text(of) => {
                let mut shared = Shared::default();
                write_all::<ByteArrayType>(group, rows.map(|row| shared.value(of(row))))
            }
            Self::MaybeText(of) => {
                let mut shared = Shared::default();
                let values = rows.map(|row| of(row).map(|text| shared.value(text)));
                write_known::<ByteArrayType>(group, values)
            }
        }
    }
}

/// The schema of a table.
pub(crate) fn schema<R>(name: &str, columns: &[(&str, Column<'_, R>)]) -> Result<TypePtr> {
    let fields: Result<Vec<_>> = columns.iter().map(|(name, column)| column.field(name)).collect();
    Ok(Arc::new(Type::group_type_builder(name).with_fields(fields?).build()?))
}

/// The last text of a column; consecutive equal texts share one copy.
#[derive(Default)]
struct Shared(Option<ByteArray>);

impl Shared {
    fn value(&mut self, text: &str) -> ByteArray {
        let last = self.0.take().filter(|last| last.data() == text.as_bytes());
        self.0.insert(last.unwrap_or_else(|| ByteArray::from(text))).clone()
    }
}

fn write_all<T: DataType>(
    group: &mut SerializedRowGroupWriter<'_, impl Write + Send>,
    values: impl Iterator<Item = T::T>,
) -> Result<()> {
    write_column::<T>(group, &values.collect::<Vec<_>>(), None)
}

/// Writes values of which some rows have none.
fn write_known<T: DataType>(
    group: &mut SerializedRowGroupWriter<'_, impl Write + Send>,
    rows: impl ExactSizeIterator<Item = Option<T::T>>,
) -> Result<()> {
    let mut values = Vec::with_capacity(rows.len());
    let level = |value: Option<T::T>| {
        let is_known = value.is_some();
        values.extend(value);
        i16::from(is_known)
    };
    let levels: Vec<i16> = rows.map(level).collect();
    write_column::<T>(group, &values, Some(&levels))
}

/// Writes the next column of a group; `levels` is 0 where a row has no value; `None`: all rows have
/// one.
fn write_column<T: DataType>(
    group: &mut SerializedRowGroupWriter<'_, impl Write + Send>,
    values: &[T::T],
    levels: Option<&[i16]>,
) -> Result<()> {
    let Some(mut column) = group.next_column()? else { return Ok(()) };
    column.typed::<T>().write_batch(values, levels, None)?;
    column.close()
}

/// An entry of the metadata: `floe.schema` and the like.
pub(crate) fn entry(key: &str, value: String) -> KeyValue {
    KeyValue::new(format!("floe.{key}"), value)
}

/// Properties of a compressed file with its author and `about`, each an [`entry`]. `measured`
/// columns get no dictionary, since their values hardly ever repeat.
pub(crate) fn properties<'a>(
    about: &[(&str, String)],
    measured: impl Iterator<Item = &'a str>,
) -> WriterPropertiesPtr {
    const VERSION: &str = env!("CARGO_PKG_VERSION");
    let about = about.iter().map(|(key, value)| entry(key, value.clone()));
    let version = entry("version", VERSION.to_string());
    let properties = WriterProperties::builder()
        .set_created_by(format!("floe {VERSION}"))
        .set_compression(Compression::SNAPPY)
        .set_dictionary_page_size_limit(DICTIONARY)
        .set_statistics_enabled(EnabledStatistics::Chunk)
        .set_key_value_metadata(Some(about.chain([version]).collect()));
    let plain = |properties: WriterPropertiesBuilder, name| {
        properties.set_column_dictionary_enabled(ColumnPath::from(name), false)
    };
    Arc::new(measured.fold(properties, plain).build())
}
